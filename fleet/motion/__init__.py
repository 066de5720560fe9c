"""How robots get to where they are sent: the interface, and what a trip leaves behind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from fleet.robot import Robot
from protocols.messages import Point, RobotId

Outcome = Literal["arrived", "no path", "stuck", "battery empty", "broken down", "cut off"]


class Accounts(NamedTuple):
    """What a battery has paid for on a trip [J], each part by what it was lost to.

    Each comes from the forces and velocities that it is about, so that they add up to what was
    drained only if nothing is forgotten. What a motion has no notion of is 0.
    """

    electronics: float = 0.0  # whatever it does
    rolling: float = 0.0  # rolling resistance
    viscous: float = 0.0  # resistance that grows with speed
    scrub: float = 0.0  # tyres that turn on the spot
    windings: float = 0.0  # heat of the motors, and the power of turning
    braking: float = 0.0  # inertia: what was put in and taken out again, not regenerated
    slip: float = 0.0  # wheels that spin, or slide sideways
    contact: float = 0.0  # taken by bodies that it pushed, less what they gave
    waiting: float = 0.0  # idle power before it could set off


class Trip(NamedTuple):
    """One robot's drive to one site, from departure to the end, whatever the end."""

    robot: RobotId
    outcome: Outcome
    origin: Point  # [m]
    site: Point  # where it was sent [m]
    end: Point  # where it came to rest [m]
    departed: float  # [s] when it was sent
    ended: float  # [s]
    path: float  # driven length [m]
    energy: float  # drained on the way [J]
    planned: float = 0.0  # length of the path that was planned when it was sent [m]
    offset: float = 0.0  # from the site to where it was bound: the site is covered [m]
    waited: float = 0.0  # before it could set off, and for others on the way [s]
    steps: int = 0  # of simulation in which it was driven
    contacts: int = 0  # times that it was pushed by another body, or pushed one
    accounts: Accounts = Accounts()  # what the energy went into


SAMPLE_FIELDS = ("robot", "time", "x", "y", "heading", "energy", "planned_x", "planned_y")
"""Columns of the samples that motion keeps for observers: id, s, m, m, rad, J left, and where the
robot should be by its plan [m].
"""


class Motion(Protocol):
    """Drives robots. It alone changes their position, heading and battery on the way."""

    @property
    def now(self) -> float:
        """The time that robots have been driven up to [s]."""

    @property
    def moving(self) -> Sequence[Robot]:
        """The robots under way."""

    def place(self, robots: Sequence[Robot]) -> None:
        """Put the fleet on the floor, where the robots say they are. Once, before all else."""

    def cost(self, robot: Robot, site: Point) -> float:
        """The energy that ``robot`` believes going to ``site`` [m] takes [J]; inf: it cannot."""

    def depart(self, robot: Robot, site: Point) -> None:
        """Send the robot to ``site`` [m] now."""

    def advance(self, until: float) -> Sequence[Trip]:
        """Drive on until trips end, at the latest to the time ``until`` [s].

        Returns the trips that ended, at the time ``now``; none if ``until`` came first.
        """

    def halt(self, robot: Robot) -> None:
        """The robot's motor fails: it stops where it is, and its trip ends "broken down"."""

    def stop(self) -> Sequence[Trip]:
        """The run is over: the trips of all who are under way, "cut off" as they are."""

    def plans(self) -> Sequence[tuple[RobotId, NDArray[np.float64]]]:
        """Who has planned a way since the last call, and its corners (k, 2) [m], in order.

        A straight way goes without saying, unless it was planned anew while under way.

        Empty unless motion was made with a sample interval.
        """

    def samples(self) -> NDArray[np.float64]:
        """Poses (k, 8) on the way since the last call, as :data:`SAMPLE_FIELDS`.

        Empty unless motion was made with a sample interval.
        """
