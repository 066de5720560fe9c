"""Trying a protocol out before a run, with two robots and one event; and during it.

What is wrong with a protocol or metric of the user's, or with a parameter that only the protocol
itself looks at, is said before anything has begun; what goes wrong later is said as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import dist, isnan
from numbers import Real
from pathlib import Path
from typing import Any, TypeVar

from fleet.scenario.errors import BadInput, bad, shown
from fleet.scenario.guard import Guard, begun, described
from fleet.scenario.plugins import what
from fleet.scenario.reading import reason
from protocols.messages import (
    Award,
    Event,
    Point,
    ProtocolFunction,
    RobotId,
    Transmission,
)

T = TypeVar("T")
PATIENCE = 10_000  # transmissions between two robots, after which a protocol never ends
PER_METRE = 20.0  # [J/m]


@dataclass(frozen=True, slots=True)
class _Extra:
    """A robot that is there for the rehearsal: a :class:`protocols.messages.RobotView`."""

    id: RobotId
    position: Point  # [m]
    neighbours: Mapping[RobotId, Point]
    radio_range: float = 2.0  # [m]
    energy: float = 100.0  # [J]

    def cost_to(self, site: Point) -> float:
        """What going to ``site`` [m] takes [J]."""
        return PER_METRE * dist(self.position, site)


PLACES: tuple[Point, Point] = ((0.0, 0.0), (1.0, 0.0))
VIEW = [_Extra(id, PLACES[id], {1 - id: PLACES[1 - id]}) for id in (0, 1)]
EVENT = Event(0, (1.5, 0.5))


def rehearse(protocol: ProtocolFunction, called: str) -> None:
    """Hold one conversation between two robots.

    Raises:
        BadInput: it refuses its parameters, never ends, says what is no transmission, ends
            without an award, or hears bids that are no numbers.
    """
    try:
        costs: list[Any] = [getattr(bid, "cost", bid) for bid in _play(protocol, called).bids]
    except BadInput:
        raise
    except ValueError as error:
        raise bad("protocol", f"{shown(called)} fails: {reason(error)}") from error
    except TypeError as error:
        raise bad("protocol", f"{shown(called)} fails: {what(error)}") from error
    for cost in costs:
        if not isinstance(cost, Real) or isnan(cost):
            raise bad(
                "protocol", f"{shown(called)}: a bid's cost is {shown(cost)}; expected a number"
            )


def _play(protocol: ProtocolFunction, called: str) -> Award:
    words = begun(protocol(VIEW, EVENT, 0), called)
    heard: Any = None
    for _ in range(PATIENCE):
        try:
            said = checked(words.send(heard), Transmission, "yields", called)
        except StopIteration as end:
            return checked(end.value, Award, "returns", called)
        if said.sender not in (0, 1):
            raise ValueError(f"robot {shown(said.sender)} speaks; there are robots 0 and 1")
        heard = (1 - said.sender,)
    raise ValueError(f"it still talks after {PATIENCE} transmissions between two robots")


def checked(value: object, kind: type[T], verb: str, called: str) -> T:
    """What a protocol yields, or returns at its end.

    Raises:
        BadInput: it is something else.
    """
    if isinstance(value, kind):
        return value
    expected = f"a {kind.__name__}" if kind is Transmission else f"an {kind.__name__} at its end"
    raise bad("protocol", f"{shown(called)} {verb} {described(value)}; expected {expected}")


def guarded(protocol: ProtocolFunction, called: str, parts: Mapping[str, Any]) -> ProtocolFunction:
    """``protocol``, if anything of it is from a file of the user's, under guard for a whole run.

    What it raises, that it never says anything more, and that it breaks one of
    :mod:`protocols.rules`, is bad input: one sentence with file and line. ``parts`` are its name
    and parameters as the scenario has them.
    """
    files = [Path(text.rpartition(":")[0]).resolve() for text in _texts(parts) if ".py:" in text]
    if not files:
        return protocol
    return Guard(protocol, called, [file.parent for file in files])


def _texts(value: Any) -> Iterator[str]:
    """All texts in a table, however deep."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for item in value.values():
            yield from _texts(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _texts(item)
