"""The nearest place to a site where a robot has room to stand.

What is in the way are discs, strips along the polygons' sides, the polygons themselves and the
walls. If the site is covered, the nearest free point lies on the border of one of them, right
across from the site, or where two borders meet.
"""

from __future__ import annotations

import math

import numpy as np

from fleet.motion.kernels.geometry import to_segment
from fleet.motion.kernels.grid import discs_near, edges_near
from fleet.motion.kernels.tangents import GRAZE
from protocols.compiled import kernel

OFF = 1e-9  # [m] by which the point is taken outside a border


@kernel
def _inside(floor, x, y):
    """Whether a point lies in a polygon: an odd number of sides to its right."""
    odd = False
    for k in range(len(floor.edges)):
        edge = floor.edges[k]
        if (edge.ay > y) != (edge.by > y):
            at = edge.ax + (y - edge.ay) / (edge.by - edge.ay) * (edge.bx - edge.ax)
            if x < at:
                odd = not odd
    return odd


@kernel
def is_free(floor, me, x, y, clearance, box):
    """Whether robot ``me`` has ``clearance`` [m] all around at (x, y) [m]."""
    if x < box[0] - GRAZE or x > box[1] + GRAZE or y < box[2] - GRAZE or y > box[3] + GRAZE:
        return False
    radius = floor.grid[0].radius
    margin = radius + clearance
    count = discs_near(floor, me, x, y, x, y, radius + margin)
    for k in range(count):
        disc = floor.discs[floor.near[k]]
        if math.hypot(disc.x - x, disc.y - y) < disc.core + margin - GRAZE:
            return False
    count = edges_near(floor, x, y, x, y, margin, 0)
    for k in range(count):
        edge = floor.edges[floor.near[k]]
        if to_segment(x, y, edge.ax, edge.ay, edge.bx, edge.by) < edge.core + margin - GRAZE:
            return False
    return len(floor.edges) == 0 or not _inside(floor, x, y)


@kernel
def _segment(segments, k, ax, ay, bx, by):
    segments[k, 0], segments[k, 1], segments[k, 2], segments[k, 3] = ax, ay, bx, by


@kernel
def _point(found, k, x, y):
    """Write a point down; returns how many there are now."""
    found[k, 0], found[k, 1] = x, y
    return k + 1


@kernel
def _borders(floor, me, x, y, reach, clearance, box):
    """Borders around (x, y): circles (k, 3) x, y, radius [m] and segments (m, 4) [m]."""
    radius = floor.grid[0].radius
    margin = radius + clearance
    count = discs_near(floor, me, x, y, x, y, reach + radius + margin)
    circles = np.empty((count, 3))
    for k in range(count):
        disc = floor.discs[floor.near[k]]
        circles[k, 0], circles[k, 1] = disc.x, disc.y
        circles[k, 2] = disc.core + margin + OFF
    count = edges_near(floor, x, y, x, y, reach + margin, 0)
    segments = np.empty((2 * count + 4, 4))
    for k in range(count):
        edge = floor.edges[floor.near[k]]
        dx, dy = edge.bx - edge.ax, edge.by - edge.ay
        off = (edge.core + margin + OFF) / math.hypot(dx, dy)
        nx, ny = -off * dy, off * dx
        _segment(segments, 2 * k, edge.ax + nx, edge.ay + ny, edge.bx + nx, edge.by + ny)
        _segment(segments, 2 * k + 1, edge.ax - nx, edge.ay - ny, edge.bx - nx, edge.by - ny)
    count *= 2
    _segment(segments, count, box[0], box[2], box[1], box[2])
    _segment(segments, count + 1, box[0], box[3], box[1], box[3])
    _segment(segments, count + 2, box[0], box[2], box[0], box[3])
    _segment(segments, count + 3, box[1], box[2], box[1], box[3])
    return circles, segments


@kernel
def _across_circles(circles, k, x, y, sx, sy, found):
    """Add to ``found`` where circle ``k`` is nearest to (x, y), and where it meets those before
    it; returns how many. If (x, y) is its centre, nearest is towards (sx, sy).
    """
    cx, cy, radius = circles[k, 0], circles[k, 1], circles[k, 2]
    dx, dy = x - cx, y - cy
    if math.hypot(dx, dy) < OFF:
        dx, dy = sx - cx, sy - cy
    away = math.hypot(dx, dy)
    count = 0
    if away > OFF:
        count = _point(found, 0, cx + dx / away * radius, cy + dy / away * radius)
    for other in range(k):
        dx, dy = circles[other, 0] - cx, circles[other, 1] - cy
        apart, second = math.hypot(dx, dy), circles[other, 2]
        if apart < OFF or apart > radius + second or apart < abs(radius - second):
            continue
        along = (apart * apart + radius * radius - second * second) / (2.0 * apart)
        half = math.sqrt(max(0.0, radius * radius - along * along))
        for side in (-1.0, 1.0):
            count = _point(
                found,
                count,
                cx + (along * dx - side * half * dy) / apart,
                cy + (along * dy + side * half * dx) / apart,
            )
    return count


@kernel
def _across_segments(circles, segments, k, x, y, found):
    """Add to ``found`` where segment ``k`` is nearest to (x, y), and where it meets circles and
    the segments before it; returns how many.
    """
    ax, ay, bx, by = segments[k, 0], segments[k, 1], segments[k, 2], segments[k, 3]
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    if square == 0.0:
        return _point(found, 0, ax, ay)
    share = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
    count = _point(found, 0, ax + share * dx, ay + share * dy)
    for c in range(len(circles)):
        cx, cy, radius = circles[c, 0], circles[c, 1], circles[c, 2]
        middle = ((cx - ax) * dx + (cy - ay) * dy) / square
        off = math.hypot(ax + middle * dx - cx, ay + middle * dy - cy)
        if off < radius:
            half = math.sqrt((radius * radius - off * off) / square)
            for share in (middle - half, middle + half):
                if 0.0 <= share <= 1.0:
                    count = _point(found, count, ax + share * dx, ay + share * dy)
    for other in range(k):
        ex, ey = segments[other, 2] - segments[other, 0], segments[other, 3] - segments[other, 1]
        cross = dx * ey - dy * ex
        if cross != 0.0:
            fx, fy = segments[other, 0] - ax, segments[other, 1] - ay
            share, there = (fx * ey - fy * ex) / cross, (fx * dy - fy * dx) / cross
            if 0.0 <= share <= 1.0 and 0.0 <= there <= 1.0:
                count = _point(found, count, ax + share * dx, ay + share * dy)
    return count


@kernel
def free_point(floor, me, sx, sy, x, y, clearance, box):
    """The free point nearest to (x, y) [m] for a robot from (sx, sy): (exists, x, y).

    ``box``: (4,) the least and the greatest x and y that the robot's centre may have [m].
    """
    cx, cy = min(max(x, box[0]), box[1]), min(max(y, box[2]), box[3])
    if is_free(floor, me, cx, cy, clearance, box):
        return True, cx, cy
    grid = floor.grid[0]
    everything = grid.width + grid.height + math.hypot(x - cx, y - cy)
    reach = 4.0 * (2.0 * grid.radius + clearance) + math.hypot(x - cx, y - cy)
    while True:
        circles, segments = _borders(floor, me, x, y, reach, clearance, box)
        found = np.empty((2 * (len(circles) + len(segments)) + 2, 2))
        best, bx, by = math.inf, x, y
        for k in range(len(circles) + len(segments)):
            if k < len(circles):
                count = _across_circles(circles, k, x, y, sx, sy, found)
            else:
                count = _across_segments(circles, segments, k - len(circles), x, y, found)
            for c in range(count):
                away = math.hypot(found[c, 0] - x, found[c, 1] - y)
                if away < best and is_free(floor, me, found[c, 0], found[c, 1], clearance, box):
                    best, bx, by = away, found[c, 0], found[c, 1]
        if best <= reach:
            return True, bx, by
        if reach > everything:
            return best < math.inf, bx, by
        reach *= 2.0
