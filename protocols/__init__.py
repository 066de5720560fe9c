"""What robots say to one another: pure conversations over a live topology.

Nothing here knows physics, files or clocks. ``protocols.catalogue`` lists what there is.
"""
