"""The floor as the planner sees it: who stands where, and the polygons, in cells.

Importing this module loads numba.
"""

from __future__ import annotations

from math import ceil, sqrt

import numpy as np

from fleet.motion.kernels.grid import columns_near, put, rows_near
from fleet.motion.kernels.records import DISC, EDGE, GRID, Floor, IntArray, Records
from worlds.arena import Arena


def lay_out(arena: Arena, radius: float, robots: int) -> Floor:
    """The floor of ``arena`` for ``robots`` of ``radius`` [m], none of which is there yet.

    Discs 0 to n - 1 are the places where robots rest, n to 2n - 1 bodies in the way.
    """
    corners = sum(len(polygon.corners) for polygon in arena.obstacles)
    grid = _grid(arena, radius, robots + corners)
    cells = int(grid[0]["columns"] * grid[0]["rows"])
    discs = np.zeros(2 * robots + corners, DISC)
    discs["x"] = discs["y"] = np.nan
    discs["core"][: 2 * robots] = radius
    edges = _edges(arena, 2 * robots)
    bins, binned = _bin(grid, edges)
    floor = Floor(
        grid,
        discs,
        np.full(cells, -1, np.int64),
        edges,
        bins,
        binned,
        np.zeros(2 * (len(discs) + len(edges)), np.int64),
        np.zeros(len(discs) + len(edges), np.bool_),
    )
    for edge in edges:
        put(floor, int(edge["a"]), float(edge["ax"]), float(edge["ay"]))
    return floor


def _grid(arena: Arena, radius: float, things: int) -> Records:
    """Cells of about one thing each, but no smaller than a robot."""
    cell = max(2.0 * radius, sqrt(arena.width * arena.height / max(things, 1)))
    grid = np.zeros(1, GRID)
    grid[0] = (
        arena.width, arena.height, radius, cell,
        max(1, ceil(arena.width / cell)), max(1, ceil(arena.height / cell)),
    )  # fmt: skip
    return grid


def _edges(arena: Arena, first: int) -> Records:
    """The sides of the obstacles; their corners are discs from ``first`` on."""
    rows = []
    for polygon in arena.obstacles:
        corners = polygon.corners
        for k, a in enumerate(corners):
            after = (k + 1) % len(corners)
            rows.append((*a, *corners[after], 0.0, first + k, first + after))
        first += len(corners)
    return np.array(rows, EDGE)


def _bin(grid: Records, edges: Records) -> tuple[IntArray, IntArray]:
    """The edges of each cell that they cross: where each cell's begin, and all by cell."""
    columns, rows = int(grid[0]["columns"]), int(grid[0]["rows"])
    held: list[list[int]] = [[] for _ in range(columns * rows)]
    for which, (ax, ay, bx, by, *_) in enumerate(edges.tolist()):
        bottom, top = rows_near(grid[0], ay, by, 0.0)
        for row in range(bottom, top + 1):
            left, right = columns_near(grid[0], row, ax, ay, bx, by, 0.0)
            for column in range(left, right + 1):
                held[row * columns + column].append(which)
    bins = np.zeros(len(held) + 1, np.int64)
    np.cumsum([len(cell) for cell in held], out=bins[1:])
    return bins, np.array([which for cell in held for which in cell], np.int64)
