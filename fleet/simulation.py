"""The loop: events are told, talked over and driven to, one at a time, until nobody can."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import dist, fsum, inf, sqrt

from fleet.motion import Motion, Trip
from fleet.observer import Observer, Sent
from fleet.radio import IdealRadio
from fleet.results import Summary, Tally
from fleet.robot import Robot, RobotSpec
from protocols.geometry import squared_distance
from protocols.messages import KINDS, Award, Event, Point, ProtocolFunction, RobotId
from protocols.topology import Topology
from worlds.arena import Arena


@dataclass(frozen=True, slots=True)
class Labels:
    """What a run is called in its summary and in its recording."""

    protocol: str
    motion: str
    world: str
    seed: int
    search_radius: float  # [m]


@dataclass(frozen=True, slots=True)
class Fleet:
    """A fleet in its world, live: robots and topology change as the run goes on."""

    labels: Labels
    arena: Arena
    spec: RobotSpec
    robots: Sequence[Robot]
    topology: Topology


class Simulation:
    """One run of one scenario, in rounds: the next event comes when the robot has arrived.

    ``sites`` yields where events happen, ``shares`` numbers in [0, 1) that pick the
    collecting robot. ``rounds`` ends the run early; None: a whole network lifetime.
    """

    def __init__(
        self,
        fleet: Fleet,
        protocol: ProtocolFunction,
        radio: IdealRadio,
        motion: Motion,
        sites: Iterator[Point],
        shares: Iterator[float],
        *,
        rounds: int | None = None,
        observers: Sequence[Observer] = (),
    ) -> None:
        self.fleet = fleet
        self.tally = Tally()
        self._protocol = protocol
        self._radio = radio
        self._motion = motion
        self._sites = sites
        self._shares = shares
        self._rounds = inf if rounds is None else rounds
        self._observers = tuple(observers)
        self._on_air = list(range(len(fleet.robots)))
        self._number = 0
        self._link_interval = min((o.link_interval or inf for o in observers), default=inf)

    def run(self) -> Summary:
        """Play rounds until an event finds nobody, or the rounds are up."""
        started = time.perf_counter()
        try:
            self._tell(lambda o: o.run_started(self.fleet))
            while self.tally.served < self._rounds and self._round():
                pass
            summary = self._summary(time.perf_counter() - started)
            self._tell(lambda o: o.run_ended(summary))
            return summary
        finally:
            self._tell(lambda o: o.closed())

    def _round(self) -> bool:
        """One event, raised again while robots fail to reach it. False: nobody took it."""
        event = Event(self.tally.events, next(self._sites))
        self.tally.events += 1
        while self._on_air:
            source = self._on_air[int(next(self._shares) * len(self._on_air))]
            winner = self._converse(event, source).winner
            if winner is None:
                return False
            if self._drive(self.fleet.robots[winner], event).outcome == "arrived":
                self.tally.served += 1
                return True
            self.tally.failed += 1
        return False

    def _converse(self, event: Event, source: RobotId) -> Award:
        """Let the protocol talk its way from the collecting robot to an award."""
        now = self._motion.now
        self._tell(lambda o: o.event_raised(event, source, now))
        award = self._talk(event, source)
        self.tally.conversations += 1
        self.tally.closest += self._found_closest(event.position, award)
        self._tell(lambda o: o.awarded(event, award, now))
        return award

    def _talk(self, event: Event, source: RobotId) -> Award:
        conversation = self._protocol(self.fleet.robots, event, source)
        say, hear = conversation.send, self._radio.deliver
        kinds, observers, number = self.tally.kinds, self._observers, self._number
        heard = None
        try:
            while True:
                transmission = say(heard)  # type: ignore[arg-type]  # None starts a generator
                heard = hear(transmission)
                kinds[transmission.kind] += 1
                number += 1
                for observer in observers:
                    observer.sent(Sent(number, self._motion.now, event.id, transmission, heard))
        except StopIteration as end:
            award: Award = end.value
            return award
        finally:
            self._number = number

    def _found_closest(self, site: Point, award: Award) -> bool:
        robots = self.fleet.robots
        found = squared_distance(robots[award.auctioneer].position, site)
        if award.winner is not None:
            found = min(found, squared_distance(robots[award.winner].position, site))
        x, y = site
        for id in self._on_air:
            px, py = robots[id].position
            if (px - x) * (px - x) + (py - y) * (py - y) < found:
                return False
        return True

    def _drive(self, robot: Robot, event: Event) -> Trip:
        """Send the robot to the event and wait for the end of its trip."""
        motion = self._motion
        self._tell(lambda o: o.departed(event, robot.id, motion.now))
        motion.depart(robot, event.position)
        while not (trips := motion.advance(motion.now + self._link_interval)):
            self._relink(robot)
        (trip,) = trips
        self._settle(robot, event, trip)
        return trip

    def _settle(self, robot: Robot, event: Event, trip: Trip) -> None:
        """Count the trip, and let everybody know where the robot is now."""
        tally = self.tally
        straight = dist(trip.origin, trip.site)
        cruise = self.fleet.spec.cruise
        tally.predicted += self.fleet.spec.power.per_metre(cruise) * straight
        tally.distance += dist(trip.origin, trip.end)
        tally.path += trip.path
        if trip.outcome != "arrived":
            robot.failed_sites.add(trip.site)
        if robot.battery.charge == 0.0:
            robot.alive = False
            self._on_air.remove(robot.id)
        self._relink(robot)
        self._tell(lambda o: o.trip_ended(event, trip))

    def _relink(self, robot: Robot) -> None:
        """Bring the links up to date with a robot that moved, or fell silent."""
        if robot.alive:
            self.fleet.topology.move(robot.id, robot.position)
        else:
            self.fleet.topology.remove(robot.id)
        if self._observers:
            now, samples = self._motion.now, self._motion.samples()
            self._tell(lambda o: o.moved(samples))
            self._tell(lambda o: o.relinked(now))

    def _tell(self, hook: Callable[[Observer], None]) -> None:
        for observer in self._observers:
            hook(observer)

    def _summary(self, wall_time: float) -> Summary:
        fleet, tally, labels = self.fleet, self.tally, self.fleet.labels
        n = len(fleet.robots)
        left = [robot.battery.charge for robot in fleet.robots]
        initial = fsum(robot.battery.capacity for robot in fleet.robots)
        mean = fsum(left) / n
        by_kind: dict[str, int] = {kind: tally.kinds[kind] for kind in KINDS}
        messages = sum(by_kind.values())
        return Summary(
            protocol=labels.protocol,
            motion=labels.motion,
            world=labels.world,
            seed=labels.seed,
            robots=n,
            radio_range=fleet.topology.radio_range,
            search_radius=labels.search_radius,
            lifetime=tally.served,
            events=tally.events,
            served=tally.served,
            failed=tally.failed,
            messages=messages,
            messages_per_robot=messages / n,
            messages_by_kind=by_kind,
            hops_greedy=by_kind["route-greedy"],
            hops_face=by_kind["route-face"],
            energy_initial=initial,
            energy_predicted=tally.predicted,
            energy_drained=initial - fsum(left),
            energy_left_mean=mean,
            energy_left_min=min(left),
            energy_left_sd=sqrt(fsum((charge - mean) ** 2 for charge in left) / n),
            reactions_per_robot=tally.served / n,
            distance_per_robot=tally.distance / n,
            path_per_robot=tally.path / n,
            closest_found=tally.closest / max(tally.conversations, 1),
            simulated_time=self._motion.now,
            wall_time=wall_time,
        )
