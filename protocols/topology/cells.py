"""A grid of cells over the plane, so that who is near is found without asking everybody.

The things in a cell are a linked list: ``head`` (cells,) has the first of each cell, ``after``
(n,) who follows, -1 ends it. Whatever is kept by cells, robots or discs on a floor, is entered and
left by the same kernels. Importing this module loads numba.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from protocols.compiled import kernel

if TYPE_CHECKING:
    from protocols.messages import Point

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]


class Grid(NamedTuple):
    """Where the cells are."""

    x: float  # of their lower left corner [m]
    y: float
    size: float  # of a cell [m]
    columns: int
    rows: int


class Cells(NamedTuple):
    """The places of a fleet, and who is in each cell. Changed in place, by :func:`put` alone."""

    grid: Grid
    x: FloatArray  # (n,) [m]; NaN: nowhere
    y: FloatArray
    head: IntArray  # (cells,)
    after: IntArray  # (n,)
    marked: NDArray[np.bool_]  # (n,) work space, all false
    near: IntArray  # (n + 1,) work space


def cells_over(positions: Sequence[Point], size: float) -> Cells:
    """Empty cells of ``size`` [m] over the positions, but no more than about one a robot."""
    n = len(positions)
    places = np.array(positions, float).reshape(-1, 2)
    known = places[~np.isnan(places).any(axis=1)]
    low = known.min(axis=0) if len(known) else np.zeros(2)
    span = np.maximum((known.max(axis=0) if len(known) else low) - low, 1e-9)
    side = max(size, math.sqrt(span[0] * span[1] / max(n, 1)))
    columns, rows = (max(1, math.ceil(length / side)) for length in span.tolist())
    return Cells(
        Grid(float(low[0]), float(low[1]), side, columns, rows),
        np.full(n, np.nan),
        np.full(n, np.nan),
        np.full(columns * rows, -1, np.int64),
        np.full(n, -1, np.int64),
        np.zeros(n, np.bool_),
        np.zeros(n + 1, np.int64),
    )


@kernel
def row_of(value, origin, size, count):
    """The row, or column, of a coordinate [m]; what lies outside belongs to the border."""
    return min(max(math.floor((value - origin) / size), 0), count - 1)


@kernel
def enter(head, after, cell, thing):
    """Put ``thing`` into a cell."""
    after[thing] = head[cell]
    head[cell] = thing


@kernel
def leave(head, after, cell, thing):
    """Take ``thing`` out of the cell that it is in."""
    if head[cell] == thing:
        head[cell] = after[thing]
        return
    before = head[cell]
    while after[before] != thing:
        before = after[before]
    after[before] = after[thing]


@kernel
def _cell_of(grid, x, y):
    row = row_of(y, grid.y, grid.size, grid.rows)
    return row * grid.columns + row_of(x, grid.x, grid.size, grid.columns)


@kernel
def put(cells: Cells, robot: int, x: float, y: float) -> None:
    """The robot is at (x, y) [m] now; NaN: nowhere, and in no cell."""
    if not math.isnan(cells.x[robot]):
        cell = _cell_of(cells.grid, cells.x[robot], cells.y[robot])
        leave(cells.head, cells.after, cell, robot)
    if not math.isnan(x):
        enter(cells.head, cells.after, _cell_of(cells.grid, x, y), robot)
    cells.x[robot], cells.y[robot] = x, y


@kernel
def gather(cells, x, y, reach, robot, count):
    """Append to ``cells.near``, of ``count`` so far, the robots within ``reach`` [m] of (x, y)
    that are not marked yet, but for ``robot``; mark them. Returns how many there are.
    """
    grid, px, py, near, marked = cells.grid, cells.x, cells.y, cells.near, cells.marked
    left = row_of(x - reach, grid.x, grid.size, grid.columns)
    right = row_of(x + reach, grid.x, grid.size, grid.columns)
    top = row_of(y + reach, grid.y, grid.size, grid.rows)
    for row in range(row_of(y - reach, grid.y, grid.size, grid.rows), top + 1):
        for column in range(left, right + 1):
            w = cells.head[row * grid.columns + column]
            while w >= 0:
                dx, dy = px[w] - x, py[w] - y
                if w != robot and not marked[w] and dx * dx + dy * dy <= reach * reach:
                    marked[w] = True
                    near[count] = w
                    count += 1
                w = cells.after[w]
    return count
