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

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from protocols.topology.witness import between

GraphName = Literal["gabriel", "udg", "rng", "emst"]
Edges: TypeAlias = NDArray[np.intp]  # (m, 2), u < v

DENSE_UP_TO = 1000  # robots for which all distances at once are quicker than a tree


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
    within = _squared(positions) <= radio_range * radio_range
    u, v = np.divmod(np.flatnonzero(within), max(len(positions), 1))
    return np.stack([u, v], axis=1)[u < v]


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
    """Which of the pairs (u, v), all that are within range, are kept apart by a third robot w.

    Whoever does is nearer to u than v is, or as near, and so is linked to u by a pair.
    """
    blocked = np.zeros(len(pairs), np.bool_)
    pair, w = _linked_to_first(pairs, len(positions))
    u, v = pairs[pair, 0], pairs[pair, 1]
    x, y = np.ascontiguousarray(positions.T)
    ux, uy, vx, vy = x[u] - x[w], y[u] - y[w], x[v] - x[w], y[v] - y[w]
    apart = between(u, v, w, (ux, uy), (vx, vy))
    if lune:
        dx, dy = x[u] - x[v], y[u] - y[v]
        uw, vw, uv = ux * ux + uy * uy, vx * vx + vy * vy, dx * dx + dy * dy
        apart |= np.maximum(uw, vw) < uv
    blocked[pair[apart]] = True
    return blocked


def _linked_to_first(
    pairs: NDArray[np.intp], count: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """All (pair, w) where the pairs link w, which is not v, to u of the pair (u, v)."""
    sender, receiver = np.concatenate([pairs, pairs[:, ::-1]]).T
    order = np.argsort(sender, kind="stable")
    first = np.searchsorted(sender[order], np.arange(count + 1))
    degree = np.diff(first)[pairs[:, 0]]
    pair = np.repeat(np.arange(len(pairs)), degree)
    skipped = first[pairs[:, 0]] - (np.cumsum(degree) - degree)
    w = receiver[order][np.repeat(skipped, degree) + np.arange(len(pair))]
    third = w != pairs[pair, 1]
    return pair[third], w[third]


def _squared(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Squared distances (n, n) [m²] of ``positions`` (n, 2) [m]."""
    x, y = np.ascontiguousarray(positions.T)
    dx, dy = x[:, None] - x, y[:, None] - y
    return np.asarray(dx * dx + dy * dy)
