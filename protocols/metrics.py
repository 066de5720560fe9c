"""What a bid is worth. A metric is a small function: robot and site in, cost out.

The lowest cost wins. A robot that cannot afford the trip does not bid at all, whatever the
metric: see :func:`protocols.auctions.offer`. In the paper's symbols the trip costs m·d and the
robot holds E_R; here m·d is what the robot believes that the trip costs, ``cost_to``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import dist, inf
from typing import TypeAlias

from protocols.messages import Point, RobotView

Metric: TypeAlias = Callable[[RobotView, Point], float]


def energy_left(robot: RobotView, site: Point) -> float:
    """Most energy left after the trip; the cost is minus that energy, m·d − E_R [J]."""
    return robot.cost_to(site) - robot.energy


def distance(robot: RobotView, site: Point) -> float:
    """Nearest to the event, as the crow flies [m]."""
    return dist(robot.position, site)


def cost_share(robot: RobotView, site: Point) -> float:
    """Smallest share of the battery spent on the trip, m·d/E_R."""
    return robot.cost_to(site) / robot.energy if robot.energy > 0.0 else inf


def cost_over_left(robot: RobotView, site: Point) -> float:
    """Least spent for each joule that is left, m·d/(E_R − m·d).

    One way to read the paper's m·d(E_R − m·d), taking the bracket for a denominator.
    """
    cost = robot.cost_to(site)
    return cost / (robot.energy - cost) if robot.energy > cost else inf


def cost_times_left(robot: RobotView, site: Point) -> float:
    """Smallest product of what is spent and what is left, m·d·(E_R − m·d) [J²].

    The paper's formula as it stands, the lowest winning: it favours the near, and the empty.
    """
    cost = robot.cost_to(site)
    return cost * (robot.energy - cost)


def most_cost_times_left(robot: RobotView, site: Point) -> float:
    """Largest product of what is spent and what is left, m·d·(E_R − m·d) [J²].

    The paper's formula as it stands, the highest winning: it favours the far, and the full.
    """
    return -cost_times_left(robot, site)


@dataclass(frozen=True, slots=True, kw_only=True)
class CompanyShare:
    """Least spent for what the battery holds, those with company close by first:
    m·d/E_R^b·(1 + a/l).

    b weighs balance against thrift: 0 is the cost, 1 the share of the battery. a is the distance
    to the nearest neighbour, l a length: a robot that stands beside another leaves no gap, one
    that stands alone does.

    Raises:
        ValueError: the length is not positive, or the balance negative.
    """

    length: float = 0.3  # l [m]
    balance: float = 0.5  # b

    def __post_init__(self) -> None:
        if not self.length > 0.0:
            raise ValueError(f"length is {self.length}; expected more than 0")
        if not self.balance >= 0.0:
            raise ValueError(f"balance is {self.balance}; expected 0 or more")

    def __call__(self, robot: RobotView, site: Point) -> float:
        """The bid's cost [J^(1 − b)]."""
        if not robot.energy > 0.0:
            return inf
        here = robot.position
        alone = min((dist(here, there) for there in robot.neighbours.values()), default=0.0)
        spent: float = robot.cost_to(site) / robot.energy**self.balance
        return spent * (1.0 + alone / self.length)


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyLeftMinusCost:
    """Most energy held, less the trip's cost times a weight: w·m·d − E_R [J].

    Weight 1 is ``energy-left``; a larger weight keeps the fleet from driving far for balance.

    Raises:
        ValueError: the weight is negative.
    """

    weight: float = 3.0

    def __post_init__(self) -> None:
        if not self.weight >= 0.0:
            raise ValueError(f"weight is {self.weight}; expected 0 or more")

    def __call__(self, robot: RobotView, site: Point) -> float:
        """The bid's cost [J]."""
        return self.weight * robot.cost_to(site) - robot.energy
