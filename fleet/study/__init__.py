"""Studies: many runs, in parallel, that survive whatever happens to the machine they run on.

The engine is three names. A :class:`Job` says what to run, :func:`run_jobs` runs what its
folder does not hold yet, and :class:`StudyResult` reads what the folder holds::

    protocols = "rfta2", "gfgf2a"
    jobs = [Job.of({"protocol": p, "seed": s}, cell=p) for s in range(9) for p in protocols]
    result = run_jobs(jobs, "out/mine")
    result.table()

Work of another kind is a function in a module, ``(Job) -> dict``, named by its import path:
``Job.of({...}, function="package.module:measure")``. What it returns is a row of the table
``runs``; rows of further tables may be under its key ``tables``.
"""

from fleet.study.endings import BrokenOff, Interrupted
from fleet.study.job import Job
from fleet.study.ledger import Counts, Failure
from fleet.study.result import StudyResult
from fleet.study.runner import run_jobs

__all__ = ["BrokenOff", "Counts", "Failure", "Interrupted", "Job", "StudyResult", "run_jobs"]
