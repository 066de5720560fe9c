"""The graphs by their definitions, computed whole: for a start, for checks, for small fleets.

All graphs are reductions of the unit disc graph (UDG), in which two robots are linked if
they are within radio range r of each other:

- ``udg``: all of them;
- ``gabriel`` (GG): links whose diametral disc holds no third robot (Gabriel and Sokal 1969);
- ``rng``: links whose lune holds no third robot (Toussaint 1980);
- ``emst``: a Euclidean minimum spanning tree (of each component).

EMST ⊆ RNG ⊆ GG ⊆ UDG. GG is planar and keeps what is connected connected, also for squares,
lattices and robots in the same place: the diametral disc is closed, an angle counts as right
within 1e-9 rad, and of robots in one place the lowest id keeps the links.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

GraphName = Literal["gabriel", "udg", "rng", "emst"]
Edges: TypeAlias = NDArray[np.intp]  # (m, 2), u < v

DENSE_UP_TO = 1000  # robots for which all distances at once are quicker than a tree
RIGHT_ANGLE = 1e-9  # [rad] how near to a right angle counts as one,
BESIDE = 1e-16  # but not for robots so much nearer to one end (squared): both would yield


def edges(positions: NDArray[np.float64], radio_range: float, graph: GraphName) -> Edges:
    """The edges (u < v) of a graph over ``positions`` (n, 2) [m]; NaN rows have none."""
    pairs = unit_disc(positions, radio_range)
    if graph == "gabriel":
        return gabriel(positions, pairs)
    if graph == "rng":
        return relative_neighbourhood(positions, pairs)
    if graph == "emst":
        return spanning_tree(positions, pairs)
    return pairs


def unit_disc(positions: NDArray[np.float64], radio_range: float) -> NDArray[np.intp]:
    """Pairs (u < v) within range of each other. ``positions`` (n, 2) [m]; returns (m, 2)."""
    if len(positions) > DENSE_UP_TO:
        from scipy.spatial import cKDTree

        pairs = cKDTree(positions).query_pairs(radio_range, output_type="ndarray")
        return np.asarray(pairs, dtype=np.intp)
    x, y = positions[:, 0], positions[:, 1]
    squared = (x[:, None] - x[None, :]) ** 2 + (y[:, None] - y[None, :]) ** 2
    return np.argwhere(np.triu(squared <= radio_range * radio_range, 1))


def connected(count: int, pairs: NDArray[np.intp]) -> bool:
    """Whether the ``pairs`` (m, 2) join ``count`` robots into one network."""
    return not components(count, pairs).any()


def component_count(count: int, pairs: NDArray[np.intp]) -> int:
    """How many networks ``count`` robots fall into."""
    return int(np.count_nonzero(components(count, pairs) == np.arange(count)))


def components(count: int, pairs: NDArray[np.intp]) -> NDArray[np.intp]:
    """For each of ``count`` robots the lowest of the component that the ``pairs`` (m, 2) put it in.

    Everybody adopts the lowest label next door, then the label of that label, until all agree:
    label propagation with pointer jumping, in a few rounds. A graph library takes longer to load.
    """
    u, v = pairs[:, 0], pairs[:, 1]
    label = np.arange(count)
    while True:
        lowest = np.minimum(label[u], label[v])
        after = label.copy()
        np.minimum.at(after, u, lowest)
        np.minimum.at(after, v, lowest)
        after = after[after]
        if np.array_equal(after, label):
            return label
        label = after


def gabriel(positions: NDArray[np.float64], pairs: NDArray[np.intp]) -> NDArray[np.intp]:
    """The ``pairs`` whose closed diametral disc holds no third robot."""
    return pairs[~_blocked(positions, pairs, lune=False)]


def relative_neighbourhood(
    positions: NDArray[np.float64], pairs: NDArray[np.intp]
) -> NDArray[np.intp]:
    """The ``pairs`` whose open lune holds no third robot."""
    return pairs[~_blocked(positions, pairs, lune=True)]


def spanning_tree(positions: NDArray[np.float64], pairs: NDArray[np.intp]) -> NDArray[np.intp]:
    """A minimum spanning tree of each component of the ``pairs``; of equals the lower ids."""
    length = ((positions[pairs[:, 0]] - positions[pairs[:, 1]]) ** 2).sum(axis=1)
    root = list(range(len(positions)))

    def find(robot: int) -> int:
        while root[robot] != robot:
            root[robot] = root[root[robot]]
            robot = root[robot]
        return robot

    chosen = []
    for k in np.lexsort((pairs[:, 1], pairs[:, 0], length)).tolist():
        a, b = find(int(pairs[k, 0])), find(int(pairs[k, 1]))
        if a != b:
            root[a] = b
            chosen.append(k)
    return pairs[np.sort(np.array(chosen, dtype=np.intp))]


def _blocked(
    positions: NDArray[np.float64], pairs: NDArray[np.intp], *, lune: bool
) -> NDArray[np.bool_]:
    """Which of the pairs (u, v) are kept apart by a third robot w: the rule of ``relink``."""
    blocked = _clearly_blocked(positions, pairs)
    u, v = pairs[~blocked, 0, None], pairs[~blocked, 1, None]
    w = np.arange(len(positions))[None, :]
    ux, uy = (positions[u, axis] - positions[w, axis] for axis in (0, 1))
    vx, vy = (positions[v, axis] - positions[w, axis] for axis in (0, 1))
    apart = between(u, v, w, (ux, uy), (vx, vy))
    if lune:
        uv = ((positions[u] - positions[v]) ** 2).sum(axis=2)
        apart |= (ux * ux + uy * uy < uv) & (vx * vx + vy * vy < uv)
    blocked[~blocked] = apart.any(axis=1)
    return blocked


def between(
    u: NDArray[np.intp] | int,
    v: NDArray[np.intp] | int,
    w: NDArray[np.intp] | int,
    to_u: Sequence[NDArray[np.float64]],
    to_v: Sequence[NDArray[np.float64]],
) -> NDArray[np.bool_]:
    """Whether w keeps u and v apart in the Gabriel graph: it is in the closed disc over them.

    ``to_u``, ``to_v``: x and y from w to u and to v [m]. All are broadcast. Of robots in one
    place, the one with the lowest id stands for all.
    """
    (ux, uy), (vx, vy) = to_u, to_v
    uw, vw = ux * ux + uy * uy, vx * vx + vy * vy
    dot = ux * vx + uy * vy
    near_right = dot * dot <= RIGHT_ANGLE * RIGHT_ANGLE * uw * vw
    inside = (dot <= 0.0) | (near_right & (uw > BESIDE * vw) & (vw > BESIDE * uw))
    at_u, at_v = uw == 0.0, vw == 0.0
    if (at_u | at_v).any():
        first = np.where(at_u & at_v, np.minimum(u, v), np.where(at_u, u, v))
        inside = np.where(at_u | at_v, w < first, inside)
    return np.asarray(inside & (w != u) & (w != v))


def _clearly_blocked(positions: NDArray[np.float64], pairs: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Pairs with somebody well inside the diametral disc: most of them, found cheaply."""
    x, y = positions[:, 0], positions[:, 1]
    squared = (x[:, None] - x[None, :]) ** 2 + (y[:, None] - y[None, :]) ** 2
    u, v = pairs[:, 0], pairs[:, 1]
    nearest = np.full(len(pairs), np.inf)
    for start in range(0, len(pairs), 4096):
        part = slice(start, start + 4096)
        nearest[part] = np.fmin.reduce(squared[u[part]] + squared[v[part]], axis=1)
    return nearest < (1.0 - 1e-9) * squared[u, v]
