"""The shortest polyline through a mesh: Polyanya (Cui, Harabor and Grastien, IJCAI 2017).

A node is an interval of a side that is seen from a root, the last turning point, about to be
passed into the triangle behind it. Its bound is the shortest way from the root through the
interval to the goal as if nothing else stood in the way, so the first way that reaches the goal
is shortest.
"""

from __future__ import annotations

import math

import numpy as np

from fleet.motion.kernels.mesh import Mesh, open_up, turn
from fleet.motion.kernels.records import NOBODY, IntArray, record_type
from fleet.motion.kernels.search import pop, push
from protocols.compiled import kernel

FLAT = 1e-9  # [m²] turns below this are none
SLIGHT = 1e-10  # [m] intervals below this are none
SEEN = -2  # instead of a root: that of the node before
SAME = 1e-9  # [m] ways to a turning point that are not longer by more

INTERVAL = record_type(
    [
        ("lx", "f8"),  # left end, as seen from the root [m]
        ("ly", "f8"),
        ("rx", "f8"),  # right end
        ("ry", "f8"),
        ("left", "i8"),  # the point of the mesh that the left end is, or NOBODY
        ("right", "i8"),
        ("x", "f8"),  # root [m]
        ("y", "f8"),
        ("root", "i8"),  # the point that it is; NOBODY: the start
        ("cost", "f8"),  # from the start to the root [m]
        ("triangle", "i8"),  # to be entered; NOBODY: the goal is reached from the root
        ("side", "i8"),  # of it, through which
        ("parent", "i8"),
    ]
)


@kernel
def _bound(node, gx, gy):
    """A lower bound of the way from a node's root through its interval to the goal [m]."""
    lx, ly, rx, ry, x, y = node.lx, node.ly, node.rx, node.ry, node.x, node.y
    dx, dy = lx - rx, ly - ry
    square = dx * dx + dy * dy
    if square > 0.0:
        here = dx * (y - ry) - dy * (x - rx)
        there = dx * (gy - ry) - dy * (gx - rx)
        if here * there > 0.0:  # beyond the side, mirrored
            gx, gy = gx + 2.0 * there * dy / square, gy - 2.0 * there * dx / square
    if turn(x, y, lx, ly, gx, gy) > 0.0:
        return math.hypot(lx - x, ly - y) + math.hypot(gx - lx, gy - ly)
    if turn(x, y, rx, ry, gx, gy) < 0.0:
        return math.hypot(rx - x, ry - y) + math.hypot(gx - rx, gy - ry)
    return math.hypot(gx - x, gy - y)


@kernel
def _meet(x, y, px, py, ax, ay, bx, by):
    """Where the ray from (x, y) through p meets the segment from a to b, or nearly [m]."""
    one, two = turn(x, y, px, py, ax, ay), turn(x, y, px, py, bx, by)
    share = 0.5 if one == two else min(max(one / (one - two), 0.0), 1.0)
    return ax + share * (bx - ax), ay + share * (by - ay)


@kernel
def _add(mesh, passable, nodes, keys, items, size, best, parent, root, triangle, side, lx, ly, left,
         rx, ry, right, goal):  # fmt: skip
    """Put what lies behind ``side`` of ``triangle`` on the heap, seen through an interval.

    ``passable``: (t,) triangles; ``size``: (2,) nodes made and waiting; ``root``: a point, or
    SEEN: that of the parent; ``goal``: (triangle, x, y).
    """
    behind = mesh.beside[triangle, side]
    if behind == NOBODY or not passable[behind] or math.hypot(lx - rx, ly - ry) < SLIGHT:
        return
    made = size[0]
    node, before = nodes[made], nodes[parent]
    node.x, node.y, node.root, node.cost = before.x, before.y, before.root, before.cost
    if root != SEEN:
        node.x, node.y, node.root = mesh.points[root, 0], mesh.points[root, 1], root
        node.cost += math.hypot(node.x - before.x, node.y - before.y)
        if node.cost > best[root] + SAME:
            return
        best[root] = min(best[root], node.cost)
    node.lx, node.ly, node.left, node.rx, node.ry, node.right = lx, ly, left, rx, ry, right
    entry = mesh.entries[triangle, side]
    node.triangle, node.side, node.parent = behind, entry, parent
    push(keys, items, size[1], node.cost + _bound(node, goal[1], goal[2]), made)
    size[0] += 1
    size[1] += 1


@kernel
def _expand(mesh, passable, nodes, keys, items, size, best, at, goal):
    """Put the successors of node ``at`` on the heap."""
    node, points = nodes[at], mesh.points
    t, right, left = node.triangle, (node.side + 1) % 3, (node.side + 2) % 3
    a, b, v = mesh.triangles[t, node.side], mesh.triangles[t, right], mesh.triangles[t, left]
    ax, ay, bx, by = points[a, 0], points[a, 1], points[b, 0], points[b, 1]
    vx, vy, x, y = points[v, 0], points[v, 1], node.x, node.y
    lx, ly, rx, ry = node.lx, node.ly, node.rx, node.ry
    if node.root != NOBODY and (node.root == node.left or node.root == node.right):
        _add(
            mesh,
            passable,
            nodes,
            keys,
            items,
            size,
            best,
            at,
            SEEN,
            t,
            right,
            vx,
            vy,
            v,
            bx,
            by,
            b,
            goal,
        )
        _add(
            mesh,
            passable,
            nodes,
            keys,
            items,
            size,
            best,
            at,
            SEEN,
            t,
            left,
            ax,
            ay,
            a,
            vx,
            vy,
            v,
            goal,
        )
        return
    if turn(x, y, lx, ly, vx, vy) > FLAT:  # all that is seen is on the right
        px, py = _meet(x, y, lx, ly, bx, by, vx, vy)
        qx, qy, q = bx, by, b
        if node.right != b:
            qx, qy = _meet(x, y, rx, ry, bx, by, vx, vy)
            q = NOBODY
        _add(
            mesh,
            passable,
            nodes,
            keys,
            items,
            size,
            best,
            at,
            SEEN,
            t,
            right,
            px,
            py,
            NOBODY,
            qx,
            qy,
            q,
            goal,
        )
        if node.left != NOBODY and mesh.owners[node.left] != NOBODY:
            _add(
                mesh, passable, nodes, keys, items, size, best, at, node.left, t, right,
                vx, vy, v, px, py, NOBODY, goal,
            )  # fmt: skip
            _add(
                mesh, passable, nodes, keys, items, size, best, at, node.left, t, left,
                ax, ay, a, vx, vy, v, goal,
            )  # fmt: skip
    elif turn(x, y, rx, ry, vx, vy) < -FLAT:  # on the left
        qx, qy = _meet(x, y, rx, ry, vx, vy, ax, ay)
        px, py, p = ax, ay, a
        if node.left != a:
            px, py = _meet(x, y, lx, ly, vx, vy, ax, ay)
            p = NOBODY
        _add(
            mesh,
            passable,
            nodes,
            keys,
            items,
            size,
            best,
            at,
            SEEN,
            t,
            left,
            px,
            py,
            p,
            qx,
            qy,
            NOBODY,
            goal,
        )
        if node.right != NOBODY and mesh.owners[node.right] != NOBODY:
            _add(
                mesh, passable, nodes, keys, items, size, best, at, node.right, t, left,
                qx, qy, NOBODY, vx, vy, v, goal,
            )  # fmt: skip
            _add(
                mesh, passable, nodes, keys, items, size, best, at, node.right, t, right,
                vx, vy, v, bx, by, b, goal,
            )  # fmt: skip
    else:
        qx, qy, q = bx, by, b
        if node.right != b:
            qx, qy = _meet(x, y, rx, ry, bx, by, vx, vy)
            q = NOBODY
        _add(
            mesh,
            passable,
            nodes,
            keys,
            items,
            size,
            best,
            at,
            SEEN,
            t,
            right,
            vx,
            vy,
            v,
            qx,
            qy,
            q,
            goal,
        )
        px, py, p = ax, ay, a
        if node.left != a:
            px, py = _meet(x, y, lx, ly, vx, vy, ax, ay)
            p = NOBODY
        _add(
            mesh,
            passable,
            nodes,
            keys,
            items,
            size,
            best,
            at,
            SEEN,
            t,
            left,
            px,
            py,
            p,
            vx,
            vy,
            v,
            goal,
        )


@kernel
def _arrive(mesh, nodes, keys, items, size, at, goal):
    """Put the way from node ``at`` to the goal, which is in its triangle, on the heap."""
    before, node = nodes[at], nodes[size[0]]
    root, gx, gy = SEEN, goal[1], goal[2]
    if before.root == NOBODY or (before.root != before.left and before.root != before.right):
        if turn(before.x, before.y, before.lx, before.ly, gx, gy) > FLAT:
            root = before.left
        elif turn(before.x, before.y, before.rx, before.ry, gx, gy) < -FLAT:
            root = before.right
        if root == NOBODY:
            return
    node.x, node.y, node.root, node.cost = before.x, before.y, before.root, before.cost
    if root != SEEN:
        node.x, node.y, node.root = mesh.points[root, 0], mesh.points[root, 1], root
        node.cost += math.hypot(node.x - before.x, node.y - before.y)
    node.triangle, node.parent = NOBODY, at
    push(keys, items, size[1], node.cost + math.hypot(gx - node.x, gy - node.y), size[0])
    size[0] += 1
    size[1] += 1


@kernel
def _more(nodes, keys, items):
    """The same with twice the room."""
    room = 2 * len(nodes)
    more, more_keys, more_items = np.empty(room, INTERVAL), np.empty(room), np.empty(room, np.int64)
    more[: len(nodes)] = nodes
    more_keys[: len(nodes)] = keys
    more_items[: len(nodes)] = items
    return more, more_keys, more_items


@kernel
def turning_points(
    mesh: Mesh, start: tuple[int, float, float], goal: tuple[int, float, float]
) -> tuple[bool, IntArray]:
    """The points of the mesh at which the shortest polyline from start to goal turns, in order,
    and whether there is one at all.

    ``start``, ``goal``: the triangle, x and y [m].
    """
    if start[0] == goal[0]:
        return True, np.empty(0, np.int64)
    passable = open_up(mesh, start[0], goal[0])
    nodes, keys, items = np.empty(4096, INTERVAL), np.empty(4096), np.empty(4096, np.int64)
    best, size = np.full(len(mesh.points), math.inf), np.zeros(2, np.int64)
    nodes[0].x, nodes[0].y, nodes[0].root, nodes[0].cost = start[1], start[2], NOBODY, 0.0
    nodes[0].parent, size[0] = NOBODY, 1
    for side in range(3):
        one, two = mesh.triangles[start[0], side], mesh.triangles[start[0], (side + 1) % 3]
        # seen from inside a side's first corner is on the right
        _add(
            mesh, passable, nodes, keys, items, size, best, 0, SEEN, start[0], side,
            mesh.points[two, 0], mesh.points[two, 1], two,
            mesh.points[one, 0], mesh.points[one, 1], one, goal,
        )  # fmt: skip
    while size[1] > 0:
        at = pop(keys, items, size[1])
        size[1] -= 1
        node = nodes[at]
        if node.triangle == NOBODY:
            return True, _roots(nodes, at)
        if node.root != NOBODY and node.cost > best[node.root] + SAME:
            continue
        if size[0] + 8 > len(nodes):
            nodes, keys, items = _more(nodes, keys, items)
        if nodes[at].triangle == goal[0]:
            _arrive(mesh, nodes, keys, items, size, at, goal)
        _expand(mesh, passable, nodes, keys, items, size, best, at, goal)
    return False, np.empty(0, np.int64)


@kernel
def _roots(nodes, at):
    """The roots of a node and those before, but the start, in the order that they are passed."""
    count, k, last = 0, at, NOBODY
    while k != NOBODY:
        if nodes[k].root != last and nodes[k].root != NOBODY:
            count += 1
        last = nodes[k].root
        k = nodes[k].parent
    found = np.empty(count, np.int64)
    k, last = at, NOBODY
    while k != NOBODY:
        if nodes[k].root != last and nodes[k].root != NOBODY:
            count -= 1
            found[count] = nodes[k].root
        last = nodes[k].root
        k = nodes[k].parent
    return found
