"""What a bid is worth. A metric is a small function: robot and site in, cost out.

The lowest cost wins. A robot that cannot afford the trip does not bid at all, whatever
the metric: see :func:`protocols.auctions.offer`.
"""

from __future__ import annotations

from collections.abc import Callable
from math import dist
from typing import TypeAlias

from protocols.messages import Point, Robot

Metric: TypeAlias = Callable[[Robot, Point], float]


def energy_left(robot: Robot, site: Point) -> float:
    """Most energy left after the trip; the cost is minus that energy [J]."""
    return robot.cost_to(site) - robot.energy


def distance(robot: Robot, site: Point) -> float:
    """Nearest to the event, as the crow flies [m]."""
    return dist(robot.position, site)
