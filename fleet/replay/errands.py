"""Robots on their way to places that are no events, to keep the network together or to find it.

Awards order such errands, but no hook tells when a robot sets off on one, or arrives. Both
show in the robot: it is engaged from the one to the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import dist

import numpy as np
from numpy.typing import NDArray

from fleet.replay.journal import RELOCATED, TripEnd
from fleet.robot import Robot
from protocols.messages import Move, Point, RobotId


@dataclass(slots=True)
class Errand:
    """One robot's way to a place that is no event."""

    robot: RobotId
    event: int
    origin: Point  # [m]
    place: Point  # [m]
    departed: float  # [s]
    charge: float  # then [J]
    path: float = 0.0  # driven so far [m]
    latest: Point = (np.nan, np.nan)  # where it was seen last [m]


class Errands:
    """Those ordered, and those under way; true if there are any."""

    def __init__(self, robots: Sequence[Robot]) -> None:
        self._robots = robots
        self._ordered: list[Errand] = []
        self._under_way: dict[RobotId, Errand] = {}

    def __bool__(self) -> bool:
        return bool(self._ordered or self._under_way)

    def order(self, event: int, moves: Sequence[Move], time: float) -> None:
        """Robots are to go; those that are busy will not."""
        for id, place in moves:
            robot = self._robots[id]
            if not robot.engaged:
                here, charge = robot.position, robot.battery.charge
                self._ordered.append(Errand(id, event, here, place, time, charge, 0.0, here))

    def set_off(self, called: RobotId | None = None) -> list[Errand]:
        """Who has set off since the order, but for a robot that an event ``called`` instead."""
        ordered, self._ordered = self._ordered, []
        gone = [one for one in ordered if one.robot != called and self._robots[one.robot].engaged]
        self._under_way |= {errand.robot: errand for errand in gone}
        return gone

    def follow(self, samples: NDArray[np.float64]) -> None:
        """Measure the ways by poses (k, 6) of robots under way."""
        for robot, errand in self._under_way.items():
            seen = samples[samples[:, 0] == robot, 2:4]
            if len(seen):
                corners = np.vstack([errand.latest, seen])
                errand.path += float(np.hypot(*np.diff(corners, axis=0).T).sum())
                errand.latest = (float(seen[-1, 0]), float(seen[-1, 1]))

    def over(self, time: float, called: RobotId | None = None) -> list[tuple[int, TripEnd]]:
        """Who has arrived, or stopped short, by now; a robot ``called`` to an event has."""
        ended = [
            errand
            for robot, errand in self._under_way.items()
            if robot == called or not self._robots[robot].engaged
        ]
        return [(errand.event, self._end(errand, time)) for errand in ended]

    def _end(self, errand: Errand, time: float) -> TripEnd:
        robot = self._robots[errand.robot]
        del self._under_way[errand.robot]
        return TripEnd(
            robot=errand.robot,
            outcome=RELOCATED,
            origin=errand.origin,
            site=errand.place,
            end=robot.position,
            departed=errand.departed,
            ended=time,
            path=errand.path + dist(errand.latest, robot.position),
            energy=errand.charge - robot.battery.charge,
        )
