"""Idle power of robots that are parked."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from fleet.robot import Robot
from protocols.messages import RobotId


class Rest:
    """What parked robots pay for standing. If that is nothing, this does nothing.

    A robot's charge is reckoned from what it held when it came to rest, so it does not depend
    on how often it is asked for.
    """

    def __init__(self, robots: Sequence[Robot], energy: float) -> None:
        self._robots = robots if energy > 0.0 else ()
        self._energy = energy  # of a robot and step [J]
        self._held = [robot.battery.charge for robot in self._robots]  # [J]
        self._since = [0] * len(self._robots)  # [steps]

    def since(self, robot: Robot, step: int) -> None:
        """The robot is parked from ``step`` on."""
        if self._robots:
            self._held[robot.id] = robot.battery.charge
            self._since[robot.id] = step

    def pay(self, step: int, under_way: Collection[RobotId]) -> None:
        """Bring the batteries of all but those ``under_way`` up to date."""
        for id, robot in enumerate(self._robots):
            if id not in under_way:
                spent = self._energy * (step - self._since[id])
                robot.battery.charge = max(0.0, self._held[id] - spent)
