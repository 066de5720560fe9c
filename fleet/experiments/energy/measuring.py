"""The work of the energy study's tasks: robots drive, and every trip becomes a row.

Both work functions are in this one file, so that a change of either, or of what a row holds, makes
results of before a thing of the past.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, dist, fsum, inf, pi, sin
from typing import Any

import numpy as np

from fleet.assembly import run, streams
from fleet.experiments.energy.settings import SHORTEST
from fleet.fleet import Fleet
from fleet.motion import Motion, Trip
from fleet.observer import Observer
from fleet.placement import start
from fleet.power import Battery
from fleet.results import Summary
from fleet.robot import Appraisal, Robot, RobotSpec
from fleet.scenario.choices import make_motion, make_world
from fleet.scenario.loading import scenario_from
from fleet.study.job import Job
from protocols.messages import Event, Point, RobotId
from worlds.ground import Ground, ground_of

Row = dict[str, Any]


def drive_tasks(job: Job) -> Row:
    """So many trips, one after the other, of random robots of one random placement.

    Straight distances are uniform from :data:`settings.SHORTEST` to the ``longest`` that the job
    says [m], in all directions that stay on free floor. Who has arrived stays there.
    """
    scenario = scenario_from(job.scenario["scenario"])
    world, random = make_world(scenario.world), streams(scenario.seed)
    ground = ground_of(world.arena, scenario.robot.radius, world.start)
    points = start(world, ground, scenario, random["placement"])
    motion = make_motion(scenario.motion, scenario.robot, world.arena, None)
    headings = random["heading"].uniform(-pi, pi, len(points)).tolist()
    robots = [
        Robot(id, point, heading, Battery(scenario.robot.capacity), inf, [], motion)
        for id, (point, heading) in enumerate(zip(points, headings, strict=True))
    ]
    motion.place(robots)
    errands = _errands(robots, ground, job.scenario["longest"], random["sites"])
    rows = [_driven(next(errands), motion, scenario.robot) for _ in range(job.scenario["tasks"])]
    return {"trips": len(rows), "tables": {"trips": rows}}


def play(job: Job) -> Row:
    """A scenario as it is; its summary, what failed trips took, and its trips if asked for."""
    log = TripLog()
    scenario, choices = scenario_from(job.scenario), ChoiceLog()
    foreseen = scenario.motion.parameters.get("belief") == "driven"
    summary = run(scenario, [log, choices] if foreseen else [log]).as_dict()
    row = summary | {"energy_failed": log.failed, "unbroken": log.unbroken}
    if foreseen:
        row |= {"choices": choices.made, "misled": choices.misled, "regret": choices.regret}
    return row | {"tables": {"trips": log.rows if "trips" in job.tables else []}}


class ChoiceLog(Observer):
    """How often Eq. (1) would choose another robot than the cost that is foreseen.

    Robots must bid by the latter. Those count that were asked and that can afford the trip; the
    one with the most energy left after it is chosen, as the paper's metric has it.
    """

    def __init__(self) -> None:
        self.made = 0  # choices among two robots or more
        self.misled = 0  # of these, where Eq. (1) chooses another one
        self.regret = 0.0  # energy that its choices have left less, in all [J]

    def run_started(self, fleet: Fleet) -> None:
        """Everybody is in place."""
        self._fleet = fleet

    def appraised(self, event: Event, appraisals: Sequence[Appraisal], time: float) -> None:
        """Choose twice among those who were asked."""
        able = [one for one in appraisals if one.cost <= one.energy]
        if len(able) < 2:
            return
        spec = self._fleet.spec
        rate = spec.power.per_metre(spec.cruise)

        def said(one: Appraisal) -> float:
            here = self._fleet.robots[one.robot].position
            return one.energy - rate * dist(here, event.position)

        best = max(able, key=lambda one: one.energy - one.cost)
        taken = max(able, key=said)
        self.made += 1
        self.misled += taken.robot != best.robot
        self.regret += (best.energy - best.cost) - (taken.energy - taken.cost)


class TripLog(Observer):
    """A row for each trip, and what trips that failed took."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self.failed = 0.0  # drained on trips that ended short of their event [J]
        self.unbroken = 0  # events served before the first such trip
        self._set_off: dict[RobotId, tuple[float, float]] = {}  # charge [J], heading [rad]
        self._served = 0
        self._broken = False

    def run_started(self, fleet: Fleet) -> None:
        """Everybody is in place."""
        self._fleet = fleet

    def departed(self, event: Event, robot: RobotId, time: float) -> None:
        """Keep what the robot has."""
        one = self._fleet.robots[robot]
        self._set_off[robot] = one.battery.charge, one.heading

    def trip_ended(self, event: Event, trip: Trip) -> None:
        """A row."""
        charge, heading = self._set_off.pop(trip.robot)
        spec = self._fleet.spec
        drained = charge - self._fleet.robots[trip.robot].battery.charge
        self.rows.append(row_of(trip, heading, drained, spec))
        self._served += trip.outcome == "arrived"
        if trip.outcome != "arrived":
            self.failed += trip.energy
            self._broken = True
        elif not self._broken:
            self.unbroken += 1

    def run_ended(self, summary: Summary) -> None:
        """All trips are over."""


def row_of(trip: Trip, heading: float, drained: float, spec: RobotSpec) -> Row:
    """One trip: what Eq. (1) says of it, what was drained, and what for. In m, s, J and rad."""
    (x0, y0), (x1, y1) = trip.origin, trip.site
    straight = dist(trip.origin, trip.site)
    bearing = float(np.arctan2(y1 - y0, x1 - x0))
    accounts, path = trip.accounts, spec.power.per_metre(spec.cruise) * trip.path
    return {
        "outcome": trip.outcome,
        "straight": straight,
        "planned": trip.planned,
        "path": trip.path,
        "turn": abs((bearing - heading + pi) % (2.0 * pi) - pi),  # to face the site
        "per_metre": spec.power.per_metre(spec.cruise),  # [J/m] of Eq. (1)
        "drained": drained,  # from the battery
        "energy_path": path,
        "energy_launch": fsum(accounts)
        - path
        - accounts.scrub
        - accounts.waiting
        - accounts.contact,
        "energy_scrub": accounts.scrub,
        "energy_waiting": accounts.waiting,
        "energy_contact": accounts.contact,
        "waited": trip.waited,
        "contacts": trip.contacts,
        "offset": trip.offset,
    }


def _errands(
    robots: list[Robot], ground: Ground, longest: float, rng: np.random.Generator
) -> Iterator[tuple[Robot, Point]]:
    """A robot and a free site at a random distance and in a random direction, again and again."""
    while True:
        distance = float(rng.uniform(SHORTEST, longest))
        for _ in range(1000):
            robot = robots[int(rng.integers(len(robots)))]
            direction = float(rng.uniform(-pi, pi))
            x = robot.position[0] + distance * cos(direction)
            y = robot.position[1] + distance * sin(direction)
            inside = 0.0 < x < ground.arena.width and 0.0 < y < ground.arena.height
            if inside and ground.holds(np.array([[x, y]]))[0]:
                yield robot, (x, y)
                break


def _driven(errand: tuple[Robot, Point], motion: Motion, spec: RobotSpec) -> Row:
    robot, site = errand
    charge, heading = robot.battery.charge, robot.heading
    motion.depart(robot, site)
    (trip,) = motion.advance(inf)
    return row_of(trip, heading, charge - robot.battery.charge, spec)
