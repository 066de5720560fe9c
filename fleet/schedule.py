"""What befalls a fleet."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fleet.faults import Blackout, Breakdown
from fleet.modes import Rounds, Stream
from worlds.events import Occurrence


@dataclass(frozen=True, slots=True)
class Schedule:
    """How time goes, what happens, what breaks, and when it is over."""

    timing: Rounds | Stream
    occurrences: Iterator[Occurrence]
    breakdowns: Sequence[Breakdown] = ()
    blackouts: Sequence[Blackout] = ()
    rounds: int | None = None  # served in rounds, or raised in a stream; None: no limit
