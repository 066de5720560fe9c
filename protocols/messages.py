"""What is said: events, bids, transmissions, and the conversation that they make up."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Literal, NamedTuple, Protocol, TypeAlias

RobotId: TypeAlias = int
Point: TypeAlias = tuple[float, float]  # [m]
Heard: TypeAlias = tuple[RobotId, ...]  # who received a transmission; empty: nobody

Kind = Literal["route-greedy", "route-face", "call", "bid", "assign"]
KINDS: tuple[Kind, ...] = ("route-greedy", "route-face", "call", "bid", "assign")


class Event(NamedTuple):
    """Something to attend to: all that a message about it carries."""

    id: int
    position: Point  # [m]


class Bid(NamedTuple):
    """An offer to serve an event. The lower cost wins, ties go to the lower robot id."""

    cost: float  # in the metric's own unit
    robot: RobotId


class Transmission(NamedTuple):
    """One frame on the air."""

    kind: Kind
    sender: RobotId
    receiver: RobotId | None  # None: a broadcast to whoever is in range
    bid: Bid | None = None  # what a "bid" offers, an "assign" names, a "call" wants bettered;
    #                         a "bid" without one is the answer of somebody who has none to make


class Move(NamedTuple):
    """A robot goes to a place that is no event: to keep the network together, or to find it."""

    robot: RobotId
    position: Point  # [m]


class Award(NamedTuple):
    """What a conversation ends with: who goes, and among whom it was chosen.

    With ``moves`` but no winner the event is carried on: it is told again to the robot that
    moved first, when all have arrived.
    """

    winner: RobotId | None  # None: nobody can take the task
    auctioneer: RobotId  # the robot that the search ended at
    bids: tuple[Bid, ...] = ()  # those the auctioneer chose among, its own included
    moves: tuple[Move, ...] = ()  # of robots that have been told


Conversation: TypeAlias = Generator[Transmission, Heard, Award]
"""A protocol under way: it yields what is sent and is told who heard it."""


class RobotView(Protocol):
    """What one robot knows: itself, and where its radio neighbours were last heard."""

    @property
    def id(self) -> RobotId:
        """Its number, from 0."""

    @property
    def position(self) -> Point:
        """Its own position [m]."""

    @property
    def radio_range(self) -> float:
        """How far its radio reaches: r [m]."""

    @property
    def energy(self) -> float:
        """What its battery holds [J]."""

    @property
    def neighbours(self) -> Mapping[RobotId, Point]:
        """Neighbours in the routing graph, by ascending id: last known positions [m]."""

    def cost_to(self, site: Point) -> float:
        """The energy it believes that going to ``site`` takes [J]; inf if it cannot."""


View: TypeAlias = Sequence[RobotView]
"""The fleet by robot id. A protocol asks only the robot whose turn it is to speak."""

ProtocolFunction: TypeAlias = Callable[[View, Event, RobotId], Conversation]
"""A protocol, its parameters bound: the view, the event, the robot that was told of it."""
