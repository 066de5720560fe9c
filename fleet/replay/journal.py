"""What a run tells the process that writes its recording, and how it gets there.

The run must not wait for its recording, so another process draws it. What crosses the pipe
is small: where everybody started, then for every few rounds what happened in order, what was
said, and the poses of those under way among it. The other end works out the rest.
"""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from typing import IO, Any, NamedTuple, TypeAlias

from protocols.messages import Heard, Point, RobotId


class RecordedLine(NamedTuple):
    """One transmission, flat."""

    number: int
    time: float  # [s]
    event: int
    kind: str
    sender: RobotId
    receiver: RobotId | None
    cost: float | None  # of the bid that it carries
    bidder: RobotId | None  # whose bid that is
    heard: Heard
    attempts: int  # frames it took


class TripEnd(NamedTuple):
    """A trip, as :class:`fleet.motion.Trip` has it; :data:`RELOCATED` if it was to no event."""

    robot: RobotId
    outcome: str
    origin: Point  # [m]
    site: Point  # [m]
    end: Point  # [m]
    departed: float  # [s]
    ended: float  # [s]
    path: float  # [m]
    energy: float  # [J]
    planned: float  # [m] when it set off; 0: motion has no notion of it
    offset: float  # [m] from the site to where it was bound: the site is covered
    waited: float  # [s] before it could set off, and for others on the way


RELOCATED = "relocated"  # the outcome of a trip to a place that is no event

Note: TypeAlias = tuple[Any, ...]
"""A happening: its name, and what the dispatcher is told of it, in plain values: pickle takes ten
times as long for values of classes of our own."""


class Scene(NamedTuple):
    """How a run starts."""

    width: float  # [m]
    height: float  # [m]
    hole: list[Point] | None  # outline [m]
    obstacles: list[list[Point]]  # outlines [m]
    positions: list[Point]  # [m]
    energies: list[float]  # [J]
    capacities: list[float]  # [J]
    radius: float  # of a robot [m]
    per_metre: float  # Eq. (1) at cruise speed [J/m]
    radio_range: float  # [m]
    disc: bool  # whether robots hear one another within that range, whatever is between
    search_radius: float  # [m]
    sensors: list[Point]  # [m]
    sensing: float  # how far they sense [m]
    graph: str
    protocol: str
    motion: str
    world: str
    seed: int
    metric: str  # what bids are worth, and in what unit; "": not known
    unit: str
    belief: str  # what robots believe that a trip costs
    routed: bool  # whether the protocol searches for the robot that decides

    @property
    def title(self) -> str:
        """Which run it is."""
        return f"{self.protocol} · {self.world} · {self.motion} · seed {self.seed}"


def send(pipe: IO[bytes], tag: str, *content: Any) -> None:
    """Write one frame."""
    pickle.dump((tag, *content), pipe, protocol=5)
    pipe.flush()


def receive(pipe: IO[bytes]) -> Iterator[tuple[Any, ...]]:
    """Frames until the other end closes the pipe, or dies in the middle of one."""
    while True:
        try:
            yield pickle.load(pipe)  # noqa: S301 - written by our own parent process
        except (EOFError, pickle.UnpicklingError):
            return
