"""What every protocol keeps to, and a view of the fleet that holds it to that.

1. Knowledge travels in transmissions: only a robot that has been told of the event, by being its
   source or by hearing a transmission, is asked, speaks, goes, or is named in an award.
2. What is said goes over a link, to a neighbour of the sender's or to all that hear it: radios
   see to that.
3. What is said has a kind: one of ours, or a word of the protocol's own, which is counted as well.
4. Robots are asked, not changed.
5. A conversation ends with an award.

A baseline that is meant to know everything says so, by an attribute ``all_knowing``; for it the
first rule does not hold.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from functools import partial
from math import isfinite, isnan
from numbers import Real
from operator import attrgetter
from types import MappingProxyType
from typing import Any

from protocols.messages import KINDS, Award, Bid, Heard, Point, RobotId, RobotView, Transmission

OURS = frozenset(KINDS)
SHOWN = 60  # characters of a value that is named
LONGEST_KIND = 40  # characters


class BrokenRule(Exception):
    """A protocol did what none may do; the sentence says which rule, and which robot."""


def all_knowing(protocol: object) -> bool:
    """Whether a protocol is a baseline that knows everybody, whoever was told."""
    return bool(getattr(getattr(protocol, "func", protocol), "all_knowing", False))


class ReadOnlyRobot:
    """What a robot knows, to be read and not to be changed: :class:`protocols.messages.RobotView`.

    Read often, so without a step in Python wherever that can be.
    """

    __slots__ = ("_robot", "cost_to", "id", "radio_range")

    id: RobotId
    radio_range: float
    cost_to: Callable[[Point], float]
    position = property(attrgetter("_robot.position"))
    energy = property(attrgetter("_robot.energy"))

    def __init__(self, robot: RobotView) -> None:
        keep = partial(object.__setattr__, self)
        keep("_robot", robot)
        keep("id", robot.id)
        keep("radio_range", robot.radio_range)
        keep("cost_to", robot.cost_to)

    @property
    def neighbours(self) -> Mapping[RobotId, Point]:
        """Neighbours in the routing graph, by ascending id: last known positions [m]."""
        return MappingProxyType(self._robot.neighbours)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise BrokenRule(
            f"robot {self.id} is asked for {name!r:.{SHOWN}}; a robot knows its id, position,"
            " radio_range, energy, neighbours and cost_to"
        )

    def __setattr__(self, name: str, _value: object) -> None:
        raise BrokenRule(
            f"robot {self.id} is written to ({name:.{SHOWN}}); robots are asked, not changed"
        )

    def __delattr__(self, name: str) -> None:
        self.__setattr__(name, None)


class Told(dict[RobotId, Any]):
    """The fleet as one conversation sees it: the robots that have been told of its event."""

    def __init__(self, fleet: Sequence[ReadOnlyRobot], told: Iterable[RobotId]) -> None:
        super().__init__((robot, fleet[robot]) for robot in told)
        self._fleet = fleet

    def __missing__(self, robot: object) -> RobotView:
        raise BrokenRule(
            f"robot {robot!r:.{SHOWN}} is asked, but nobody has told it of the event"
            " (a baseline that is to know everybody says so: all_knowing = True)"
        )

    def __len__(self) -> int:
        return len(self._fleet)

    def __iter__(self) -> Iterator[Any]:
        raise BrokenRule(
            "all robots are asked, but nobody has told them of the event"
            " (a baseline that is to know everybody says so: all_knowing = True)"
        )


def plainly_allowed(said: Any, told: Container[Any]) -> bool:
    """Whether it is seen at once that a transmission may be made; else :meth:`Conduct.check` tells.

    It is asked of each; ``told`` are the robots that have been told of the event.
    """
    if type(said) is not Transmission:
        return False
    parts: tuple[Any, ...] = said  # of whatever types they are
    kind, sender, _, bid = parts
    return (
        type(kind) is str
        and kind in OURS
        and type(sender) is int
        and sender in told
        and (
            bid is None
            or (
                type(bid) is Bid
                and type(bid[0]) is float
                and not isnan(bid[0])
                and type(bid[1]) is int
                and bid[1] in told
            )
        )
    )


class Conduct:
    """Holds one conversation to the rules. ``view`` is what its protocol is to see.

    ``fleet`` are read-only robots, made once for many conversations.
    """

    def __init__(
        self, fleet: Sequence[ReadOnlyRobot], source: RobotId, *, knows_all: bool = False
    ) -> None:
        everybody = dict(enumerate(fleet)) if knows_all else None
        self.told: dict[RobotId, Any] = everybody or Told(fleet, (source,))
        self.view: Any = fleet if knows_all else self.told
        self._fleet = fleet

    def heard(self, robots: Heard) -> None:
        """These have heard a transmission."""
        for robot in robots:
            self.told[robot] = self._fleet[robot]

    def check(self, said: Any) -> None:
        """Whether a transmission may be made; a sentence for each thing that may be wrong.

        Raises:
            BrokenRule: it may not.
        """
        if not isinstance(said, Transmission):
            raise BrokenRule(f"it yields {said!r:.{SHOWN}}; expected a Transmission")
        kind, sender, receiver, bid = said
        if not isinstance(kind, str) or kind not in OURS:
            _check_kind(kind)
        self._check_robot(sender, "speaks")
        if receiver is not None:
            self._check_number(receiver, "is spoken to")
        if bid is not None:
            self._check_bid(bid)

    def check_award(self, award: object) -> None:
        """Whether a conversation may end with this.

        Raises:
            BrokenRule: it may not.
        """
        if not isinstance(award, Award):
            raise BrokenRule(f"it ends with {award!r:.{SHOWN}}; expected an Award")
        if award.winner is not None:
            self._check_robot(award.winner, "wins")
        self._check_robot(award.auctioneer, "is named as the auctioneer")
        for bid in award.bids:
            self._check_bid(bid)
        for move in award.moves:
            self._check_robot(move.robot, "is moved")
            if not all(map(isfinite, move.position)):
                raise BrokenRule(f"robot {move.robot} is moved to {move.position}; expected x, y")

    def _check_bid(self, bid: Any) -> None:
        if not isinstance(bid, Bid):
            raise BrokenRule(f"a bid is {bid!r:.{SHOWN}}; expected a Bid")
        self._check_robot(bid.robot, "bids")
        cost: Any = bid.cost
        if not isinstance(cost, Real) or isnan(cost):
            raise BrokenRule(f"robot {bid.robot} bids {cost!r:.{SHOWN}}; expected a number")

    def _check_robot(self, robot: Any, does: str) -> None:
        if type(robot) is not int or robot not in self.told:
            self._check_number(robot, does)
            raise BrokenRule(f"robot {robot} {does}, but nobody has told it of the event")

    def _check_number(self, robot: Any, does: str) -> None:
        n = len(self._fleet)
        if type(robot) is not int or not 0 <= robot < n:
            raise BrokenRule(f"robot {robot!r:.{SHOWN}} {does}; expected one of 0 to {n - 1}")


def _check_kind(kind: Any) -> None:
    if not isinstance(kind, str) or not kind.isprintable() or not 0 < len(kind) <= LONGEST_KIND:
        raise BrokenRule(f"a transmission's kind is {kind!r:.{SHOWN}}; expected a word")
    near = get_close_matches(kind.lower(), KINDS, 1, 0.8) if kind not in KINDS else []
    if near:
        raise BrokenRule(f"a transmission's kind is {kind!r}; did you mean {near[0]!r}?")
