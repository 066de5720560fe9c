"""The event handler: hears of events from sensors, and picks the robot that is told first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from fleet.robot import Robot
from protocols.messages import Point, RobotId
from worlds.sensors import SensorField

HandlerName = Literal["random", "nearest-known"]


class Notice(NamedTuple):
    """Word of an event that the handler takes for a new one."""

    delay: float  # since it happened [s]
    position: Point  # where it is said to be [m]


class Handler:
    """Picks collecting robots, and learns of events: at once, or from a sensor field.

    ``shares`` yields numbers in [0, 1): ``random`` picks any robot on the air by them, as in
    the paper; ``nearest-known`` the one that was last known nearest to the event.
    """

    def __init__(
        self,
        shares: Iterator[float],
        choice: HandlerName = "random",
        field: SensorField | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        self.sensor_messages = 0
        self._shares = shares
        self._choice = choice
        self.field = field
        self._rng = rng
        self._known: list[Point] = []

    def meet(self, robots: Sequence[Robot]) -> None:
        """The handler knows where everybody starts."""
        self._known = [robot.position for robot in robots]

    def hear_from(self, robot: Robot) -> None:
        """A robot has told where it is."""
        self._known[robot.id] = robot.position

    def collector(self, site: Point, on_air: Sequence[RobotId]) -> RobotId:
        """Who is told of an event at ``site`` [m]; ``on_air`` is not empty."""
        share = next(self._shares)
        if self._choice == "random":
            return on_air[int(share * len(on_air))]
        x, y = site
        known = self._known
        return min(on_air, key=lambda k: ((known[k][0] - x) ** 2 + (known[k][1] - y) ** 2, k))

    def notices(self, site: Point) -> list[Notice]:
        """When and where word of an event at ``site`` [m] comes; none: nobody noticed it.

        Without sensors at once, and exactly. With sensors the first report counts; of the
        others each is taken for another event with a small probability.
        """
        if self.field is None or self._rng is None:
            return [Notice(0.0, site)]
        reports = self.field.detect(site, self._rng)
        self.sensor_messages += sum(report.hops for report in reports)
        spec = self.field.spec
        reports.sort(key=lambda report: (report.hops, report.sensor))
        mistaken = self._rng.random(len(reports)) < spec.duplicates
        return [
            Notice(report.hops * spec.hop_time, report.position)
            for k, report in enumerate(reports)
            if k == 0 or mistaken[k]
        ]
