"""Robots that drive: along planned paths, at the speeds and with the turns of a real drive.

With an engine, bodies move in a physics space; without, they go where they are commanded to.
Both run the same compiled loop and agree to the bit as long as nothing touches.

Importing this module loads numba.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import dist, floor, inf, tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fleet.energy import Battery
from fleet.motion import Outcome, Trip
from fleet.motion.engine import Engine
from fleet.motion.kernels.records import ARRIVED, EMPTY, LOST, TOUCHED, WAITING
from fleet.motion.law import law_of
from fleet.motion.movers import Movers
from fleet.motion.options import DriveOptions
from fleet.motion.planning import Plan, Planner
from fleet.robot import Robot, RobotSpec
from protocols.messages import Point, RobotId
from worlds.arena import Arena

SAME_PLACE = 1e-6  # [m]


@dataclass(slots=True)
class _Voyage:
    """A trip in progress."""

    robot: Robot
    battery: Battery
    slot: int
    origin: Point  # [m]
    site: Point  # [m]
    plan: Plan  # the first one
    departed: int  # [steps]
    replans: int = 0
    stopping: bool = False  # it brakes, to plan anew


class DrivenMotion:
    """Motion with bodies: ``engine`` says whether they can touch.

    Time goes in steps of ``options.dt``: ``now`` is a multiple of it, and :meth:`advance` leads
    to the last step not after its ``until``. A trip ends with a step.

    Raises:
        ValueError: free traffic without an engine: nothing would keep bodies apart.
    """

    def __init__(
        self,
        spec: RobotSpec,
        arena: Arena,
        options: DriveOptions | None = None,
        *,
        engine: bool,
        sample_interval: float | None = None,
    ) -> None:
        self.spec = spec
        self.options = options or DriveOptions()
        if self.options.traffic == "free" and not engine:
            raise ValueError("motion traffic is 'free' without an engine; expected 'reserved'")
        self._arena = arena
        self._with_engine = engine
        self._law = law_of(spec, self.options, sample_interval)
        self._eq1 = spec.power.per_metre(spec.cruise)  # [J/m]
        self._step = 0
        self._voyages: list[_Voyage] = []  # in order of departure
        self._under_way: set[RobotId] = set()
        self._over: list[Trip] = []

    @property
    def now(self) -> float:
        """The time that robots have been driven up to [s]: whole steps."""
        return self._step * self.options.dt

    @property
    def moving(self) -> Sequence[Robot]:
        """The robots under way, by departure; those that wait to set off too."""
        return [voyage.robot for voyage in self._voyages]

    def place(self, robots: Sequence[Robot]) -> None:
        """Put the fleet on the floor, where the robots say they are. Once, before all else.

        Raises:
            ValueError: a robot overlaps another one, an obstacle or a wall.
        """
        points = [robot.position for robot in robots]
        ladder = self.options.ladder(self.spec)
        self._planner = Planner(self._arena, self.spec.radius, points, ladder)
        self._engine = (
            Engine(self._arena, self.spec, robots, bridge=self.options.bridge)
            if self._with_engine
            else None
        )
        self._movers = Movers(self._law, self._planner.floor, self._engine)
        self._facing = [robot.heading for robot in robots]  # [rad], not wrapped
        self._robots = robots

    def cost(self, robot: Robot, site: Point) -> float:
        """The energy that ``robot`` believes going to ``site`` [m] takes [J], by the options.

        inf: there is no path, or it is under way.
        """
        options = self.options
        if robot.id in self._under_way:
            return inf
        if options.belief == "straight" and not options.reachability:
            return self._eq1 * dist(robot.position, site)
        plan = self._planner.plan(robot.id, robot.position, site)
        if plan.pieces is None:
            return inf
        if options.belief == "straight":
            return self._eq1 * dist(robot.position, site)
        if options.belief == "path":
            return self._eq1 * plan.length
        per_metre = self._eq1 if options.per_metre is None else options.per_metre
        return per_metre * plan.length + options.per_launch

    def depart(self, robot: Robot, site: Point) -> None:
        """Send the robot to ``site`` [m] now. If there is no path, its trip is over at once.

        Raises:
            ValueError: it is under way.
        """
        if robot.id in self._under_way:
            raise ValueError(f"robot {robot.id} is under way; expected one that rests")
        plan = self._planner.plan(robot.id, robot.position, site)
        if plan.pieces is None:
            self._over.append(
                Trip(
                    robot.id, "no path", robot.position, site, robot.position,
                    self.now, self.now, 0.0, 0.0, offset=dist(robot.position, site),
                )  # fmt: skip
            )
            return
        slot = self._movers.depart(
            robot.id, robot.position, self._facing[robot.id], robot.battery.charge,
            plan.pieces, self._step,
        )  # fmt: skip
        self._planner.changed()
        self._under_way.add(robot.id)
        self._voyages.append(
            _Voyage(robot, robot.battery, slot, robot.position, site, plan, self._step)
        )
        if not len(plan.pieces):
            self._finish({len(self._voyages) - 1: "arrived"})

    def advance(self, until: float) -> Sequence[Trip]:
        """Drive on until trips end, at the latest to the last step not after ``until`` [s]."""
        last = self._last_step(until)
        while self._voyages and self._step < last and not self._over:
            made, over = self._movers.advance(self._step, last - self._step)
            self._step += made
            self._report()
            if over:
                self._look_after(over)
        if not self._voyages and not self._over and until < inf:
            self._step = max(self._step, last)
        trips, self._over = self._over, []
        return trips

    def halt(self, robot: Robot) -> None:
        """The robot's motor fails: it stops where it is, and its trip ends "broken down".

        In reserved traffic, those whose ways it blocks brake and plan anew. If they are too near
        for that, bodies may touch.
        """
        for place, voyage in enumerate(self._voyages):
            if voyage.robot is robot:
                self._movers.stand(voyage.slot, self._step)
                self._finish({place: "broken down"})
                return

    def samples(self) -> NDArray[np.float64]:
        """Poses under way since the last call, by time and robot."""
        rows = self._movers.samples()
        rows[:, 4] -= tau * np.floor((rows[:, 4] + 0.5 * tau) / tau)
        return rows[np.lexsort((rows[:, 0], rows[:, 1]))]

    def _last_step(self, until: float) -> int:
        """The last step not after ``until``, within rounding."""
        return 2**62 if until == inf else floor(until / self.options.dt + 1e-6)

    def _report(self) -> None:
        """Tell the robots where they are and what their batteries hold."""
        columns = self._movers.poses().T.tolist()
        points = zip(columns[0], columns[1], strict=True)
        for voyage, point, heading, charge in zip(
            self._voyages, points, columns[2], columns[3], strict=True
        ):
            robot = voyage.robot
            robot.position = point
            robot.heading = heading
            voyage.battery.charge = charge

    def _look_after(self, places: Sequence[int]) -> None:
        """See to the trips that are over, and to those that cannot go on as planned."""
        ended: dict[int, Outcome] = {}
        for place in places:
            voyage = self._voyages[place]
            phase = self._movers.phase(voyage.slot)
            if phase == EMPTY:
                ended[place] = "battery empty"
            elif phase == ARRIVED and not voyage.stopping:
                ended[place] = "arrived"
        self._finish(ended)

    def _finish(self, outcomes: Mapping[int, Outcome]) -> None:
        """Trips, by place in the order of departure, are over: park the robots where they are."""
        for place, outcome in outcomes.items():
            voyage = self._voyages[place]
            robot = voyage.robot
            state = self._movers.state(voyage.slot)
            self._over.append(self._trip(voyage, outcome, state))
            self._facing[robot.id] = state["heading"]
            self._planner.rest(robot.id, robot.position)
            if self._engine is not None:
                self._engine.park(robot.id)
            self._under_way.discard(robot.id)
        self._movers.leave(list(outcomes))
        self._voyages = [v for k, v in enumerate(self._voyages) if k not in outcomes]

    def _trip(self, voyage: _Voyage, outcome: Outcome, state: dict[str, Any]) -> Trip:
        dt = self.options.dt
        smooth = state["path"] - state["jostled"]
        contact = state["spent_adrift"] - self._eq1 * state["jostled"]
        driving = state["spent"] - state["spent_turning"] - state["spent_waiting"]
        return Trip(
            voyage.robot.id,
            outcome,
            voyage.origin,
            voyage.site,
            (state["x"], state["y"]),
            voyage.departed * dt,
            self.now,
            state["path"],
            state["spent"],
            voyage.plan.length,
            dist(voyage.plan.goal, voyage.site),
            state["waited"] * dt,
            state["steps"],
            state["contacts"],
            self._eq1 * state["path"],
            driving - state["spent_adrift"] - self._eq1 * smooth,
            state["spent_turning"],
            state["spent_waiting"],
            contact,
        )
