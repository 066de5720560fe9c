"""The cells of the floor: who is near a segment, without asking everybody."""

from __future__ import annotations

import math

from fleet.motion.kernels.geometry import to_segment
from fleet.motion.kernels.records import NOBODY, Floor, Record
from protocols.compiled import kernel
from protocols.topology.cells import enter, leave, row_of


@kernel
def _cell_of(grid, x, y):
    row = row_of(y, 0.0, grid.cell, grid.rows)
    return row * grid.columns + row_of(x, 0.0, grid.cell, grid.columns)


@kernel
def put(floor: Floor, disc: int, x: float, y: float) -> None:
    """Move a disc to (x, y) [m]; NaN: take it away."""
    grid, heads, after = floor.grid[0], floor.heads, floor.discs["after"]
    moved = floor.discs[disc]
    if not math.isnan(moved.x):
        leave(heads, after, _cell_of(grid, moved.x, moved.y), disc)
    if not math.isnan(x):
        enter(heads, after, _cell_of(grid, x, y), disc)
    moved.x, moved.y = x, y


@kernel
def _slab(ax, ay, bx, by, low, high):
    """The x [m] that the part of a segment with y in [low, high] [m] lies between."""
    first, last = 0.0, 1.0
    dy = by - ay
    if dy != 0.0:
        one, two = (low - ay) / dy, (high - ay) / dy
        first, last = min(max(min(one, two), 0.0), 1.0), max(min(max(one, two), 1.0), 0.0)
    one, two = ax + first * (bx - ax), ax + last * (bx - ax)
    return min(one, two), max(one, two)


@kernel
def columns_near(
    grid: Record, row: int, ax: float, ay: float, bx: float, by: float, reach: float
) -> tuple[int, int]:
    """First and last column of the cells in ``row`` within ``reach`` [m] of a segment."""
    low, high = row * grid.cell, (row + 1) * grid.cell
    if row == 0:
        low = -math.inf
    if row == grid.rows - 1:
        high = math.inf
    left, right = _slab(ax, ay, bx, by, low - reach, high + reach)
    return (
        row_of(left - reach, 0.0, grid.cell, grid.columns),
        row_of(right + reach, 0.0, grid.cell, grid.columns),
    )


@kernel
def rows_near(grid: Record, ay: float, by: float, reach: float) -> tuple[int, int]:
    """First and last row of the cells within ``reach`` [m] of a segment."""
    return (
        row_of(min(ay, by) - reach, 0.0, grid.cell, grid.rows),
        row_of(max(ay, by) + reach, 0.0, grid.cell, grid.rows),
    )


@kernel
def discs_near(floor, me, ax, ay, bx, by, reach):
    """List in ``floor.near`` the discs but ``me`` whose centre is within ``reach`` [m] of a
    segment; returns how many.
    """
    grid, discs, heads, near = floor.grid[0], floor.discs, floor.heads, floor.near
    count = 0
    first, last = rows_near(grid, ay, by, reach)
    for row in range(first, last + 1):
        left, right = columns_near(grid, row, ax, ay, bx, by, reach)
        for column in range(left, right + 1):
            disc = heads[row * grid.columns + column]
            while disc != NOBODY:
                found = discs[disc]
                if disc != me and to_segment(found.x, found.y, ax, ay, bx, by) < reach:
                    near[count] = disc
                    count += 1
                disc = found.after
    return count


@kernel
def edges_near(floor, ax, ay, bx, by, reach, at):
    """List in ``floor.near``, from ``at`` on, the edges in cells within ``reach`` [m] of a
    segment; returns the end of the list.
    """
    grid, near, marks = floor.grid[0], floor.near, floor.marks
    if len(floor.edges) == 0:
        return at
    count = at
    first, last = rows_near(grid, ay, by, reach)
    offset = len(floor.discs)
    for row in range(first, last + 1):
        left, right = columns_near(grid, row, ax, ay, bx, by, reach)
        for cell in range(row * grid.columns + left, row * grid.columns + right + 1):
            for k in range(floor.bins[cell], floor.bins[cell + 1]):
                edge = floor.binned[k]
                if not marks[offset + edge]:
                    marks[offset + edge] = True
                    near[count] = edge
                    count += 1
    for k in range(at, count):
        marks[offset + near[k]] = False
    return count
