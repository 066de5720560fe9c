"""Robots: what they are made of, and what they know."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, pi
from typing import Protocol

from fleet.energy import Battery, PowerModel
from protocols.messages import Point, RobotId


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """How a robot is built.

    Raises:
        ValueError: a value is out of its range.
    """

    radius: float = 0.1  # [m]
    mass: float = 9.0  # [kg]
    cruise: float = 0.76  # [m/s] the paper's speed, near the cheapest for its power model
    acceleration: float = 1.0  # [m/s²] both ways
    turn_rate: float = 1.6667 * pi  # [rad/s]
    turn_acceleration: float = 1.6667 * pi  # [rad/s²]
    capacity: float = 100.0  # [J] of the battery, full at the start
    power: PowerModel = field(default_factory=PowerModel)

    def __post_init__(self) -> None:
        for name in (
            "radius", "mass", "cruise", "acceleration", "turn_rate", "turn_acceleration", "capacity"
        ):  # fmt: skip
            value = getattr(self, name)
            if not 0.0 < value < inf:
                raise ValueError(f"robot {name} is {value}; expected more than 0")


PRESETS: dict[str, RobotSpec] = {"small": RobotSpec()}
"""Robots by name, for scenario files."""


class Estimator(Protocol):
    """Whoever can tell what a drive would cost."""

    def cost(self, robot: Robot, site: Point) -> float:
        """The energy that ``robot`` believes going to ``site`` [m] takes [J]; inf: it cannot."""


class Robot:
    """One robot of a running fleet. Motion moves it and drains it; protocols only ask it.

    It is the :class:`protocols.messages.Robot` that conversations see.
    """

    __slots__ = (
        "_motion", "_tables", "alive", "battery", "failed_sites", "heading", "id", "position",
        "radio_range",
    )  # fmt: skip

    def __init__(
        self,
        id: RobotId,
        position: Point,
        heading: float,
        battery: Battery,
        radio_range: float,
        tables: Sequence[Mapping[RobotId, Point]],
        motion: Estimator,
    ) -> None:
        self.id = id
        self.position = position  # [m]
        self.heading = heading  # [rad]
        self.battery = battery
        self.radio_range = radio_range  # r [m]
        self.alive = True
        self.failed_sites: set[Point] = set()  # it was sent there and did not get there
        self._tables = tables
        self._motion = motion

    @property
    def energy(self) -> float:
        """What the battery holds [J]."""
        return self.battery.charge

    @property
    def neighbours(self) -> Mapping[RobotId, Point]:
        """Radio neighbours in the routing graph: last known positions [m]."""
        return self._tables[self.id]

    def cost_to(self, site: Point) -> float:
        """The energy it believes that going to ``site`` takes [J]; inf if it cannot go."""
        if site in self.failed_sites:
            return inf
        return self._motion.cost(self, site)
