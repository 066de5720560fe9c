"""A watch over the user's code: what never comes to an end is broken off, and said.

The code runs in its own thread; another one looks at it from time to time, and raises in it.
"""

from __future__ import annotations

import sys
from ctypes import c_ulong, py_object, pythonapi
from pathlib import Path
from threading import Lock, Thread, get_ident
from time import monotonic, sleep
from types import FrameType
from weakref import ref

PATIENCE = 4.0  # [s] for a file to be imported, or a robot to say the next thing
TICK = 0.2  # [s] between two looks
ELSEWHERE = ("importlib", "numba", "llvmlite")  # time in there is not the user's


class Stuck(BaseException):
    """The code that is watched does not come to an end. No ``except Exception`` holds it."""


class Watch:
    """A context in which code of the user's in ``folder`` may stay for :data:`PATIENCE`.

    It can be entered as often as one likes. Importing libraries and compiling do not count.

    Raises:
        Stuck: in the midst of the code, when it has been there for longer.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = str(folder)
        self._lock = Lock()
        self._thread = 0
        self._entered: float | None = None
        self._watcher: Thread | None = None

    def __enter__(self) -> None:
        with self._lock:
            self._thread, self._entered = get_ident(), monotonic()
        if self._watcher is None:
            self._watcher = Thread(target=_look_after, args=(ref(self),), daemon=True)
            self._watcher.start()

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._entered = None

    def look(self) -> None:
        """Break the code off if it has been in there for too long."""
        with self._lock:
            if self._entered is None:
                return
            if _elsewhere(sys._current_frames().get(self._thread), self.folder):
                self._entered += TICK
            elif monotonic() - self._entered > PATIENCE:
                pythonapi.PyThreadState_SetAsyncExc(c_ulong(self._thread), py_object(Stuck))


def _look_after(watch: ref[Watch]) -> None:
    """Look every now and then, for as long as somebody has the watch."""
    while (held := watch()) is not None:
        held.look()
        del held
        sleep(TICK)


def _elsewhere(frame: FrameType | None, folder: str) -> bool:
    """Whether the user's code is waiting for a library to be imported or compiled."""
    while frame is not None and not frame.f_code.co_filename.startswith(folder):
        if any(name in frame.f_code.co_filename for name in ELSEWHERE):
            return True
        frame = frame.f_back
    return False
