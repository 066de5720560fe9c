"""Who is linked to whom, and what of that is new."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from protocols.messages import RobotId

Changes: TypeAlias = tuple[list[int], list[int]]
"""Links that are new and links that are gone, u < v of n robots as u·n + v each."""


class Adjacency:
    """Links among n robots, either way: one that only one end knows is a link too."""

    def __init__(self, n: int) -> None:
        self._n = n
        self._of: list[set[RobotId]] = [set() for _ in range(n)]

    def update(self, links: Iterable[tuple[RobotId, set[RobotId]]]) -> Changes:
        """Some robots have these links now; returns what differs."""
        new: list[int] = []
        gone: list[int] = []
        for robot, now in links:
            before = self._of[robot]
            if now == before:
                continue
            for other in now - before:
                new.append(self._code(robot, other))
                self._of[other].add(robot)
            for other in before - now:
                gone.append(self._code(robot, other))
                self._of[other].discard(robot)
            self._of[robot] = now
        return new, gone

    def _code(self, one: RobotId, other: RobotId) -> int:
        return min(one, other) * self._n + max(one, other)
