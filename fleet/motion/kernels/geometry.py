"""Distances between points, segments and arcs, and angles."""

from __future__ import annotations

import math

from protocols.compiled import kernel

TWO_PI = 2.0 * math.pi


@kernel
def wrapped(angle):
    """``angle`` [rad] in [-π, π)."""
    if -math.pi <= angle < math.pi:
        return angle
    return angle - TWO_PI * math.floor((angle + math.pi) / TWO_PI)


@kernel
def turned(angle):
    """``angle`` [rad] in [0, 2π)."""
    angle -= TWO_PI * math.floor(angle / TWO_PI)
    return angle if angle < TWO_PI else 0.0


@kernel
def to_segment(px, py, ax, ay, bx, by):
    """Distance [m] from a point to a segment."""
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    share = 0.0
    if square > 0.0:
        share = min(max(((px - ax) * dx + (py - ay) * dy) / square, 0.0), 1.0)
    return math.hypot(ax + share * dx - px, ay + share * dy - py)


@kernel
def _side(ax, ay, bx, by, px, py):
    """Positive: the point is to the left of the line from a to b."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel
def between_segments(ax, ay, bx, by, cx, cy, dx, dy):
    """Distance [m] between two segments; 0 if they cross."""
    first = (_side(ax, ay, bx, by, cx, cy) > 0.0) != (_side(ax, ay, bx, by, dx, dy) > 0.0)
    second = (_side(cx, cy, dx, dy, ax, ay) > 0.0) != (_side(cx, cy, dx, dy, bx, by) > 0.0)
    if first and second:
        return 0.0
    return min(
        to_segment(ax, ay, cx, cy, dx, dy),
        to_segment(bx, by, cx, cy, dx, dy),
        to_segment(cx, cy, ax, ay, bx, by),
        to_segment(dx, dy, ax, ay, bx, by),
    )


@kernel
def _spans(first, sweep, angle):
    """Whether the arc that turns by ``sweep`` >= 0 from ``first`` on has ``angle`` [rad] in it."""
    return turned(angle - first) <= sweep


@kernel
def to_arc(px, py, cx, cy, radius, first, sweep):
    """Distance [m] from a point to an arc, counter-clockwise from ``first`` by ``sweep`` >= 0."""
    dx, dy = px - cx, py - cy
    if _spans(first, sweep, math.atan2(dy, dx)):
        return abs(math.hypot(dx, dy) - radius)
    last = first + sweep
    return min(
        math.hypot(cx + radius * math.cos(first) - px, cy + radius * math.sin(first) - py),
        math.hypot(cx + radius * math.cos(last) - px, cy + radius * math.sin(last) - py),
    )


@kernel
def arc_to_segment(cx, cy, radius, first, sweep, ax, ay, bx, by):
    """Distance [m] between an arc, as in :func:`to_arc`, and a segment; 0 if they meet.

    It is taken on at an end of one of them, where they meet, or where the segment is nearest
    to the centre.
    """
    last = first + sweep
    distance = min(
        to_segment(cx + radius * math.cos(first), cy + radius * math.sin(first), ax, ay, bx, by),
        to_segment(cx + radius * math.cos(last), cy + radius * math.sin(last), ax, ay, bx, by),
    )
    distance = min(distance, to_arc(ax, ay, cx, cy, radius, first, sweep))
    distance = min(distance, to_arc(bx, by, cx, cy, radius, first, sweep))
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    if square == 0.0:
        return distance
    foot = ((cx - ax) * dx + (cy - ay) * dy) / square
    x, y = ax + foot * dx - cx, ay + foot * dy - cy
    off = math.hypot(x, y)
    if off >= radius:
        if 0.0 <= foot <= 1.0 and _spans(first, sweep, math.atan2(y, x)):
            distance = min(distance, off - radius)
        return distance
    half = math.sqrt((radius * radius - off * off) / square)
    for share in (foot - half, foot + half):
        angle = math.atan2(ay + share * dy - cy, ax + share * dx - cx)
        if 0.0 <= share <= 1.0 and _spans(first, sweep, angle):
            return 0.0
    return distance
