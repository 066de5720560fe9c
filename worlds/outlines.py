"""Outlines of what is occupied on a grid of cells, as polygons.

What is occupied lies to the left of its outline. Occupied cells that touch at a corner hang
together, by a bridge a tenth of a cell wide: nobody passes between them. So free cells that touch
at a corner are apart.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from worlds.shapes import Corner, FloatArray, Polygon
from worlds.simplification import simplified
from worlds.slits import Loop, cut_open

FINE = 10  # steps of an outline in a cell
STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))  # east, north, west, south
SOUTH_EAST_NORTH_WEST = ((0, 0), (1, 0), (1, 1), (0, 1))  # where a cell's sides begin

Node: TypeAlias = tuple[int, int]


def polygons(
    occupied: NDArray[np.bool_], x: FloatArray, y: FloatArray, tolerance: float = 0.0
) -> tuple[Polygon, ...]:
    """What is ``occupied`` (rows, columns), as simple polygons; the first row is the lowest.

    ``x`` (columns + 1,) and ``y`` (rows + 1,) [m] are the lines of the grid. With a
    ``tolerance`` [cells] outlines take short cuts: see :mod:`worlds.simplification`. What goes
    all around something free is cut open: see :mod:`worlds.slits`.
    """
    loops = cut_open(simplified(trace(occupied), FINE * tolerance))
    return tuple(Polygon(_on_the_floor(loop, x, y)) for loop in loops)


def trace(occupied: NDArray[np.bool_]) -> list[list[Node]]:
    """The outlines of what is ``occupied`` (rows, columns), corner by corner, in steps.

    Those around something occupied run counter-clockwise, those around something free
    clockwise. None touches another one, or itself.
    """
    ways = _sides(occupied)
    left = {(node, heading) for node, headings in ways.items() for heading in headings}
    return [
        _follow(ways, left, node, heading)
        for node, headings in ways.items()
        for heading in headings
        if (node, heading) in left
    ]


def _sides(occupied: NDArray[np.bool_]) -> dict[Node, list[int]]:
    """The nodes where sides between occupied and free begin, with their headings."""
    around = np.pad(occupied, 1)
    beside = (around[:-2, 1:-1], around[1:-1, 2:], around[2:, 1:-1], around[1:-1, :-2])
    ways: dict[Node, list[int]] = {}
    for heading, (dx, dy) in enumerate(SOUTH_EAST_NORTH_WEST):
        rows, columns = np.nonzero(occupied & ~beside[heading])
        for node in zip((columns + dx).tolist(), (rows + dy).tolist(), strict=True):
            ways.setdefault(node, []).append(heading)
    return ways


def _follow(
    ways: dict[Node, list[int]], left: set[tuple[Node, int]], node: Node, heading: int
) -> list[Node]:
    """The outline that goes on from ``node``; its sides are taken out of ``left``."""
    loop: list[Node] = []
    while (node, heading) in left:
        left.remove((node, heading))
        dx, dy = STEPS[heading]
        node = (node[0] + dx, node[1] + dy)
        x, y = FINE * node[0], FINE * node[1]
        onward = ways[node]
        if len(onward) == 2:  # occupied cells touch at this corner: over the bridge
            heading = (heading - 1) % 4
            loop += [(x - dx, y - dy), (x + STEPS[heading][0], y + STEPS[heading][1])]
        elif onward[0] != heading:
            heading = onward[0]
            loop.append((x, y))
    return loop


def _on_the_floor(loop: Loop, x: FloatArray, y: FloatArray) -> tuple[Corner, ...]:
    """The corners in metres."""
    across, up = np.array(loop, float).T / FINE
    over = np.interp(across, np.arange(len(x)), x).tolist()
    high = np.interp(up, np.arange(len(y)), y).tolist()
    return tuple(zip(over, high, strict=True))
