"""The ways to read what the paper leaves open: each is run and told by itself, none mixed.

A *search* reading decides where a route ends and so who goes; the *bids* reading decides only how
RFTA2GE's bids from two hops away are counted, and leaves the winner as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Literal, get_args

Stop = Literal["edge", "node"]
Check = Literal["minimum", "hop"]
Bids = Literal["relayed", "aggregated", "outbid"]

ANY = "any"
"""The reading of series that search for nobody: all readings share them."""


@dataclass(frozen=True, slots=True)
class SearchReading:
    """When a failed search stops, and where the search radius is looked at."""

    stop: Stop = "edge"
    check: Check = "minimum"

    def __str__(self) -> str:
        return f"{self.stop}, {self.check}"

    @property
    def parameters(self) -> dict[str, str]:
        """What of a protocol's ``search`` is not the default."""
        chosen = {"stop": self.stop, "check": self.check}
        return {key: value for key, value in chosen.items() if value != getattr(DEFAULT, key)}


DEFAULT = SearchReading()
SEARCHES = tuple(SearchReading(*both) for both in product(get_args(Stop), get_args(Check)))
BIDS: tuple[Bids, ...] = get_args(Bids)

STOPS = {
    "edge": "a failed search ends when the first edge of the face comes up again (Section 2.5)",
    "node": "a failed search ends before a robot is entered twice (the pseudo-code)",
}
CHECKS = {
    "minimum": "the search radius is looked at where greedy routing ends",
    "hop": "the search radius is looked at at every hop (the picture of Lemma 2)",
}
COUNTS = {
    "relayed": "every bid is relayed by itself",
    "aggregated": "a neighbour passes on the best bid that it has heard",
    "outbid": "aggregated, and only those bid that outbid whom they heard the call from",
}


def ge_series(bids: Bids) -> str:
    """The series whose messages are those of RFTA2GE with bids counted that way."""
    return "rfta2ge" if bids == "relayed" else f"rfta2ge-{bids}"
