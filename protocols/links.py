"""The graphs by their definitions, computed whole: for a start, for checks, for small fleets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

DENSE_UP_TO = 1000  # robots for which all distances at once are quicker than a tree
RIGHT_ANGLE = 1e-9  # [rad] how near to a right angle counts as one,
BESIDE = 1e-16  # but not for robots so much nearer to one end (squared): both would yield


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
    return component_count(count, pairs) == 1


def component_count(count: int, pairs: NDArray[np.intp]) -> int:
    """How many networks ``count`` robots fall into."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return int(connected_components(links, directed=False)[0])


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
    uw, vw = ux * ux + uy * uy, vx * vx + vy * vy
    at_u, at_v = uw == 0.0, vw == 0.0
    dot = ux * vx + uy * vy
    near_right = dot * dot <= RIGHT_ANGLE * RIGHT_ANGLE * uw * vw
    between = (dot <= 0.0) | (near_right & (uw > BESIDE * vw) & (vw > BESIDE * uw))
    if lune:
        uv = ((positions[u] - positions[v]) ** 2).sum(axis=2)
        between |= (uw < uv) & (vw < uv)
    first = np.where(at_u & at_v, np.minimum(u, v), np.where(at_u, u, v))
    between = np.where(at_u | at_v, w < first, between)
    blocked[~blocked] = (between & (w != u) & (w != v)).any(axis=1)
    return blocked


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
