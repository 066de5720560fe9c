"""The air that robots share: frames overlap on it, and drown one another.

A frame is received by a robot if it is strong enough there, the robot does not send itself, and
at no moment the sum of all other frames there comes within ``capture`` of it (additive
interference, as in Iyer, Rosenberg and Karnik, IEEE Trans. Wireless Commun. 8(5), 2009). Powers
are multiples of the weakest that can be received, times are whole nanoseconds: what begins at
the same instant begins at the same instant.
"""

from __future__ import annotations

from bisect import insort
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Protocol

from protocols.messages import RobotId

_end = attrgetter("end")

Audible = Callable[[RobotId], Iterable[tuple[RobotId, float]]]
"""Whom a frame of this robot matters to, if only as noise, and how strong it is there."""


@dataclass(slots=True, eq=False)
class Flight:
    """One frame on the air."""

    sender: RobotId
    start: int  # [ns]
    end: int  # [ns]
    reached: Sequence[RobotId] = ()  # that it matters to
    received: dict[RobotId, float] = field(default_factory=dict)  # whole so far, how strong
    drowned: bool = False  # somewhere, by other frames
    over: bool = False


class Listener(Protocol):
    """Who is told when the air about a robot falls busy or idle."""

    def fell_busy(self, robot: RobotId, now: int) -> None:
        """Something can be sensed at the robot, from ``now`` [ns] on."""

    def fell_idle(self, robot: RobotId, now: int) -> None:
        """Nothing can be sensed there any more."""


class Medium:
    """All frames on the air, as each robot gets them."""

    def __init__(
        self, robots: int, audible: Audible, capture: float, sensing: float, listener: Listener
    ) -> None:
        self._audible = audible
        self._capture = capture  # signal over the sum of the others, from which it is received
        self._sensing = sensing  # power from which the air counts as busy
        self._listener = listener
        self._arriving: list[dict[Flight, float]] = [{} for _ in range(robots)]
        self._total = [0.0] * robots  # power arriving
        self._idle_since = [-1] * robots  # [ns]
        self._sending: list[Flight | None] = [None] * robots
        self._flying: list[Flight] = []  # by their end
        self.frames = 0
        self.overlapped = 0  # frames that drowned at somebody who would have received them

    def sends(self, robot: RobotId) -> bool:
        """Whether the robot is on the air itself."""
        return self._sending[robot] is not None

    def busy(self, robot: RobotId, since: int, now: int) -> bool:
        """Whether anything could be sensed at the robot from ``since`` until just before ``now``.

        What begins at ``now`` cannot be sensed yet.
        """
        if self._sending[robot] is not None or self._idle_since[robot] > since:
            return True
        arriving = self._arriving[robot]
        return sum(p for flight, p in arriving.items() if flight.start < now) >= self._sensing

    def idle_since(self, robot: RobotId) -> int:
        """When the air about the robot fell idle [ns]; negative: it always was."""
        return self._idle_since[robot]

    def begin(self, sender: RobotId, now: int, end: int) -> Flight:
        """A frame goes on the air; those that end at this instant have ended."""
        while self._flying and self._flying[0].end <= now:
            self._land(self._flying[0])
        flight = Flight(sender, now, end)
        self.frames += 1
        self._sending[sender] = flight
        for other in self._arriving[sender]:
            other.received.pop(sender, None)  # who sends hears nothing
        self._listener.fell_busy(sender, now)
        reached = []
        for robot, power in self._audible(sender):
            reached.append(robot)
            self._arrive(flight, robot, power, now)
        flight.reached = reached
        insort(self._flying, flight, key=_end)
        return flight

    def finish(self, flight: Flight) -> list[RobotId]:
        """The frame is over; who received it, ascending."""
        if not flight.over:
            self._land(flight)
        return sorted(flight.received)

    def _land(self, flight: Flight) -> None:
        """The last of a frame has passed everybody."""
        flight.over = True
        self._flying.remove(flight)
        sender = flight.sender
        self._sending[sender] = None
        if self._total[sender] < self._sensing:
            self._idle_since[sender] = flight.end
            self._listener.fell_idle(sender, flight.end)
        for robot in flight.reached:
            arriving = self._arriving[robot]
            del arriving[flight]
            before = self._total[robot]
            self._total[robot] = sum(arriving.values())
            if before >= self._sensing > self._total[robot] and not self.sends(robot):
                self._idle_since[robot] = flight.end
                self._listener.fell_idle(robot, flight.end)
        self.overlapped += flight.drowned

    def _arrive(self, flight: Flight, robot: RobotId, power: float, now: int) -> None:
        """The first of a frame gets to a robot."""
        arriving, noise = self._arriving[robot], self._total[robot]
        total = noise + power
        for other in arriving:
            signal = other.received.get(robot)
            if signal is not None and signal < self._capture * (total - signal):
                del other.received[robot]
                other.drowned = True
        if power >= 1.0 and self._sending[robot] is None:
            if power >= self._capture * noise:
                flight.received[robot] = power
            else:
                flight.drowned = True
        arriving[flight] = power
        self._total[robot] = total
        if noise < self._sensing <= total:
            self._listener.fell_busy(robot, now)
