"""The shortest path of a robot from where it stands to a site, if there is one.

The straight line comes first. As long as the path found runs into something, what it runs into
is added to what it must avoid, and the shortest path among only that is found anew. A path that
avoids everything and is shortest among some of it is shortest among all of it.

Paths keep a clearance from what stands around. If there is none, less clearance is tried.
"""

from __future__ import annotations

import math

import numpy as np

from fleet.motion.kernels.geometry import arc_to_segment, between_segments, to_arc, to_segment
from fleet.motion.kernels.goal import free_point, is_free
from fleet.motion.kernels.grid import discs_near, edges_near, put
from fleet.motion.kernels.records import CIRCLE, LINE, NOBODY, FloatArray, Floor, Records
from fleet.motion.kernels.search import GOAL, START, lay, lay_line, shortest
from fleet.motion.kernels.tangents import GRAZE
from protocols.compiled import kernel

NO_PATH = -1
TOUCH = 1e-9  # [m] a robot starts this far off what it touches


@kernel
def squeeze(floor, me, x, y, clearance, saved):
    """Shrink what stands nearer to the start than ``clearance`` [m], so that it is just outside.

    ``saved`` (k, 2): which, and its core before [m]; returns how many. Discs come first, edges
    are numbered on from them.
    """
    radius = floor.grid[0].radius
    margin = radius + clearance
    count = 0
    for k in range(discs_near(floor, me, x, y, x, y, radius + margin)):
        disc = floor.discs[floor.near[k]]
        away = math.hypot(disc.x - x, disc.y - y)
        if away < disc.core + margin + TOUCH and count < len(saved):
            saved[count, 0], saved[count, 1] = floor.near[k], disc.core
            disc.core = away - margin - TOUCH
            count += 1
    for k in range(edges_near(floor, x, y, x, y, margin + TOUCH, 0)):
        edge = floor.edges[floor.near[k]]
        away = to_segment(x, y, edge.ax, edge.ay, edge.bx, edge.by)
        if away < edge.core + margin + TOUCH and count < len(saved):
            saved[count, 0], saved[count, 1] = len(floor.discs) + floor.near[k], edge.core
            edge.core = away - margin - TOUCH
            count += 1
    return count


@kernel
def unsqueeze(floor, saved, count):
    """Let what was squeezed be as it was."""
    for k in range(count):
        which = int(saved[k, 0])
        if which < len(floor.discs):
            floor.discs[which].core = saved[k, 1]
        else:
            floor.edges[which - len(floor.discs)].core = saved[k, 1]


@kernel
def disc_hit(segment, disc, radius):
    """Whether a segment of path comes nearer to a disc's centre than ``radius`` [m]."""
    if segment.kind == LINE:
        bx, by = segment.x + segment.length * segment.cos, segment.y + segment.length * segment.sin
        return to_segment(disc.x, disc.y, segment.x, segment.y, bx, by) < radius - GRAZE
    sweep = segment.length / segment.radius
    first = segment.angle if segment.sense > 0.0 else segment.angle - sweep
    return (
        to_arc(disc.x, disc.y, segment.x, segment.y, segment.radius, first, sweep) < radius - GRAZE
    )


@kernel
def edge_hit(segment, edge, radius):
    """Whether a segment of path comes nearer to a polygon's side than ``radius`` [m]."""
    if segment.kind == LINE:
        bx, by = segment.x + segment.length * segment.cos, segment.y + segment.length * segment.sin
        away = between_segments(segment.x, segment.y, bx, by, edge.ax, edge.ay, edge.bx, edge.by)
        return away < radius - GRAZE
    sweep = segment.length / segment.radius
    first = segment.angle if segment.sense > 0.0 else segment.angle - sweep
    away = arc_to_segment(
        segment.x, segment.y, segment.radius, first, sweep, edge.ax, edge.ay, edge.bx, edge.by
    )
    return away < radius - GRAZE


@kernel
def _avoid_disc(floor, disc, known, count):
    """Add a disc to the list of what must be avoided, unless it is there; returns the count."""
    if not floor.marks[disc]:
        floor.marks[disc] = True
        known[count] = disc
        count += 1
    return count


@kernel
def _obstruct(floor, me, segments, first, last, clearance, known, count):
    """Add what the path segments[first:last] runs into to ``known``, of which there are ``count``.

    Discs come first, edges are numbered on from them. Returns the new count.
    """
    radius = floor.grid[0].radius
    margin = radius + clearance
    offset = len(floor.discs)
    for p in range(first, last):
        segment = segments[p]
        bx, by, reach = segment.x, segment.y, segment.radius
        if segment.kind == LINE:
            bx, by = (
                segment.x + segment.length * segment.cos,
                segment.y + segment.length * segment.sin,
            )
            reach = 0.0
        near = discs_near(floor, me, segment.x, segment.y, bx, by, reach + radius + margin)
        for k in range(near):
            disc = floor.near[k]
            if disc_hit(segment, floor.discs[disc], floor.discs[disc].core + margin):
                count = _avoid_disc(floor, disc, known, count)
        near = edges_near(floor, segment.x, segment.y, bx, by, reach + margin, 0)
        for k in range(near):
            which = floor.near[k]
            edge = floor.edges[which]
            if not floor.marks[offset + which] and edge_hit(segment, edge, edge.core + margin):
                count = _avoid_disc(floor, offset + which, known, count)
                count = _avoid_disc(floor, edge.a, known, count)
                count = _avoid_disc(floor, edge.b, known, count)
    return count


@kernel
def _among(floor, sx, sy, gx, gy, clearance, known, count):
    """The known obstacles as the search wants them: (circles, how many, sides, how many)."""
    margin = floor.grid[0].radius + clearance
    circles, sides = np.empty(count + 2, CIRCLE), np.empty((count, 5))
    circles[START].x, circles[START].y, circles[START].radius = sx, sy, 0.0
    circles[GOAL].x, circles[GOAL].y, circles[GOAL].radius = gx, gy, 0.0
    rounds, flats = 2, 0
    for k in range(count):
        if known[k] < len(floor.discs):
            disc = floor.discs[known[k]]
            circle = circles[rounds]
            circle.x, circle.y, circle.radius = disc.x, disc.y, disc.core + margin
            rounds += 1
        else:
            edge = floor.edges[known[k] - len(floor.discs)]
            sides[flats, 0], sides[flats, 1] = edge.ax, edge.ay
            sides[flats, 2], sides[flats, 3] = edge.bx, edge.by
            sides[flats, 4] = edge.core + margin
            flats += 1
    return circles, rounds, sides, flats


@kernel
def _shortest_path(floor, me, sx, sy, gx, gy, clearance, box, segments, first):
    """The path from s to g [m], written into ``segments`` from ``first`` on: its end there.

    NO_PATH if there is none; more than ``len(segments)`` if there is too little room.
    """
    if math.hypot(gx - sx, gy - sy) < TOUCH:
        return first
    lay_line(segments[first], sx, sy, gx, gy)
    last = first + 1
    known = floor.near[len(floor.near) // 2 :]
    found, count = 0, 0
    while True:
        count = _obstruct(floor, me, segments, first, last, clearance, known, found)
        if count == found:
            break
        found = count
        circles, rounds, sides, flats = _among(floor, sx, sy, gx, gy, clearance, known, found)
        nodes, goal = shortest(circles, rounds, sides, flats, box)
        if goal == NOBODY:
            last = NO_PATH
            break
        last = lay(circles, nodes, goal, segments, first)
        if last > len(segments):
            break
    for k in range(found):
        floor.marks[known[k]] = False
    return last


@kernel
def plan(
    floor: Floor,
    me: int,
    sx: float,
    sy: float,
    x: float,
    y: float,
    clearances: FloatArray,
    segments: Records,
) -> tuple[int, float, float, float]:
    """The path of robot ``me`` from where it stands, s [m], to the site (x, y) [m].

    ``clearances``: (k,) to try in turn [m]. ``segments``: (room,) SEGMENT; lines and arcs are
    written from 1 on, the turn that comes first is left to the drive. Returns
    (end of the path in ``segments``, goal x, goal y, length [m]); the end is NO_PATH if there is
    no path, and more than ``room`` if that is too little.
    """
    grid = floor.grid[0]
    box, saved = np.empty(4), np.empty((64, 2))
    end, gx, gy = NO_PATH, sx, sy
    for k in range(len(clearances)):
        margin = grid.radius + clearances[k]
        box[0], box[1] = min(margin, sx), max(grid.width - margin, sx)
        box[2], box[3] = min(margin, sy), max(grid.height - margin, sy)
        squeezed = squeeze(floor, me, sx, sy, clearances[k], saved)
        exists, gx, gy = free_point(floor, me, sx, sy, x, y, clearances[k], box)
        if exists:
            end = _shortest_path(floor, me, sx, sy, gx, gy, clearances[k], box, segments, 1)
        unsqueeze(floor, saved, squeezed)
        if end != NO_PATH:
            break
    length = 0.0
    for k in range(1, min(end, len(segments))):
        length += segments[k].length
    return end, gx, gy, length


@kernel
def move_in(floor: Floor, points: FloatArray) -> tuple[int, int]:
    """Put the robots where they are, ``points`` (n, 2) [m].

    Returns the first robot that overlaps something, and the robot that it overlaps or NOBODY;
    (NOBODY, NOBODY) if all have room.
    """
    radius = floor.grid[0].radius
    box = np.array([0.0, floor.grid[0].width, 0.0, floor.grid[0].height])
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        for other in range(discs_near(floor, k, x, y, x, y, 2.0 * radius)):
            disc = floor.discs[floor.near[other]]
            if math.hypot(disc.x - x, disc.y - y) < disc.core + radius - GRAZE:
                return k, floor.near[other] if floor.near[other] < len(points) else NOBODY
        if min(x, box[1] - x, y, box[3] - y) < radius - GRAZE:
            return k, NOBODY
        if not is_free(floor, k, x, y, 0.0, box):
            return k, NOBODY
        put(floor, k, x, y)
    return NOBODY, NOBODY
