"""Tangents from circle to circle, and how far one can follow a circle.

A robot goes around a circle counter-clockwise (side +1) or clockwise (side -1) and leaves it
along a straight line that touches the next circle, which it goes around on a side of its own.
There is one such line at most. A point is a circle of radius 0.
"""

from __future__ import annotations

import math

from fleet.motion.kernels.geometry import (
    TWO_PI,
    arc_to_segment,
    between_segments,
    to_segment,
    turned,
    wrapped,
)
from protocols.compiled import kernel

GRAZE = 1e-7  # [m], [rad] paths may touch what they go around, and this much more


@kernel
def tangent(x, y, radius, side, x2, y2, radius2, side2):
    """Where the line leaves the first circle and meets the second: (exists, angle, angle).

    Both centres lie on known sides of the line, at the distance of their radii: so the angle
    between the line's normal and the line of centres is the arc cosine of the difference
    (same sides) or the sum (different sides) of the radii, by the distance of the centres.
    """
    dx, dy = x2 - x, y2 - y
    distance = math.hypot(dx, dy)
    same = side == side2
    across = radius - radius2 if same else radius + radius2
    if abs(across) > distance:
        # a point on a circle, within rounding, counts as on it
        if abs(across) > distance + GRAZE or distance == 0.0:
            return False, 0.0, 0.0
        across = math.copysign(distance, across)
    leaves = math.atan2(dy, dx) - side * math.acos(across / distance)
    return True, leaves, leaves if same else leaves + math.pi


@kernel
def _before(first, side, middle, half):
    """How far [rad] one can go from ``first`` on to ``side`` before the angles within ``half``
    of ``middle``.
    """
    if abs(wrapped(first - middle)) < half - GRAZE:
        return 0.0
    sweep = turned(side * (middle - side * half - first))
    return 0.0 if sweep > TWO_PI - GRAZE else sweep


@kernel
def free_sweep(circles, count, box, around, first, side):
    """How far [rad] a robot can follow circle ``around`` before another one or a wall.

    ``circles``: (count,), of which 0 and 1 are start and goal; ``box``: (4,) the least and the
    greatest x and y that its centre may have [m].
    """
    circle = circles[around]
    x, y, radius = circle.x, circle.y, circle.radius
    sweep = TWO_PI
    for k in range(2, count):
        dx, dy = circles[k].x - x, circles[k].y - y
        other = circles[k].radius
        apart = math.hypot(dx, dy)
        if k == around or apart >= radius + other - GRAZE or apart <= radius - other + GRAZE:
            continue
        if apart <= other - radius - GRAZE or apart == 0.0:
            return 0.0
        cosine = (apart * apart + radius * radius - other * other) / (2.0 * apart * radius)
        half = math.acos(min(max(cosine, -1.0), 1.0))
        sweep = min(sweep, _before(first, side, math.atan2(dy, dx), half))
    for wall in range(4):
        room = box[wall] - (x if wall < 2 else y)
        if wall == 0 or wall == 2:
            room = -room
        if room >= radius - GRAZE:
            continue
        if room <= -radius:
            return 0.0
        towards = (math.pi, 0.0, 1.5 * math.pi, 0.5 * math.pi)[wall]
        sweep = min(sweep, _before(first, side, towards, math.acos(room / radius)))
    return sweep


@kernel
def line_is_free(ax, ay, bx, by, circles, count, one, two, sides, side_count):
    """Whether a segment meets no circle but ``one`` and ``two``, and no polygon's side.

    ``sides``: (side_count, 5) from and to [m], and the distance to keep [m].
    """
    for k in range(2, count):
        if k != one and k != two:
            away = to_segment(circles[k].x, circles[k].y, ax, ay, bx, by)
            if away < circles[k].radius - GRAZE:
                return False
    for k in range(side_count):
        away = between_segments(ax, ay, bx, by, sides[k, 0], sides[k, 1], sides[k, 2], sides[k, 3])
        if away < sides[k, 4] - GRAZE:
            return False
    return True


@kernel
def arc_is_free(x, y, radius, first, sweep, sides, side_count):
    """Whether an arc, counter-clockwise from ``first`` by ``sweep``, meets no polygon's side."""
    for k in range(side_count):
        away = arc_to_segment(
            x, y, radius, first, sweep, sides[k, 0], sides[k, 1], sides[k, 2], sides[k, 3]
        )
        if away < sides[k, 4] - GRAZE:
            return False
    return True
