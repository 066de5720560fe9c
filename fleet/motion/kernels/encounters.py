"""Where a path on a mesh begins and ends, and which robots are in its way."""

from __future__ import annotations

import numpy as np

from fleet.motion.kernels.goal import free_point
from fleet.motion.kernels.grid import discs_near, edges_near
from fleet.motion.kernels.plan import disc_hit, edge_hit, squeeze
from fleet.motion.kernels.records import LINE, FloatArray, Floor, IntArray, Records
from fleet.motion.kernels.search import lay_line
from protocols.compiled import kernel

BESIDE = 2.0  # robots' radii: who stands so near to a path that hits somebody is found too


@kernel
def approach(
    floor: Floor, me: int, ends: FloatArray, clearance: float, saved: FloatArray
) -> tuple[bool, float, float, int]:
    """Shrink what the start is too near to, and find where to go: (exists, x, y, shrunk).

    ``ends``: (4,) x and y of start and site [m]; ``saved``: see
    :func:`fleet.motion.kernels.plan.squeeze`.
    """
    grid, box = floor.grid[0], np.empty(4)
    margin = grid.radius + clearance
    sx, sy = ends[0], ends[1]
    box[0], box[1] = min(margin, sx), max(grid.width - margin, sx)
    box[2], box[3] = min(margin, sy), max(grid.height - margin, sy)
    squeezed = squeeze(floor, me, sx, sy, clearance, saved)
    exists, x, y = free_point(floor, me, sx, sy, ends[2], ends[3], clearance, box)
    return exists, x, y, squeezed


@kernel
def straight(floor: Floor, ends: FloatArray, margin: float, segments: Records) -> bool:
    """Write the line between both ``ends`` (4,) [m] down as segment 1; whether it keeps off
    all obstacles.
    """
    segment = segments[1]
    lay_line(segment, ends[0], ends[1], ends[2], ends[3])
    for k in range(edges_near(floor, ends[0], ends[1], ends[2], ends[3], margin, 0)):
        edge = floor.edges[floor.near[k]]
        if edge_hit(segment, edge, edge.core + margin):
            return False
    return True


@kernel
def robots_hit(
    floor: Floor, me: int, segments: Records, last: int, margin: float, found: IntArray
) -> int:
    """List in ``found`` the robots that the path segments[1:last] runs into, and those beside
    where it does; returns how many.
    """
    radius, robots, count = floor.grid[0].radius, len(found), 0
    beside = BESIDE * radius
    for p in range(1, last):
        segment, before, hit = segments[p], count, False
        bx, by = segment.x, segment.y
        if segment.kind == LINE:
            bx, by = bx + segment.length * segment.cos, by + segment.length * segment.sin
        reach = segment.radius + radius + margin + beside
        for k in range(discs_near(floor, me, segment.x, segment.y, bx, by, reach)):
            disc = floor.near[k]
            if disc >= robots or floor.marks[disc]:
                continue
            core = floor.discs[disc].core + margin
            if disc_hit(segment, floor.discs[disc], core + beside):
                hit = hit or disc_hit(segment, floor.discs[disc], core)
                floor.marks[disc] = True
                found[count] = disc
                count += 1
        if not hit:  # nobody is in the way of this segment: those beside it do not matter
            for k in range(before, count):
                floor.marks[found[k]] = False
            count = before
    for k in range(count):
        floor.marks[found[k]] = False
    return count


@kernel
def path_length(segments: Records, last: int) -> float:
    """Of the path segments[1:last] [m]."""
    length = 0.0
    for k in range(1, last):
        length += segments[k].length
    return length


@kernel
def ways_around(points: FloatArray, turns: IntArray, ends: FloatArray) -> IntArray:
    """On which side a polyline from start to goal, ``ends`` (4,) [m], passes each of the points
    ``turns`` that it turns at: (k,), +1: counter-clockwise.
    """
    sides = np.empty(len(turns), np.int64)
    for k in range(len(turns)):
        x, y = points[turns[k], 0], points[turns[k], 1]
        ax, ay, bx, by = ends[0], ends[1], ends[2], ends[3]
        if k > 0:
            ax, ay = points[turns[k - 1], 0], points[turns[k - 1], 1]
        if k < len(turns) - 1:
            bx, by = points[turns[k + 1], 0], points[turns[k + 1], 1]
        left = (x - ax) * (by - y) - (y - ay) * (bx - x) > 0.0
        sides[k] = 1 if left else -1
    return sides
