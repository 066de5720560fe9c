"""A roadmap of a floor with many corners: which tangents between them are free of obstacles.

Obstacles stay where they are, so this is found out once, and searches look only at robots anew.
Of ragged obstacles most corners lie so deep among others that no robot can go around them: only
those count around which a body finds a free arc.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion.kernels.geometry import TWO_PI, between_segments, to_segment, turned
from fleet.motion.kernels.grid import columns_near, edges_near, rows_near
from fleet.motion.kernels.records import FloatArray, Floor, IntArray, Records
from fleet.motion.kernels.tangents import GRAZE
from protocols.compiled import kernel

BINS = 128  # directions around a corner for each of which it is kept whether it is free
STEP = TWO_PI / BINS  # [rad]
NONE, SOME, SURE = 0, 1, 2
SPARE = 1.0 + 0.5 * STEP * STEP  # margins in the middle of a bin with which all of it is free
BLUR = 1.5  # pitches: from a point to the middle of its cell, and from a side to that of its own
STRETCH = 1.5  # margins that are asked about at once


class Roadmap(NamedTuple):
    """Corners that can be gone around, and the free lines between them.

    A node is a corner and a side: 2 × corner for clockwise, and one more for counter-clockwise.
    """

    corners: IntArray  # (c,) their discs on the floor
    places: FloatArray  # (c, 2) [m]
    room: NDArray[np.int8]  # (c, BINS) directions in which a body has room: NONE, SOME or SURE
    begins: IntArray  # (2c + 1,) where the lines that leave each node begin
    ends: IntArray  # (lines,) the nodes that they lead to
    angles: FloatArray  # (lines, 2) where they leave and arrive on their circles [rad]
    lengths: FloatArray  # (lines,) [m]
    points: FloatArray  # (lines, 2) where they arrive [m]
    away: NDArray[np.float32]  # (rows, columns) from the middle of cells to sides, nearly [m]
    pitch: float  # side of these cells [m]
    areas: IntArray  # (c,) which corners hang together by lines
    landmarks: FloatArray  # (c, landmarks) the least length of lines to some corners; inf: none


@kernel
def _near_line(edge, ax, ay, bx, by, limit):
    """Whether an edge comes nearer to a segment than ``limit`` [m]; boxes are compared first."""
    if min(edge.ax, edge.bx) - max(ax, bx) >= limit or min(ax, bx) - max(edge.ax, edge.bx) >= limit:
        return False
    if min(edge.ay, edge.by) - max(ay, by) >= limit or min(ay, by) - max(edge.ay, edge.by) >= limit:
        return False
    return between_segments(ax, ay, bx, by, edge.ax, edge.ay, edge.bx, edge.by) < limit


@kernel
def _stretch_is_clear(floor, ax, ay, bx, by, margin):
    """Whether a short segment keeps ``margin`` [m] from all polygons' sides."""
    grid = floor.grid[0]
    first, last = rows_near(grid, ay, by, margin)
    for row in range(first, last + 1):
        left, right = columns_near(grid, row, ax, ay, bx, by, margin)
        for cell in range(row * grid.columns + left, row * grid.columns + right + 1):
            for k in range(floor.bins[cell], floor.bins[cell + 1]):
                edge = floor.edges[floor.binned[k]]
                if _near_line(edge, ax, ay, bx, by, edge.core + margin - GRAZE):
                    return False
    return True


@kernel
def _away(roadmap, x, y):
    """How far sides are from (x, y) [m], to within :data:`BLUR` pitches."""
    away, pitch = roadmap.away, roadmap.pitch
    row = min(max(int(y / pitch), 0), away.shape[0] - 1)
    column = min(max(int(x / pitch), 0), away.shape[1] - 1)
    return away[row, column]


@kernel
def line_is_clear(floor, roadmap, ax, ay, bx, by, margin, begin):
    """Whether a segment keeps ``margin`` [m] from all polygons' sides.

    Most that do not are told by the distances on the roadmap alone, looking from ``begin`` [m]
    on: before, a robot that starts nearer than that may be. Where these leave it open, sides are
    asked.
    """
    length = math.hypot(bx - ax, by - ay)
    if length == 0.0:
        return _stretch_is_clear(floor, ax, ay, bx, by, margin)
    dx, dy, blur = (bx - ax) / length, (by - ay) / length, BLUR * roadmap.pitch
    at = begin
    while at < length:
        away = _away(roadmap, ax + at * dx, ay + at * dy)
        if away + blur < margin:
            return False
        at += max(away + blur - margin, roadmap.pitch)
    at = 0.0
    while at < length:
        spare = _away(roadmap, ax + at * dx, ay + at * dy) - blur - margin
        if spare < roadmap.pitch:
            spare = min(STRETCH * margin, length - at)
            x, y, end = ax + at * dx, ay + at * dy, at + spare
            if not _stretch_is_clear(floor, x, y, ax + end * dx, ay + end * dy, margin):
                return False
        at += spare
    return True


@kernel
def mark_sides(floor: Floor, fine: Records, found: NDArray[np.bool_]) -> None:
    """Mark in ``found`` (rows, columns) the cells of the grid ``fine`` that sides cross."""
    grid = fine[0]
    for k in range(len(floor.edges)):
        edge = floor.edges[k]
        first, last = rows_near(grid, edge.ay, edge.by, 0.0)
        for row in range(first, last + 1):
            left, right = columns_near(grid, row, edge.ax, edge.ay, edge.bx, edge.by, 0.0)
            for column in range(left, right + 1):
                found[row, column] = True


@kernel
def open_directions(
    floor: Floor, corners: IntArray, box: FloatArray, margin: float, found: NDArray[np.int8]
) -> None:
    """Note in ``found`` (c, BINS) around which corners, and where, a body has room.

    ``box``: (4,) the least and the greatest x and y that its centre may have [m].
    """
    for c in range(len(corners)):
        disc = floor.discs[corners[c]]
        count = edges_near(floor, disc.x, disc.y, disc.x, disc.y, 2.0 * margin, 0)
        for k in range(BINS):
            angle = (k + 0.5) * STEP
            x, y = disc.x + margin * math.cos(angle), disc.y + margin * math.sin(angle)
            inside = box[0] <= x <= box[1] and box[2] <= y <= box[3]
            room, at = SURE if inside else NONE, 0
            while room != NONE and at < count:
                edge = floor.edges[floor.near[at]]
                away = to_segment(x, y, edge.ax, edge.ay, edge.bx, edge.by)
                if away < margin - GRAZE:
                    room = NONE
                elif away < margin * SPARE and edge.a != corners[c] and edge.b != corners[c]:
                    room = SOME
                at += 1
            found[c, k] = room


@kernel
def is_open(roadmap, corner, angle):
    """Whether a body may have room around a corner at an ``angle`` [rad], to a bin or so."""
    k = int(turned(angle) / STEP) % BINS
    row = roadmap.room[corner]
    return row[k] != NONE or row[(k + 1) % BINS] != NONE or row[k - 1] != NONE


@kernel
def open_sweep(roadmap, corner, angle, side):
    """How far [rad] a body may follow the circle around a corner from there, to a bin or so."""
    k = int(turned(angle) / STEP) % BINS
    row = roadmap.room[corner]
    if row[k] == NONE:
        k = (k + side) % BINS
    count = 0
    while count < BINS and row[k] != NONE:
        k = (k + side) % BINS
        count += 1
    return (count + 2) * STEP


@kernel
def is_sure(roadmap, corner, first, sweep):
    """Whether an arc around a corner, counter-clockwise from ``first`` by ``sweep`` [rad], is free
    for sure: where it is in the middle of bins, nothing comes in between.
    """
    k, end = int(turned(first) / STEP), int((turned(first) + sweep) / STEP)
    while k <= end:
        if roadmap.room[corner, k % BINS] != SURE:
            return False
        k += 1
    return True


@kernel
def _note(lines, numbers, made, here, there, leaves, arrives, length):
    """Write a line and the same one backwards down; returns how many there are."""
    lines[made, 0], lines[made, 1] = here, there
    numbers[made, 0], numbers[made, 1], numbers[made, 2] = leaves, arrives, length
    lines[made + 1, 0], lines[made + 1, 1] = there ^ 1, here ^ 1
    numbers[made + 1, 0], numbers[made + 1, 1], numbers[made + 1, 2] = arrives, leaves, length
    return made + 2


@kernel
def lines_from(
    floor: Floor, roadmap: Roadmap, one: int, margin: float, lines: IntArray, numbers: FloatArray
) -> int:
    """List the free tangents from corner ``one`` to those after it, both ways; how many.

    ``lines`` (k, 2): nodes from and to; ``numbers`` (k, 3): where they leave and arrive [rad],
    and their lengths [m]. There is room for eight of each corner.
    """
    places = roadmap.places
    x, y = places[one, 0], places[one, 1]
    made = 0
    for two in range(one + 1, len(places)):
        dx, dy = places[two, 0] - x, places[two, 1] - y
        distance = math.hypot(dx, dy)
        if distance <= GRAZE:
            continue
        ahead = math.atan2(dy, dx)
        for side in (1, -1):
            for same in (True, False):
                across = 0.0 if same else 2.0 * margin
                if across > distance:
                    continue
                leaves = ahead - side * math.acos(across / distance)
                arrives = leaves if same else leaves + math.pi
                if not is_open(roadmap, one, leaves) or not is_open(roadmap, two, arrives):
                    continue
                ax, ay = x + margin * math.cos(leaves), y + margin * math.sin(leaves)
                bx = places[two, 0] + margin * math.cos(arrives)
                by = places[two, 1] + margin * math.sin(arrives)
                if not line_is_clear(floor, roadmap, ax, ay, bx, by, margin, 0.0):
                    continue
                other = side if same else -side
                here, there = 2 * one + (side + 1) // 2, 2 * two + (other + 1) // 2
                length = math.hypot(bx - ax, by - ay)
                made = _note(lines, numbers, made, here, there, leaves, arrives, length)
    return made
