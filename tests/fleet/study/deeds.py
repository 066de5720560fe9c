"""Work functions for the tests of studies: honest ones, and those that kill their process."""

from __future__ import annotations

import ctypes
import os
import signal
import time
from pathlib import Path


def note(job):
    """Leave a trace of the call, and give a row."""
    log = job.scenario.get("log")
    if log:
        with Path(log).open("a") as file:
            file.write(f"{job.scenario['n']} {os.getpid()}\n")
    return {"n": job.scenario["n"], "square": job.scenario["n"] ** 2, "pid": os.getpid()}


def slow(job):
    time.sleep(job.scenario.get("seconds", 0.05))
    return note(job)


def deadly(job):
    """Do what the scenario's ``deed`` says, at the ``n`` that it says; else :func:`note`."""
    if job.scenario["n"] != job.scenario["victim"]:
        return note(job)
    if "once" in job.scenario:
        marker = Path(job.scenario["once"])
        if marker.exists():
            return note(job)
        marker.touch()
    DEEDS[job.scenario["deed"]]()
    raise AssertionError("it should be dead")


def raise_error():
    raise ValueError("bad physics")


def run_out_of_memory():
    bytearray(1 << 62)


def commit_suicide():
    os.kill(os.getpid(), signal.SIGKILL)


DEEDS = {
    "raise": raise_error,
    "memory": run_out_of_memory,
    "exit": lambda: os._exit(7),
    "segfault": lambda: ctypes.string_at(0),
    "kill": commit_suicide,
}


def with_tables(job):
    n = job.scenario["n"]
    parts = [{"part": k, "size": float(k)} for k in range(n)]
    return note(job) | {"by_kind": {"route-face": n}, "tables": {"parts": parts}}


def unspeakable(job):
    return {"n": object()}


def numbers(job):
    import numpy as np

    return {"n": np.int64(job.scenario["n"]), "x": np.float64(0.1), "list": np.arange(3)}
