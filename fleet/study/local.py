"""The study on one machine: a pool of worker processes, one job in each."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any, Protocol, TypeAlias

from fleet.study.endings import BrokenOff
from fleet.study.job import Job, Outcome
from fleet.study.worker import Worker

HEARTBEAT = 0.1  # [s] between looks at whether to stop
LIMIT = 3600.0  # [s] that a job may take, unless the caller says otherwise

Take: TypeAlias = Callable[[], Job | None]


class Executor(Protocol):
    """Runs jobs somewhere else, each apart from all others."""

    def run(self, take: Take) -> Iterator[list[Outcome]]:
        """Outcomes as they come, several at a time; an empty list now and then while none do.

        ``take`` gives the next job, as there is room for one; None: there is none at the
        moment. The end is when there is none and nothing is under way. A job whose worker
        died is an outcome like others: "killed".

        Raises:
            BrokenOff: what runs the jobs is gone.
        """

    def close(self) -> None:
        """Let go of everything, at once."""


class LocalExecutor:
    """As many worker processes as asked for, started as jobs come.

    A job that takes longer than ``limit`` [s] is ended with its worker; None: none is.
    """

    def __init__(self, workers: int, limit: float | None = None) -> None:
        self.workers = workers
        self._limit = limit
        self._folder = str(Path.cwd())
        self._busy: dict[Any, Worker] = {}  # by connection
        self._idle: list[Worker] = []

    def run(self, take: Take) -> Iterator[list[Outcome]]:
        """See :class:`Executor`."""
        self._feed(take)
        while self._busy:
            ready = wait(list(self._busy), HEARTBEAT)
            outcomes = [self._outcome(self._busy.pop(connection)) for connection in ready]
            outcomes += self._overdue()
            self._feed(take)  # nobody shall be idle while the outcomes are written down
            yield outcomes
            self._feed(take)  # what comes again because of them

    def close(self) -> None:
        """Kill the workers."""
        for worker in (*self._busy.values(), *self._idle):
            worker.close()
        self._busy.clear()
        self._idle.clear()

    def _feed(self, take: Take) -> None:
        while len(self._busy) < self.workers and (job := take()):
            worker = self._idle.pop() if self._idle else self._start()
            worker.give(job)
            self._busy[worker.connection] = worker

    def _start(self) -> Worker:
        try:
            return Worker(self._folder)
        except (EOFError, OSError) as error:  # the limit of processes, or their server was killed
            raise BrokenOff(f"no worker process can be started: {error!r}") from error

    def _overdue(self) -> list[Outcome]:
        """The outcomes of jobs that have had their time."""
        if self._limit is None:
            return []
        since = time.monotonic() - self._limit
        late = [c for c, worker in self._busy.items() if worker.since < since]
        outcomes = []
        for worker in map(self._busy.pop, late):
            assert worker.job is not None
            outcomes.append(overdue(worker.job, self._limit))
            worker.close()
        return outcomes

    def _outcome(self, worker: Worker) -> Outcome:
        job, outcome = worker.job, worker.answer()
        if outcome is not None:
            self._idle.append(worker)
            return outcome
        assert job is not None
        cause = worker.death()
        worker.close()
        return killed(job, cause)


def killed(job: Job, cause: str) -> Outcome:
    """The outcome of a job that its worker did not survive."""
    return Outcome(job.key, "killed", "", {}, cause, 1, 0.0)


def overdue(job: Job, limit: float) -> Outcome:
    """The outcome of a job that was ended because it took too long."""
    said = f"it took longer than {limit:g} s, the limit of a run (--limit)"
    return Outcome(job.key, "overdue", "", {}, said, 1, limit)


def usable_cores() -> int:
    """The cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
