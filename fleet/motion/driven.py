"""Robots that drive: along planned paths, at the speeds and with the turns of a real drive.

With an engine, forces move bodies in a physics space, and what they do is what happens; without,
robots go exactly as planned, and what that takes is worked out from the plan: the prediction.

Importing this module loads numba; pymunk is loaded only for an engine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import dist, floor, inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fleet.motion import Outcome, Trip
from fleet.motion.builds import builds_of
from fleet.motion.kernels.records import ARRIVED, EMPTY, TOUCHED, WAITING, Records
from fleet.motion.movers import Movers
from fleet.motion.options import DriveOptions
from fleet.motion.params import fine_substeps, ladder_of, params_of
from fleet.motion.planning import Planner, corners
from fleet.power import Battery
from fleet.robot import Robot, RobotSpec
from protocols.messages import Point, RobotId
from worlds.arena import Arena

if TYPE_CHECKING:
    from fleet.motion.engine import Engine

SAME_PLACE = 1e-6  # [m]


@dataclass(slots=True)
class _Voyage:
    """A trip in progress."""

    robot: Robot
    slot: int
    origin: Point  # [m]
    site: Point  # [m]
    planned: float  # length of the first plan [m]
    goal: Point  # of the last plan [m]
    departed: int  # [steps]
    replans: int = 0


class DrivenMotion:
    """Motion with bodies: ``engine`` says whether they can touch.

    Time goes in steps of ``options.dt``: ``now`` is a multiple of it, and :meth:`advance` leads
    to the last step not after its ``until``. A trip ends with a step.

    ``rng`` draws how each robot differs from what its controller believes.

    Raises:
        ValueError: the robot cannot drive at all, or traffic is free without an engine, so that
            nothing would keep bodies apart.
    """

    def __init__(
        self,
        spec: RobotSpec,
        arena: Arena,
        options: DriveOptions | None = None,
        *,
        engine: bool,
        sample_interval: float | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        self.spec = spec
        self.options = options or DriveOptions()
        if self.options.traffic == "free" and not engine:
            raise ValueError("motion traffic is 'free' without an engine; expected 'reserved'")
        self._arena = arena
        self._with_engine = engine
        self._rng = rng or np.random.default_rng(0)
        self._params = params_of(spec, self.options, sample_interval)
        self._fine = fine_substeps(spec, self.options)
        self._substeps = 1
        self._stopping: set[int] = set()  # slots of those that brake, to plan anew
        self._tread()
        self._eq1 = spec.power.per_metre(spec.cruise)  # [J/m]
        self._step = 0
        self._voyages: list[_Voyage] = []  # in order of departure, as the next two
        self._robots: list[Robot] = []
        self._batteries: list[Battery] = []
        self._under_way: set[RobotId] = set()
        self._over: list[Trip] = []
        self._watched = sample_interval is not None
        self._plans: list[tuple[RobotId, NDArray[np.float64]]] = []

    @property
    def now(self) -> float:
        """The time that robots have been driven up to [s]: whole steps."""
        return self._step * self.options.dt

    @property
    def moving(self) -> Sequence[Robot]:
        """The robots under way, by departure; those that wait to set off too."""
        return tuple(self._robots)

    def place(self, robots: Sequence[Robot]) -> None:
        """Put the fleet on the floor, where the robots say they are. Once, before all else.

        Raises:
            ValueError: a robot overlaps another one, an obstacle or a wall.
        """
        points = [robot.position for robot in robots]
        ladder = ladder_of(self.spec, self.options)
        self._planner = Planner(self._arena, self.spec.radius, points, ladder)
        builds = builds_of(self.spec, len(robots), self._rng)
        self._engine = self._make_engine(builds, robots) if self._with_engine else None
        self._movers = Movers(self._params, builds, self._planner.floor, self._engine)
        self._facing = [robot.heading for robot in robots]  # [rad], not wrapped

    def _make_engine(self, builds: Records, robots: Sequence[Robot]) -> Engine:
        from fleet.motion.engine import Engine

        radius, bridge = self.spec.radius, self.options.bridge
        return Engine(self._arena, radius, builds, robots, bridge=bridge)

    def cost(self, robot: Robot, site: Point) -> float:
        """The energy that ``robot`` believes going to ``site`` [m] takes [J], by the options.

        inf: there is no path, or it is under way.
        """
        options = self.options
        if robot.id in self._under_way:
            return inf
        straight = self._eq1 * dist(robot.position, site)
        if options.belief == "straight" and not options.reachability:
            return straight
        plan = self._planner.plan(robot.id, robot.position, site)
        if plan.segments is None:
            return inf
        if options.belief == "driven":
            return self._movers.rollout(robot.position, self._facing[robot.id], plan.segments)
        if options.belief == "corrected":
            per_metre = self._eq1 if options.per_metre is None else options.per_metre
            return per_metre * plan.length + options.per_launch
        return straight if options.belief == "straight" else self._eq1 * plan.length

    def depart(self, robot: Robot, site: Point) -> None:
        """Send the robot to ``site`` [m] now. If there is no path, its trip is over at once.

        Raises:
            ValueError: it is under way.
        """
        if robot.id in self._under_way:
            raise ValueError(f"robot {robot.id} is under way; expected one that rests")
        plan = self._planner.plan(robot.id, robot.position, site)
        if plan.segments is None:
            here, now = robot.position, self.now
            trip = Trip(robot.id, "no path", here, site, here, now, now, path=0.0, energy=0.0)
            self._over.append(trip)
            return
        slot = self._movers.depart(
            robot.id, robot.position, self._facing[robot.id], robot.battery.charge,
            plan.segments, self._step,
        )  # fmt: skip
        self._planner.changed()
        if self._watched and len(plan.segments) > 1:
            self._plans.append((robot.id, corners(plan.segments)))
        self._under_way.add(robot.id)
        self._robots.append(robot)
        self._batteries.append(robot.battery)
        self._voyages.append(
            _Voyage(robot, slot, robot.position, site, plan.length, plan.goal, self._step)
        )
        if not len(plan.segments):
            self._finish({len(self._voyages) - 1: "arrived"})

    def advance(self, until: float) -> Sequence[Trip]:
        """Drive on until trips end, at the latest to the last step not after ``until`` [s]."""
        last = self._last_step(until)
        if self.spec.extra.transmission:
            for voyage, battery in zip(self._voyages, self._batteries, strict=True):
                self._movers.hold(voyage.slot, battery.charge)
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
                ended: dict[int, Outcome] = {place: "broken down"}
                self._stand(voyage)
                if self.options.traffic == "reserved":
                    ended |= self._plan_anew(self._make_way(voyage))
                self._finish(ended)
                self._tread()
                return

    def stop(self) -> Sequence[Trip]:
        """The run is over: the trips of all who are under way, "cut off" as they are."""
        self._finish(dict.fromkeys(range(len(self._voyages)), "cut off"))
        trips, self._over = self._over, []
        return trips

    def plans(self) -> Sequence[tuple[RobotId, NDArray[np.float64]]]:
        """Ways planned since the last call: those that bend, and all that were planned anew."""
        plans, self._plans = self._plans, []
        return plans

    def samples(self) -> NDArray[np.float64]:
        """Poses under way since the last call, by time and robot."""
        return self._movers.samples()

    def _last_step(self, until: float) -> int:
        """The last step not after ``until``, within rounding."""
        return 2**62 if until == inf else floor(until / self.options.dt + 1e-6)

    def _report(self) -> None:
        """Tell the robots where they are and what their batteries hold."""
        poses = self._movers.poses().tolist()
        for robot, battery, (x, y, heading, charge) in zip(
            self._robots, self._batteries, poses, strict=True
        ):
            robot.position = x, y
            robot.heading = heading
            battery.charge = charge

    def _look_after(self, over: Sequence[tuple[int, int]]) -> None:
        """See to the trips that are over, and to those that cannot go on as planned: places in
        the order of departure, and phases.
        """
        ended: dict[int, Outcome] = {}
        anew: list[_Voyage] = []
        for place, phase in over:
            voyage = self._voyages[place]
            if phase == EMPTY:
                ended[place] = "battery empty"
                anew += self._check_rest(voyage)
            elif phase == ARRIVED and voyage.slot not in self._stopping:
                ended[place] = "arrived"
            elif phase == TOUCHED:
                self._stop(voyage)
                anew += self._make_way(voyage)
            else:
                anew.append(voyage)
        self._finish(ended | self._plan_anew(anew))
        self._tread()

    def _plan_anew(self, voyages: Sequence[_Voyage]) -> dict[int, Outcome]:
        """Let robots go on to their sites by other paths; those that cannot, by place."""
        ended: dict[int, Outcome] = {}
        for voyage in {voyage.slot: voyage for voyage in voyages}.values():
            outcome = self._try_anew(voyage)
            if outcome is not None:
                self._stand(voyage)
                ended[self._voyages.index(voyage)] = outcome
        return ended

    def _try_anew(self, voyage: _Voyage) -> Outcome | None:
        robot, slot = voyage.robot, voyage.slot
        self._stopping.discard(slot)
        voyage.replans += 1
        if voyage.replans > self.options.replans:
            return "stuck"
        if self.options.traffic == "reserved":
            self._stand(voyage)
            plan = self._planner.plan(robot.id, robot.position, voyage.site)
        else:
            stopped = self._movers.stopped(slot)
            plan = self._planner.plan_among(stopped, robot.id, robot.position, voyage.site)
        if plan.segments is None:
            return "stuck"
        voyage.goal = plan.goal
        if not len(plan.segments):
            return "arrived"
        self._movers.resume(slot, plan.segments, self._step)
        self._planner.changed()
        if self._watched:
            self._plans.append((robot.id, corners(plan.segments)))
        return None

    def _stand(self, voyage: _Voyage) -> None:
        """The robot stands where it is, and rests there for all that others know."""
        self._movers.stand(voyage.slot, self._step)
        self._planner.changed()
        if self._engine is not None:
            self._engine.park(voyage.robot.id)

    def _tread(self) -> None:
        """Take finer steps where bodies may touch: where nobody keeps them apart, or where some
        had to stop against their reservations.
        """
        substeps = self._fine if self._stopping or self.options.traffic == "free" else 1
        if substeps != self._substeps:
            self._params[0]["substeps"] = self._substeps = substeps

    def _stop(self, voyage: _Voyage) -> None:
        """Let a robot brake on its path, to plan anew from there."""
        self._stopping.add(voyage.slot)
        self._movers.stop_short(voyage.slot, self._step)
        self._planner.changed()

    def _check_rest(self, voyage: _Voyage) -> list[_Voyage]:
        """If a robot has died elsewhere than foreseen, others must make way."""
        foreseen = self._planner.resting_place(voyage.robot.id)
        if self.options.traffic == "free" or dist(foreseen, voyage.robot.position) < SAME_PLACE:
            return []
        self._stand(voyage)
        return self._make_way(voyage)

    def _make_way(self, obstacle: _Voyage) -> list[_Voyage]:
        """Stop all whose reserved ways lead where a robot stands or stops against its own
        reservation, and all whose ways these block in turn. Those that had not set off yet must
        plan anew: they are returned.
        """
        by_slot = {voyage.slot: voyage for voyage in self._voyages}
        queue, seen = [obstacle.slot], {obstacle.slot}
        waiting = []
        while queue:
            for slot in self._movers.blocked_by(queue.pop(0), self._step):
                phase = self._movers.phase(slot)
                if slot in seen or phase >= ARRIVED:
                    continue
                if phase == WAITING:
                    self._stand(by_slot[slot])
                    waiting.append(by_slot[slot])
                else:
                    self._stop(by_slot[slot])
                seen.add(slot)
                queue.append(slot)
        return waiting

    def _finish(self, outcomes: Mapping[int, Outcome]) -> None:
        """Trips, by place in the order of departure, are over: park the robots where they are."""
        for place, outcome in outcomes.items():
            voyage = self._voyages[place]
            robot = voyage.robot
            trip, heading = self._trip(voyage, outcome)
            self._over.append(trip)
            self._facing[robot.id] = heading
            self._planner.rest(robot.id, robot.position)
            self._under_way.discard(robot.id)
            self._stopping.discard(voyage.slot)
        self._movers.leave(list(outcomes))
        for place in sorted(outcomes, reverse=True):
            del self._voyages[place], self._robots[place], self._batteries[place]

    def _trip(self, voyage: _Voyage, outcome: Outcome) -> tuple[Trip, float]:
        """The trip that is over, and where the robot faces [rad], not wrapped."""
        dt = self.options.dt
        driven = self._movers.driven(voyage.slot)
        trip = Trip(
            voyage.robot.id,
            outcome,
            voyage.origin,
            voyage.site,
            (driven.x, driven.y),
            voyage.departed * dt,
            self.now,
            driven.path,
            driven.spent,
            voyage.planned,
            dist(voyage.goal, voyage.site),
            driven.waited * dt,
            driven.steps,
            driven.contacts,
            self._movers.accounts(voyage.slot),
        )
        return trip, driven.heading
