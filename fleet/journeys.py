"""Who is under way to what, what for, and what the drives add up to."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import dist
from typing import NamedTuple

from fleet.fleet import Fleet
from fleet.motion import Motion, Trip
from fleet.observer import Audience
from fleet.presence import Presence
from fleet.robot import Robot
from fleet.tally import Tally
from fleet.tasks import State, Task
from protocols.messages import Move, RobotId


class Journey(NamedTuple):
    """What a robot was sent for."""

    task: Task
    relocation: bool = False  # to a place that is no event, as an award has asked
    carries: bool = False  # and the robot takes the task along, to tell of it there


@dataclass(slots=True, eq=False)
class Journeys:
    """Sends robots off and counts what they have done once they are back at rest."""

    fleet: Fleet
    motion: Motion
    presence: Presence
    audience: Audience
    tally: Tally
    _under_way: dict[RobotId, Journey] = field(default_factory=dict, init=False)
    _since: dict[RobotId, float] = field(default_factory=dict, init=False)  # engaged [s]

    def __bool__(self) -> bool:
        """Whether anybody is under way."""
        return bool(self._under_way)

    def send(self, robot: Robot, task: Task, now: float) -> None:
        """The robot sets off to an event."""
        self.presence.stand(now)
        task.state, task.taken = State.TAKEN, now
        self._engage(robot, Journey(task), now)
        self.audience.departed(task.event, robot.id, now)
        self.motion.depart(robot, task.event.position)
        self.presence.show_plans(now)

    def relocate(self, move: Move, task: Task, now: float, *, carries: bool) -> bool:
        """A robot sets off to a place that is no event, if it can."""
        robot = self.fleet.robots[move.robot]
        if robot.engaged or not robot.able or not robot.alive:
            return False
        self.presence.stand(now)
        self.tally.relocations += 1
        self._engage(robot, Journey(task, relocation=True, carries=carries), now)
        self.audience.relocating(task.event, move, now)
        self.motion.depart(robot, move.position)
        self.presence.show_plans(now)
        return True

    def ended(self, trip: Trip, now: float) -> Journey:
        """A trip has ended: count it; what it was for. The robot stays engaged."""
        robot, tally, spec = self.fleet.robots[trip.robot], self.tally, self.fleet.spec
        tally.predicted += spec.power.per_metre(spec.cruise) * dist(trip.origin, trip.site)
        tally.distance += dist(trip.origin, trip.end)
        tally.path += trip.path
        tally.pay_for(trip)
        if trip.outcome != "arrived":
            robot.failed_sites.add(trip.site)
        if robot.battery.charge == 0.0:
            self.presence.bury(robot, now)
        journey = self._under_way.pop(robot.id)
        if journey.relocation:
            self.audience.relocated(journey.task.event, trip)
        else:
            self.audience.trip_ended(journey.task.event, trip)
            tally.failed += trip.outcome != "arrived"
        return journey

    def release(self, robot: Robot, now: float) -> None:
        """The robot is free again."""
        robot.engaged = False
        self.tally.engaged += now - self._since.pop(robot.id)

    def break_down(self, robot: Robot) -> None:
        """The robot's motor fails: it stops where it is."""
        robot.able = False
        if robot.id in self._under_way:
            self.motion.halt(robot)

    def break_off(self, now: float) -> None:
        """The run is over: whoever is under way stops, and what that has cost is counted."""
        for trip in self.motion.stop():
            self.tally.pay_for(trip)
        for id in list(self._since):
            self.release(self.fleet.robots[id], now)

    def _engage(self, robot: Robot, journey: Journey, now: float) -> None:
        robot.engaged = True
        self._since[robot.id] = now
        self._under_way[robot.id] = journey
