"""The shortest path on a floor with a roadmap: A* over its lines, around robots added as they hit.

Start, goal and the robots that are in the way are circles beside the roadmap's corners; lines to
and from them, and all arcs, are looked at closely only when they come up for the shortest path.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion.kernels.geometry import TWO_PI, arc_to_segment, to_arc, to_segment, turned
from fleet.motion.kernels.goal import free_point
from fleet.motion.kernels.grid import discs_near, edges_near
from fleet.motion.kernels.plan import NO_PATH, TOUCH, disc_hit, squeeze, unsqueeze
from fleet.motion.kernels.records import (
    CIRCLE,
    NOBODY,
    FloatArray,
    Floor,
    IntArray,
    Records,
    record_type,
)
from fleet.motion.kernels.roadmap import (
    Roadmap,
    is_open,
    is_sure,
    line_is_clear,
    open_sweep,
)
from fleet.motion.kernels.search import (
    GOAL,
    NODE,
    SHORT,
    START,
    lay,
    lay_line,
    pop,
    push,
    sweep_between,
)
from fleet.motion.kernels.tangents import GRAZE, tangent
from protocols.compiled import kernel

NO_LINE = -1
FIRST = -2  # lines from the start are numbered on from here, downwards
MOST_ROUNDS = 40  # of adding robots that are in the way
BESIDE = 2.0  # robots' radii: who stands so near to a path that hits somebody is added too
LOCAL = 3.0  # [m] around robots in the way to corners that paths may go on to; those of paths
#              found before count however far they are
TRIED = 24  # corners near the goal that are looked at from there
UNKNOWN, CLEAR, BLOCKED = 0, 1, 2  # what is known of a line

ARRIVAL = record_type(
    [
        ("node", "i8"),  # where the line arrives: corners as in the roadmap, then circles
        ("line", "i8"),  # of the roadmap, or NO_LINE
        ("arrival", "f8"),  # angle on that circle [rad]
        ("x", "f8"),  # the same as a point [m]
        ("y", "f8"),
        ("parent", "i8"),  # the arrival that the line comes from
        ("departure", "f8"),  # angle on the parent's circle [rad]
        ("sweep", "f8"),  # along the parent's circle up to there [rad]
        ("cost", "f8"),  # length from the start [m]
        ("reach", "f8"),  # how far it can go on along the circle [rad], once settled
        ("before", "i8"),  # the arrival that was settled before at this node
    ]
)


class _Sight(NamedTuple):
    """What has been seen from start and goal: the same in all rounds of a plan."""

    nodes: IntArray  # (k,) that tangents from the start lead to
    numbers: FloatArray  # (k, 5) where they leave and arrive [rad], arrive x, y and length [m]
    seen: NDArray[np.int8]  # (k,) whether they are free of obstacles
    goal: NDArray[np.int8]  # (nodes,) whether those from a node to the goal are
    kept: NDArray[np.bool_]  # (corners,) those of paths found in earlier rounds
    ahead: FloatArray  # (corners,) lower bounds of the way from there to the goal [m]


@kernel
def _circle(roadmap, circles, margin, node):
    """The circle of a node: (x, y, radius, side) [m]."""
    at, side = node // 2, 2 * (node % 2) - 1
    if at < len(roadmap.places):
        return roadmap.places[at, 0], roadmap.places[at, 1], margin, side
    circle = circles[at - len(roadmap.places)]
    return circle.x, circle.y, circle.radius, side


@kernel
def _arc_is_clear(floor, roadmap, circles, count, node, first, sweep, margin, box):
    """Whether a body that follows the circle of ``node``, counter-clockwise from ``first`` by
    ``sweep`` [rad], keeps off everything and stays in the box.
    """
    x, y, radius, _ = _circle(roadmap, circles, margin, node)
    if radius * sweep <= SHORT:
        return True
    for quarter in range(4):
        angle = 0.5 * math.pi * quarter
        if turned(angle - first) <= sweep:
            px, py = x + radius * math.cos(angle), y + radius * math.sin(angle)
            if px < box[0] - GRAZE or px > box[1] + GRAZE or py < box[2] - GRAZE:
                return False
            if py > box[3] + GRAZE:
                return False
    for k in range(2, count):
        circle = circles[k]
        if k != node // 2 - len(roadmap.places):
            away = to_arc(circle.x, circle.y, x, y, radius, first, sweep)
            if away < circle.radius - GRAZE:
                return False
    if node < 2 * len(roadmap.places) and is_sure(roadmap, node // 2, first, sweep):
        return True
    for k in range(edges_near(floor, x, y, x, y, radius + margin, 0)):
        edge = floor.edges[floor.near[k]]
        away = arc_to_segment(x, y, radius, first, sweep, edge.ax, edge.ay, edge.bx, edge.by)
        if away < edge.core + margin - GRAZE:
            return False
    return True


@kernel
def _sees(floor, roadmap, sight, node, arrival, ax, ay, margin, to_goal):
    """Whether the line from a [m], of ``node``, to an arrival is free of obstacles."""
    if arrival.line >= 0:
        return True
    begin = 0.0
    if arrival.line <= FIRST:
        seen = sight.seen[FIRST - arrival.line]
        begin = 2.0 * margin
    else:
        seen = sight.goal[node] if to_goal else UNKNOWN
    if seen == UNKNOWN:
        clear = line_is_clear(floor, roadmap, ax, ay, arrival.x, arrival.y, margin, begin)
        seen = CLEAR if clear else BLOCKED
        if arrival.line <= FIRST:
            sight.seen[FIRST - arrival.line] = seen
        elif to_goal:
            sight.goal[node] = seen
    return seen == CLEAR


@kernel
def _step_is_clear(floor, roadmap, sight, circles, count, arrivals, arrival, margin, box):
    """Whether the arc and the line that lead from the parent to this arrival are free."""
    parent = arrivals[arrival.parent]
    x, y, radius, side = _circle(roadmap, circles, margin, parent.node)
    ax, ay = x + radius * math.cos(arrival.departure), y + radius * math.sin(arrival.departure)
    offset = len(roadmap.places)
    one, two = parent.node // 2 - offset, arrival.node // 2 - offset
    for k in range(2, count):
        circle = circles[k]
        if k != one and k != two:
            away = to_segment(circle.x, circle.y, ax, ay, arrival.x, arrival.y)
            if away < circle.radius - GRAZE:
                return False
    if not _sees(
        floor, roadmap, sight, parent.node, arrival, ax, ay, margin, two == GOAL and one < 0
    ):
        return False
    first = parent.arrival if side > 0 else parent.arrival - arrival.sweep
    return _arc_is_clear(
        floor, roadmap, circles, count, parent.node, first, arrival.sweep, margin, box
    )


@kernel
def _is_beaten(floor, roadmap, circles, count, arrivals, arrival, settled, margin, box):
    """Whether an arrival settled before gets to where this one is, along the circle, as well."""
    _, _, radius, side = _circle(roadmap, circles, margin, arrival.node)
    k = settled
    while k != NOBODY:
        rival = arrivals[k]
        sweep = sweep_between(side, rival.arrival, arrival.arrival)
        if sweep <= rival.reach and rival.cost + radius * sweep <= arrival.cost + SHORT:
            first = rival.arrival if side > 0 else rival.arrival - sweep
            if _arc_is_clear(
                floor, roadmap, circles, count, arrival.node, first, sweep, margin, box
            ):
                return True
        k = rival.before
    return False


@kernel
def _longer(arrivals, keys, items, room):
    """The same with ``room``."""
    more, more_keys, more_items = np.empty(room, ARRIVAL), np.empty(room), np.empty(room, np.int64)
    more_keys[: len(keys)] = keys
    more_items[: len(items)] = items
    for k in range(len(arrivals)):
        more[k] = arrivals[k]
    return more, more_keys, more_items


@kernel
def _write(new, node, line, parent, departure, sweep, arrival, x, y, cost):
    new.node, new.line, new.parent, new.departure, new.sweep = node, line, parent, departure, sweep
    new.arrival, new.x, new.y, new.cost, new.before = arrival, x, y, cost, NOBODY


@kernel
def _follow_lines(
    floor, roadmap, sight, circles, margin, arrivals, at, shut, keys, items, made, waiting
):
    """Put the roadmap's lines that leave where ``at`` is on the heap: (made, waiting)."""
    here, goal = arrivals[at], circles[GOAL]
    side = 2 * (here.node % 2) - 1
    for line in range(roadmap.begins[here.node], roadmap.begins[here.node + 1]):
        if shut[line]:
            continue
        sweep = sweep_between(side, here.arrival, roadmap.angles[line, 0])
        end = roadmap.ends[line]
        if sweep > here.reach or floor.discs[roadmap.corners[end // 2]].core != 0.0:
            continue
        x, y = roadmap.points[line, 0], roadmap.points[line, 1]
        cost = here.cost + margin * sweep + roadmap.lengths[line]
        _write(
            arrivals[made], end, line, at, roadmap.angles[line, 0], sweep,
            roadmap.angles[line, 1], x, y, cost,
        )  # fmt: skip
        rest = max(math.hypot(goal.x - x, goal.y - y), sight.ahead[end // 2])
        push(keys, items, waiting, cost + rest, made)
        made += 1
        waiting += 1
    return made, waiting


@kernel
def _beside(floor, roadmap, place, margin):
    """A corner near a place that can be seen from there, and how far it is: (NOBODY, 0) if none
    of the nearest can.
    """
    last = -1.0
    for _ in range(TRIED):
        nearest, corner = math.inf, NOBODY
        for k in range(len(roadmap.places)):
            away = math.hypot(roadmap.places[k, 0] - place.x, roadmap.places[k, 1] - place.y)
            if last < away < nearest:
                nearest, corner = away, k
        if corner == NOBODY:
            break
        last = nearest
        x, y = roadmap.places[corner, 0], roadmap.places[corner, 1]
        for side in (-1, 1):
            exists, _, angle = tangent(place.x, place.y, 0.0, side, x, y, margin, side)
            if exists and is_open(roadmap, corner, angle):
                px, py = x + margin * math.cos(angle), y + margin * math.sin(angle)
                if line_is_clear(floor, roadmap, place.x, place.y, px, py, margin, 0.0):
                    return corner, math.hypot(px - place.x, py - place.y)
    return NOBODY, 0.0


@kernel
def _bounds(roadmap, beside, away):
    """Lower bounds (corners,) of the way from each corner to the goal [m], by the landmarks."""
    found = np.zeros(len(roadmap.places))
    if beside == NOBODY:
        return found
    for corner in range(len(found)):
        for k in range(roadmap.landmarks.shape[1]):
            one, two = roadmap.landmarks[corner, k], roadmap.landmarks[beside, k]
            if one < math.inf and two < math.inf:
                found[corner] = max(found[corner], abs(one - two) - away)
    return found


@kernel
def _look_around(floor, roadmap, circles, margin, box, beside, away):
    """The tangents from the start to corners where a body may have room: a :class:`_Sight`."""
    start, corners = circles[START], len(roadmap.places)
    nodes, numbers = np.empty(2 * corners, np.int64), np.empty((2 * corners, 5))
    count = 0
    for corner in range(corners):
        if floor.discs[roadmap.corners[corner]].core != 0.0:
            continue
        x, y = roadmap.places[corner, 0], roadmap.places[corner, 1]
        away = math.hypot(x - start.x, y - start.y)
        if away < margin:
            continue
        ahead, half = math.atan2(y - start.y, x - start.x), math.asin(margin / away)
        for side in (-1, 1):
            leaves = ahead - side * half
            arrives = leaves - side * 0.5 * math.pi
            if not is_open(roadmap, corner, arrives):
                continue
            px, py = x + margin * math.cos(arrives), y + margin * math.sin(arrives)
            if px < box[0] - GRAZE or px > box[1] + GRAZE:
                continue
            if py < box[2] - GRAZE or py > box[3] + GRAZE:
                continue
            nodes[count] = 2 * corner + (side + 1) // 2
            numbers[count, 0], numbers[count, 1] = leaves, arrives
            numbers[count, 2], numbers[count, 3] = px, py
            numbers[count, 4] = math.hypot(px - start.x, py - start.y)
            count += 1
    return _Sight(
        nodes[:count], numbers[:count], np.zeros(count, np.int8),
        np.zeros(2 * corners, np.int8), np.zeros(corners, np.bool_),
        _bounds(roadmap, beside, away),
    )  # fmt: skip


@kernel
def _set_out(sight, circles, arrivals, keys, items, made, waiting):
    """Put the tangents from the start to corners on the heap: (made, waiting)."""
    goal = circles[GOAL]
    for k in range(len(sight.nodes)):
        if sight.seen[k] != BLOCKED:
            x, y, cost = sight.numbers[k, 2], sight.numbers[k, 3], sight.numbers[k, 4]
            _write(
                arrivals[made], sight.nodes[k], FIRST - k, 0, sight.numbers[k, 0], 0.0,
                sight.numbers[k, 1], x, y, cost,
            )  # fmt: skip
            rest = max(math.hypot(goal.x - x, goal.y - y), sight.ahead[sight.nodes[k] // 2])
            push(keys, items, waiting, cost + rest, made)
            made += 1
            waiting += 1
    return made, waiting


@kernel
def _is_local(roadmap, sight, circles, corner, other):
    """Whether paths between a corner and a robot in the way are looked at."""
    if other < 2 or sight.kept[corner]:
        return True
    dx = roadmap.places[corner, 0] - circles[other].x
    dy = roadmap.places[corner, 1] - circles[other].y
    return dx * dx + dy * dy < LOCAL * LOCAL


@kernel
def _go_to(roadmap, sight, circles, margin, box, arrivals, at, target, keys, items, made, waiting):
    """Put the tangents from where ``at`` is to the circle of the node ``target``, an even number,
    on the heap, one for each side: (made, waiting).
    """
    here, goal, offset = arrivals[at], circles[GOAL], 2 * len(roadmap.places)
    x, y, radius, side = _circle(roadmap, circles, margin, here.node)
    for node in range(target, target + 2):
        x2, y2, radius2, side2 = _circle(roadmap, circles, margin, node)
        if node // 2 == offset // 2 + GOAL and side2 != side:
            continue
        leaving = side2 if here.node == offset + 2 * START + 1 else side
        exists, departure, arrival = tangent(x, y, radius, leaving, x2, y2, radius2, side2)
        if not exists or (node < offset and not is_open(roadmap, node // 2, arrival)):
            continue
        sweep = 0.0 if radius == 0.0 else sweep_between(leaving, here.arrival, departure)
        px, py = x2 + radius2 * math.cos(arrival), y2 + radius2 * math.sin(arrival)
        if sweep > here.reach or px < box[0] - GRAZE or px > box[1] + GRAZE:
            continue
        if py < box[2] - GRAZE or py > box[3] + GRAZE:
            continue
        fx, fy = x + radius * math.cos(departure), y + radius * math.sin(departure)
        cost = here.cost + radius * sweep + math.hypot(px - fx, py - fy)
        _write(arrivals[made], node, NO_LINE, at, departure, sweep, arrival, px, py, cost)
        rest = math.hypot(goal.x - px, goal.y - py)
        if node < offset:
            rest = max(rest, sight.ahead[node // 2])
        push(keys, items, waiting, cost + rest, made)
        made += 1
        waiting += 1
    return made, waiting


@kernel
def _search(floor, roadmap, sight, circles, count, margin, box):
    """The shortest path: (arrivals, that at the goal); NOBODY if there is none.

    ``circles``: (count,) CIRCLE: start, goal, and those to go around beside the roadmap's corners.
    """
    corners = len(roadmap.places)
    most = 2 * corners + 2 * count
    arrivals = np.empty(4 * most + 64, ARRIVAL)
    keys, items = np.empty(4 * most + 64), np.empty(4 * most + 64, np.int64)
    settled = np.full(most, NOBODY)  # the last arrival settled by node
    shut = np.zeros(len(roadmap.ends), np.bool_)  # lines that are settled
    _write(
        arrivals[0], 2 * (corners + START) + 1, NO_LINE, NOBODY, 0.0, 0.0, 0.0,
        circles[START].x, circles[START].y, 0.0,
    )  # fmt: skip
    arrivals[0].reach = TWO_PI
    keys[0], items[0] = 0.0, 0
    made, waiting = 1, 1
    while waiting > 0:
        at = pop(keys, items, waiting)
        waiting -= 1
        here = arrivals[at]
        node = here.node
        if at > 0:
            if here.line >= 0 and shut[here.line]:
                continue
            if not _step_is_clear(
                floor, roadmap, sight, circles, count, arrivals, here, margin, box
            ):
                continue
            if here.line >= 0:
                shut[here.line] = True
            if node // 2 == corners + GOAL:
                return arrivals, at
            if _is_beaten(
                floor, roadmap, circles, count, arrivals, here, settled[node], margin, box
            ):
                continue
            here.before = settled[node]
            settled[node] = at
            here.reach = TWO_PI
            if node < 2 * corners:
                here.reach = open_sweep(roadmap, node // 2, here.arrival, 2 * (node % 2) - 1)
        room = made + 2 * count + 4
        if node < 2 * corners:
            room += roadmap.begins[node + 1] - roadmap.begins[node]
        else:
            room += 2 * corners
        if room > len(arrivals):
            arrivals, keys, items = _longer(arrivals, keys, items, 2 * room)
        if node < 2 * corners:
            made, waiting = _follow_lines(
                floor, roadmap, sight, circles, margin, arrivals, at, shut,
                keys, items, made, waiting,
            )  # fmt: skip
        elif node // 2 == corners + START:
            made, waiting = _set_out(sight, circles, arrivals, keys, items, made, waiting)
        else:
            for corner in range(corners):
                if not _is_local(roadmap, sight, circles, corner, node // 2 - corners):
                    continue
                if floor.discs[roadmap.corners[corner]].core == 0.0:
                    made, waiting = _go_to(
                        roadmap, sight, circles, margin, box, arrivals, at, 2 * corner,
                        keys, items, made, waiting,
                    )  # fmt: skip
        for other in range(1, count):
            if other == node // 2 - corners:
                continue
            if node < 2 * corners and not _is_local(roadmap, sight, circles, node // 2, other):
                continue
            if other == GOAL and node < 2 * corners and sight.goal[node] == BLOCKED:
                continue
            made, waiting = _go_to(
                roadmap, sight, circles, margin, box, arrivals, at, 2 * (corners + other),
                keys, items, made, waiting,
            )  # fmt: skip
    return arrivals, NOBODY


@kernel
def _lay_down(roadmap, sight, circles, margin, arrivals, goal, segments, first):
    """Write the path to the arrival ``goal`` down; see :func:`fleet.motion.kernels.search.lay`."""
    steps, at = 1, goal
    while arrivals[at].parent != NOBODY:
        steps += 1
        at = arrivals[at].parent
        if arrivals[at].node < 2 * len(roadmap.places):
            sight.kept[arrivals[at].node // 2] = True
    rounds, nodes = np.empty(steps, CIRCLE), np.empty(steps, NODE)
    at = goal
    for k in range(steps - 1, -1, -1):
        step, node = arrivals[at], nodes[k]
        x, y, radius, side = _circle(roadmap, circles, margin, step.node)
        rounds[k].x, rounds[k].y, rounds[k].radius = x, y, radius
        node.circle, node.side, node.arrival, node.x, node.y = k, side, step.arrival, step.x, step.y
        node.parent, node.departure, node.sweep = k - 1, step.departure, step.sweep
        at = step.parent
    return lay(rounds, nodes, steps - 1, segments, first)


@kernel
def _add(floor, disc, margin, circles, count):
    """Put a disc of the floor among the circles to go around; returns them, and how many."""
    if count == len(circles):
        more = np.empty(2 * count, CIRCLE)
        for k in range(count):
            more[k] = circles[k]
        circles = more
    found = floor.discs[disc]
    circles[count].x, circles[count].y = found.x, found.y
    circles[count].radius = found.core + margin
    return circles, count + 1


@kernel
def _add_hit(floor, me, segments, first, last, margin, circles, count):
    """Add the robots that the path segments[first:last] runs into; (circles, how many)."""
    radius, robots = floor.grid[0].radius, len(floor.discs) - len(floor.edges)
    beside = BESIDE * radius
    for p in range(first, last):
        segment, before, hit = segments[p], count, False
        bx = segment.x + segment.length * segment.cos if segment.radius == 0.0 else segment.x
        by = segment.y + segment.length * segment.sin if segment.radius == 0.0 else segment.y
        reach = segment.radius + radius + margin + beside
        for k in range(discs_near(floor, me, segment.x, segment.y, bx, by, reach)):
            disc = floor.near[k]
            if disc >= robots or floor.marks[disc]:
                continue
            found = floor.discs[disc]
            if disc_hit(segment, found, found.core + margin + beside):
                hit = hit or disc_hit(segment, found, found.core + margin)
                floor.marks[disc] = True
                circles, count = _add(floor, disc, margin, circles, count)
                floor.near[len(floor.near) - count] = disc
        if not hit:  # nobody is in the way of this segment: those beside it may wait
            for k in range(before, count):
                floor.marks[floor.near[len(floor.near) - 1 - k]] = False
            count = before
    return circles, count


@kernel
def _shortest(floor, roadmap, me, sx, sy, gx, gy, margin, box, segments, first):
    """The path from s to g [m], written into ``segments`` from ``first`` on: its end there.

    NO_PATH if there is none; more than ``len(segments)`` if there is too little room.
    """
    if math.hypot(gx - sx, gy - sy) < TOUCH:
        return first
    circles = np.empty(32, CIRCLE)
    circles[START].x, circles[START].y, circles[START].radius = sx, sy, 0.0
    circles[GOAL].x, circles[GOAL].y, circles[GOAL].radius = gx, gy, 0.0
    count = 2
    for k in range(discs_near(floor, me, sx, sy, sx, sy, floor.grid[0].radius + margin)):
        disc = floor.near[k]
        if disc < len(floor.discs) - len(floor.edges) or floor.discs[disc].core != 0.0:
            floor.marks[disc] = True
            circles, count = _add(floor, disc, margin, circles, count)
    lay_line(segments[first], sx, sy, gx, gy)
    before, rounds = count, 0
    straight = line_is_clear(floor, roadmap, sx, sy, gx, gy, margin, 2.0 * margin)
    last = first + 1 if straight else NO_PATH
    beside, away = _beside(floor, roadmap, circles[GOAL], margin)
    if not straight and beside != NOBODY:
        here, _ = _beside(floor, roadmap, circles[START], margin)
        if here != NOBODY and roadmap.areas[here] != roadmap.areas[beside]:
            rounds = MOST_ROUNDS  # no line leads there
    sight = _look_around(floor, roadmap, circles, margin, box, beside, away)
    while rounds < MOST_ROUNDS:
        if last != NO_PATH:
            before = count
            circles, count = _add_hit(floor, me, segments, first, last, margin, circles, count)
            straight_hits = rounds == 0 and _hits(segments[first], circles, count)
            if count == before and not straight_hits:
                break
        arrivals, goal = _search(floor, roadmap, sight, circles, count, margin, box)
        last = NO_PATH
        if goal != NOBODY:
            last = _lay_down(roadmap, sight, circles, margin, arrivals, goal, segments, first)
        if last == NO_PATH or last > len(segments):
            break
        rounds += 1
    for k in range(discs_near(floor, me, sx, sy, sx, sy, floor.grid[0].radius + margin)):
        floor.marks[floor.near[k]] = False
    for disc in range(len(floor.discs) - len(floor.edges)):
        floor.marks[disc] = False
    return NO_PATH if rounds == MOST_ROUNDS else last


@kernel
def _hits(segment, circles, count):
    """Whether a path segment runs into one of the circles that were there from the start."""
    for k in range(2, count):  # noqa: SIM110  # numba has no any()
        if disc_hit(segment, circles[k], circles[k].radius):
            return True
    return False


@kernel
def plan_mapped(
    floor: Floor,
    roadmap: Roadmap,
    me: int,
    ends: FloatArray,
    clearance: float,
    segments: Records,
) -> tuple[int, float, float, float]:
    """As :func:`fleet.motion.kernels.plan.plan`, with one clearance and the roadmap made for it.

    ``ends``: (4,) x, y of the start and of the site [m].
    """
    grid = floor.grid[0]
    margin = grid.radius + clearance
    sx, sy = ends[0], ends[1]
    box, saved = np.empty(4), np.empty((256, 2))
    box[0], box[1] = min(margin, sx), max(grid.width - margin, sx)
    box[2], box[3] = min(margin, sy), max(grid.height - margin, sy)
    squeezed = squeeze(floor, me, sx, sy, clearance, saved)
    end = NO_PATH
    exists, gx, gy = free_point(floor, me, sx, sy, ends[2], ends[3], clearance, box)
    if exists:
        end = _shortest(floor, roadmap, me, sx, sy, gx, gy, margin, box, segments, 1)
    unsqueeze(floor, saved, squeezed)
    length = 0.0
    for k in range(1, min(end, len(segments))):
        length += segments[k].length
    return end, gx, gy, length
