"""Where everybody rests, and the paths among them.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import ceil, cos, isfinite, nan, sin
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion.floor import lay_out
from fleet.motion.kernels.grid import put
from fleet.motion.kernels.plan import NO_PATH, move_in, plan
from fleet.motion.kernels.records import LINE, NOBODY, SEGMENT
from fleet.motion.meshed import plan_on_meshes
from fleet.motion.meshes import is_ragged, mesh_of
from protocols.compiled import direct
from protocols.messages import Point, RobotId
from worlds.arena import Arena

CHORD = 0.2  # [rad] of an arc that a chord spans, at most


class Plan(NamedTuple):
    """A way to a site, or that there is none."""

    segments: NDArray[Any] | None  # (k,) SEGMENT; None: no path
    length: float  # [m]
    goal: Point  # where it ends: the site, or as near as there is room [m]


def corners(segments: NDArray[Any]) -> NDArray[np.float64]:
    """A way of one or more SEGMENT as a polyline (k, 2) [m], arcs by chords."""
    points: list[Point] = []
    for kind, x, y, radius, angle, sense, along_x, along_y, length, *_ in segments.tolist():
        if kind == LINE:
            way = [(x, y), (x + length * along_x, y + length * along_y)]
        else:
            turn = sense * length / radius
            chords = ceil(abs(turn) / CHORD)
            angles = [angle + turn * k / chords for k in range(chords + 1)]
            way = [(x + radius * cos(a), y + radius * sin(a)) for a in angles]
        points += way[1:] if points else way
    return np.array(points)


class Planner:
    """Plans, and remembers plans for as long as nobody has moved.

    Raises:
        ValueError: robots overlap one another, an obstacle or a wall.
    """

    def __init__(
        self, arena: Arena, radius: float, points: Sequence[Point], clearances: Sequence[float]
    ) -> None:
        self.floor = lay_out(arena, radius, len(points))
        self._clearances = np.array(clearances)
        self.ragged = is_ragged(arena)
        self._mesh_with = cache(lambda clearance: mesh_of(arena, radius, clearance, len(points)))
        self._make_room(32)
        self._count = len(points)
        self._plan, self._put = direct(plan), direct(put)
        self._known: dict[tuple[RobotId, Point], Plan] = {}
        which, other = move_in(self.floor, np.array(points, float).reshape(-1, 2))
        if which != NOBODY:
            whom = f"robot {other}" if other != NOBODY else "a wall or an obstacle"
            raise ValueError(
                f"robot {which} of radius {radius} m at {points[which]} overlaps {whom};"
                f" expected bodies apart"
            )

    def plan(self, robot: RobotId, position: Point, site: Point) -> Plan:
        """The shortest way of ``robot`` from ``position`` to ``site`` [m].

        Raises:
            ValueError: the site is not finite.
        """
        known = self._known.get((robot, site))
        if known is not None:
            return known
        if not all(map(isfinite, site)):
            raise ValueError(f"the site of robot {robot} is {site}; expected two numbers [m]")
        look = self._on_meshes if self.ragged else self._among_corners
        while True:
            end, x, y, length = look(robot, position, site)
            if end <= len(self._segments):
                break
            self._make_room(2 * end)
        segments = None if end == NO_PATH else self._raw[1:end].copy().view(SEGMENT)
        found = Plan(segments, float(length), (float(x), float(y)))
        self._known[robot, site] = found
        return found

    def _among_corners(
        self, robot: RobotId, position: Point, site: Point
    ) -> tuple[int, float, float, float]:
        return self._plan(self.floor, robot, *position, *site, self._clearances, self._segments)

    def _on_meshes(
        self, robot: RobotId, position: Point, site: Point
    ) -> tuple[int, float, float, float]:
        clearances = self._clearances.tolist()
        return plan_on_meshes(
            self._mesh_with, self.floor, clearances, robot, position, site, self._segments
        )

    def plan_among(
        self, stopped: Sequence[tuple[RobotId, Point]], robot: RobotId, position: Point, site: Point
    ) -> Plan:
        """The same around others that have ``stopped`` on their ways, if there is one."""
        around = self._count
        self._known.clear()
        for other, where in stopped:
            self._put(self.floor, around + other, *where)
        found = self.plan(robot, position, site)
        for other, _ in stopped:
            self._put(self.floor, around + other, nan, nan)
        self._known.clear()
        return self.plan(robot, position, site) if found.segments is None else found

    def resting_place(self, robot: RobotId) -> Point:
        """Where the robot rests, or will [m]."""
        disc = self.floor.discs[robot]
        return float(disc["x"]), float(disc["y"])

    def rest(self, robot: RobotId, position: Point) -> None:
        """The robot rests at ``position`` [m], or will."""
        self._put(self.floor, robot, *position)
        self._known.clear()

    def changed(self) -> None:
        """Somebody's place has been changed by a kernel: forget the plans."""
        self._known.clear()

    def _make_room(self, segments: int) -> None:
        """For paths of so many; as plain bytes they are copied three times as fast."""
        self._segments = np.zeros(segments, SEGMENT)
        self._raw = self._segments.view(f"V{SEGMENT.itemsize}")
