"""When a robot with something to send may send it: carrier sense with back-off.

Two standards: the unslotted CSMA/CA of IEEE 802.15.4 (2020, 6.2.5), which looks at the air once
after each back-off, and the distributed coordination function of IEEE 802.11 (2020, 10.3),
whose back-off stands still while the air is busy. Both wait longer after each failure.

All times are whole nanoseconds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from fleet.radio.medium import Medium
from protocols.messages import RobotId

Schedule = Callable[[int, Callable[[], None]], None]
"""Puts something down for a time [ns]."""

Draw = Callable[[RobotId, int], int]
"""A number from 0 to below the given one, by chance; the robot's own chance."""

Granted = Callable[[RobotId, int, bool], None]
"""Told once the robot may send (True) at that time [ns], or the standard gives up (False)."""


class Timing(NamedTuple):
    """What a standard's physical layer takes [ns], and how it backs off."""

    slot: int  # unit of back-off
    sense: int  # listening before sending: CCA, or the part of DIFS beyond a back-off's slots
    turnaround: int  # between receiving and sending: aTurnaroundTime, or SIFS
    acknowledgement: int  # airtime
    patience: int  # from the end of a frame until its acknowledgement is given up
    preamble: int  # airtime before the first bit of a frame
    least: int  # slots to draw from at first
    most: int  # and at most
    looks: int  # at a busy air in a row, after which sending fails; 802.11 never gives up


class Access(Protocol):
    """A way to take turns."""

    def contend(self, robot: RobotId, failures: int, now: int) -> None:
        """The robot has a frame, which has failed so many times."""

    def fell_busy(self, robot: RobotId, now: int) -> None:
        """See :class:`fleet.radio.medium.Listener`."""

    def fell_idle(self, robot: RobotId, now: int) -> None:
        """See :class:`fleet.radio.medium.Listener`."""


class Unslotted:
    """IEEE 802.15.4 without beacons: back off, look once, turn round, send."""

    def __init__(
        self, timing: Timing, medium: Medium, schedule: Schedule, draw: Draw, granted: Granted
    ) -> None:
        self._timing, self._medium = timing, medium
        self._schedule, self._draw, self._granted = schedule, draw, granted

    def contend(self, robot: RobotId, failures: int, now: int) -> None:
        """Back off anew; the standard forgets earlier failures."""
        self._back_off(robot, 0, now)

    def fell_busy(self, robot: RobotId, now: int) -> None:
        """The air is looked at only after a back-off."""

    def fell_idle(self, robot: RobotId, now: int) -> None:
        """The same."""

    def _back_off(self, robot: RobotId, looks: int, now: int) -> None:
        t = self._timing
        window = min(t.least << looks, t.most)
        look = now + t.slot * self._draw(robot, window)
        seen = look + t.sense
        self._schedule(seen, lambda: self._look(robot, looks, look, seen))

    def _look(self, robot: RobotId, looks: int, since: int, now: int) -> None:
        t = self._timing
        if not self._medium.busy(robot, since, now):
            send = now + t.turnaround
            self._schedule(send, lambda: self._granted(robot, send, True))
        elif looks == t.looks:
            self._granted(robot, now, False)
        else:
            self._back_off(robot, looks + 1, now)


class Distributed:
    """IEEE 802.11's DCF, basic access: count down idle slots, and send at the last."""

    def __init__(
        self, timing: Timing, medium: Medium, schedule: Schedule, draw: Draw, granted: Granted
    ) -> None:
        self._timing, self._medium = timing, medium
        self._schedule, self._draw, self._granted = schedule, draw, granted
        self._left: dict[RobotId, int] = {}  # slots to count down
        self._counting: dict[RobotId, int] = {}  # since when [ns]

    def contend(self, robot: RobotId, failures: int, now: int) -> None:
        """Draw from a window that doubles with each failure."""
        t = self._timing
        self._left[robot] = self._draw(robot, min(t.least << failures, t.most))
        if not self._medium.busy(robot, now, now + 1):
            self._count(robot, now)

    def fell_busy(self, robot: RobotId, now: int) -> None:
        """Stand still; a slot that has not passed whole counts anew."""
        since = self._counting.get(robot)
        if since is None:
            return
        passed = (now - since) // self._timing.slot
        if passed < self._left[robot]:
            self._left[robot] -= max(0, passed)
            del self._counting[robot]

    def fell_idle(self, robot: RobotId, now: int) -> None:
        """Go on."""
        if robot in self._left and robot not in self._counting:
            self._count(robot, now)

    def _count(self, robot: RobotId, now: int) -> None:
        t = self._timing
        since = now + t.sense
        self._counting[robot] = since
        send = since + t.slot * self._left[robot]
        self._schedule(send, lambda: self._arrive(robot, since, send))

    def _arrive(self, robot: RobotId, since: int, send: int) -> None:
        if self._counting.get(robot) != since:
            return  # the air fell busy meanwhile
        del self._counting[robot], self._left[robot]
        self._granted(robot, send, True)
