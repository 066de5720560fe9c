"""The compiled half of the live topology: one robot moves, its neighbourhood is linked anew.

Importing this module loads numba.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from protocols.compiled import kernel
from protocols.topology import witness
from protocols.topology.cells import Cells, FloatArray, IntArray, gather, put

UDG, GABRIEL, RNG = 0, 1, 2

between = kernel(witness.between)


class Adjacency(NamedTuple):
    """Who is linked to whom. Changed in place, by :func:`relink` alone."""

    graph: int  # UDG, GABRIEL or RNG
    radio_range: float  # [m]
    table: IntArray  # (n, capacity) neighbours by robot
    degree: IntArray  # (n,) how many of a row count
    changed: IntArray  # (n + 1,) work space


@kernel
def blocks(graph, w, u, v, at_w, at_u, at_v):
    """Whether a robot ``w`` at ``at_w``, (x, y) [m], keeps ``u`` and ``v`` from being linked."""
    if graph == UDG:
        return False
    to_u = (at_u[0] - at_w[0], at_u[1] - at_w[1])
    to_v = (at_v[0] - at_w[0], at_v[1] - at_w[1])
    if between(u, v, w, to_u, to_v):
        return True  # in the diametral disc, and so in the lune
    if graph == GABRIEL:
        return False
    uw, vw = to_u[0] * to_u[0] + to_u[1] * to_u[1], to_v[0] * to_v[0] + to_v[1] * to_v[1]
    dx, dy = at_u[0] - at_v[0], at_u[1] - at_v[1]
    return uw < dx * dx + dy * dy and vw < dx * dx + dy * dy


@kernel
def _position_of(links, robot, other):
    for k in range(links.degree[robot]):
        if links.table[robot, k] == other:
            return k
    return -1


@kernel
def _unlink(links, u, v):
    for a, b in ((u, v), (v, u)):
        k = _position_of(links, a, b)
        links.degree[a] -= 1
        links.table[a, k] = links.table[a, links.degree[a]]


@kernel
def _link(links, u, v):
    for a, b in ((u, v), (v, u)):
        links.table[a, links.degree[a]] = b
        links.degree[a] += 1


@kernel
def _free(links, cells, u, v, count):
    """Whether none of the ``count`` first in ``cells.near`` keeps ``u`` and ``v`` apart."""
    x, y = cells.x, cells.y
    at_u, at_v = (x[u], y[u]), (x[v], y[v])
    for k in range(count):
        w = cells.near[k]
        if w not in (u, v) and blocks(links.graph, w, u, v, (x[w], y[w]), at_u, at_v):
            return False
    return True


@kernel
def relink(links: Adjacency, cells: Cells, robot: int, x: float, y: float) -> int:
    """Move ``robot`` to (x, y) [m], or off the air with NaN, and bring the links up to date.

    Returns the number of robots in ``links.changed``: the moved one, its neighbours, and all
    whose links differ now; -1 if the table has too little room, then nothing was changed.

    A link can only open or close between robots within reach of where the robot was or is:
    for the Gabriel graph the range, since whoever stands in a diametral disc is within its
    diameter of everything else in it; for the lune, twice that.
    """
    graph, near, marked, degree = links.graph, cells.near, cells.marked, links.degree
    reach = 2.0 * links.radio_range if graph == RNG else links.radio_range
    old_x, old_y = cells.x[robot], cells.y[robot]
    was_there, is_there = not math.isnan(old_x), not math.isnan(x)
    count = 0
    if was_there:
        count = gather(cells, old_x, old_y, reach, robot, count)
    if is_there:
        count = gather(cells, x, y, reach, robot, count)
    room = count + 1 <= links.table.shape[1]
    for k in range(count):
        marked[near[k]] = False
        room = room and degree[near[k]] + count + 1 <= links.table.shape[1]
    if not room:
        return -1

    put(cells, robot, x, y)
    for k in range(degree[robot]):
        marked[links.table[robot, k]] = True
    while degree[robot] > 0:
        _unlink(links, robot, links.table[robot, degree[robot] - 1])
    limit = links.radio_range * links.radio_range
    for i in range(count):
        u = near[i]
        at_u = (cells.x[u], cells.y[u])
        for j in range(i):
            v = near[j]
            at_v = (cells.x[v], cells.y[v])
            dx, dy = at_u[0] - at_v[0], at_u[1] - at_v[1]
            if graph == UDG or dx * dx + dy * dy > limit:
                continue
            now = is_there and blocks(graph, robot, u, v, (x, y), at_u, at_v)
            then = was_there and blocks(graph, robot, u, v, (old_x, old_y), at_u, at_v)
            if not now and not then:
                continue
            linked = _position_of(links, u, v) >= 0
            if now and linked:
                _unlink(links, u, v)
                marked[u] = marked[v] = True
            elif not now and not linked and _free(links, cells, u, v, count):
                _link(links, u, v)
                marked[u] = marked[v] = True
        dx, dy = at_u[0] - x, at_u[1] - y
        if is_there and dx * dx + dy * dy <= limit and _free(links, cells, robot, u, count):
            _link(links, robot, u)
            marked[u] = True
    changes = 1
    links.changed[0] = robot
    for k in range(count):
        if marked[near[k]]:
            marked[near[k]] = False
            links.changed[changes] = near[k]
            changes += 1
    return changes


@kernel
def relink_all(
    links: Adjacency,
    cells: Cells,
    start: int,
    robots: IntArray,
    places: FloatArray,
    dirty: NDArray[np.bool_],
) -> int:
    """As :func:`relink`, for ``robots`` (k,) from index ``start`` on, to ``places`` (k, 2) [m].

    Sets ``dirty`` (n,) for all whose links, or whose neighbours' places, differ now. Returns
    the index of the robot for which the table has too little room; k if there was none.
    """
    for k in range(start, len(robots)):
        changes = relink(links, cells, robots[k], places[k, 0], places[k, 1])
        if changes < 0:
            return k
        for j in range(changes):
            dirty[links.changed[j]] = True
    return len(robots)
