"""Plans on ragged floors: any-angle on a mesh, pulled taut, around the robots that are hit.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from fleet.motion.kernels.encounters import (
    approach,
    path_length,
    robots_hit,
    straight,
    ways_around,
)
from fleet.motion.kernels.mesh import Mesh, locate
from fleet.motion.kernels.plan import NO_PATH, TOUCH, unsqueeze
from fleet.motion.kernels.polyanya import turning_points
from fleet.motion.kernels.records import NOBODY, FloatArray, Floor, IntArray, Records
from fleet.motion.kernels.taut import pull_taut
from fleet.motion.meshes import without
from protocols.messages import Point

MOST_ROUNDS = 40  # of taking robots that are hit out of the mesh

Found: TypeAlias = tuple[int, float, float, float]  # end of the path, goal x, y, length [m]


def plan_on_meshes(
    mesh_with: Callable[[float], Mesh],
    floor: Floor,
    clearances: Sequence[float],
    me: int,
    position: Point,
    site: Point,
    segments: Records,
) -> Found:
    """As :func:`fleet.motion.kernels.plan.plan`, on the mesh ``mesh_with`` each clearance [m].

    Those of less clearance are asked for when they are needed.
    """
    radius = float(floor.grid[0]["radius"])
    ends, saved = np.array([*position, *site]), np.empty((256, 2))
    found = NO_PATH, *position, 0.0
    for clearance in clearances:
        mesh = mesh_with(clearance)
        exists, x, y, squeezed = approach(floor, me, ends, clearance, saved)
        end = NO_PATH
        if exists:
            there = np.array([*position, x, y])
            end = _way(mesh, floor, me, there, radius + clearance, segments)
        unsqueeze(floor, saved, squeezed)
        length = path_length(segments, min(end, len(segments)))
        found = end, x, y, length
        if end != NO_PATH:
            break
    return found


def _way(
    mesh: Mesh, floor: Floor, me: int, ends: FloatArray, margin: float, segments: Records
) -> int:
    """The end of the shortest path, written down from 1 on; NO_PATH if there is none."""
    if np.hypot(ends[2] - ends[0], ends[3] - ends[1]) < TOUCH:
        return 1
    found = np.empty(len(floor.discs) - len(floor.edges), np.int64)
    taken: list[int] = []
    end, cut = 2, mesh
    if not straight(floor, ends, margin, segments):
        end = _path(mesh, floor, taken, ends, margin, segments)
    for _ in range(MOST_ROUNDS):
        if end == NO_PATH or end > len(segments):
            return end
        hit = found[: robots_hit(floor, me, segments, end, margin, found)].tolist()
        fresh = [robot for robot in hit if robot not in taken]
        if not fresh:
            return end
        taken += fresh
        cut = without(mesh, floor, taken, margin)
        end = _path(cut, floor, taken, ends, margin, segments)
    return NO_PATH


def _path(
    mesh: Mesh,
    floor: Floor,
    robots: Sequence[int],
    ends: FloatArray,
    margin: float,
    segments: Records,
) -> int:
    """The same among obstacles and those ``robots`` that the mesh goes around."""
    start = locate(mesh, ends[0], ends[1], margin)
    goal = locate(mesh, ends[2], ends[3], margin)
    if start[0] == NOBODY or goal[0] == NOBODY:
        return NO_PATH
    areas = mesh.areas[start[0]], mesh.areas[goal[0]]
    if NOBODY not in areas and areas[0] != areas[1]:
        return NO_PATH
    exists, turns = turning_points(mesh, start, goal)
    if not exists:
        return NO_PATH
    around: IntArray = np.array(robots, np.int64)
    sides = ways_around(mesh.points, turns, ends)
    return pull_taut(floor, mesh.owners[turns], sides, around, ends, margin, segments)
