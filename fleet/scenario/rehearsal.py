"""Trying a protocol out before a run: two robots, one event.

What is wrong with a protocol or metric of the user's, or with a parameter that only the protocol
itself looks at, is said before anything has begun.
"""

from __future__ import annotations

import traceback
from collections.abc import Generator, Mapping
from dataclasses import dataclass
from math import dist, isnan
from numbers import Real
from pathlib import Path
from typing import Any

from fleet.scenario.errors import bad
from protocols.messages import Award, Event, Point, ProtocolFunction, RobotId, Transmission

PATIENCE = 10_000  # transmissions between two robots, after which a protocol never ends
PER_METRE = 20.0  # [J/m]


@dataclass(frozen=True, slots=True)
class _Extra:
    """A robot that is there for the rehearsal: a :class:`protocols.messages.Robot`."""

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
        BadInput: it fails, never ends, says what is no transmission, ends without an award, or
            hears bids that are no numbers.
    """
    try:
        award = _play(protocol)
    except Exception as error:  # whatever the user's file raises is the user's to read
        raise bad("protocol", f"{called!r} fails{_line(error)}: {_reason(error)}") from error
    if not isinstance(award, Award):
        raise bad("protocol", f"{called!r} returns {_kind(award)}; expected an Award at its end")
    costs: list[Any] = [bid.cost for bid in award.bids]
    for cost in costs:
        if not isinstance(cost, Real) or isnan(cost):
            raise bad("protocol", f"{called!r}: a bid's cost is {cost!r}; expected a number")


def _play(protocol: ProtocolFunction) -> object:
    words: Any = protocol(VIEW, EVENT, 0)
    if not isinstance(words, Generator):
        raise TypeError(f"it returns {_kind(words)}; expected a generator of transmissions")
    heard: tuple[RobotId, ...] | None = None
    for _ in range(PATIENCE):
        try:
            said = words.send(heard)
        except StopIteration as end:
            return end.value
        if not isinstance(said, Transmission):
            raise TypeError(f"it yields {_kind(said)}; expected a Transmission")
        heard = (1 - said.sender,)
    raise RuntimeError(f"it still talks after {PATIENCE} transmissions between two robots")


def _kind(value: object) -> str:
    return "nothing" if value is None else f"{type(value).__name__} {value!r:.40}"


def _reason(error: Exception) -> str:
    return str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"


def _line(error: Exception) -> str:
    """Where it was raised, if that is not in this program."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    ours = {"fleet", "protocols"} & set(Path(last.filename).parts)
    return "" if ours else f" in line {last.lineno}"
