"""A watch over the user's code: what never comes to an end is broken off, and said.

The code runs in its own thread; another one looks at it from time to time, and raises in it.
"""

from __future__ import annotations

import sys
from ctypes import c_ulong, py_object, pythonapi
from pathlib import Path
from threading import Thread, get_ident
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

    Whoever is in and out thousands of times a second begins once, and then says by itself
    when it is ``inside``, counts its ``steps``, and settles if the watch has ``struck``.
    Nobody holds a lock: before it strikes the watcher says so and looks once more whether the
    code is inside; whoever leaves says so and looks whether it was struck. One of them sees.

    Raises:
        Stuck: in the midst of the code, when it has been there for longer.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = str(folder)
        self.inside = False
        self.steps = 0  # times that it was entered
        self.struck = False  # an exception may be on its way
        self._thread = 0
        self._seen = -1  # the step that was under way when it was last looked at
        self._since = 0.0  # and when that was first seen [s]
        self._watcher: Thread | None = None

    def begin(self) -> None:
        """The code runs in this thread."""
        self._thread = get_ident()
        if self._watcher is None:
            self._watcher = Thread(target=_look_after, args=(ref(self),), daemon=True)
            self._watcher.start()

    def settle(self) -> None:
        """Wait for an exception that may be on its way to this thread."""
        while self.struck:
            sleep(0.1 * TICK)

    def __enter__(self) -> None:
        self.begin()
        self.steps += 1
        self.inside = True

    def __exit__(self, *_: object) -> None:
        self.inside = False
        self.settle()

    def look(self) -> None:
        """Break the code off if it has been in there for too long."""
        step = self.steps
        if not self.inside:
            self.struck, self._seen = False, -1
        elif step != self._seen:
            self._seen, self._since = step, monotonic()
        elif _elsewhere(sys._current_frames().get(self._thread), self.folder):
            self._since += TICK
        elif monotonic() - self._since > PATIENCE:
            self.struck = True
            if self.inside and self.steps == step:
                pythonapi.PyThreadState_SetAsyncExc(c_ulong(self._thread), py_object(Stuck))
            else:
                self.struck = False


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
