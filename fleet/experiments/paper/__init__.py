"""The paper's campaign, run anew: its figures, tables and claims beside the published ones.

Stanulovic, Mitton and Mezei, "Routing with Face Traversal and Auctions Algorithms for Task
Allocation in WSRN", Sensors 21(18):6149, 2021, doi:10.3390/s21186149.
"""
