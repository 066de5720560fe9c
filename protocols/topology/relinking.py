"""The compiled half of the live topology: one robot moves, its neighbourhood is linked anew.

All arrays are the caller's and are changed in place. Importing this module loads numba.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from protocols.compiled import kernel
from protocols.topology.graphs import BESIDE, RIGHT_ANGLE

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]

UDG, GABRIEL, RNG = 0, 1, 2


@kernel
def blocks(graph, w, u, v, wx, wy, ux, uy, vx, vy):
    """Whether a robot ``w`` at (wx, wy) [m] keeps ``u`` and ``v`` from being linked."""
    if graph == UDG:
        return False
    uw = (ux - wx) * (ux - wx) + (uy - wy) * (uy - wy)
    vw = (vx - wx) * (vx - wx) + (vy - wy) * (vy - wy)
    if uw == 0.0 and vw == 0.0:
        return w < min(u, v)
    if uw == 0.0:
        return w < u
    if vw == 0.0:
        return w < v
    dot = (ux - wx) * (vx - wx) + (uy - wy) * (vy - wy)
    near_right = dot * dot <= RIGHT_ANGLE * RIGHT_ANGLE * uw * vw
    if dot <= 0.0 or (near_right and uw > BESIDE * vw and vw > BESIDE * uw):
        return True  # in the diametral disc, and so in the lune
    if graph == GABRIEL:
        return False
    uv = (ux - vx) * (ux - vx) + (uy - vy) * (uy - vy)
    return uw < uv and vw < uv


@kernel
def _cell(value, origin, size, count):
    """The row or column of a coordinate [m]; what lies outside belongs to the border."""
    return min(max(int((value - origin) // size), 0), count - 1)


@kernel
def gather(x, y, reach, robot, px, py, head, after, grid, marked, near, count):
    """Append to ``near`` the robots within ``reach`` [m] of (x, y) that are not marked yet."""
    x0, y0, size = grid[0], grid[1], grid[2]
    columns, rows = int(grid[3]), int(grid[4])
    for row in range(_cell(y - reach, y0, size, rows), _cell(y + reach, y0, size, rows) + 1):
        for column in range(
            _cell(x - reach, x0, size, columns), _cell(x + reach, x0, size, columns) + 1
        ):
            w = head[row * columns + column]
            while w >= 0:
                dx, dy = px[w] - x, py[w] - y
                if w != robot and not marked[w] and dx * dx + dy * dy <= reach * reach:
                    marked[w] = True
                    near[count] = w
                    count += 1
                w = after[w]
    return count


@kernel
def move_cell(
    robot: int,
    x: float,
    y: float,
    px: FloatArray,
    py: FloatArray,
    head: IntArray,
    after: IntArray,
    grid: FloatArray,
) -> None:
    """Take the robot out of its cell, put it where it is now. NaN: in no cell."""
    x0, y0, size = grid[0], grid[1], grid[2]
    columns, rows = int(grid[3]), int(grid[4])
    if not math.isnan(px[robot]):
        cell = _cell(py[robot], y0, size, rows) * columns + _cell(px[robot], x0, size, columns)
        if head[cell] == robot:
            head[cell] = after[robot]
        else:
            w = head[cell]
            while after[w] != robot:
                w = after[w]
            after[w] = after[robot]
    if not math.isnan(x):
        cell = _cell(y, y0, size, rows) * columns + _cell(x, x0, size, columns)
        after[robot] = head[cell]
        head[cell] = robot
    px[robot], py[robot] = x, y


@kernel
def _position_of(robot, links, degree, other):
    for k in range(degree[robot]):
        if links[robot, k] == other:
            return k
    return -1


@kernel
def _unlink(u, v, links, degree):
    for a, b in ((u, v), (v, u)):
        k = _position_of(a, links, degree, b)
        degree[a] -= 1
        links[a, k] = links[a, degree[a]]


@kernel
def _link(u, v, links, degree):
    for a, b in ((u, v), (v, u)):
        links[a, degree[a]] = b
        degree[a] += 1


@kernel
def _free(graph, u, v, near, count, px, py):
    """Whether nobody in ``near`` keeps ``u`` and ``v`` apart."""
    for k in range(count):
        w = near[k]
        if w in (u, v):
            continue
        if blocks(graph, w, u, v, px[w], py[w], px[u], py[u], px[v], py[v]):
            return False
    return True


@kernel
def relink(
    robot: int,
    x: float,
    y: float,
    graph: int,
    radio_range: float,
    px: FloatArray,
    py: FloatArray,
    links: IntArray,
    degree: IntArray,
    head: IntArray,
    after: IntArray,
    grid: FloatArray,
    marked: NDArray[np.bool_],
    near: IntArray,
    changed: IntArray,
) -> int:
    """Move ``robot`` to (x, y) [m], or off the air with NaN, and bring the links up to date.

    ``px, py``: (n,) positions [m]; ``links`` (n, capacity) and ``degree`` (n,): adjacency;
    ``head`` (cells,), ``after`` (n,) and ``grid`` [x0, y0, size, columns, rows]: the robots of
    each cell as a linked list; ``marked`` (n,) all false, ``near`` (n,) and ``changed`` (n,):
    work space. Returns the number of robots in ``changed``: the moved one, its neighbours, and
    all whose links differ now; -1 if ``links`` has too little room, then nothing was changed.

    A link can only open or close between robots within reach of where the robot was or is:
    for the Gabriel graph the range, since whoever stands in a diametral disc is within its
    diameter of everything else in it; for the lune, twice that.
    """
    reach = 2.0 * radio_range if graph == RNG else radio_range
    old_x, old_y = px[robot], py[robot]
    was_there, is_there = not math.isnan(old_x), not math.isnan(x)
    count = 0
    if was_there:
        count = gather(old_x, old_y, reach, robot, px, py, head, after, grid, marked, near, count)
    if is_there:
        count = gather(x, y, reach, robot, px, py, head, after, grid, marked, near, count)
    for k in range(count):
        marked[near[k]] = False
    for k in range(count):
        if degree[near[k]] + count + 1 > links.shape[1]:
            return -1
    if count + 1 > links.shape[1]:
        return -1

    move_cell(robot, x, y, px, py, head, after, grid)
    for k in range(degree[robot]):
        marked[links[robot, k]] = True
    while degree[robot] > 0:
        _unlink(robot, links[robot, degree[robot] - 1], links, degree)
    limit = radio_range * radio_range
    for i in range(count):
        u = near[i]
        for j in range(i):
            v = near[j]
            dx, dy = px[u] - px[v], py[u] - py[v]
            if graph == UDG or dx * dx + dy * dy > limit:
                continue
            ux, uy, vx, vy = px[u], py[u], px[v], py[v]
            now = is_there and blocks(graph, robot, u, v, x, y, ux, uy, vx, vy)
            then = was_there and blocks(graph, robot, u, v, old_x, old_y, ux, uy, vx, vy)
            if not now and not then:
                continue
            linked = _position_of(u, links, degree, v) >= 0
            if now and linked:
                _unlink(u, v, links, degree)
                marked[u] = marked[v] = True
            elif not now and not linked and _free(graph, u, v, near, count, px, py):
                _link(u, v, links, degree)
                marked[u] = marked[v] = True
        dx, dy = px[u] - x, py[u] - y
        if is_there and dx * dx + dy * dy <= limit and _free(graph, robot, u, near, count, px, py):
            _link(robot, u, links, degree)
            marked[u] = True
    changes = 1
    changed[0] = robot
    for k in range(count):
        if marked[near[k]]:
            marked[near[k]] = False
            changed[changes] = near[k]
            changes += 1
    return changes


@kernel
def relink_all(
    start: int,
    robots: IntArray,
    places: FloatArray,
    graph: int,
    radio_range: float,
    px: FloatArray,
    py: FloatArray,
    links: IntArray,
    degree: IntArray,
    head: IntArray,
    after: IntArray,
    grid: FloatArray,
    marked: NDArray[np.bool_],
    near: IntArray,
    changed: IntArray,
    dirty: NDArray[np.bool_],
) -> int:
    """As :func:`relink`, for ``robots`` (k,) from index ``start`` on, to ``places`` (k, 2) [m].

    Sets ``dirty`` (n,) for all whose links, or whose neighbours' places, differ now. Returns
    the index of the robot for which ``links`` has too little room; k if there was none.
    """
    for k in range(start, len(robots)):
        changes = relink(
            robots[k], places[k, 0], places[k, 1], graph, radio_range, px, py, links, degree,
            head, after, grid, marked, near, changed,
        )  # fmt: skip
        if changes < 0:
            return k
        for j in range(changes):
            dirty[changed[j]] = True
    return len(robots)
