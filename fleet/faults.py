"""What breaks: motors, whole robots, and the radio of a region."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from typing import Literal, NamedTuple

import numpy as np

from protocols.messages import Point, RobotId


class Breakdown(NamedTuple):
    """A robot fails for good."""

    time: float  # [s]
    robot: RobotId
    what: Literal["motor", "all"]  # "motor": it stays and still relays; "all": it is gone


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedBreakdown:
    """A breakdown at a given time.

    Raises:
        ValueError: the time or the robot's id is negative.
    """

    time: float  # [s]
    robot: RobotId
    what: Literal["motor", "all"] = "all"

    def __post_init__(self) -> None:
        if not self.time >= 0.0 or self.robot < 0:
            raise ValueError(
                f"breakdown of robot {self.robot} at {self.time} s; expected 0 or more of both"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Blackout:
    """The radio of a round region is silent for a while.

    Raises:
        ValueError: it has no size or no duration.
    """

    start: float  # [s]
    duration: float  # [s]
    x: float  # [m]
    y: float  # [m]
    radius: float  # [m]

    def __post_init__(self) -> None:
        if not (self.start >= 0.0 and self.duration > 0.0 and self.radius > 0.0):
            raise ValueError(
                f"blackout from {self.start} s for {self.duration} s within {self.radius} m;"
                f" expected 0 or more, more than 0, and more than 0"
            )

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.start + self.duration

    def covers(self, place: Point) -> bool:
        """Whether a place [m] lies in the region."""
        dx, dy = place[0] - self.x, place[1] - self.y
        return dx * dx + dy * dy <= self.radius * self.radius


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """What goes wrong in a run, at random and as planned.

    Raises:
        ValueError: a rate is negative.
    """

    motor_rate: float = 0.0  # breakdowns of a robot's motor [1/s]
    robot_rate: float = 0.0  # breakdowns of a whole robot [1/s]
    planned: tuple[PlannedBreakdown, ...] = ()
    blackouts: tuple[Blackout, ...] = ()

    def __post_init__(self) -> None:
        for name in ("motor_rate", "robot_rate"):
            if not 0.0 <= getattr(self, name) < inf:
                raise ValueError(f"faults {name} is {getattr(self, name)}; expected 0 or more")

    def breakdowns(self, robots: int, rng: np.random.Generator) -> Iterator[Breakdown]:
        """The breakdowns of a run, in no order; each robot has at most one of each kind."""
        for fault in self.planned:
            yield Breakdown(fault.time, fault.robot, fault.what)
        draws = rng.exponential(1.0, (2, robots)).tolist()
        kinds: tuple[Literal["motor", "all"], ...] = ("motor", "all")
        for what, rate, row in zip(kinds, (self.motor_rate, self.robot_rate), draws, strict=True):
            if rate > 0.0:
                yield from (Breakdown(t / rate, robot, what) for robot, t in enumerate(row))
