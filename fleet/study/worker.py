"""Worker processes: each runs one job at a time, and takes nobody along when it dies."""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import ModuleType
from typing import Any

from fleet.study.attempt import attempt
from fleet.study.job import Job, Outcome

FORKSERVER = "forkserver" in multiprocessing.get_all_start_methods()
CONTEXT: Any = multiprocessing.get_context("forkserver" if FORKSERVER else "spawn")
LOADED_ONCE = ["fleet.study.worker", "fleet.assembly", "protocols.topology.relinking"]
"""What the server loads before it forks workers: the compiler is the better part of a second."""

_starting = threading.Lock()  # threads of a Dask worker start processes side by side

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

Connection = multiprocessing.connection.Connection


class Worker:
    """A process that runs jobs, one after the other, until it is closed or dies.

    It ignores Ctrl-C, which is its parent's business, and dies with its parent. Everything it
    needs of a job it gets through a pipe; a crash is blamed on the one job that it had.
    ``folder`` is where the user's files are named from.
    """

    def __init__(self, folder: str) -> None:
        self.connection, theirs = CONTEXT.Pipe()
        self.job: Job | None = None  # what it is at work on
        self.since = 0.0  # when it was given that, by the monotonic clock [s]
        with _bare_start():
            self._process = CONTEXT.Process(target=serve, args=(theirs, folder))
            self._process.daemon = True
            self._process.start()
        theirs.close()

    def give(self, job: Job) -> None:
        """Start on a job. If the worker is dead, :meth:`answer` will say so."""
        self.job, self.since = job, time.monotonic()
        with suppress(OSError):  # a dead worker's pipe
            self.connection.send(job)

    def answers_within(self, seconds: float | None) -> bool:
        """Wait so long for the outcome of the job, or for the worker's death; None: for ever."""
        try:
            return bool(self.connection.poll(seconds))
        except OSError:
            return True

    def answer(self) -> Outcome | None:
        """The outcome of the job, waited for; None: the worker died of it."""
        try:
            outcome: Outcome = self.connection.recv()
        except (EOFError, OSError):
            return None
        self.job = None
        return outcome

    def death(self) -> str:
        """How the worker died, in words."""
        self._process.join(5.0)
        code = self._process.exitcode
        if code is None:
            return "the worker closed its pipe and lives on"
        if code >= 0:
            return f"the worker exited with code {code}"
        name = signal.Signals(-code).name if -code in list(signal.Signals) else f"signal {-code}"
        hint = " (the system kills with it when memory runs out)" if name == "SIGKILL" else ""
        return f"the worker was killed by {name}{hint}"

    def close(self) -> None:
        """End the process, whatever it is doing."""
        self.connection.close()
        self._process.kill()
        self._process.join(5.0)


def serve(connection: Connection, folder: str) -> None:
    """What a worker process does: take a job, run it, answer; to the end of the pipe."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    _die_with_parent()
    _be_the_one_to_go()
    with suppress(OSError):  # another machine may not have it; a file that is missed is named
        os.chdir(folder)
    with suppress(EOFError, OSError):  # the parent has closed its end, or is dead
        while True:
            connection.send(attempt(connection.recv()))


def _die_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch() -> None:
        multiprocessing.connection.wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _be_the_one_to_go() -> None:
    """Where the system picks whom to kill when memory runs out, it shall not be the parent."""
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("500")


@contextmanager
def _bare_start() -> Iterator[None]:
    """Start a process without running the user's main script in it.

    multiprocessing would import the script that called us into every worker, for functions
    defined there; we send none.
    """
    with _starting, _environment(_for_workers()):
        if FORKSERVER:
            CONTEXT.set_forkserver_preload(LOADED_ONCE)
        main = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = main


def _for_workers() -> dict[str, str]:
    """Environment in which the workers' server starts: our modules, and a core for each."""
    threads = {name: "1" for name in THREADS if name not in os.environ}
    path = os.pathsep.join(folder or str(Path.cwd()) for folder in sys.path)
    return threads | {"PYTHONPATH": path, "PYTHONSAFEPATH": "1"}


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
