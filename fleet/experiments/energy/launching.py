"""What a launch costs as the prediction of motion has it: to set beside what is fitted."""

from __future__ import annotations

from functools import cache
from math import inf, pi

from fleet.motion.driven import DrivenMotion
from fleet.power import Battery
from fleet.robot import Robot, RobotSpec
from worlds.arena import Arena

HEADINGS = 60  # over which turning first is averaged


def ramps_cost(spec: RobotSpec) -> float:
    """Speeding up to cruise and braking to rest, beyond Eq. (1) on the way they take [J]."""
    return _drive(spec, 0.0) - spec.power.per_metre(spec.cruise) * _far(spec)


@cache
def pivot_cost(spec: RobotSpec) -> float:
    """Turning towards the site first, over headings of which all are alike [J]."""
    headings = [2.0 * pi * (k + 0.5) / HEADINGS for k in range(HEADINGS)]
    return sum(_drive(spec, heading) for heading in headings) / HEADINGS - _drive(spec, 0.0)


def launch_cost(spec: RobotSpec) -> float:
    """Both [J]."""
    return ramps_cost(spec) + pivot_cost(spec)


def _far(spec: RobotSpec) -> float:
    """Far enough to reach cruise speed twice over [m]."""
    return 10.0 * spec.cruise + 2.0 * spec.cruise**2 / spec.acceleration


@cache
def _drive(spec: RobotSpec, heading: float) -> float:
    """What a straight drive takes that begins with a turn from ``heading`` [rad] [J]."""
    far, room = _far(spec), 4.0 * spec.radius
    motion = DrivenMotion(spec, Arena(far + 2.0 * room, 2.0 * room), engine=False)
    robot = Robot(0, (room, room), heading, Battery(1e9), inf, [], motion)
    motion.place([robot])
    motion.depart(robot, (room + far, room))
    (trip,) = motion.advance(inf)
    return trip.energy
