"""What the writer knows of the run so far, and the layers that tell it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import dist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.replay.columns import Moment
from fleet.replay.journal import RecordedLine, Scene, TripEnd
from fleet.replay.sink import Sink
from protocols.messages import Award, Point, RobotId


class UnderWay(NamedTuple):
    """A robot that drives."""

    event: int
    origin: Point  # [m]
    site: Point  # [m]
    departed: float  # [s]
    errand: bool = False  # to a place that is no event


@dataclass(slots=True)
class OpenConversation:
    """What has been said about an event since it was last raised."""

    event: int
    site: Point  # [m]
    source: RobotId
    lines: list[RecordedLine] = field(default_factory=list)

    def count(self, kind: str) -> int:
        """Transmissions of a kind so far."""
        return sum(line.kind == kind for line in self.lines)

    @property
    def calls(self) -> int:
        """Calls for bids so far."""
        return self.count("call")

    @property
    def parents(self) -> dict[RobotId, RobotId]:
        """Whom each robot first heard the call from, in the order in which they heard it."""
        parents: dict[RobotId, RobotId] = {}
        callers: set[RobotId] = set()
        for line in self.lines:
            if line.kind == "call":
                callers.add(line.sender)
                for robot in line.heard:
                    if robot not in callers:
                        parents.setdefault(robot, line.sender)
        return parents


class FleetState:
    """The state of the fleet, kept up to the happening that is being told."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.n = len(scene.positions)
        self.positions = np.array(scene.positions, float).reshape(-1, 2)  # latest known [m]
        self.energies = np.array(scene.energies)  # (n,) [J]
        self.capacity = max(scene.capacities)  # [J]
        self.on_air = self.energies > 0.0  # (n,)
        self.under_way: dict[RobotId, UnderWay] = {}
        self.sites: dict[int, Point] = {}  # of the events that are not over [m]
        self.conversations: dict[
            int, OpenConversation
        ] = {}  # by event, the latest about each open one
        self.round = 0
        self.now = 0.0  # [s]
        self.mark = mark_of(scene)

    def at(self, robot: RobotId) -> Point:
        """Where a robot is, as far as known [m]."""
        x, y = self.positions[robot].tolist()
        return x, y

    def foreseen(self, robot: RobotId, site: Point) -> float:
        """What Eq. (1) charges for the straight line from where the robot is to a site [J]."""
        return self.scene.per_metre * dist(self.at(robot), site)


def mark_of(scene: Scene) -> float:
    """The radius that robots are drawn with [m]: theirs, unless they would be hard to see."""
    return max(scene.radius, 0.0055 * max(scene.width, scene.height))


class Layer:
    """One part of the picture: it is told what happens and turns it into rows.

    The state is up to date when a layer is told, and knows the trip that ended no more.
    """

    def run_started(self, state: FleetState) -> None:
        """Everybody is in place."""

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """An event is told to a robot; again, by another, if nobody went or arrived."""

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """A transmission was made."""

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """A conversation is over."""

    def broken_off(self, at: Moment, event: int, reason: str) -> None:
        """A conversation came to no end."""

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """An event is "served", "expired" or "lost"; the state knows it no more."""

    def departed(self, at: Moment, robot: RobotId) -> None:
        """A robot sets off; the state knows where to, and whether that is an event."""

    def planned(self, at: Moment, robot: RobotId, way: NDArray[np.float64]) -> None:
        """A robot that has set off is going to drive along ``way`` (k, 2) [m]."""

    def moved(self, at: Moment, samples: NDArray[np.float64]) -> None:
        """Poses (k, 8) of those under way, up to now; the moment's time is that of the last."""

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """A robot came to rest: at an event, short of it, or elsewhere, see :data:`RELOCATED`."""

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """Nothing more happens; without a summary, the run broke off."""

    def send(self, sink: Sink) -> None:
        """Pass on the rows made since the last time."""
