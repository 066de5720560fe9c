"""The shortest way from point to point around circles: A* over tangents.

A node is the arrival, along a straight line, at a circle and on a side of it. Going on means
following that circle and leaving it on a tangent to another one, or to the goal. Lines are
looked at closely only when they come up for the shortest way, so most never are.
"""

from __future__ import annotations

import math

import numpy as np

from fleet.motion.kernels.geometry import TWO_PI, turned
from fleet.motion.kernels.records import ARC, LINE, NOBODY, record_type
from fleet.motion.kernels.tangents import GRAZE, arc_is_free, free_sweep, line_is_free, tangent
from protocols.compiled import kernel

START, GOAL = 0, 1  # circles of radius 0
SHORT = 1e-8  # [m] segments below this are left out

NODE = record_type(
    [
        ("circle", "i8"),  # where the line arrives
        ("side", "i8"),  # +1: on around it counter-clockwise
        ("arrival", "f8"),  # angle on that circle [rad]
        ("x", "f8"),  # the same as a point [m]
        ("y", "f8"),
        ("parent", "i8"),  # the node that the line comes from
        ("departure", "f8"),  # angle on the parent's circle [rad]
        ("sweep", "f8"),  # along the parent's circle up to there [rad]
        ("cost", "f8"),  # length from the start [m]
        ("reach", "f8"),  # how far it can go on along the circle [rad], once settled
        ("before", "i8"),  # the node that was settled before on this circle and side
    ]
)


@kernel
def push(keys, items, size, key, item):
    """Into the heap ``keys``, ``items`` of ``size``; there must be room."""
    at = size
    while at > 0 and keys[(at - 1) // 2] > key:
        keys[at], items[at] = keys[(at - 1) // 2], items[(at - 1) // 2]
        at = (at - 1) // 2
    keys[at], items[at] = key, item


@kernel
def pop(keys, items, size):
    """Take the smallest out of the heap; its item is returned."""
    top = items[0]
    key, item = keys[size - 1], items[size - 1]
    at = 0
    while True:
        child = 2 * at + 1
        if child >= size - 1:
            break
        if child + 1 < size - 1 and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[at], items[at] = keys[child], items[child]
        at = child
    keys[at], items[at] = key, item
    return top


@kernel
def sweep_between(side, first, last):
    """From angle to angle [rad] on ``side``; hardly anything back counts as nothing."""
    sweep = turned(side * (last - first))
    return 0.0 if sweep > TWO_PI - GRAZE else sweep


@kernel
def _line_of(circles, count, sides, side_count, nodes, node):
    """Whether the line that ``node`` arrives by is free."""
    parent = nodes[node.parent]
    circle = circles[parent.circle]
    return line_is_free(
        circle.x + circle.radius * math.cos(node.departure),
        circle.y + circle.radius * math.sin(node.departure),
        node.x, node.y, circles, count, parent.circle, node.circle, sides, side_count,
    )  # fmt: skip


@kernel
def _arc_of(circles, sides, side_count, nodes, node):
    """Whether the arc from the parent's arrival to the line that ``node`` arrives by is free."""
    parent = nodes[node.parent]
    circle = circles[parent.circle]
    first = parent.arrival if parent.side > 0 else parent.arrival - node.sweep
    return arc_is_free(circle.x, circle.y, circle.radius, first, node.sweep, sides, side_count)


@kernel
def _beaten(circles, sides, side_count, nodes, node, settled):
    """Whether a node settled before gets to where this one arrives, along the circle, as well."""
    k = settled
    circle = circles[node.circle]
    while k != NOBODY:
        rival = nodes[k]
        sweep = sweep_between(node.side, rival.arrival, node.arrival)
        if sweep <= rival.reach and rival.cost + circle.radius * sweep <= node.cost + SHORT:
            first = rival.arrival if node.side > 0 else rival.arrival - sweep
            if arc_is_free(circle.x, circle.y, circle.radius, first, sweep, sides, side_count):
                return True
        k = rival.before
    return False


@kernel
def _grown(nodes, keys, items, room):
    """The same with ``room``."""
    more, more_keys, more_items = np.empty(room, NODE), np.empty(room), np.empty(room, np.int64)
    more_keys[: len(keys)] = keys
    more_items[: len(items)] = items
    for k in range(len(nodes)):
        more[k] = nodes[k]
    return more, more_keys, more_items


@kernel
def shortest(circles, count, sides, side_count, box):
    """The shortest way: (nodes, the goal's node); NOBODY if there is none.

    ``circles``: (count,) CIRCLE, first start and goal, then what is in the way, inflated;
    ``sides``, ``box``: see :mod:`fleet.motion.kernels.tangents`.
    """
    room = 16 + 8 * count
    nodes = np.empty(room, NODE)
    keys, items = np.empty(room), np.empty(room, np.int64)
    settled = np.full((count, 2), NOBODY)  # the last node settled by circle and side
    shut = np.zeros((2 * count, 2 * count), np.bool_)  # tangents that are settled or not free
    start = nodes[0]
    start.circle, start.side, start.cost, start.parent = START, 1, 0.0, NOBODY
    start.x, start.y = circles[START].x, circles[START].y
    start.arrival, start.sweep, start.departure, start.reach = 0.0, 0.0, 0.0, 0.0
    keys[0], items[0] = 0.0, 0
    made, waiting = 1, 1
    while waiting > 0:
        at = pop(keys, items, waiting)
        waiting -= 1
        node = nodes[at]
        around, side = node.circle, node.side
        if at > 0:
            parent = nodes[node.parent]
            here = 2 * around + (1 if side > 0 else 0)
            there = 2 * parent.circle + (1 if parent.side > 0 else 0)
            if shut[there, here]:
                continue
            if not _line_of(circles, count, sides, side_count, nodes, node):
                shut[there, here] = True
                continue
            if not _arc_of(circles, sides, side_count, nodes, node):
                continue
            shut[there, here] = True
            if around == GOAL:
                return nodes, at
            before = settled[around, (side + 1) // 2]
            if _beaten(circles, sides, side_count, nodes, node, before):
                continue
            node.before = before
            settled[around, (side + 1) // 2] = at
            node.reach = free_sweep(circles, count, box, around, node.arrival, side)
        if made + 2 * count > len(nodes):
            nodes, keys, items = _grown(nodes, keys, items, 2 * len(nodes) + 2 * count)
        made, waiting = _spread(circles, count, box, nodes, at, shut, keys, items, made, waiting)
    return nodes, NOBODY


@kernel
def _spread(circles, count, box, nodes, at, shut, keys, items, made, waiting):
    """Put the tangents that leave the circle of node ``at`` on the heap: (made, waiting)."""
    node = nodes[at]
    circle = circles[node.circle]
    goal = circles[GOAL]
    for other in range(1, count):
        if other == node.circle:
            continue
        for arriving in (1, -1):
            leaving = node.side
            if other == GOAL:
                if arriving != leaving:
                    continue
            elif node.circle == START:
                leaving = arriving
            here = 2 * other + (1 if arriving > 0 else 0)
            if shut[2 * node.circle + (1 if node.side > 0 else 0), here]:
                continue
            end = circles[other]
            exists, departure, arrival = tangent(
                circle.x, circle.y, circle.radius, leaving, end.x, end.y, end.radius, arriving
            )
            if not exists:
                continue
            sweep = 0.0 if node.circle == START else sweep_between(leaving, node.arrival, departure)
            if sweep > node.reach + GRAZE:
                continue
            x = circles[other].x + circles[other].radius * math.cos(arrival)
            y = circles[other].y + circles[other].radius * math.sin(arrival)
            if x < box[0] - GRAZE or x > box[1] + GRAZE or y < box[2] - GRAZE or y > box[3] + GRAZE:
                continue
            fx = circle.x + circle.radius * math.cos(departure)
            fy = circle.y + circle.radius * math.sin(departure)
            new = nodes[made]
            new.circle, new.side, new.arrival, new.x, new.y = other, arriving, arrival, x, y
            new.parent, new.departure, new.sweep = at, departure, sweep
            new.cost = node.cost + circle.radius * sweep + math.hypot(x - fx, y - fy)
            new.before = NOBODY
            push(keys, items, waiting, new.cost + math.hypot(goal.x - x, goal.y - y), made)
            made += 1
            waiting += 1
    return made, waiting


@kernel
def lay(circles, nodes, goal, segments, first):
    """Write the way to node ``goal`` as lines and arcs into ``segments`` from ``first`` on.

    Returns the end of the path; more than ``len(segments)`` if there is too little room, then
    ``segments`` holds only some of it.
    """
    steps = 0
    at = goal
    while nodes[at].parent != NOBODY:
        steps += 1
        at = nodes[at].parent
    order = np.empty(steps, np.int64)
    at = goal
    for k in range(steps - 1, -1, -1):
        order[k] = at
        at = nodes[at].parent
    count = first
    for k in range(steps):
        node = nodes[order[k]]
        parent = nodes[node.parent]
        circle = circles[parent.circle]
        if circle.radius * node.sweep > SHORT:
            if count < len(segments):
                segment = segments[count]
                segment.kind, segment.x, segment.y, segment.radius = (
                    ARC,
                    circle.x,
                    circle.y,
                    circle.radius,
                )
                segment.angle, segment.sense = parent.arrival, float(parent.side)
                segment.length = circle.radius * node.sweep
            count += 1
        x = circle.x + circle.radius * math.cos(node.departure)
        y = circle.y + circle.radius * math.sin(node.departure)
        if math.hypot(node.x - x, node.y - y) > SHORT:
            if count < len(segments):
                lay_line(segments[count], x, y, node.x, node.y)
            count += 1
    return count


@kernel
def lay_line(segment, ax, ay, bx, by):
    """Make ``segment`` the straight line from a to b [m]."""
    dx, dy = bx - ax, by - ay
    segment.kind, segment.x, segment.y, segment.radius = LINE, ax, ay, 0.0
    segment.length = math.hypot(dx, dy)
    segment.angle = math.atan2(dy, dx)
    segment.cos, segment.sin = dx / segment.length, dy / segment.length
