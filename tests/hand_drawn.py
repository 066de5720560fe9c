"""Networks that stand still, and conversations over them that are watched word by word."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import dist, inf

import numpy as np

from protocols.messages import Award, Conversation, Event, Heard, Point, RobotId, Transmission
from protocols.topology import GraphName, Topology, connected, unit_disc

PER_METRE = 19.355789473684212  # Eq. (1) at 0.76 m/s [J/m]


@dataclass(frozen=True)
class Still:
    """A robot that does not move."""

    id: RobotId
    position: Point
    energy: float
    neighbours: Mapping[RobotId, Point]
    unreachable: tuple[Point, ...] = ()
    radio_range: float = 1.0

    def cost_to(self, site: Point) -> float:
        return inf if site in self.unreachable else PER_METRE * dist(self.position, site)


def network(
    positions: Sequence[Point],
    radio_range: float,
    graph: GraphName = "gabriel",
    energy: float | Sequence[float] = 100.0,
    *,
    compiled: bool | None = None,
) -> list[Still]:
    """Robots at these positions [m], linked as the topology says."""
    topology = Topology(positions, radio_range, graph, compiled=compiled)
    energies = [energy] * len(positions) if isinstance(energy, float | int) else energy
    return [
        Still(id, position, float(energies[id]), topology.neighbours[id], radio_range=radio_range)
        for id, position in enumerate(topology.positions)
    ]


def random_points(count: int, side: float, rng: np.random.Generator) -> list[Point]:
    return [(x, y) for x, y in (side * rng.random((count, 2))).tolist()]


def random_connected(
    count: int, side: float, radio_range: float, rng: np.random.Generator
) -> list[Point]:
    """Points of a connected unit disc graph, by drawing until there is one."""
    while True:
        points = random_points(count, side, rng)
        if connected(count, unit_disc(np.array(points), radio_range)):
            return points


@dataclass
class Talk:
    """A conversation that is over."""

    award: Award
    transcript: list[tuple[Transmission, Heard]]

    @property
    def route(self) -> list[RobotId]:
        """The robots that the packet visited, the source left out."""
        return [t.receiver for t, _ in self.transcript if t.kind.startswith("route")]

    def said(self, kind: str) -> list[tuple[RobotId, RobotId | None]]:
        return [(t.sender, t.receiver) for t, _ in self.transcript if t.kind == kind]


def converse(
    protocol: Callable[..., Conversation],
    view: Sequence[Still],
    event: Event | Point,
    source: RobotId,
    *,
    deaf: Callable[[Transmission], bool] = lambda _: False,
    local: bool = True,
) -> Talk:
    """Play a protocol over an ideal radio; ``deaf`` names transmissions that nobody hears."""
    if not isinstance(event, Event):
        event = Event(0, event)
    spy = Spy(view, source, local)
    conversation = protocol(spy, event, source)
    talk = Talk(None, [])
    heard = None
    try:
        while True:
            transmission = conversation.send(heard)
            near = view[transmission.sender].neighbours
            assert transmission.sender in spy.informed, f"{transmission} by who knows of nothing"
            assert transmission.receiver is None or transmission.receiver in near, (
                f"{transmission} uses no link"
            )
            heard = () if transmission.receiver is None else (transmission.receiver,)
            if transmission.receiver is None:
                heard = tuple(near)
            if deaf(transmission):
                heard = ()
            spy.informed.update(heard)
            talk.transcript.append((transmission, heard))
    except StopIteration as end:
        talk.award = end.value
    return talk


class Spy(Sequence):
    """A view that lets only those be asked who have been told of the event."""

    def __init__(self, view: Sequence[Still], source: RobotId, local: bool) -> None:
        self._view = view
        self.informed = {source} if local else set(range(len(view)))
        self._local = local

    def __getitem__(self, robot: RobotId) -> Still:
        assert robot in self.informed, f"robot {robot} was asked, but has heard nothing"
        return self._view[robot]

    def __len__(self) -> int:
        return len(self._view)

    def __iter__(self) -> Iterator[Still]:
        assert not self._local, "nobody can look at the whole fleet"
        return iter(self._view)


def routed(routing: Callable[..., object], view: Sequence[Still], *arguments: object) -> Talk:
    """Play a routing (a part of a conversation) by itself; the award is where it ended."""

    def alone(spy: Spy, _event: Event, _source: RobotId) -> Conversation:
        return (yield from routing(spy, *arguments))

    return converse(alone, view, Event(0, (0.0, 0.0)), arguments[0])
