"""Meshes of ragged floors, each made once, and what robots that rest there take out of them.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import ceil, cos, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fleet.motion.kernels.mesh import Mesh, count_cells, triangles_near, ways_out
from fleet.motion.kernels.records import NOBODY, Floor, IntArray
from worlds.arena import Arena
from worlds.ground import geos

RAGGED = 400  # corners from which on a mesh pays
CHORDS = 8  # of a quarter circle around a corner
COARSE = 0.3  # clearances by which the mesh may be smaller than the free floor
ROUND = 1.0 / cos(pi / (4 * CHORDS))  # so much larger circles are whose chords keep off them


def is_ragged(arena: Arena) -> bool:
    """Whether the obstacles have so many corners that paths are looked for on a mesh."""
    return sum(len(polygon.corners) for polygon in arena.obstacles) > RAGGED


@lru_cache(16)
@geos
def mesh_of(arena: Arena, radius: float, clearance: float, robots: int) -> Mesh:
    """The mesh for robots of ``radius`` that keep ``clearance`` [m] from obstacles.

    ``robots``: how many there are; discs of the floor beyond twice as many are corners.
    """
    import shapely

    margin = radius + clearance
    spared = COARSE * clearance
    room = margin + spared
    free = shapely.box(margin, margin, arena.width - margin, arena.height - margin)
    obstacles = shapely.union_all([shapely.polygons(p.corners) for p in arena.obstacles])
    free = shapely.difference(free, shapely.buffer(obstacles, room * ROUND, quad_segs=CHORDS))
    free = shapely.simplify(free, spared)
    corners = np.array([corner for p in arena.obstacles for corner in p.corners])
    points, triangles = _triangulated(free)
    beside, entries = _joined(triangles)
    owners = _owners(points, triangles, beside, corners, np.arange(len(corners)) + 2 * robots)
    return _binned(arena, points, owners, triangles, beside, entries)


def _triangulated(free: Any) -> tuple[NDArray[np.float64], IntArray]:
    """Points (v, 2) and triangles (t, 3), counter-clockwise, of an area."""
    import shapely

    parts = [p for p in shapely.get_parts(free) if p.geom_type == "Polygon" and p.area > 0.0]
    found = shapely.get_parts(shapely.constrained_delaunay_triangles(parts))
    found = shapely.get_parts(found)
    rings = shapely.get_coordinates(found).reshape(-1, 4, 2)[:, :3]
    points, which = np.unique(rings.reshape(-1, 2), axis=0, return_inverse=True)
    triangles = which.reshape(-1, 3).astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    doubled = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[doubled < 0.0] = triangles[doubled < 0.0][:, ::-1]
    return points, triangles


def _joined(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """The triangle across each side (t, 3), and which side of that it is."""
    beside, entries = np.full((2, *triangles.shape), NOBODY)
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    order = np.lexsort(np.sort(sides, axis=1).T)
    ordered = np.sort(sides, axis=1)[order]
    same = np.flatnonzero((ordered[1:] == ordered[:-1]).all(axis=1))
    for one, two in ((order[same], order[same + 1]), (order[same + 1], order[same])):
        beside.reshape(-1)[one], entries.reshape(-1)[one] = two // 3, two % 3
    return beside, entries


def _owners(
    points: NDArray[np.float64],
    triangles: IntArray,
    beside: IntArray,
    centres: NDArray[np.float64],
    discs: IntArray,
) -> IntArray:
    """Whose circle paths turn around at each point (v,); NOBODY: they do not turn there."""
    from scipy.spatial import cKDTree

    angles = np.zeros(len(points))
    for k in range(3):
        here = points[triangles[:, k]]
        one, two = (points[triangles[:, (k + n) % 3]] - here for n in (1, 2))
        cross = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        np.add.at(angles, triangles[:, k], np.arctan2(cross, (one * two).sum(axis=1)))
    open_side = beside == NOBODY
    border = np.zeros(len(points), bool)
    border[triangles[open_side]] = True
    border[np.roll(triangles, -1, axis=1)[open_side]] = True
    turning = np.flatnonzero(border & (angles > pi + 1e-9))
    owners = np.full(len(points), NOBODY)
    if len(turning):
        owners[turning] = discs[cKDTree(centres).query(points[turning])[1]]
    return owners


def _binned(
    arena: Arena,
    points: NDArray[np.float64],
    owners: IntArray,
    triangles: IntArray,
    beside: IntArray,
    entries: IntArray,
) -> Mesh:
    pitch = sqrt(arena.width * arena.height / max(len(triangles), 1))
    rows, columns = ceil(arena.height / pitch), ceil(arena.width / pitch)
    shape = np.array([rows, columns, len(triangles)])
    counts, nothing = np.zeros(rows * columns, np.int64), np.zeros(0, np.int64)
    outward = np.zeros(len(triangles), np.int64)
    ways_out(beside, outward)
    mesh = Mesh(
        points,
        owners,
        triangles,
        beside,
        entries,
        _areas(beside),
        outward,
        nothing,
        nothing,
        shape,
        float(pitch),
    )
    count_cells(mesh, counts, nothing, False)
    bins = np.concatenate([[0], np.cumsum(counts)])
    binned = np.zeros(int(bins[-1]), np.int64)
    count_cells(mesh, bins[:-1].copy(), binned, True)
    return mesh._replace(bins=bins, binned=binned)


def _areas(beside: IntArray) -> IntArray:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    here, side = np.nonzero(beside != NOBODY)
    shape = (len(beside), len(beside))
    links = coo_array((np.ones(len(here), np.int8), (here, beside[here, side])), shape=shape)
    return np.asarray(connected_components(links, directed=False)[1], np.int64)


@geos
def without(mesh: Mesh, floor: Floor, robots: Sequence[int], margin: float) -> Mesh:
    """The mesh with the circles of some discs of ``floor`` taken out: triangles that these meet
    are cut anew.
    """
    import shapely

    centres = np.array([(floor.discs[k]["x"], floor.discs[k]["y"]) for k in robots])
    radii = np.array([floor.discs[k]["core"] + margin for k in robots]) * ROUND
    met = np.zeros(len(mesh.triangles), np.bool_)
    for (x, y), radius in zip(centres.tolist(), radii.tolist(), strict=True):
        triangles_near(mesh, x, y, radius, met)
    if not met.any():
        return mesh
    area = shapely.coverage_union_all(shapely.polygons(mesh.points[mesh.triangles[met]]))
    discs = shapely.buffer(shapely.points(centres), radii, quad_segs=CHORDS)
    points, fresh = _triangulated(shapely.difference(area, shapely.union_all(discs)))
    fresh += len(mesh.points)
    border = mesh.triangles[met]
    old = np.unique(border)
    # those of the new points that the mesh has already
    known = {(x, y): k for k, (x, y) in zip(old.tolist(), mesh.points[old].tolist(), strict=True)}
    names = np.arange(len(mesh.points) + len(points))
    for k, point in enumerate(points.tolist()):
        names[len(mesh.points) + k] = known.get((point[0], point[1]), len(mesh.points) + k)
    fresh = names[fresh]
    all_points = np.concatenate([mesh.points, points])
    beside, entries = _joined(fresh)
    first = len(mesh.triangles)
    beside[beside != NOBODY] += first
    triangles = np.concatenate([mesh.triangles, fresh])
    beside = np.concatenate([mesh.beside, beside])
    entries = np.concatenate([mesh.entries, entries])
    ends = {}
    for t, side in zip(*np.nonzero(beside[first:] == NOBODY), strict=True):
        ends[int(fresh[t, side]), int(fresh[t, (side + 1) % 3])] = int(t) + first, int(side)
    taken = np.flatnonzero(met)
    for t in taken.tolist():
        for side in range(3):
            other, entry = int(mesh.beside[t, side]), int(mesh.entries[t, side])
            if other == NOBODY or met[other]:
                continue
            ours = int(mesh.triangles[t, side]), int(mesh.triangles[t, (side + 1) % 3])
            there = ends.get(ours, (NOBODY, NOBODY))
            beside[other, entry], entries[other, entry] = there
            if there[0] != NOBODY:
                beside[there], entries[there] = other, entry
    triangles[taken] = NOBODY
    owners = np.concatenate([mesh.owners, np.full(len(points), NOBODY)])
    away = np.hypot(*(points[:, None] - centres).transpose(2, 0, 1)) / radii
    nearest = np.argmin(away, axis=1) if len(points) else np.zeros(0, int)
    on = len(points) and away[np.arange(len(points)), nearest] < 1.0 + 1e-6
    owners[len(mesh.points) :] = np.where(on, np.array(robots)[nearest], NOBODY)
    unknown = np.full(len(fresh), NOBODY)
    return mesh._replace(
        points=all_points,
        owners=owners,
        triangles=triangles,
        beside=beside,
        entries=entries,
        areas=np.concatenate([mesh.areas, unknown]),
        outward=np.concatenate([mesh.outward, unknown]),
    )
