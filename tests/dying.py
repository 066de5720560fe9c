"""A study whose tables are being written, ended at any point; for test_derived.py.

Run as a program, it forks children that die of a real signal; imported, it dies of an exception
after which nothing more is done, as if the process had ended.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import sys
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa

from fleet.study import Job, run_jobs
from fleet.study.attempt import pack
from fleet.study.audit import audit
from fleet.study.job import Outcome
from fleet.study.open_ledger import writing


class Killed(BaseException):
    """The process has ended here."""


def jobs(count):
    return [
        Job.of({"n": n}, cell=f"n={n}", labels={"n": n}, tables=("parts", "wholes"))
        for n in range(count)
    ]


def outcome(job):
    n = job.scenario["n"]
    tables = {name: pack([{"part": k, "of": n} for k in range(3)]) for name in job.tables}
    return Outcome(job.key, "done", json.dumps({"square": n * n}), tables, "", 1, 0.1)


def begin(folder, count=6):
    """A folder with the tables of two runs, and six runs in its ledger."""
    for known in (2, count):
        with writing(folder) as ledger:
            ledger.plan(jobs(known))
            ledger.record(map(outcome, jobs(known)))
        if known == 2:
            run_jobs(jobs(known), folder)


def go_on(folder, count=6):
    """The next command: nothing is left to be run, and tables are written where they are not."""
    return run_jobs(jobs(count), folder, workers=1)


def check(folder, count=6):
    """The tables are those of the ledger, and nothing else is left."""
    found = audit(folder)
    assert found.problems == []
    assert (found.runs, found.tables) == (count, 3)
    assert {path.name for path in folder.iterdir()} == {
        "ledger.sqlite", "study.lock", "runs.parquet", "parts.parquet", "wholes.parquet"
    }  # fmt: skip


class Death:
    """Ends the process at the n-th write: before it, half-way through it, or after it."""

    def __init__(self, at, how, end):
        self.left, self.how, self.end, self.dead = at, how, end, False

    def around(self, function):
        def call(*arguments, **named):
            if self.dead:
                self.end()
            self.left -= 1
            due = self.left < 0
            if due and self.how == "half":
                self.dead = True
                if arguments and isinstance(arguments[-1], bytes | memoryview):
                    function(*arguments[:-1], bytes(arguments[-1])[: len(arguments[-1]) // 2])
                self.end()
            if due and self.how == "before":
                self.dead = True
                self.end()
            result = function(*arguments, **named)
            if due:
                self.dead = True
                self.end()
            return result

        return call


@contextmanager
def dying(death):
    """All that reaches the disk beside the ledger goes through ``death``."""
    kept = Path.open, Path.replace, Path.unlink, os.fsync

    def opened(self, mode="r", *rest, **named):
        file = kept[0](self, mode, *rest, **named)
        if "w" not in mode:
            return file
        return Watched(file, death)

    Path.open = opened
    Path.replace, Path.unlink, os.fsync = (death.around(f) for f in kept[1:])
    try:
        yield
    finally:
        Path.open, Path.replace, Path.unlink, os.fsync = kept


class Watched:
    """A file whose writes may be the last thing that is done."""

    def __init__(self, file, death):
        self._file = file
        self.write = death.around(file.write)

    def __getattr__(self, name):
        return getattr(self._file, name)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._file.close()


def many(folder, points, randomly):
    """``points`` deaths at the writes in turn, and as many at ``randomly`` chosen moments."""
    pa.set_cpu_count(1)
    pa.set_io_thread_count(1)
    begin(folder / "template")
    rng = random.Random(7)  # moments, not secrets
    hows = ("before", "half", "after")
    for number in range(points + randomly):
        place = folder / str(number)
        shutil.copytree(folder / "template", place)
        child = os.fork()
        if child == 0:
            end = lambda: os.kill(os.getpid(), signal.SIGKILL)  # noqa: E731
            if number >= points:
                signal.setitimer(signal.ITIMER_REAL, rng.uniform(0.0, 0.06) + 1e-4)
                go_on(place)
            else:
                with dying(Death(number // 3, hows[number % 3], end)):
                    go_on(place)
            os._exit(0)
        rng.random()
        _, status = os.waitpid(child, 0)
        sys.stdout.write(f"{number} {os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0}\n")
        go_on(place)
        check(place)
        shutil.rmtree(place)


if __name__ == "__main__":
    many(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
