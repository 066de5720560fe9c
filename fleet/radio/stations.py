"""Robots' transceivers: one frame at a time, acknowledged and repeated as a standard has it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fleet.radio.access import Access, Distributed, Draw, Schedule, Timing, Unslotted
from fleet.radio.medium import Audible, Flight, Medium
from protocols.messages import Heard, RobotId

Survives = Callable[[RobotId, RobotId, int], bool]
"""Whether frame number so and so from one robot to another survives all but collisions."""


class Delivery(NamedTuple):
    """What became of a frame."""

    heard: Heard
    known: bool  # the sender knows: it was acknowledged, or needs no acknowledgement
    attempts: int  # times it was on the air, or should have been
    end: int  # when the sender is done with it [ns]


@dataclass(frozen=True, slots=True)
class Standard:
    """A physical layer, how it takes turns, and how often it repeats."""

    timing: Timing
    bit: int  # [ns]
    distributed: bool  # 802.11's DCF; else 802.15.4's unslotted CSMA/CA
    retries: int
    capture: float  # signal over interference, as powers
    sensing: float  # power from which the air counts as busy, over the weakest received


@dataclass(slots=True, eq=False)
class _Job:
    """A frame in hand."""

    number: int
    receiver: RobotId | None
    bits: int
    done: Callable[[Delivery], None]
    attempts: int = 0
    heard: Heard = ()
    awaiting: bool = False  # an acknowledgement


class Stations:
    """The transceivers of all robots over one medium."""

    def __init__(
        self,
        robots: int,
        audible: Audible,
        survives: Survives,
        standard: Standard,
        schedule: Schedule,
        draw: Draw,
    ) -> None:
        self.medium = Medium(robots, audible, standard.capture, standard.sensing, self)
        self.airtime = [0] * robots  # spent sending [ns]
        self.listened = [0] * robots  # spent receiving whole frames [ns]
        self._standard, self._schedule, self._survives = standard, schedule, survives
        kind = Distributed if standard.distributed else Unslotted
        self._access: Access = kind(standard.timing, self.medium, schedule, draw, self._granted)
        self._queues: Sequence[deque[_Job]] = [deque() for _ in range(robots)]
        self._numbers = 0

    def send(
        self,
        sender: RobotId,
        receiver: RobotId | None,
        bits: int,
        done: Callable[[Delivery], None],
        now: int,
    ) -> None:
        """Send a frame of so many ``bits``, after those that its sender still has; None: to all."""
        self._numbers += 1
        queue = self._queues[sender]
        queue.append(_Job(self._numbers, receiver, bits, done))
        if len(queue) == 1:
            self._access.contend(sender, 0, now)

    def fell_busy(self, robot: RobotId, now: int) -> None:
        """See :class:`fleet.radio.medium.Listener`."""
        self._access.fell_busy(robot, now)

    def fell_idle(self, robot: RobotId, now: int) -> None:
        """See :class:`fleet.radio.medium.Listener`."""
        self._access.fell_idle(robot, now)

    def _granted(self, robot: RobotId, now: int, may: bool) -> None:
        """It is the robot's turn, or its turn never came."""
        job = self._queues[robot][0]
        job.attempts += 1
        if not may:
            self._end(robot, job, now, known=job.receiver is None)
        elif self.medium.sends(robot):  # an acknowledgement of its own came between
            self._again(robot, job, now)
        else:
            self._on_air(
                robot,
                self._airtime(job.bits),
                now,
                lambda end, got: self._sent(robot, job, end, got),
            )

    def _on_air(
        self, robot: RobotId, airtime: int, now: int, over: Callable[[int, list[RobotId]], None]
    ) -> None:
        end = now + airtime
        flight = self.medium.begin(robot, now, end)
        self.airtime[robot] += airtime
        self._schedule(end, lambda: over(end, self._finish(flight)))

    def _finish(self, flight: Flight) -> list[RobotId]:
        received = self.medium.finish(flight)
        for robot in received:
            self.listened[robot] += flight.end - flight.start
        return received

    def _sent(self, robot: RobotId, job: _Job, now: int, received: list[RobotId]) -> None:
        """A frame is over: broadcasts are done, others want an acknowledgement."""
        number = 64 * job.number + 2 * job.attempts
        got = [other for other in received if self._survives(robot, other, number)]
        if job.receiver is None:
            job.heard = tuple(got)
            self._end(robot, job, now, known=True)
            return
        attempt = job.attempts
        if job.receiver in got:
            job.heard = (job.receiver,)
            reply = now + self._standard.timing.turnaround
            self._schedule(reply, lambda: self._acknowledge(robot, job, reply, number + 1))
        job.awaiting = True
        patience = now + self._standard.timing.patience
        self._schedule(patience, lambda: self._give_up(robot, job, attempt, patience))

    def _acknowledge(self, robot: RobotId, job: _Job, now: int, number: int) -> None:
        """The receiver answers, unless it is on the air itself."""
        receiver = job.receiver
        if receiver is None or self.medium.sends(receiver):
            return

        def over(end: int, received: list[RobotId]) -> None:
            if robot in received and job.awaiting and self._survives(receiver, robot, number):
                job.awaiting = False
                self._end(robot, job, end, known=True)

        self._on_air(receiver, self._standard.timing.acknowledgement, now, over)

    def _give_up(self, robot: RobotId, job: _Job, attempt: int, now: int) -> None:
        """No acknowledgement came."""
        if job.awaiting and job.attempts == attempt:
            job.awaiting = False
            self._again(robot, job, now)

    def _again(self, robot: RobotId, job: _Job, now: int) -> None:
        if job.attempts > self._standard.retries:
            self._end(robot, job, now, known=False)
        else:
            self._access.contend(robot, job.attempts, now)

    def _end(self, robot: RobotId, job: _Job, now: int, *, known: bool) -> None:
        """The robot is done with the frame, and goes on to its next."""
        queue = self._queues[robot]
        queue.popleft()
        if queue:
            self._access.contend(robot, 0, now)
        job.done(Delivery(job.heard, known, job.attempts, now))

    def _airtime(self, bits: int) -> int:
        return self._standard.timing.preamble + bits * self._standard.bit
