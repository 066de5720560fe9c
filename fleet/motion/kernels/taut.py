"""From turning points to a path: lines and arcs, taut around the circles of what it passes.

The mesh has polygons for circles, slightly larger. Pulled taut around the circles themselves, a
path leaves some of them alone, and may come to touch others beside: those are put in.
"""

from __future__ import annotations

import math

import numpy as np

from fleet.motion.kernels.geometry import (
    arc_to_segment,
    between_segments,
    to_arc,
    to_segment,
    turned,
)
from fleet.motion.kernels.grid import edges_near
from fleet.motion.kernels.plan import NO_PATH
from fleet.motion.kernels.records import (
    CIRCLE,
    NOBODY,
    FloatArray,
    Floor,
    IntArray,
    Records,
    record_type,
)
from fleet.motion.kernels.search import NODE, lay, sweep_between
from fleet.motion.kernels.tangents import GRAZE, tangent
from protocols.compiled import kernel

BACK = 1.25 * math.pi  # [rad] who would have to follow a circle so far passes it the other way
MOST_REPAIRS = 200

PASSED = record_type(
    [
        ("disc", "i8"),  # of the floor; NOBODY: start or goal
        ("side", "i8"),  # +1: counter-clockwise
        ("x", "f8"),  # [m]
        ("y", "f8"),
        ("radius", "f8"),
        ("arrival", "f8"),  # angles on the circle [rad]
        ("departure", "f8"),
        ("sweep", "f8"),
    ]
)
"""A circle that a path goes around."""


@kernel
def _put_in(floor, margin, passed, count, at, disc, side):
    """Put the circle of a disc before the one numbered ``at``."""
    for k in range(count, at, -1):
        passed[k] = passed[k - 1]
    here, found = passed[at], floor.discs[disc]
    here.disc, here.side, here.x, here.y = disc, side, found.x, found.y
    here.radius = found.core + margin
    return count + 1


@kernel
def _take_out(passed, count, at):
    for k in range(at, count - 1):
        passed[k] = passed[k + 1]
    return count - 1


@kernel
def _pull(passed, count):
    """Find the tangents from circle to circle, and leave out those that are passed by.

    Returns how many are left, or NO_PATH; and the first one that is no longer as it was.
    """
    k, changed = 0, count
    while k < count - 1:
        one, two = passed[k], passed[k + 1]
        if one.disc == two.disc and one.disc != NOBODY:
            count = _take_out(passed, count, k + 1)
            changed, k = min(changed, k), max(k - 1, 0)
            continue
        leaving = two.side if one.disc == NOBODY else one.side
        arriving = leaving if two.disc == NOBODY else two.side
        exists, departure, arrival = tangent(
            one.x, one.y, one.radius, leaving, two.x, two.y, two.radius, arriving
        )
        if not exists:
            return NO_PATH, 0
        one.departure, two.arrival, one.sweep = departure, arrival, 0.0
        if one.disc != NOBODY:
            one.sweep = sweep_between(one.side, one.arrival, departure)
            if one.sweep > BACK:
                count = _take_out(passed, count, k)
                changed, k = min(changed, k - 1), k - 1
                continue
        k += 1
    return count, changed


@kernel
def _worst(floor, margin, passed, k, disc, worst, ax, ay, bx, by, arc):
    """Whether a disc comes nearer to a part of the path than any before: (disc, how near)."""
    found = floor.discs[disc]
    if disc == passed[k].disc or (not arc and disc == passed[k + 1].disc):
        return NOBODY, worst
    if arc:
        one = passed[k]
        first = one.arrival if one.side > 0 else one.arrival - one.sweep
        away = to_arc(found.x, found.y, one.x, one.y, one.radius, first, one.sweep)
    else:
        away = to_segment(found.x, found.y, ax, ay, bx, by)
    away -= found.core + margin
    return (disc, away) if away < worst else (NOBODY, worst)


@kernel
def _blocker(floor, margin, passed, k, robots, count, arc):
    """What the arc around circle ``k``, or the line from there to the next, runs into.

    (whether it does, the disc that it is nearest to, on which side that is to be passed)
    """
    one, two = passed[k], passed[k + 1]
    ax, ay = (
        one.x + one.radius * math.cos(one.departure),
        one.y + one.radius * math.sin(one.departure),
    )
    bx, by = two.x + two.radius * math.cos(two.arrival), two.y + two.radius * math.sin(two.arrival)
    hit, found, worst = False, NOBODY, math.inf
    first = one.arrival if one.side > 0 else one.arrival - one.sweep
    if arc:
        near = edges_near(floor, one.x, one.y, one.x, one.y, one.radius + margin, 0)
    else:
        near = edges_near(floor, ax, ay, bx, by, margin, 0)
    for n in range(near):
        edge = floor.edges[floor.near[n]]
        if arc:
            away = arc_to_segment(
                one.x, one.y, one.radius, first, one.sweep, edge.ax, edge.ay, edge.bx, edge.by
            )
        else:
            away = between_segments(ax, ay, bx, by, edge.ax, edge.ay, edge.bx, edge.by)
        if away < edge.core + margin - GRAZE:
            hit = True
            for corner in (edge.a, edge.b):
                disc, worst = _worst(floor, margin, passed, k, corner, worst, ax, ay, bx, by, arc)
                if disc != NOBODY:
                    found = disc
    for n in range(count):
        disc, away = _worst(floor, margin, passed, k, robots[n], worst, ax, ay, bx, by, arc)
        if disc != NOBODY and away < -GRAZE:
            hit, found, worst = True, disc, away
    if found == NOBODY:
        return hit, found, 0
    if arc:
        return hit, found, one.side
    disc = floor.discs[found]
    left = (bx - ax) * (disc.y - ay) - (by - ay) * (disc.x - ax) > 0.0
    return hit, found, 1 if left else -1


@kernel
def pull_taut(
    floor: Floor,
    discs: IntArray,
    sides: IntArray,
    robots: IntArray,
    ends: FloatArray,
    margin: float,
    segments: Records,
) -> int:
    """Write the path that passes ``discs`` (k,) on ``sides`` (k,) taut into ``segments``.

    ``robots``: discs that it must keep off, beside obstacles; ``ends``: (4,) x and y of start and
    goal [m]. The path is written from 1 on. Returns its end; NO_PATH if it would run into
    something, more than ``len(segments)`` if there is too little room.
    """
    passed = np.empty(len(discs) + MOST_REPAIRS * 2 + 4, PASSED)
    for k in range(2):
        end = passed[k]
        end.disc, end.side, end.x, end.y, end.radius = NOBODY, 1, ends[2 * k], ends[2 * k + 1], 0.0
        end.arrival, end.departure, end.sweep = 0.0, 0.0, 0.0
    count = 2
    for k in range(len(discs)):
        count = _put_in(floor, margin, passed, count, k + 1, discs[k], sides[k])
    count, _ = _pull(passed, count)
    k, repairs = 0, 0
    while count != NO_PATH and k < count - 1:
        arc, hit, disc, side = True, False, NOBODY, 1
        if passed[k].disc != NOBODY and passed[k].radius * passed[k].sweep > 0.0:
            hit, disc, side = _blocker(floor, margin, passed, k, robots, len(robots), True)
        if not hit:
            arc = False
            hit, disc, side = _blocker(floor, margin, passed, k, robots, len(robots), False)
        if not hit:
            k += 1
            continue
        repairs += 1
        if disc == NOBODY or repairs > MOST_REPAIRS:
            return NO_PATH
        around, way = passed[k].disc, passed[k].side
        count = _put_in(floor, margin, passed, count, k + 1, disc, side)
        if arc:
            count = _put_in(floor, margin, passed, count, k + 2, around, way)
        count, changed = _pull(passed, count)
        k = max(min(k, changed) - 1, 0)
    if count == NO_PATH:
        return NO_PATH
    last: int = _lay(passed, count, segments)
    return last


@kernel
def _lay(passed, count, segments):
    """Write the path down; see :func:`fleet.motion.kernels.search.lay`."""
    circles, nodes = np.empty(count, CIRCLE), np.empty(count, NODE)
    for k in range(count):
        one, node = passed[k], nodes[k]
        circles[k].x, circles[k].y, circles[k].radius = one.x, one.y, one.radius
        node.circle, node.side, node.arrival, node.parent = k, one.side, turned(one.arrival), k - 1
        node.x = one.x + one.radius * math.cos(one.arrival)
        node.y = one.y + one.radius * math.sin(one.arrival)
        if k > 0:
            node.departure, node.sweep = passed[k - 1].departure, passed[k - 1].sweep
    return lay(circles, nodes, count - 1, segments, 1)
