"""Who receives what is sent, and when."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple, Protocol, TypeAlias

from fleet.robot import Robot
from protocols.messages import Heard, Point, RobotId, Transmission
from protocols.rules import BrokenRule


class BrokenProtocol(BrokenRule):
    """A protocol sends over a link that is not there, or without end."""


class Reception(NamedTuple):
    """What became of a transmission."""

    heard: Heard
    delay: float = 0.0  # from when it is told until the sender knows [s]
    attempts: int = 1  # frames it took, the sender's alone


class AirCounts(NamedTuple):
    """What went over the air so far."""

    beacons: int = 0
    frames: int = 0  # of all kinds, if the radio knows of frames that overlap
    drowned: int = 0  # frames that others kept somebody from receiving
    doubts: int = 0  # frames that were heard, though their senders do not know


Transmit: TypeAlias = Callable[[Transmission, float], Reception]
"""Sends something at that time [s], over a radio on which it has arrived then."""

Received: TypeAlias = Callable[[Reception, float], None]
"""Told what became of a transmission, at that time [s]."""


class Radio(Protocol):
    """The air between the robots."""

    @property
    def takes_time(self) -> bool:
        """Whether transmissions do; then they can also be lost."""

    @property
    def instant(self) -> Transmit | None:
        """How to send over a radio that takes no time; None: it does."""

    @property
    def tables(self) -> Sequence[Mapping[RobotId, Point]]:
        """By robot: its neighbours in the routing graph, and where they were last known [m]."""

    @property
    def reach(self) -> float:
        """How far robots hear one another in the open [m], if nothing is lost."""

    @property
    def disc(self) -> bool:
        """Whether they do so in all directions and everywhere."""

    def hearers(self, robot: RobotId) -> Sequence[RobotId]:
        """Who hears the robot where it is now, if nothing is lost; ascending."""

    def counts(self) -> AirCounts:
        """What went over the air so far."""

    def refresh(self, moved: Iterable[Robot], time: float) -> None:
        """Robots that moved are where they are now; beacons up to ``time`` [s] have been sent."""

    def silence(self, robot: Robot) -> None:
        """The robot is off the air."""

    def restore(self, robot: Robot) -> None:
        """The robot is on the air again."""

    def send(self, transmission: Transmission, time: float, done: Received) -> None:
        """Send it now; ``done`` is told what became of it, at once or when that is known.

        Raises:
            BrokenProtocol: it is addressed to a robot that the sender does not know.
        """
