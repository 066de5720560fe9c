"""How time goes: in rounds, as in the paper, or as a stream of events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple


@dataclass(frozen=True, slots=True, kw_only=True)
class Rounds:
    """One event at a time; the next happens when the last has been attended to.

    Life ends with the first event that nobody takes. Over a radio that loses frames an event
    is offered ``offers`` times before nobody is said to take it.

    Raises:
        ValueError: a value is out of its range.
    """

    offers: int = 5
    service: float = 0.0  # how long a robot works on an event [s]

    def __post_init__(self) -> None:
        if self.offers < 1:
            raise ValueError(f"time offers is {self.offers}; expected 1 or more")
        if not 0.0 <= self.service < inf:
            raise ValueError(f"time service is {self.service}; expected 0 or more")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """Events by the clock, many at once; who is busy does not bid.

    An event that nobody takes waits, and is offered again after ``backoff``, each time twice
    as long, up to ``backoff_most``. It expires if no robot has set off to it by its deadline.
    A robot that does not report is given up for lost after ``patience``.

    Raises:
        ValueError: a value is out of its range.
    """

    rate: float = 0.2  # events a second, on average
    duration: float = 600.0  # of the run [s]
    service: float = 0.0  # how long a robot works on an event [s]
    deadline: float = inf  # [s]
    backoff: float = 2.0  # [s]
    backoff_most: float = 60.0  # [s]
    patience: float = 5.0  # [s]
    offers: int = 1000  # after so many an event is given up

    def __post_init__(self) -> None:
        for name in ("rate", "duration", "deadline", "backoff", "backoff_most"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"time {name} is {getattr(self, name)}; expected more than 0")
        for name in ("service", "patience"):
            if not 0.0 <= getattr(self, name) < inf:
                raise ValueError(f"time {name} is {getattr(self, name)}; expected 0 or more")
        if not self.rate <= 1e6:
            raise ValueError(f"time rate is {self.rate}; expected at most a million a second")
        if not self.duration <= 1e9:
            raise ValueError(f"time duration is {self.duration} s; expected at most 1e9")
        if self.offers < 1:
            raise ValueError(f"time offers is {self.offers}; expected 1 or more")


class Entry(NamedTuple):
    """A way for time to go, and where it comes from."""

    function: Callable[..., Any]
    source: str


TIMINGS: dict[str, Entry] = {
    "rounds": Entry(Rounds, "Stanulovic et al., Sensors 21(18):6149, 2021, section 5"),
    "stream": Entry(Stream, "Poisson by default; see the events"),
}
