"""What every protocol is put through: a battery over random networks that stand still.

:func:`problems` plays a protocol on networks with uneven, often nearly empty batteries, and says
what it does that no protocol may, or that none should. The tests put the catalogue through it,
``fleet check`` a protocol of the user's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import dist, inf
from typing import Any, NamedTuple

import numpy as np

from protocols.messages import (
    KINDS,
    Award,
    Event,
    Heard,
    Point,
    ProtocolFunction,
    RobotId,
    Transmission,
)
from protocols.rules import BrokenRule, Conduct, ReadOnlyRobot, all_knowing
from protocols.topology import GraphName, Topology, connected, unit_disc

PER_METRE = 19.355789473684212  # Eq. (1) at 0.76 m/s [J/m]
PATIENCE = 40_000  # transmissions after which a conversation is said never to end


@dataclass(frozen=True)
class StillRobot:
    """A robot that does not move: a :class:`protocols.messages.RobotView`."""

    id: RobotId
    position: Point  # [m]
    energy: float  # [J]
    neighbours: Mapping[RobotId, Point]
    unreachable: tuple[Point, ...] = ()
    radio_range: float = 1.0  # [m]

    def cost_to(self, site: Point) -> float:
        """What going to ``site`` [m] takes [J]."""
        return inf if site in self.unreachable else PER_METRE * dist(self.position, site)


def network(
    positions: Sequence[Point],
    radio_range: float,
    graph: GraphName = "gabriel",
    energy: float | Sequence[float] = 100.0,
) -> list[StillRobot]:
    """Robots at these positions [m], linked as the topology says."""
    topology = Topology(positions, radio_range, graph)
    energies = [energy] * len(positions) if isinstance(energy, float | int) else energy
    return [
        StillRobot(
            id, position, float(energies[id]), topology.neighbours[id], radio_range=radio_range
        )
        for id, position in enumerate(topology.positions)
    ]


def random_points(count: int, side: float, rng: np.random.Generator) -> list[Point]:
    """Points in a square [m]."""
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
    def route(self) -> list[RobotId | None]:
        """The robots that the packet visited, the source left out."""
        return [t.receiver for t, _ in self.transcript if t.kind.startswith("route")]

    def said(self, kind: str) -> list[tuple[RobotId, RobotId | None]]:
        """From whom to whom something of that kind was said."""
        return [(t.sender, t.receiver) for t, _ in self.transcript if t.kind == kind]


def converse(
    protocol: ProtocolFunction,
    view: Sequence[StillRobot],
    event: Event | Point,
    source: RobotId,
    *,
    deaf: Callable[[Transmission], bool] = lambda _: False,
    knows_all: bool | None = None,
) -> Talk:
    """Play a protocol over an ideal radio; ``deaf`` names transmissions that nobody hears.

    Raises:
        BrokenRule: it breaks one of :mod:`protocols.rules`, sends where no link is, or does not
            come to an end.
    """
    if not isinstance(event, Event):
        event = Event(0, event)
    all_known = all_knowing(protocol) if knows_all is None else knows_all
    conduct = Conduct([ReadOnlyRobot(robot) for robot in view], source, knows_all=all_known)
    words = protocol(conduct.view, event, source)
    transcript: list[tuple[Transmission, Heard]] = []
    heard: Heard | None = None
    while True:
        try:
            said = words.send(heard)  # type: ignore[arg-type]  # None starts a generator
        except StopIteration as end:
            conduct.check_award(end.value)
            return Talk(end.value, transcript)
        try:
            conduct.check(said)
            near = view[said.sender].neighbours
            _check_link(said, near)
        except BrokenRule as broken:
            words.throw(broken)  # to be raised where it was said
            raise
        heard = tuple(near) if said.receiver is None else (said.receiver,)
        heard = () if deaf(said) else heard
        conduct.heard(heard)
        transcript.append((said, heard))
        if len(transcript) > PATIENCE:
            raise BrokenRule(f"it still talks after {PATIENCE} transmissions")


def _check_link(said: Transmission, near: Mapping[RobotId, Point]) -> None:
    if said.receiver is not None and said.receiver not in near:
        raise BrokenRule(
            f"robot {said.sender} sends a {said.kind!r} to robot {said.receiver}, which is not"
            f" among its neighbours {tuple(near)}"
        )


class Case(NamedTuple):
    """A network, an event and who is told of it."""

    points: list[Point]
    graph: GraphName
    energy: list[float]
    event: Event
    source: RobotId
    rng: np.random.Generator  # for what a check changes

    def view(self) -> list[StillRobot]:
        """Its robots."""
        return network(self.points, RANGE, self.graph, self.energy)


RANGE = 2.7  # [m]
CHANGES = 8  # robots that are changed in a network, one at a time, to see who decides another way
GRAPHS: tuple[GraphName, ...] = ("gabriel", "udg", "rng", "emst")


def cases(graph: GraphName, count: int = 12) -> Iterator[Case]:
    """Networks of 40 robots with uneven batteries; in each third one all are nearly empty."""
    rng = np.random.default_rng(list(graph.encode()))
    for k in range(count):
        points = random_connected(40, 10.0, RANGE, rng)
        energy = rng.uniform(0.0, 60.0 if k % 3 else 5.0, 40).tolist()
        event = Event(k, random_points(1, 10.0, rng)[0])
        yield Case(points, graph, energy, event, int(rng.integers(40)), rng)


def keeps_the_rules(protocol: ProtocolFunction, case: Case) -> str:
    """Those of :mod:`protocols.rules`."""
    converse(protocol, case.view(), case.event, case.source)
    return ""


def says_the_same_again(protocol: ProtocolFunction, case: Case) -> str:
    """Nothing but what robots know and hear decides."""
    first, second = (converse(protocol, case.view(), case.event, case.source) for _ in range(2))
    return "" if first == second else "the same situation led to another conversation"


def speaks_the_language(protocol: ProtocolFunction, case: Case) -> str:
    """Of our kinds of transmissions, calls alone are broadcast, and an assignment names a bid."""
    for said, _ in converse(protocol, case.view(), case.event, case.source).transcript:
        if said.kind in KINDS and said.kind != "call" and said.receiver is None:
            return f"a {said.kind!r} of robot {said.sender} is for nobody in particular"
        if said.kind == "assign" and said.bid is None:
            return f"robot {said.sender} assigns without naming the bid"
    return ""


def sends_who_can_afford_it(protocol: ProtocolFunction, case: Case) -> str:
    """The winner has the energy for the trip."""
    view = case.view()
    winner = converse(protocol, view, case.event, case.source).award.winner
    if winner is None or view[winner].energy >= view[winner].cost_to(case.event.position):
        return ""
    return f"robot {winner} wins, but holds less than the trip costs"


def does_not_look_at_names(protocol: ProtocolFunction, case: Case) -> str:
    """Relabelling the robots relabels the winner."""
    order = case.rng.permutation(len(case.points)).tolist()
    shuffled = case._replace(
        points=[case.points[k] for k in order], energy=[case.energy[k] for k in order]
    )
    plain = converse(protocol, case.view(), case.event, case.source).award
    other = converse(protocol, shuffled.view(), case.event, order.index(case.source)).award
    renamed = None if other.winner is None else order[other.winner]
    if renamed == plain.winner and order[other.auctioneer] == plain.auctioneer:
        return ""
    return f"robot {plain.winner} wins; with the robots renamed, robot {renamed} does"


def decides_by_what_was_heard(protocol: ProtocolFunction, case: Case) -> str:
    """Two situations in which a robot knows the same lead to the same decision of it.

    What a robot can know is itself, its neighbours, and whatever those that it heard knew when they
    spoke. Something is changed that most robots cannot know, the battery of one, or whether it is
    there; whoever does not hear of it goes on as before.
    """
    if all_knowing(protocol):
        return ""

    view = case.view()
    talk = converse(protocol, view, case.event, case.source)
    before = decisions(view, case.source, talk)
    told = {case.source}.union(*(heard for _, heard in talk.transcript))
    near = sorted(told.union(*(view[robot].neighbours for robot in told)) - {case.source})
    for changed in case.rng.permutation(near)[:CHANGES].tolist():
        for other in (_another_battery(case, changed), _gone(case, changed)):
            talk = converse(protocol, other, case.event, case.source)
            after = decisions(other, case.source, talk)
            problem = _parted(before, after) or _parted(after, before)
            if problem:
                return f"{problem}, as robot {changed} is another"
    return ""


def _another_battery(case: Case, robot: RobotId) -> list[StillRobot]:
    view = case.view()
    full = view[robot].energy < 20.0
    view[robot] = replace(view[robot], energy=90.0 if full else 0.5)
    return view


def _gone(case: Case, robot: RobotId) -> list[StillRobot]:
    away = [*case.points]
    away[robot] = (float("nan"), float("nan"))
    return case._replace(points=away).view()


Knowledge = int  # a digest of all that a robot can know


class Decisions(NamedTuple):
    """What was decided, and what by."""

    made: dict[tuple[RobotId, Knowledge], Any]  # what a robot said that knew this
    last: set[tuple[RobotId, Knowledge]]  # what robots knew in the end, and said nothing more


def decisions(view: Sequence[StillRobot], source: RobotId, talk: Talk) -> Decisions:
    """What each robot knew whenever it spoke, and at the end.

    A frame may carry whatever its sender knows, such as how far a call has come.
    """
    knows: list[Knowledge] = [
        hash((robot.id, robot.position, robot.energy, tuple(robot.neighbours.items())))
        for robot in view
    ]
    knows[source] = hash((knows[source], "told"))
    made: dict[tuple[RobotId, Knowledge], Any] = {}
    for said, heard in talk.transcript:
        carried = knows[said.sender]
        made[said.sender, carried] = said
        for robot in (said.sender, *heard):
            knows[robot] = hash((knows[robot], said, carried))
    award = talk.award
    decider = award.auctioneer if award.winner is None else award.winner  # who goes, or gives up
    made[decider, knows[decider]] = (award.winner, award.moves)
    return Decisions(made, set(enumerate(knows)) - {(decider, knows[decider])})


def _parted(one: Decisions, other: Decisions) -> str:
    """What a robot decided another way though it knew the same; "" if none did."""
    for known, said in one.made.items():
        if known in other.last or other.made.get(known, said) != said:
            return f"robot {known[0]} says {said}, or another time does not, by what it cannot know"
    return ""


CHECKS: dict[str, Callable[[ProtocolFunction, Case], str]] = {
    "keeps the rules": keeps_the_rules,
    "says the same again": says_the_same_again,
    "speaks the language": speaks_the_language,
    "sends who can afford the trip": sends_who_can_afford_it,
    "does not look at names": does_not_look_at_names,
    "decides by what was heard": decides_by_what_was_heard,
}
"""What is checked, in words."""


def problem(
    check: str,
    protocol: ProtocolFunction,
    graphs: Sequence[GraphName] = GRAPHS,
    where: Callable[[BrokenRule], str] = lambda _: "",
) -> str:
    """What is wrong with a protocol by one of :data:`CHECKS`; "" if nothing is.

    ``where`` says in which line a rule was broken.
    """
    for graph in graphs:
        for case in cases(graph):
            try:
                found = CHECKS[check](protocol, case)
            except BrokenRule as broken:
                found = f"breaks a rule{where(broken)}: {broken}"
            if found:
                return f"{found} (event {case.event.id} on the {graph} graph)"
    return ""
