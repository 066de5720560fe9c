"""Where it happens: floors, obstacles, starting places, and when events appear.

Nothing here knows robots, radios or protocols. ``worlds.catalogue`` lists what there is.
"""
