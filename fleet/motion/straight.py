"""Motion as the paper has it: straight to the event at cruise speed, through everything."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import atan2, dist, floor

import numpy as np
from numpy.typing import NDArray

from fleet.motion import SAMPLE_FIELDS, Accounts, Outcome, Trip
from fleet.robot import Robot, RobotSpec
from protocols.messages import Point, RobotId


@dataclass(frozen=True, slots=True)
class _Leg:
    """A robot under way at constant speed, as far as its battery lasts."""

    robot: Robot
    origin: Point  # [m]
    site: Point  # [m]
    end: Point  # [m]
    departed: float  # [s]
    ends: float  # [s]
    charge: float  # at departure [J]
    energy: float  # that the whole leg takes [J]
    outcome: Outcome

    def share(self, time: float) -> float:
        """How much of the leg is driven at ``time`` [s], in [0, 1]."""
        return 1.0 if time >= self.ends else (time - self.departed) / (self.ends - self.departed)


class StraightMotion:
    """Points at constant speed; Eq. (1) holds exactly. Robots pass through one another."""

    def __init__(self, spec: RobotSpec, sample_interval: float | None = None) -> None:
        self.now = 0.0  # [s]
        self._cruise = spec.cruise
        self._power = spec.power
        self._per_metre = spec.power.per_metre(spec.cruise)
        self._interval = sample_interval
        self._legs: list[_Leg] = []
        self._samples: list[NDArray[np.float64]] = []

    @property
    def moving(self) -> Sequence[Robot]:
        """The robots under way."""
        return [leg.robot for leg in self._legs]

    def place(self, robots: Sequence[Robot]) -> None:
        """Nothing to do: points need no room."""

    def cost(self, robot: Robot, site: Point) -> float:
        """Eq. (1) on the straight line [J]."""
        return self._per_metre * dist(robot.position, site)

    def depart(self, robot: Robot, site: Point) -> None:
        """Send the robot to ``site`` [m] now."""
        origin, charge = robot.position, robot.battery.charge
        length = dist(origin, site)
        energy = self._per_metre * length
        end = site
        outcome: Outcome = "arrived"
        if energy > charge:
            reached = charge / energy
            end = _along(origin, site, reached)
            length, energy, outcome = reached * length, charge, "battery empty"
        robot.heading = atan2(site[1] - origin[1], site[0] - origin[0])
        self._legs.append(
            _Leg(
                robot,
                origin,
                site,
                end,
                self.now,
                self.now + length / self._cruise,
                charge,
                energy,
                outcome,
            )
        )

    def advance(self, until: float) -> Sequence[Trip]:
        """Drive on to the next end of a trip, at the latest to the time ``until`` [s]."""
        before = self.now
        self._legs = [self._as_it_lasts(leg) for leg in self._legs]
        self.now = min(until, min((leg.ends for leg in self._legs), default=until))
        trips, under_way = [], []
        for leg in self._legs:
            self._sample(leg, before)
            share = leg.share(self.now)
            robot = leg.robot
            if share < 1.0:
                robot.position = _between(leg, share)
                robot.battery.charge = leg.charge - share * leg.energy
                under_way.append(leg)
                continue
            robot.position = leg.end
            robot.battery.charge = leg.charge - leg.energy
            trips.append(
                Trip(
                    robot.id,
                    leg.outcome,
                    leg.origin,
                    leg.site,
                    leg.end,
                    leg.departed,
                    leg.ends,
                    dist(leg.origin, leg.end),
                    leg.energy,
                    planned=dist(leg.origin, leg.site),
                    accounts=self._accounts(leg),
                )
            )
        self._legs = under_way
        return trips

    def halt(self, robot: Robot) -> None:
        """The robot's motor fails: its leg ends here and now."""
        for k, leg in enumerate(self._legs):
            if leg.robot is robot:
                self._legs[k] = self._cut_short(leg, "broken down")

    def stop(self) -> Sequence[Trip]:
        """The run is over: the trips of all who are under way, "cut off" as they are."""
        self._legs = [self._cut_short(leg, "cut off") for leg in self._legs]
        return self.advance(self.now)

    def _cut_short(self, leg: _Leg, outcome: Outcome) -> _Leg:
        """The leg, ended here and now."""
        share = leg.share(self.now)
        end, energy = _between(leg, share), share * leg.energy
        return replace(leg, end=end, ends=self.now, energy=energy, outcome=outcome)

    def _accounts(self, leg: _Leg) -> Accounts:
        """The three terms of Eq. (1)."""
        time = leg.energy / self._power.power(self._cruise)
        return Accounts(
            electronics=self._power.constant * time,
            rolling=self._power.linear * self._cruise * time,
            viscous=self._power.quadratic * self._cruise**2 * time,
        )

    def _as_it_lasts(self, leg: _Leg) -> _Leg:
        """The leg as the battery lasts, if it has paid for other things on the way, as talk."""
        other = leg.charge - leg.share(self.now) * leg.energy - leg.robot.battery.charge
        if other == 0.0:
            return leg
        charge = leg.charge - other
        if leg.energy <= charge:
            return replace(leg, charge=charge)
        share = charge / leg.energy
        return replace(
            leg, charge=charge, energy=charge, outcome="battery empty", end=_between(leg, share),
            ends=leg.departed + share * (leg.ends - leg.departed),
        )  # fmt: skip

    def plans(self) -> Sequence[tuple[RobotId, NDArray[np.float64]]]:
        """None: the line to the site is all there is."""
        return ()

    def samples(self) -> NDArray[np.float64]:
        """Poses under way since the last call, by time."""
        if not self._samples:
            return np.empty((0, len(SAMPLE_FIELDS)))
        rows = np.vstack(self._samples)
        self._samples.clear()
        return rows[np.lexsort((rows[:, 0], rows[:, 1]))]

    def _sample(self, leg: _Leg, after: float) -> None:
        """Keep the leg's poses on the grid of its own clock in (``after``, now], and its end."""
        if self._interval is None:
            return
        first = floor((after - leg.departed) / self._interval) + 1
        last = floor((min(self.now, leg.ends) - leg.departed) / self._interval)
        times = leg.departed + self._interval * np.arange(first, last + 1)
        if leg.ends <= self.now:
            times = np.append(times[times < leg.ends], leg.ends)
        share = np.array([leg.share(time) for time in times.tolist()])
        (ax, ay), (bx, by) = leg.origin, leg.end
        rows = np.empty((len(times), len(SAMPLE_FIELDS)))
        rows[:, 0] = leg.robot.id
        rows[:, 1] = times
        rows[:, 2] = ax + share * (bx - ax)
        rows[:, 3] = ay + share * (by - ay)
        rows[:, 4] = leg.robot.heading
        rows[:, 5] = leg.charge - share * leg.energy
        rows[:, 6:8] = rows[:, 2:4]
        self._samples.append(rows)


def _between(leg: _Leg, share: float) -> Point:
    return _along(leg.origin, leg.end, share)


def _along(a: Point, b: Point, share: float) -> Point:
    return (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
