"""Roadmaps of ragged floors, each made once.

Importing this module loads numba.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from fleet.motion.floor import lay_out
from fleet.motion.kernels.records import GRID, Floor
from fleet.motion.kernels.roadmap import BINS, Roadmap, lines_from, mark_sides, open_directions
from worlds.arena import Arena

RAGGED = 400  # corners from which on a roadmap pays
MOST_CELLS = 4_000_000  # of the map of distances
LANDMARKS = 12


def is_ragged(arena: Arena) -> bool:
    """Whether the obstacles have so many corners that paths are looked for on a roadmap."""
    return sum(len(polygon.corners) for polygon in arena.obstacles) > RAGGED


@lru_cache(16)
def roadmap_of(arena: Arena, radius: float, clearance: float) -> Roadmap:
    """The roadmap for robots of ``radius`` that keep ``clearance`` [m] from obstacles."""
    floor = lay_out(arena, radius, 0)
    margin = radius + clearance
    corners = np.arange(len(floor.discs))
    box = np.array([margin, arena.width - margin, margin, arena.height - margin])
    room = np.zeros((len(corners), BINS), np.int8)
    open_directions(floor, corners, box, margin, room)
    kept = room.any(axis=1)
    places = np.column_stack([floor.discs["x"], floor.discs["y"]])[kept]
    count = len(places)
    nothing, none = np.zeros(0, np.int64), np.zeros((0, 2))
    begins = np.zeros(2 * count + 1, np.int64)
    roadmap = Roadmap(
        corners[kept],
        places,
        room[kept],
        begins,
        nothing,
        none,
        np.zeros(0),
        none,
        *_distances(floor, arena, margin),
        nothing,
        none,
    )
    lines, numbers = np.zeros((8 * count + 8, 2), np.int64), np.zeros((8 * count + 8, 3))
    found = []
    for one in range(count):
        made = lines_from(floor, roadmap, one, margin, lines, numbers)
        found.append((lines[:made].copy(), numbers[:made].copy()))
    nodes = np.concatenate([ends for ends, _ in found] or [lines[:0]])
    reals = np.concatenate([reals for _, reals in found] or [numbers[:0]])
    order = np.lexsort((reals[:, 2], nodes[:, 0]))
    np.cumsum(np.bincount(nodes[:, 0], minlength=2 * count), out=begins[1:])
    nodes, reals = nodes[order], reals[order]
    areas, landmarks = _landmarks(count, nodes // 2, reals[:, 2])
    turns = np.column_stack([np.cos(reals[:, 1]), np.sin(reals[:, 1])])
    return roadmap._replace(
        ends=nodes[:, 1].copy(),
        angles=reals[:, :2].copy(),
        lengths=reals[:, 2].copy(),
        points=places[nodes[:, 1] // 2] + margin * turns,
        areas=areas,
        landmarks=landmarks,
    )


def _distances(floor: Floor, arena: Arena, margin: float) -> tuple[NDArray[np.float32], float]:
    """How far the sides of obstacles are from the middle of each fine cell, and its pitch [m]."""
    from scipy.ndimage import distance_transform_edt

    pitch = max(0.25 * margin, sqrt(arena.width * arena.height / MOST_CELLS))
    rows, columns = ceil(arena.height / pitch), ceil(arena.width / pitch)
    fine = np.zeros(1, GRID)
    fine[0]["cell"], fine[0]["columns"], fine[0]["rows"] = pitch, columns, rows
    crossed = np.zeros((rows, columns), bool)
    mark_sides(floor, fine, crossed)
    away = distance_transform_edt(~crossed) * pitch
    return away.astype(np.float32), pitch


def _landmarks(
    count: int, pairs: NDArray[np.int64], lengths: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Which corners hang together by lines (count,), and the least length of lines (count,
    landmarks) from each to a few of the largest such area, far from each other.

    Arcs count as nothing, so that the difference of two of them is a lower bound for the length
    of any path between two corners, robots or not (Goldberg and Harrelson, SODA 2005).
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components, dijkstra

    order = np.lexsort((-lengths, pairs[:, 1], pairs[:, 0]))  # of several lines the shortest last
    links = np.full(0, 0.0), np.zeros((0, 2), np.int64)
    if len(order):
        ends, kept = pairs[order], lengths[order]
        last = np.append((np.diff(ends, axis=0) != 0).any(axis=1), True)
        links = np.maximum(kept[last], 1e-9), ends[last]
    graph = coo_array((links[0], (links[1][:, 0], links[1][:, 1])), shape=(count, count)).tocsr()
    found = np.full((count, LANDMARKS), np.inf)
    if not count:
        return np.zeros(0, np.int64), found
    areas = connected_components(graph, directed=False)[1].astype(np.int64)
    nearest = np.where(areas == np.argmax(np.bincount(areas)), np.inf, -1.0)
    for k in range(min(LANDMARKS, int((nearest > 0.0).sum()))):
        found[:, k] = dijkstra(graph, indices=int(np.argmax(nearest)))
        nearest = np.minimum(nearest, found[:, k])
    return areas, found
