"""Studies: many runs, in parallel, that survive whatever happens to the machine they run on.

The engine is three names. A :class:`Task` says what to run, :func:`run_tasks` runs what its
folder does not hold yet, and :class:`StudyResult` reads what the folder holds::

    protocols = "rfta2", "gfgf2a"
    tasks = [Task.of({"protocol": p, "seed": s}, cell=p) for s in range(9) for p in protocols]
    result = run_tasks(tasks, "out/mine")
    result.table()

Work of another kind is a function in a module, ``(Task) -> dict``, named by its import path:
``Task.of({...}, function="package.module:measure")``. What it returns is a row of the table
``runs``; rows of further tables may be under its key ``tables``.
"""

from fleet.study.errors import BrokenOff, Interrupted
from fleet.study.ledger import Counts, Failure
from fleet.study.result import StudyResult
from fleet.study.running import run_tasks
from fleet.study.task import Task

__all__ = ["BrokenOff", "Counts", "Failure", "Interrupted", "StudyResult", "Task", "run_tasks"]
