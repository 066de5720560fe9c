"""Cutting open what goes all around something free, so that its outline is a single loop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

Loop: TypeAlias = list[tuple[float, float]]  # corners; clockwise around something free

HAIRLINE = 0.002  # half the width of a slit, at most; in the loops' unit


class _Crossing(NamedTuple):
    """Where a loop crosses a height."""

    x: float
    loop: int
    side: int  # from the corner of that number to the next


def cut_open(loops: Sequence[Sequence[tuple[float, float]]]) -> list[Loop]:
    """The same region by outer loops alone: slits, 2 × :data:`HAIRLINE` wide, join the others
    to what is around them.

    Loops must not touch one another or themselves; nor will those that are returned.
    """
    found: list[Loop] = [list(loop) for loop in loops]
    while True:
        inner = next((k for k, loop in enumerate(found) if area(loop) < 0.0), None)
        if inner is None:
            return found
        y, half = _height(found, inner)
        crossings = sorted(_crossings(found, y))
        here = next(k for k, crossing in enumerate(crossings) if crossing.loop == inner)
        west, east = crossings[here - 1], crossings[here]
        joined = _joined(found[west.loop], west.side, found[inner], east.side, y, half)
        found = [loop for k, loop in enumerate(found) if k not in {inner, west.loop}]
        found.append(joined)


def area(loop: Sequence[tuple[float, float]]) -> float:
    """The area inside; negative if the loop runs clockwise."""
    x, y = np.array(loop, float).T
    return float(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _height(loops: Sequence[Loop], inner: int) -> tuple[float, float]:
    """A height that crosses the ``inner`` loop far from all corners; half the slit's width."""
    low, high = min(y for _, y in loops[inner]), max(y for _, y in loops[inner])
    heights = np.unique([y for loop in loops for _, y in loop if low <= y <= high])
    widest = int(np.argmax(np.diff(heights)))
    gap = float(heights[widest + 1] - heights[widest])
    return float(heights[widest]) + 0.5 * gap, min(HAIRLINE, 0.25 * gap)


def _crossings(loops: Sequence[Loop], y: float) -> list[_Crossing]:
    return [
        _Crossing(_at(a, b, y), k, side)
        for k, loop in enumerate(loops)
        for side, (a, b) in enumerate(zip(loop, [*loop[1:], loop[0]], strict=True))
        if (a[1] > y) != (b[1] > y)
    ]


def _at(a: tuple[float, float], b: tuple[float, float], y: float) -> float:
    """The x of the line from a to b at the height ``y``."""
    return a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])


def _joined(host: Loop, west: int, hole: Loop, east: int, y: float, half: float) -> Loop:
    """Down side ``west`` of the host, through the slit, up side ``east`` of the hole, around it,
    and back.
    """
    down = host[west], host[(west + 1) % len(host)]
    up = hole[east], hole[(east + 1) % len(hole)]
    around = [*hole[east + 1 :], *hole[: east + 1]]
    upper, lower = y + half, y - half
    there = [(_at(*down, upper), upper), (_at(*up, upper), upper)]
    back = [(_at(*up, lower), lower), (_at(*down, lower), lower)]
    return [*host[: west + 1], *there, *around, *back, *host[west + 1 :]]
