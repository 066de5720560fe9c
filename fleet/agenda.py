"""What will happen when, in a total order."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count
from math import inf
from typing import TypeAlias

Action: TypeAlias = Callable[[], None]


class Agenda:
    """Actions by time; of those at one time, the one put down first comes first."""

    def __init__(self) -> None:
        self._heap: list[tuple[float, int, Action]] = []
        self._order = count()

    def at(self, time: float, action: Action) -> None:
        """Put ``action`` down for ``time`` [s]."""
        heappush(self._heap, (time, next(self._order), action))

    @property
    def next_time(self) -> float:
        """When the next action is due [s]; inf if there is none."""
        return self._heap[0][0] if self._heap else inf

    def take(self) -> Action:
        """The next action, which is taken off."""
        return heappop(self._heap)[2]
