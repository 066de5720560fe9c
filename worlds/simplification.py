"""Outlines with fewer corners, that leave nobody more room than before.

Corners that point inwards are cut off, the slightest first. What is occupied only grows: where
there was no way through there is none now, at most ways become narrower, by no more than the
tolerance on either side. Outlines never come to touch: what was apart stays apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from heapq import heapify, heappop, heappush
from math import hypot
from typing import TypeAlias

Node: TypeAlias = tuple[int, int]

BIN = 64  # side of a bin of corners, in the loops' unit


def simplified(loops: Sequence[Sequence[Node]], tolerance: float) -> list[list[Node]]:
    """The loops with short cuts across free floor, and without corners on straight lines.

    What is occupied lies to the left. Each short cut keeps within ``tolerance`` of the corners
    that it leaves out; with none, only straight lines are merged. Coordinates are whole
    numbers, so that what lies on which side of what is exact.
    """
    chain = _Chain(loops)
    heap = [(spared, at, 0) for at in range(len(chain.nodes)) if (spared := chain.spared(at)) >= 0]
    heapify(heap)
    while heap:
        spared, at, stamp = heappop(heap)
        if spared > tolerance:
            break
        if stamp != chain.stamps[at] or not chain.is_clear(at):
            continue
        for beside in chain.remove(at):
            spared = chain.spared(beside)
            if spared >= 0.0:
                heappush(heap, (spared, beside, chain.stamps[beside]))
    return list(chain.loops())


class _Chain:
    """The corners of all loops, linked; each can be taken out."""

    def __init__(self, loops: Sequence[Sequence[Node]]) -> None:
        self.nodes: list[Node] = [node for loop in loops for node in loop]
        self.stamps = [0] * len(self.nodes)  # how often a neighbour was taken out
        self._before: list[int] = []
        self._after: list[int] = []
        self._loop: list[int] = []  # which each corner belongs to
        self._ends: list[tuple[int, int]] = []  # first and last corner of each, and
        self._left: list[int] = []  # how many are left of it
        self._bins: dict[Node, set[int]] = {}
        for number, loop in enumerate(loops):
            first, last = len(self._loop), len(self._loop) + len(loop) - 1
            self._before += [last, *range(first, last)]
            self._after += [*range(first + 1, last + 1), first]
            self._loop += [number] * len(loop)
            self._ends.append((first, last))
            self._left.append(len(loop))
        for at, (x, y) in enumerate(self.nodes):
            self._bins.setdefault((x // BIN, y // BIN), set()).add(at)

    def spared(self, at: int) -> float:
        """How far the corners that would be left out are from the short cut past this one.

        Negative: it points outwards, or its loop is a triangle.
        """
        a, c = self.nodes[self._before[at]], self.nodes[self._after[at]]
        if self._left[self._loop[at]] <= 3 or _turn(a, self.nodes[at], c) > 0:
            return -1.0
        dx, dy = c[0] - a[0], c[1] - a[1]
        square = dx * dx + dy * dy
        far = 0.0
        for x, y in self._between(self._before[at], self._after[at]):
            share = min(max(((x - a[0]) * dx + (y - a[1]) * dy) / square, 0.0), 1.0)
            far = max(far, hypot(a[0] + share * dx - x, a[1] + share * dy - y))
        return far

    def is_clear(self, at: int) -> bool:
        """Whether no other corner lies where the short cut would lead through, or on it.

        A triangle has no corner to spare.
        """
        if self._left[self._loop[at]] <= 3:
            return False
        a, b, c = (self.nodes[k] for k in (self._before[at], at, self._after[at]))
        (x0, x1), (y0, y1) = ((min(v), max(v)) for v in zip(a, b, c, strict=True))
        for column in range(x0 // BIN, x1 // BIN + 1):
            for row in range(y0 // BIN, y1 // BIN + 1):
                for k in self._bins.get((column, row), ()):
                    p = self.nodes[k]
                    if (
                        x0 <= p[0] <= x1
                        and y0 <= p[1] <= y1
                        and _turn(a, b, p) <= 0
                        and _turn(b, c, p) <= 0
                        and _turn(c, a, p) <= 0
                        and k not in {self._before[at], at, self._after[at]}
                    ):
                        return False
        return True

    def remove(self, at: int) -> tuple[int, int]:
        """Take a corner out; returns its neighbours."""
        before, after = self._before[at], self._after[at]
        self._after[before], self._before[after] = after, before
        self._left[self._loop[at]] -= 1
        x, y = self.nodes[at]
        self._bins[x // BIN, y // BIN].remove(at)
        self.stamps[at] = -1
        for beside in (before, after):
            self.stamps[beside] += 1
        return before, after

    def loops(self) -> Iterator[list[Node]]:
        """What is left."""
        for first, last in self._ends:
            yield [self.nodes[k] for k in range(first, last + 1) if self.stamps[k] >= 0]

    def _between(self, first: int, last: int) -> Iterator[Node]:
        """The corners that once were between two of the same loop."""
        begin, end = self._ends[self._loop[first]]
        while (first := begin if first == end else first + 1) != last:
            yield self.nodes[first]


def _turn(a: Node, b: Node, c: Node) -> int:
    """Positive: from a over b to c is a turn to the left."""
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
