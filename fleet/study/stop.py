"""Being asked to stop, at a time when it does no harm."""

from __future__ import annotations

import signal
import threading
import time
from types import FrameType
from typing import Any

GRACE = 0.5  # [s] that jobs under way are given to end


class Stop:
    """Ctrl-C and SIGTERM as something to look at, between jobs, in the main thread."""

    def __init__(self) -> None:
        self.signal = 0  # the number of the one that came
        self._deadline = 0.0
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Stop:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._before[number] = signal.signal(number, self._asked)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _asked(self, number: int, _frame: FrameType | None) -> None:
        again = self.signal != 0
        self.signal = number
        self._deadline = 0.0 if again else time.monotonic() + GRACE

    def over(self) -> bool:
        """Whether jobs under way have had their time."""
        return self.signal != 0 and time.monotonic() >= self._deadline
