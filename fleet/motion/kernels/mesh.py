"""A mesh of the free floor: triangles in which the centre of a body may be anywhere."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion.kernels.records import NOBODY, FloatArray, IntArray
from protocols.compiled import kernel

INSIDE = 1e-12  # [m²] so far beyond a side a point still counts as in the triangle


class Mesh(NamedTuple):
    """Triangles, counter-clockwise; side k of one leads from its corner k to the next."""

    points: FloatArray  # (v, 2) [m]
    owners: IntArray  # (v,) the disc of the floor that a path turns around there, or NOBODY
    triangles: IntArray  # (t, 3) points; NOBODY: taken out
    beside: IntArray  # (t, 3) the triangle across each side, or NOBODY
    entries: IntArray  # (t, 3) that side, as counted there
    areas: IntArray  # (t,) which triangles hang together
    outward: IntArray  # (t,) of a triangle in a dead end, the next one on the way out, or NOBODY
    bins: IntArray  # (rows × columns + 1,) where each cell's triangles begin in binned
    binned: IntArray  # triangles by cell
    shape: IntArray  # (3,) rows and columns of cells, and how many triangles are in them
    pitch: float  # side of a cell [m]


@kernel
def turn(ax, ay, bx, by, cx, cy):
    """Positive: from a over b to c [m] is a turn to the left. Twice the triangle's area [m²]."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@kernel
def _nearest_on(mesh, triangle, x, y):
    """The point of a triangle that is nearest to (x, y) [m]: (distance, x, y)."""
    corners, points = mesh.triangles[triangle], mesh.points
    best, bx, by, inside = math.inf, x, y, True
    for k in range(3):
        a, b = corners[k], corners[(k + 1) % 3]
        ax, ay = points[a, 0], points[a, 1]
        dx, dy = points[b, 0] - ax, points[b, 1] - ay
        if turn(ax, ay, points[b, 0], points[b, 1], x, y) < -INSIDE:
            inside = False
        square = dx * dx + dy * dy
        share = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
        px, py = ax + share * dx, ay + share * dy
        away = math.hypot(px - x, py - y)
        if away < best:
            best, bx, by = away, px, py
    return (0.0, x, y) if inside else (best, bx, by)


@kernel
def locate(mesh: Mesh, x: float, y: float, reach: float) -> tuple[int, float, float]:
    """The triangle nearest to (x, y) [m] within ``reach`` [m], or NOBODY, and the point in it."""
    rows, columns, kept = mesh.shape[0], mesh.shape[1], mesh.shape[2]
    found, best, bx, by = NOBODY, math.inf, x, y
    low = min(max(int((y - reach) / mesh.pitch), 0), rows - 1)
    high = min(max(int((y + reach) / mesh.pitch), 0), rows - 1)
    left = min(max(int((x - reach) / mesh.pitch), 0), columns - 1)
    right = min(max(int((x + reach) / mesh.pitch), 0), columns - 1)
    for row in range(low, high + 1):
        for k in range(mesh.bins[row * columns + left], mesh.bins[row * columns + right + 1]):
            triangle = mesh.binned[k]
            if mesh.triangles[triangle, 0] != NOBODY:
                away, px, py = _nearest_on(mesh, triangle, x, y)
                if away < best:
                    found, best, bx, by = triangle, away, px, py
                if best == 0.0:
                    return found, bx, by
    for triangle in range(kept, len(mesh.triangles)):
        away, px, py = _nearest_on(mesh, triangle, x, y)
        if away < best:
            found, best, bx, by = triangle, away, px, py
    if best > reach:
        found = NOBODY
    return found, bx, by


@kernel
def triangles_near(mesh: Mesh, x: float, y: float, reach: float, found: NDArray[np.bool_]) -> None:
    """Mark in ``found`` (t,) the triangles that come within ``reach`` of (x, y) [m]."""
    rows, columns, kept = mesh.shape[0], mesh.shape[1], mesh.shape[2]
    low = min(max(int((y - reach) / mesh.pitch), 0), rows - 1)
    high = min(max(int((y + reach) / mesh.pitch), 0), rows - 1)
    left = min(max(int((x - reach) / mesh.pitch), 0), columns - 1)
    right = min(max(int((x + reach) / mesh.pitch), 0), columns - 1)
    for row in range(low, high + 1):
        for k in range(mesh.bins[row * columns + left], mesh.bins[row * columns + right + 1]):
            triangle = mesh.binned[k]
            if mesh.triangles[triangle, 0] != NOBODY and not found[triangle]:
                found[triangle] = _nearest_on(mesh, triangle, x, y)[0] <= reach
    for triangle in range(kept, len(mesh.triangles)):
        if mesh.triangles[triangle, 0] != NOBODY:
            found[triangle] = found[triangle] or _nearest_on(mesh, triangle, x, y)[0] <= reach


@kernel
def count_cells(mesh: Mesh, counts: IntArray, binned: IntArray, write: bool) -> None:
    """Count in ``counts`` (cells,) the triangles whose box meets each cell, or write them down."""
    rows, columns = mesh.shape[0], mesh.shape[1]
    for triangle in range(len(mesh.triangles)):
        a, b, c = mesh.triangles[triangle]
        xs = (mesh.points[a, 0], mesh.points[b, 0], mesh.points[c, 0])
        ys = (mesh.points[a, 1], mesh.points[b, 1], mesh.points[c, 1])
        for row in range(
            min(int(min(ys) / mesh.pitch), rows - 1), min(int(max(ys) / mesh.pitch), rows - 1) + 1
        ):
            for column in range(
                min(int(min(xs) / mesh.pitch), columns - 1),
                min(int(max(xs) / mesh.pitch), columns - 1) + 1,
            ):
                cell = row * columns + column
                if write:
                    binned[counts[cell]] = triangle
                counts[cell] += 1


@kernel
def ways_out(beside: IntArray, outward: IntArray) -> None:
    """Write down where each dead end is left: triangles with one way on are taken off, until each
    has two.
    """
    ways, queue = np.zeros(len(beside), np.int64), np.empty(len(beside), np.int64)
    waiting, done = 0, 0
    for t in range(len(beside)):
        outward[t] = NOBODY
        for k in range(3):
            ways[t] += beside[t, k] != NOBODY
        if ways[t] == 1:
            queue[waiting] = t
            waiting += 1
    while done < waiting:
        t = queue[done]
        done += 1
        if ways[t] != 1:
            continue
        ways[t] = 0
        for k in range(3):
            other = beside[t, k]
            if other != NOBODY and ways[other] > 0:
                outward[t] = other
                ways[other] -= 1
                if ways[other] == 1:
                    queue[waiting] = other
                    waiting += 1


@kernel
def open_up(mesh: Mesh, start: int, goal: int) -> NDArray[np.bool_]:
    """Which triangles (t,) a shortest way between two of them may pass: no dead ends, but those
    that they are in, or that triangles were taken out of.
    """
    found = np.zeros(len(mesh.outward), np.bool_)
    for t in range(len(found)):
        found[t] = mesh.outward[t] == NOBODY
    for t in (start, goal):
        k = t
        while k != NOBODY:
            found[k] = True
            k = mesh.outward[k]
    for t in range(mesh.shape[2]):
        if len(mesh.triangles) > mesh.shape[2] and mesh.triangles[t, 0] == NOBODY:
            k = mesh.outward[t]
            while k != NOBODY:
                found[k] = True
                k = mesh.outward[k]
    return found
