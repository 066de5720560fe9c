"""The loop: events happen, are talked over and driven to."""

from __future__ import annotations

import time
from functools import partial
from math import inf

from fleet.agenda import Agenda
from fleet.conversations import Conversations
from fleet.dispatch import Dispatch, Dispatcher
from fleet.faults import Breakdown
from fleet.fleet import Fleet
from fleet.handler import Handler, Notice
from fleet.journeys import Journey, Journeys
from fleet.motion import Motion, Trip
from fleet.observer import Audience
from fleet.presence import Presence
from fleet.radio import Radio
from fleet.results import Ending, PlayedRun, Summary, summarise
from fleet.robot import Appraisal, Robot
from fleet.schedule import Schedule
from fleet.tally import Tally
from fleet.tasks import State, Task, TaskBook
from protocols.geometry import squared_distance
from protocols.messages import Award, Event, Point, ProtocolFunction, RobotId
from worlds.events import Occurrence

UNNOTICED = 1000  # events in a row of which no sensor tells, after which rounds are over


class Simulation:
    """One run of one scenario."""

    def __init__(
        self,
        fleet: Fleet,
        protocol: ProtocolFunction | Dispatcher,
        radio: Radio,
        agenda: Agenda,
        motion: Motion,
        handler: Handler,
        schedule: Schedule,
        audience: Audience,
    ) -> None:
        self.fleet = fleet
        self.tally = Tally()
        self.book = TaskBook()
        self.now = 0.0  # [s]
        self.ended: Ending | None = None  # why, once it has
        self._schedule = schedule
        self._mode = mode = schedule.timing.mode(schedule.rounds, lossy=radio.takes_time)
        self._handler = handler
        self._motion = motion
        self._radio = radio
        self._audience = audience
        self._agenda = agenda
        self._presence = Presence(
            fleet, radio, motion, audience, self.tally, many_drive=not mode.one_at_a_time
        )
        self._journeys = Journeys(fleet, motion, self._presence, audience, self.tally)
        self._talks: Conversations | Dispatch
        if isinstance(protocol, Dispatcher) and not mode.one_at_a_time:
            self._talks = Dispatch(
                protocol, self._presence.view, self._agenda, self.tally, self._concluded
            )
        else:
            self._talks = Conversations(
                protocol, self._presence.view, fleet.robots, radio, self._agenda, self.tally,
                audience, fleet.spec.extra, mode.listening, self._concluded, self._broken_off,
            )  # fmt: skip
        self._unnoticed = 0  # events in a row
        self._appraisals: dict[Point, dict[int, Appraisal]] | None = {} if audience.weighs else None
        for robot in fleet.robots:
            robot.appraisals = self._appraisals

    def run(self) -> Summary:
        """Play to the end: of the network's life, of the rounds, or of the time."""
        started = time.perf_counter()
        try:
            self.begin()
            while self.ended is None:
                self.go_on()
            return self.finish(time.perf_counter() - started)
        finally:
            self.close()

    def begin(self) -> None:
        """Everybody is in place: the run begins."""
        self._audience.run_started(self.fleet)
        self._begin()

    def finish(self, wall_time: float) -> Summary:
        """The run has ended, for the reason that ``ended`` gives: sum it up."""
        assert self.ended is not None
        self._presence.stand(self.now)
        self._journeys.break_off(self.now)
        summary = self._summary(self.ended, wall_time)
        self._audience.run_ended(summary)
        return summary

    def close(self) -> None:
        """Let observers go, however far the run has come."""
        self._audience.closed()

    def switch(self, protocol: ProtocolFunction) -> None:
        """From now on robots talk by another protocol.

        Raises:
            ValueError: it, or the one so far, is a dispatcher of a stream.
        """
        talks, dispatching = self._talks, isinstance(protocol, Dispatcher)
        if dispatching or not isinstance(talks, Conversations):
            raise ValueError("a dispatcher cannot take over from a protocol, nor one from it")
        talks.protocol = protocol

    def _begin(self) -> None:
        """Put down what is known to come."""
        schedule, agenda = self._schedule, self._agenda
        self._handler.meet(self.fleet.robots)
        for fault in schedule.breakdowns:
            agenda.at(fault.time, partial(self._break_down, fault))
        for blackout in schedule.blackouts:
            agenda.at(blackout.start, partial(self._presence.black_out, blackout, blackout.start))
            agenda.at(blackout.end, partial(self._presence.lift, blackout, blackout.end))
        if self._mode.duration < inf:
            agenda.at(self._mode.duration, partial(self._end, "time over"))
        self._expect()

    def go_on(self) -> None:
        """One step: drive up to what is due next, or to the next end of a trip, and see to it."""
        due = self._agenda.next_time
        if due <= self.now:
            self._agenda.take()()
            return
        until = self._presence.slice_end(self.now, due)
        if until == inf and not self._journeys:
            self._end("no more events")  # nothing can happen any more
            return
        trips = self._motion.advance(until)
        self.now = max(self.now, self._motion.now if trips else until)
        if trips or until < due:
            self._presence.follow(self.now, [trip.robot for trip in trips])
            for trip in trips:
                self._settle(self.fleet.robots[trip.robot], trip)
        else:
            self._agenda.take()()

    def _end(self, why: Ending) -> None:
        self.ended = self.ended or why

    # What happens, and who is told

    def _expect(self) -> None:
        """Put the next occurrence down for when it happens, if there is one."""
        mode = self._mode
        enough = mode.enough(len(self.book.tasks), self.tally.served)
        occurrence = None if enough else next(self._schedule.occurrences, None)
        if occurrence is not None:
            self._agenda.at(mode.when(occurrence, self.now), partial(self._occur, occurrence))
        elif mode.one_at_a_time:
            self._end("rounds played" if enough else "no more events")

    def _occur(self, occurrence: Occurrence) -> None:
        """Something happens; word of it comes to the handler, or does not."""
        mode, site = self._mode, occurrence.position
        service = mode.service if occurrence.service is None else occurrence.service
        deadline = mode.deadline if occurrence.deadline is None else occurrence.deadline
        notices = self._handler.notices(site)
        self._unnoticed = 0 if notices else self._unnoticed + 1
        for notice in notices or [Notice(0.0, site)]:
            event = Event(len(self.book.tasks), notice.position)
            task = Task(event, site, self.now, deadline, service)
            self.book.open(task)
            self._audience.event_occurred(task)
            if not notices:
                self._close(task, State.LOST, "no sensor noticed it")
            elif notice.delay:
                self._agenda.at(self.now + notice.delay, partial(self._offer, task))
            else:
                self._offer(task)
            if deadline < inf:
                self._agenda.at(self.now + deadline, partial(self._expire, task))
        if not mode.one_at_a_time:
            self._expect()
        elif self._unnoticed == UNNOTICED:
            self._end("no sensor notices events")

    def _close(self, task: Task, state: State, reason: str = "") -> None:
        """A task has come to its end; in rounds the next event may happen."""
        self.book.close(task, state, self.now, reason)
        self._audience.event_closed(task.event, state.value, self.now)
        following = self._mode.next_in_line(task)
        enough = self._mode.enough(len(self.book.tasks), self.tally.served)
        if following is not None and not enough:
            self._agenda.at(self.now, partial(self._offer, following))
        elif self._mode.one_at_a_time and (enough or not self.book.open_tasks):
            self._agenda.at(self.now, self._expect)

    def _offer(self, task: Task, source: RobotId | None = None) -> None:
        """Tell a robot of the task, the handler's choice or ``source``, and let it talk."""
        if task.state not in (State.REPORTED, State.WAITING):
            return
        if self.now - task.raised > task.deadline:
            self._close(task, State.EXPIRED)  # it was taken when the deadline passed
            return
        if not self._mode.takes_turn(task):
            return
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
        send = partial(self._journeys.relocate, task=task, now=self.now, carries=winner is None)
        set_off = [send(move) for move in award.moves]
        if winner is None and any(set_off):
            task.state = State.WAITING  # for the robot that carries it on
        elif winner is None:
            self._put_off(task, "nobody could take it")
        elif winner.engaged or not winner.able or not winner.alive:
            self.tally.conflicts += 1
            self._put_off(task, "the winner was taken")
        else:
            self._journeys.send(winner, task, self.now)

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
        """Nobody goes: the task waits for its next offer, or is given up."""
        wait = self._mode.next_offer(task, silent=silent, anybody=bool(self._presence.on_air))
        if wait is not None:
            task.state = State.WAITING
            self._agenda.at(self.now + wait, partial(self._offer, task))
            return
        offered = f"offered {task.offers} times: " if task.offers > 1 else ""
        self._close(task, State.LOST, offered + why)
        if self._mode.one_at_a_time:
            self._end(self._presence.why_nobody(task.event.position))

    # Where drives end

    def _settle(self, robot: Robot, trip: Trip) -> None:
        """A trip has ended: the event is served, or raised again."""
        journey = self._journeys.ended(trip, self.now)
        task = journey.task
        if journey.relocation:
            self._relocated(robot, trip, journey)
        elif trip.outcome != "arrived":
            self._journeys.release(robot, self.now)
            self._raise_again(robot, task)
        else:
            task.reached = self.now
            self._handler.hear_from(robot)
            if task.service > 0.0 and robot.alive:
                self._agenda.at(self.now + task.service, partial(self._served, robot, task))
            else:
                self._served(robot, task)

    def _relocated(self, robot: Robot, trip: Trip, journey: Journey) -> None:
        """A relocation has ended: what the robot carried is told to it anew.

        Unless it went nowhere: then nothing has changed, and what was said would be said again.
        """
        task = journey.task
        self._journeys.release(robot, self.now)
        if not journey.carries or task.state is not State.WAITING:
            return
        if trip.outcome != "arrived" or not robot.on_air:
            self._raise_again(robot, task)
        elif trip.path == 0.0 or self._mode.carried_enough(task):
            self._put_off(task, "it was carried on in vain")
        else:
            self._offer(task, robot.id)

    def _served(self, robot: Robot, task: Task) -> None:
        """The robot has done its work on an event."""
        self._journeys.release(robot, self.now)
        if task.state is not State.TAKEN:
            return
        if not robot.alive and task.service > 0.0:
            self._raise_again(robot, task)
            return
        self.tally.served += 1
        self._close(task, State.SERVED)

    def _raise_again(self, robot: Robot, task: Task) -> None:
        """Its robot did not make it: ask for another as soon as that is noticed."""
        task.state = State.WAITING
        unnoticed = self._mode.missed_after(task, on_air=robot.on_air)
        if unnoticed > 0.0:
            self._agenda.at(self.now + unnoticed, partial(self._offer, task))
        else:
            self._offer(task)

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
        self._audience.broke_down(fault)
        self._journeys.break_down(robot)
        if fault.what == "all":
            self._presence.bury(robot, self.now)

    def _summary(self, ended: Ending, wall_time: float) -> Summary:
        run = PlayedRun(
            self.fleet, self.tally, self.book, ended, self.now,
            self._radio.counts(), self._handler.sensor_messages,
        )  # fmt: skip
        mode = self._mode
        return summarise(run, wall_time, mode.longest_wait, streamed=not mode.one_at_a_time)
