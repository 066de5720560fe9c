"""Where everybody is, and who is on the air: kept up to date as robots drive and fail."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import dist, inf

import numpy as np

from fleet.faults import Blackout
from fleet.fleet import Fleet
from fleet.motion import Motion
from fleet.observer import Audience
from fleet.radio import Radio
from fleet.results import Ending
from fleet.robot import Robot, SeenRobot
from fleet.tally import RADIO, STANDING, Tally
from protocols.messages import Point, RobotId, View

REFRESH = 0.1  # links are at most so old while robots drive and anybody talks or beacons [s]


class Presence:
    """The fleet's robots as they are now, for the radio, the handler and observers.

    ``on_air`` lists the robots that can be talked to, ascending; ``view`` is what conversations
    see: the robots themselves, or, while many drive, all as of the last refresh.
    """

    def __init__(
        self,
        fleet: Fleet,
        radio: Radio,
        motion: Motion,
        audience: Audience,
        tally: Tally,
        *,
        many_drive: bool,
    ) -> None:
        self.view: View = fleet.robots
        self._seen = [SeenRobot(robot) for robot in fleet.robots] if many_drive else []
        if many_drive:
            self.view = self._seen
        self.on_air: list[RobotId] = [robot.id for robot in fleet.robots]
        self._fleet = fleet
        self._radio = radio
        self._motion = motion
        self._audience = audience
        self._tally = tally
        places = np.array([robot.position for robot in fleet.robots], float).reshape(-1, 2)
        self._x, self._y = places[:, 0].copy(), places[:, 1].copy()
        self._interval = REFRESH if radio.takes_time else inf  # [s]
        self._refreshed = 0.0  # since when nobody has moved unheard of [s]
        self._link_interval = audience.link_interval or inf  # [s]
        self._shown = 0.0  # when observers were last told [s]
        self._true_links = audience.present and radio.takes_time
        self._blackouts: list[Blackout] = []
        self._idle = fleet.spec.extra.idle  # [W]
        self._listening = fleet.spec.extra.listening  # [W]
        self._paid = [0.0] * len(fleet.robots)  # until when each has paid for standing [s]

    def slice_end(self, now: float, due: float) -> float:
        """How far to drive before links must be looked at again, at most to ``due`` [s]."""
        if not self._motion.moving:
            return due
        look = min(self._refreshed + self._interval, self._shown + self._link_interval)
        return min(due, max(now, look))

    def follow(self, now: float, arrived: Sequence[RobotId] = ()) -> None:
        """Robots have driven: tell the radio, and observers, where they are.

        What observers ask to see on the way changes nothing: a radio that takes time, whose
        robots only know what they have heard, is told in intervals of its own.
        """
        due = bool(arrived) or now >= self._refreshed + self._interval
        moved = [*self._motion.moving, *(self._fleet.robots[id] for id in arrived)]
        if due or not self._radio.takes_time:
            self._update(moved, now)
        if due:
            self.stand(now, arrived)
        if due or not self._radio.takes_time:
            self._radio.refresh(moved, now)
        if self._audience.present and moved:
            self._show(moved, now)

    def _update(self, moved: Iterable[Robot], now: float) -> None:
        """Keep where robots are."""
        for robot in moved:
            self._x[robot.id], self._y[robot.id] = robot.position
        for robot in moved if self._seen else ():
            self._seen[robot.id].position = robot.position
        if self._blackouts:
            self._listen_anew(now)
        self._refreshed = now

    def freshen(self, now: float) -> None:
        """Before anybody talks: links that are too old are brought up to date.

        Over a radio that takes no time neighbours always know where they are.
        """
        self.stand(now)
        late = not self._radio.takes_time or now >= self._refreshed + self._interval
        if late and self._motion.moving:
            self.follow(now)

    def stand(self, now: float, arrived: Sequence[RobotId] = ()) -> None:
        """Robots pay for their radios up to now, and idle power if they stand; those that stand
        and cannot are gone.

        Under way it is motion that pays the rest, for those who have just arrived too. Ask for
        this before somebody sets off.
        """
        moving, accounts = self._motion.moving, self._tally.accounts
        if not moving:
            self._refreshed = self._shown = now
        if not self._idle and not self._listening:
            return
        under_way = {*arrived, *(robot.id for robot in moving)}
        for robot in self._fleet.robots:
            time = now - self._paid[robot.id]
            if not robot.alive or time <= 0.0:
                continue
            self._paid[robot.id] = now
            if robot.on_air:
                accounts[RADIO] += robot.battery.drain(self._listening * time)
            if robot.id not in under_way:
                accounts[STANDING] += robot.battery.drain(self._idle * time)
                if robot.battery.charge == 0.0:
                    self.bury(robot, now)

    def bury(self, robot: Robot, now: float) -> None:
        """The robot is gone: its battery is empty, or it broke down altogether."""
        if robot.alive and robot.battery.charge == 0.0:
            self._audience.exhausted(robot.id, now)
        robot.alive = False
        self._x[robot.id] = self._y[robot.id] = np.nan
        self._update_air([robot], now)
        if self._true_links:
            self._fleet.topology.remove(robot.id)

    def black_out(self, blackout: Blackout, now: float) -> None:
        """The radio of a region falls silent."""
        self._blackouts.append(blackout)
        self._audience.blacked_out(blackout)
        self._listen_anew(now)

    def lift(self, blackout: Blackout, now: float) -> None:
        """The radio of a region is back."""
        self._blackouts.remove(blackout)
        self._audience.lifted(blackout)
        self._listen_anew(now)

    def nobody_nearer(self, site: Point, squared: float) -> bool:
        """Whether no living robot is nearer to ``site`` [m] than the root of ``squared``."""
        dx, dy = self._x - site[0], self._y - site[1]
        return not (dx * dx + dy * dy < squared).any()

    def why_nobody(self, site: Point) -> Ending:
        """Why no robot goes to ``site`` [m], by what the robots themselves believe."""
        robots = [robot for robot in self._fleet.robots if robot.on_air]
        if not robots:
            return "nobody on the air"
        robots = [robot for robot in robots if robot.able and not robot.engaged]
        if not robots:
            return "nobody can drive"
        per_metre = self._fleet.spec.power.per_metre(self._fleet.spec.cruise)
        charged = [r for r in robots if per_metre * dist(r.position, site) <= r.energy]
        if not charged:
            return "nobody has the energy"
        charged.sort(key=lambda robot: dist(robot.position, site))
        reachable = False
        for robot in charged:
            cost = robot.cost_to(site)
            if cost <= robot.energy:
                return "nobody was found"
            reachable = reachable or cost < inf
        return "nobody has the energy" if reachable else "nobody can reach the event"

    def _listen_anew(self, now: float) -> None:
        """Who is in a silent region, now that robots or regions have changed."""
        changed = []
        for robot in self._fleet.robots:
            silenced = any(blackout.covers(robot.position) for blackout in self._blackouts)
            if silenced != robot.silenced:
                robot.silenced = silenced
                changed.append(robot)
        self._update_air(changed, now)

    def _update_air(self, changed: Sequence[Robot], now: float) -> None:
        before = self.on_air
        for robot in changed:
            listed = robot.id in self.on_air
            if robot.on_air and not listed:
                self.on_air = sorted([*self.on_air, robot.id])
                self._radio.restore(robot)
            elif listed and not robot.on_air:
                self.on_air = [id for id in self.on_air if id != robot.id]
                self._radio.silence(robot)
        if self.on_air is not before:
            self._audience.air_changed(self.on_air, now)

    def show_plans(self, now: float) -> None:
        """Tell observers where robots are going to drive."""
        for robot, way in self._motion.plans():
            self._audience.planned(robot, way, now)

    def _show(self, moved: Iterable[Robot], now: float) -> None:
        self._shown = now
        if self._true_links:
            for robot in moved:
                if robot.alive:
                    self._fleet.topology.move(robot.id, robot.position)
        self.show_plans(now)
        self._audience.moved(self._motion.samples())
        self._audience.relinked(now)
