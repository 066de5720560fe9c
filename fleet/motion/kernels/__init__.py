"""The compiled half of motion: where a robot can go, and how it drives there.

Kernels work on arrays of records, named in :mod:`fleet.motion.kernels.records`. Every module
here but that one loads numba when it is imported.
"""
