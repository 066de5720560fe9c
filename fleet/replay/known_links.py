"""Who is linked to whom, and what of that is new."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from protocols.messages import RobotId

Changes: TypeAlias = tuple[list[int], list[int]]
"""Links that are new and links that are gone, u < v of n robots as u·n + v each."""


class KnownLinks:
    """Links among n robots, either way: one that only one end knows is a link too."""

    def __init__(self, n: int) -> None:
        self._n = n
        self._of: list[set[RobotId]] = [set() for _ in range(n)]

    def update(self, links: Iterable[tuple[RobotId, set[RobotId]]]) -> Changes:
        """Some robots have these links now; returns what differs. Of two who differ on a link the
        latter is believed.
        """
        new: set[int] = set()
        gone: set[int] = set()
        for robot, now in links:
            before = self._of[robot]
            if now == before:
                continue
            for other in now - before:
                self._turn(robot, other, gone, new)
                self._of[other].add(robot)
            for other in before - now:
                self._turn(robot, other, new, gone)
                self._of[other].discard(robot)
            self._of[robot] = now
        return sorted(new), sorted(gone)

    def _turn(self, one: RobotId, other: RobotId, before: set[int], now: set[int]) -> None:
        """A link is ``now`` what it was not, unless it just became what it was ``before``."""
        code = min(one, other) * self._n + max(one, other)
        if code in before:
            before.remove(code)
        else:
            now.add(code)
