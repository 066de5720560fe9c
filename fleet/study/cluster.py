"""The study on a Dask cluster. Dask carries jobs and results; it does not run them.

Each thread of a Dask worker keeps a worker process of ours, as the local executor does: a job
that crashes takes that process down and nothing else, and is blamed alone. Short jobs travel
in bundles. The scheduler's port runs whatever code it is sent: keep it on the loopback, or use
``tls://``.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import logging
import multiprocessing
import threading
import time
from collections import deque
from collections.abc import Iterator
from importlib import import_module
from itertools import count, islice
from pathlib import Path
from typing import Any, NamedTuple

from fleet.scenario.errors import bad
from fleet.study.endings import BrokenOff
from fleet.study.job import Job, Outcome
from fleet.study.local import HEARTBEAT, Take, killed, overdue
from fleet.study.version import program_version
from fleet.study.worker import Worker

BUNDLE_SECONDS = 0.5  # how long a bundle of short jobs should take
MOST_BUNDLED = 20
AHEAD = 2  # bundles for each thread: one at work, one waiting
PATIENCE = 120.0  # [s] without any Dask worker
ANSWER = 10.0  # [s] in which the scheduler has to answer

Bundle = tuple[Job, ...]


class Dispatched(NamedTuple):
    """A bundle that is with the cluster."""

    future: Any
    bundle: Bundle


class ClusterExecutor:
    """The threads of all workers of a Dask scheduler, as they come and go.

    Raises:
        BrokenOff: nobody answers at that address.
        BadInput: dask.distributed is not installed; it is the extra "cluster".
    """

    def __init__(self, scheduler: str, limit: float | None = None) -> None:
        try:
            connect: Any = import_module("distributed").Client
        except ModuleNotFoundError as error:
            said = "a cluster needs dask.distributed; install talking-fleet[cluster]"
            raise bad("--scheduler", said) from error
        for name in ("distributed", "distributed.client"):  # what is lost is said by us
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            self._client = connect(scheduler, timeout=ANSWER, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise BrokenOff(f"no Dask scheduler answers at {scheduler!r} ({error})") from error
        self._limit = limit
        self._sent: dict[str, Dispatched] = {}
        self._again: deque[Bundle] = deque()
        self._numbers = count()
        self._seconds = BUNDLE_SECONDS  # of a job, in the mean

    def run(self, take: Take) -> Iterator[list[Outcome]]:
        """See :class:`fleet.study.local.Executor`."""
        try:
            yield from self._run(take)
        except BrokenOff:
            raise
        except (Exception, asyncio.CancelledError) as error:
            gone = isinstance(error, OSError | asyncio.CancelledError)  # Dask's comm errors too
            if self._client.status == "running" and not gone:
                raise
            raise BrokenOff(f"the Dask scheduler is lost ({type(error).__name__})") from error

    def close(self) -> None:
        """Take back what is waiting; what is at work there ends by itself."""
        self._client.close(timeout=1.0)

    def _run(self, take: Take) -> Iterator[list[Outcome]]:
        threads = self._threads()
        looked = peopled = time.monotonic()
        while True:
            now = time.monotonic()
            if now - looked > 1.0:
                threads, looked = self._threads(), now
            peopled = now if threads else peopled
            if now - peopled > PATIENCE:
                raise BrokenOff(f"the Dask cluster has had no worker for {PATIENCE:.0f} s")
            self._feed(take, AHEAD * max(threads, 1))
            if not self._sent:
                return
            yield self._collect()

    def _threads(self) -> int:
        """How many jobs the cluster can run at a time."""
        if self._client.status != "running":
            raise BrokenOff(f"the Dask scheduler is lost ({self._client.status})")
        try:
            threads = self._client.sync(self._client.scheduler.ncores, callback_timeout=ANSWER)
        except TimeoutError as error:
            raise BrokenOff(f"the Dask scheduler has not answered for {ANSWER:.0f} s") from error
        return int(sum(threads.values()))

    def _feed(self, take: Take, room: int) -> None:
        """Send bundles until ``room`` of them are on their way."""
        if len(self._sent) > room // 2:
            return
        size = max(1, min(MOST_BUNDLED, int(BUNDLE_SECONDS / max(self._seconds, 1e-3))))
        bundles: list[Bundle] = []
        while len(self._sent) + len(bundles) < room:
            bundle = self._again.popleft() if self._again else tuple(islice(iter(take, None), size))
            if not bundle:
                break
            bundles.append(bundle)
        if not bundles:
            return
        keys = [f"fleet-{bundle[0].key[:16]}-{next(self._numbers)}" for bundle in bundles]
        futures = self._client.map(
            work, bundles, version=program_version(), folder=str(Path.cwd()),
            limit=self._limit,
            key=keys, retries=0, pure=False,
        )  # fmt: skip
        self._sent |= {
            key: Dispatched(future, bundle)
            for key, future, bundle in zip(keys, futures, bundles, strict=True)
        }

    def _collect(self) -> list[Outcome]:
        """What has come in; waits a heartbeat at the most."""
        until = time.monotonic() + HEARTBEAT
        while not (ended := self._ended()):
            if time.monotonic() >= until:
                return []
            time.sleep(0.005)
        outcomes = []
        finished = {key: self._sent[key].future for key in ended if ended[key] == "finished"}
        for key, answer in self._gather(finished).items():
            outcomes += self._answered(key, answer)
        for key in ended.keys() - finished.keys():
            future, bundle = self._sent.pop(key)
            if ended[key] == "error":
                outcomes += self._died(bundle, future.exception(timeout=ANSWER))
            else:  # cancelled or lost, with whoever had it
                self._again.append(bundle)
        return outcomes

    def _ended(self) -> dict[str, str]:
        """The bundles that are no longer under way, with what became of them."""
        states = {key: sent.future.status for key, sent in self._sent.items()}
        return {key: state for key, state in states.items() if state != "pending"}

    def _gather(self, futures: dict[str, Any]) -> dict[str, Any]:
        """Results of finished futures; those whose keeper has just died come another time."""
        if not futures:
            return {}
        gathering = asyncio.run_coroutine_threadsafe(
            self._client.gather(futures, errors="skip", asynchronous=True),
            self._client.loop.asyncio_loop,
        )
        try:
            answers: dict[str, Any] = gathering.result(ANSWER)
        except concurrent.futures.TimeoutError:
            gathering.cancel()
            return {}
        return answers

    def _answered(self, key: str, answer: list[Outcome] | str) -> list[Outcome]:
        if isinstance(answer, str):
            raise BrokenOff(answer)
        self._sent.pop(key).future.release()
        for outcome in answer:
            self._seconds += 0.1 * (outcome.seconds - self._seconds)
        return answer

    def _died(self, bundle: Bundle, error: BaseException) -> list[Outcome]:
        """A bundle whose Dask worker died under it: its jobs go again, each by itself."""
        if type(error).__name__ != "KilledWorker":
            raise BrokenOff(f"the Dask workers cannot run jobs: {type(error).__name__}: {error}")
        if len(bundle) > 1:
            self._again.extend((job,) for job in bundle)
            return []
        return [killed(bundle[0], "the Dask worker died")]


_mine = threading.local()  # the worker process of this thread of a Dask worker


def work(
    bundle: Bundle, *, version: str, folder: str, limit: float | None = None
) -> list[Outcome] | str:
    """What a thread of a Dask worker does with a bundle; a sentence if it must not."""
    if program_version() != version:
        return (
            f"a Dask worker runs {program_version()}, and the study {version};"
            f" expected the same program everywhere"
        )
    # Dask's workers may not have children, unless configured so; ours end with their parent.
    multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
    return [_run_apart(job, folder, limit) for job in bundle]


def _run_apart(job: Job, folder: str, limit: float | None) -> Outcome:
    """Run a job in this thread's worker process, a new one if the last one died."""
    if getattr(_mine, "folder", None) != folder:
        _mine.worker, _mine.folder = Worker(folder), folder
    worker: Worker = _mine.worker
    worker.give(job)
    if limit is not None and not worker.answers_within(limit):
        worker.close()
        _mine.folder = None
        return overdue(job, limit)
    outcome = worker.answer()
    if outcome is None:
        outcome = killed(job, worker.death())
        worker.close()
        _mine.folder = None
    return outcome
