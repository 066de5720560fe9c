"""The loop: events happen, are talked over and driven to, in rounds or as a stream."""

from __future__ import annotations

import time
from collections import deque
from functools import partial
from math import dist, inf

from fleet.agenda import Agenda
from fleet.conversations import Conversations
from fleet.dispatch import Dispatch, Dispatcher
from fleet.faults import Breakdown
from fleet.fleet import Fleet
from fleet.handler import Handler, Notice
from fleet.modes import Rounds, Stream
from fleet.motion import Motion, Trip
from fleet.observer import Audience
from fleet.presence import Presence
from fleet.radio import Radio
from fleet.results import Summary, Tally, summarise
from fleet.robot import Appraisal, Robot
from fleet.schedule import Schedule
from fleet.service import stream_figures
from fleet.tasks import State, Task, TaskBook
from protocols.geometry import squared_distance
from protocols.messages import Award, Event, Move, Point, ProtocolFunction, RobotId
from worlds.events import Occurrence


class Simulation:
    """One run of one scenario."""

    def __init__(
        self,
        fleet: Fleet,
        protocol: ProtocolFunction | Dispatcher,
        radio: Radio,
        motion: Motion,
        handler: Handler,
        schedule: Schedule,
        audience: Audience,
    ) -> None:
        self.fleet = fleet
        self.tally = Tally()
        self.book = TaskBook()
        self.now = 0.0  # [s]
        self._schedule = schedule
        self._handler = handler
        self._motion = motion
        self._audience = audience
        self._agenda = Agenda()
        many_drive = isinstance(schedule.timing, Stream)
        self._presence = Presence(fleet, radio, motion, audience, many_drive=many_drive)
        self._talks: Conversations | Dispatch
        if many_drive and isinstance(protocol, Dispatcher):
            self._talks = Dispatch(
                protocol, self._presence.view, radio, self._agenda, self.tally, self._concluded
            )
        else:
            self._talks = Conversations(
                protocol, self._presence.view, fleet.robots, radio, self._agenda, self.tally,
                audience, fleet.spec.extra.transmission, self._concluded, self._broken_off,
            )  # fmt: skip
        self._trips: dict[int, Task] = {}  # by robot: what it is under way to
        self._relocating: dict[int, tuple[Task, bool]] = {}  # by robot: why, and if it carries it
        self._since: dict[int, float] = {}  # by robot: since when it is engaged [s]
        self._in_hand: Task | None = None  # in rounds one task is attended to at a time,
        self._in_line: deque[Task] = deque()  # and others that one event raised wait in line
        self._over = False
        appraisals: dict[Point, dict[int, Appraisal]] | None = {} if audience.weighs else None
        for robot in fleet.robots:
            robot.appraisals = appraisals
        self._appraisals = appraisals

    def run(self) -> Summary:
        """Play to the end: of the network's life, of the rounds, or of the time."""
        started = time.perf_counter()
        try:
            self._audience.run_started(self.fleet)
            self._begin()
            while not self._over:
                self._go_on()
            self._presence.stand(self.now)
            for robot in list(self._since):
                self._release(self.fleet.robots[robot])
            summary = self._summary(time.perf_counter() - started)
            self._audience.run_ended(summary)
            return summary
        finally:
            self._audience.closed()

    def _begin(self) -> None:
        """Put down what is known to come."""
        schedule, agenda = self._schedule, self._agenda
        self._handler.meet(self.fleet.robots)
        for fault in schedule.breakdowns:
            agenda.at(fault.time, partial(self._break_down, fault))
        for blackout in schedule.blackouts:
            agenda.at(blackout.start, partial(self._presence.black_out, blackout, blackout.start))
            agenda.at(blackout.end, partial(self._presence.lift, blackout, blackout.end))
        if isinstance(schedule.timing, Stream):
            agenda.at(schedule.timing.duration, self._stop)
        self._expect()

    def _go_on(self) -> None:
        """Drive up to what is due next, or to the next end of a trip, and see to it."""
        due = self._agenda.next_time
        if due <= self.now:
            self._agenda.take()()
            return
        until = self._presence.slice_end(self.now, due)
        if until == inf and not self._trips and not self._relocating:
            self._over = True  # nothing can happen any more
            return
        trips = self._motion.advance(until)
        self.now = max(self.now, self._motion.now if trips else until)
        if trips or until < due:
            self._presence.follow(self.now, [trip.robot for trip in trips])
            for trip in trips:
                self._settle(self.fleet.robots[trip.robot], trip)
        else:
            self._agenda.take()()

    def _stop(self) -> None:
        self._over = True

    # What happens, and who is told

    def _expect(self) -> None:
        """Put the next occurrence down: in rounds now, in a stream by its time."""
        timing = self._schedule.timing
        if self._enough():
            self._over = self._over or isinstance(timing, Rounds)
            return
        occurrence = next(self._schedule.occurrences, None)
        if occurrence is None:
            self._over = self._over or isinstance(timing, Rounds)
        elif isinstance(timing, Stream):
            self._agenda.at(occurrence.time, partial(self._occur, occurrence))
        else:
            self._occur(occurrence)

    def _enough(self) -> bool:
        """Whether as many rounds as asked for were served, or events raised."""
        limit = self._schedule.rounds
        streaming = isinstance(self._schedule.timing, Stream)
        return limit is not None and limit <= (
            len(self.book.tasks) if streaming else self.tally.served
        )

    def _occur(self, occurrence: Occurrence) -> None:
        """Something happens; word of it comes to the handler, or does not."""
        timing, site = self._schedule.timing, occurrence.position
        service = timing.service if occurrence.service is None else occurrence.service
        deadline = timing.deadline if isinstance(timing, Stream) else inf
        if occurrence.deadline is not None:
            deadline = occurrence.deadline
        notices = self._handler.notices(site)
        noticed = bool(notices)
        for notice in notices or [Notice(0.0, site)]:
            event = Event(len(self.book.tasks), notice.position)
            task = Task(event, site, self.now, deadline, service)
            self.book.open(task)
            self._audience.event_occurred(task)
            if not noticed:
                self._close(task, State.LOST, "no sensor noticed it")
            elif notice.delay:
                self._agenda.at(self.now + notice.delay, partial(self._offer, task))
            else:
                self._offer(task)
            if deadline < inf:
                self._agenda.at(self.now + deadline, partial(self._expire, task))
        if isinstance(timing, Stream):
            self._expect()

    def _close(self, task: Task, state: State, reason: str = "") -> None:
        """A task has come to its end; in rounds the next event may happen."""
        self.book.close(task, state, self.now, reason)
        self._audience.event_closed(task.event, state.value, self.now)
        if isinstance(self._schedule.timing, Rounds):
            if self._in_hand is task:
                self._in_hand = None
            if self._in_line and not self._enough():
                self._agenda.at(self.now, partial(self._offer, self._in_line.popleft()))
            elif self._enough() or not self.book.open_tasks:
                self._agenda.at(self.now, self._expect)

    def _offer(self, task: Task, source: RobotId | None = None) -> None:
        """Tell a robot of the task, the handler's choice or ``source``, and let it talk."""
        if task.state not in (State.REPORTED, State.WAITING):
            return
        if self.now - task.raised > task.deadline:
            self._close(task, State.EXPIRED)  # it was taken when the deadline passed
            return
        if isinstance(self._schedule.timing, Rounds):
            if self._in_hand not in (None, task):
                self._in_line.append(task)
                return
            self._in_hand = task
        task.state = State.REPORTED
        self._presence.freshen(self.now)
        on_air = self._presence.on_air
        if not on_air:
            self._put_off(task, "nobody is on the air")
            return
        if source is None:
            source = self._handler.collector(task.event.position, on_air)
        self._audience.event_raised(task.event, source, self.now)
        self._talks.start(task, source, self.now)

    # What conversations come to

    def _concluded(self, task: Task, award: Award) -> None:
        """A conversation has ended: somebody goes, or nobody can."""
        if task.state is not State.REPORTED:
            return  # it expired while it was talked over
        robots, site = self.fleet.robots, task.event.position
        found = squared_distance(robots[award.auctioneer].position, site)
        if award.winner is not None:
            found = min(found, squared_distance(robots[award.winner].position, site))
        self.tally.closest += self._presence.nobody_nearer(site, found)
        self._tell_appraisals(task)
        self._audience.awarded(task.event, award, self.now)
        winner = None if award.winner is None else robots[award.winner]
        set_off = [self._relocate(move, winner, task) for move in award.moves]
        if winner is None and any(set_off):
            task.state = State.WAITING  # for the robot that carries it on
        elif winner is None:
            self._put_off(task, "nobody could take it")
        elif winner.engaged or not winner.able or not winner.alive:
            self.tally.conflicts += 1
            self._put_off(task, "the winner was taken")
        else:
            self._send(winner, task)

    def _broken_off(self, task: Task, why: str) -> None:
        """A conversation came to no end. The handler hears nothing, and asks again."""
        if task.state is State.REPORTED:
            self._tell_appraisals(task)
            self._audience.broken_off(task.event, why, self.now)
            self._put_off(task, why, silent=True)

    def _tell_appraisals(self, task: Task) -> None:
        """Tell observers what robots believed of the trip, and forget it."""
        if self._appraisals is not None:
            found = self._appraisals.pop(task.event.position, {})
            self._audience.appraised(task.event, list(found.values()), self.now)

    def _put_off(self, task: Task, why: str, *, silent: bool = False) -> None:
        """The task waits; in rounds, where nothing is lost on the air, life is over."""
        timing = self._schedule.timing
        if isinstance(timing, Rounds):
            patience = timing.offers if self._talks.radio.takes_time else 1
            if task.offers < patience and self._presence.on_air:
                self._agenda.at(self.now, partial(self._offer, task))
                return
            self._close(task, State.LOST, why)
            self._over = True
            return
        if task.offers >= timing.offers:
            self._close(task, State.LOST, f"offered {task.offers} times: {why}")
            return
        task.state = State.WAITING
        wait = min(timing.backoff * 2.0 ** min(task.offers - 1, 30), timing.backoff_most)
        if silent:
            wait = max(wait, timing.patience)
        self._agenda.at(self.now + wait, partial(self._offer, task))

    # Driving

    def _send(self, robot: Robot, task: Task) -> None:
        """The robot sets off."""
        self._presence.stand(self.now)
        task.state, task.taken = State.TAKEN, self.now
        robot.engaged = True
        self._since[robot.id] = self.now
        self._trips[robot.id] = task
        self._audience.departed(task.event, robot.id, self.now)
        self._motion.depart(robot, task.event.position)
        self._presence.show_plans(self.now)

    def _relocate(self, move: Move, winner: Robot | None, task: Task) -> bool:
        """A robot goes to a place that is no event; it carries the task if nobody has won it."""
        robot = self.fleet.robots[move.robot]
        if robot.engaged or not robot.able or not robot.alive:
            return False
        self._presence.stand(self.now)
        self.tally.relocations += 1
        robot.engaged = True
        self._since[robot.id] = self.now
        self._relocating[robot.id] = task, winner is None
        self._audience.relocating(task.event, move, self.now)
        self._motion.depart(robot, move.position)
        self._presence.show_plans(self.now)
        return True

    def _relocated(self, robot: Robot, trip: Trip) -> None:
        """A relocation has ended: what the robot carried is told to it anew."""
        task, carries = self._relocating.pop(robot.id)
        self._audience.relocated(task.event, trip)
        self._release(robot)
        if not carries or task.state is not State.WAITING:
            return
        if trip.outcome == "arrived" and robot.on_air:
            self._offer(task, robot.id)
        else:
            self._raise_again(robot, task)

    def _settle(self, robot: Robot, trip: Trip) -> None:
        """A trip has ended: count it; the event is served, or raised again."""
        tally, spec = self.tally, self.fleet.spec
        tally.predicted += spec.power.per_metre(spec.cruise) * dist(trip.origin, trip.site)
        tally.distance += dist(trip.origin, trip.end)
        tally.path += trip.path
        if trip.outcome != "arrived":
            robot.failed_sites.add(trip.site)
        if robot.battery.charge == 0.0:
            self._presence.bury(robot, self.now)
        if robot.id in self._relocating:
            self._relocated(robot, trip)
            return
        task = self._trips.pop(robot.id)
        self._audience.trip_ended(task.event, trip)
        if trip.outcome != "arrived":
            tally.failed += 1
            self._release(robot)
            self._raise_again(robot, task)
            return
        task.reached = self.now
        self._handler.hear_from(robot)
        if task.service > 0.0 and robot.alive:
            self._agenda.at(self.now + task.service, partial(self._served, robot, task))
        else:
            self._served(robot, task)

    def _served(self, robot: Robot, task: Task) -> None:
        """The robot has done its work, unless it broke down over it."""
        self._release(robot)
        if task.state is not State.TAKEN:
            return
        if not robot.alive and task.service > 0.0:
            self._raise_again(robot, task)
            return
        self.tally.served += 1
        self._close(task, State.SERVED)

    def _release(self, robot: Robot) -> None:
        """The robot is free again."""
        robot.engaged = False
        self.tally.engaged += self.now - self._since.pop(robot.id)

    def _raise_again(self, robot: Robot, task: Task) -> None:
        """Its robot did not make it: ask for another, at once or when its silence is noticed."""
        task.state = State.WAITING
        timing = self._schedule.timing
        if isinstance(timing, Rounds) or robot.on_air:
            self._offer_again(task)
        else:
            self._agenda.at(self.now + timing.patience, partial(self._offer, task))

    def _offer_again(self, task: Task) -> None:
        """At once, if there is anybody to offer it to."""
        if self._presence.on_air:
            task.offers = 0 if isinstance(self._schedule.timing, Rounds) else task.offers
            self._offer(task)
        else:
            self._put_off(task, "nobody is on the air")

    # How things go wrong

    def _expire(self, task: Task) -> None:
        if task.state in (State.REPORTED, State.WAITING):
            self._close(task, State.EXPIRED)

    def _break_down(self, fault: Breakdown) -> None:
        """A motor, or a whole robot, fails."""
        robot = self.fleet.robots[fault.robot]
        if not robot.alive or (fault.what == "motor" and not robot.able):
            return
        self.tally.breakdowns += 1
        robot.able = False
        self._audience.broke_down(fault)
        if robot.id in self._trips or robot.id in self._relocating:
            self._motion.halt(robot)
        if fault.what == "all":
            self._presence.bury(robot, self.now)

    def _summary(self, wall_time: float) -> Summary:
        timing, radio = self._schedule.timing, self._talks.radio
        figures = None
        if isinstance(timing, Stream):
            figures = stream_figures(
                self.book, self.tally, len(self.fleet.robots), self.now, timing.backoff_most,
                radio.beacons, self._handler.sensor_messages,
            )  # fmt: skip
        return summarise(self.fleet, self.tally, len(self.book.tasks), self.now, wall_time, figures)
