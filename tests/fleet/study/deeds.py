"""Work functions for the tests of studies: honest ones, and those that kill their process."""

from __future__ import annotations

import ctypes
import os
import signal
import time
from pathlib import Path


def note(task):
    """Leave a trace of the call, and give a row."""
    log = task.scenario.get("log")
    if log:
        with Path(log).open("a") as file:
            file.write(f"{task.scenario['n']} {os.getpid()}\n")
    return {"n": task.scenario["n"], "square": task.scenario["n"] ** 2, "pid": os.getpid()}


def slow(task):
    time.sleep(task.scenario.get("seconds", 0.05))
    return note(task)


def deadly(task):
    """Do what the scenario's ``deed`` says, at the ``n`` that it says; else :func:`note`."""
    if task.scenario["n"] != task.scenario["victim"]:
        return note(task)
    if "once" in task.scenario:
        marker = Path(task.scenario["once"])
        if marker.exists():
            return note(task)
        marker.touch()
    DEEDS[task.scenario["deed"]]()
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


def with_tables(task):
    n = task.scenario["n"]
    parts = [{"part": k, "size": float(k)} for k in range(n)]
    return note(task) | {"by_kind": {"route-face": n}, "tables": {"parts": parts}}


def unspeakable(task):
    return {"n": object()}


def numbers(task):
    import numpy as np

    return {"n": np.int64(task.scenario["n"]), "x": np.float64(0.1), "list": np.arange(3)}
