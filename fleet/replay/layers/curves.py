"""What is counted once a round, as curves."""

from __future__ import annotations

from collections import Counter

import numpy as np
import rerun as rr

from fleet.replay.columns import Moment, column, doubles
from fleet.replay.journal import RecordedLine, TripEnd
from fleet.replay.scheme import (
    COMPONENTS,
    EVENT_COLOUR,
    FLEET_ENERGY,
    FLEET_MESSAGES,
    KIND_COLOURS,
    KIND_LABELS,
    LINK_COUNT,
    ON_AIR,
    ROUTING_COLOUR,
    SOURCE_COLOUR,
    TOTAL_ENERGY,
    TRIP_ENERGY,
    UDG_COLOUR,
    WINNER_COLOUR,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import KINDS, Award

FORESEEN_COLOUR = 0x9AA5B5FF


class Curves(Layer):
    """Energy, messages and trips, at the end of each round."""

    def __init__(self) -> None:
        self._kinds: Counter[str] = Counter()
        self._foreseen = self._drained = 0.0  # [J] all trips so far
        self._energy: list[tuple[Moment, tuple[float, ...]]] = []
        self._messages: list[tuple[Moment, tuple[float, ...]]] = []
        self._trips: list[tuple[Moment, tuple[float, float]]] = []
        self._totals: list[tuple[Moment, tuple[float, float]]] = []
        self._on_air: list[tuple[Moment, tuple[float]]] = []

    def run_started(self, state: FleetState) -> None:
        """Full batteries, no messages."""
        self._state = state
        self._count(Moment(0.0, 0, 0, 0.0))

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """One more."""
        self._kinds[line.kind] += 1

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """Messages are counted when the talking is over."""
        self._messages.append((at, tuple(float(self._kinds[kind]) for kind in KINDS)))
        self._kinds.clear()

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """Energy is counted when the driving is over."""
        foreseen = self._state.foreseen(trip.origin, trip.site)
        self._foreseen += foreseen
        self._drained += trip.energy
        self._trips.append((at, (foreseen, trip.energy)))
        self._totals.append((at, (self._foreseen, self._drained)))
        self._count(at)

    def send(self, sink: Sink) -> None:
        """The curves."""
        for path, rows in (
            (FLEET_ENERGY, self._energy),
            (FLEET_MESSAGES, self._messages),
            (TRIP_ENERGY, self._trips),
            (TOTAL_ENERGY, self._totals),
            (ON_AIR, self._on_air),
        ):
            if rows:
                when, values = zip(*rows, strict=True)
                numbers = np.array(values, float)
                sink.rows(
                    path,
                    when,
                    column(
                        rr.Scalars.descriptor_scalars(),
                        doubles(numbers.ravel()),
                        np.full(len(numbers), numbers.shape[1]),
                    ),
                )
                rows.clear()

    def _count(self, at: Moment) -> None:
        energies = self._state.energies
        mean, spread = float(energies.mean()), float(energies.std())
        figures = (mean, float(energies.min()), max(mean - spread, 0.0), mean + spread)
        self._energy.append((at, figures))
        self._on_air.append((at, (float(self._state.on_air.sum()),)))


def describe_counts(sink: Sink) -> None:
    """Names, units and colours of the curves."""
    curves: dict[str, tuple[list[str], list[int], list[float]]] = {
        FLEET_ENERGY: (
            ["mean", "minimum", "mean − SD", "mean + SD"],
            [0xE8ECF2FF, EVENT_COLOUR, FORESEEN_COLOUR, FORESEEN_COLOUR],
            [2.5, 1.5, 1.0, 1.0],
        ),
        FLEET_MESSAGES: (
            [KIND_LABELS[kind] for kind in KINDS],
            [KIND_COLOURS[kind] for kind in KINDS],
            [1.5] * len(KINDS),
        ),
        TRIP_ENERGY: (
            ["Eq. (1), straight", "drained"], [FORESEEN_COLOUR, WINNER_COLOUR], [2.5, 1.5]
        ),
        TOTAL_ENERGY: (
            ["Eq. (1), straight", "drained"], [FORESEEN_COLOUR, WINNER_COLOUR], [2.5, 1.5]
        ),
        LINK_COUNT: (
            ["in range", "routing"], [UDG_COLOUR | 0xFF, ROUTING_COLOUR | 0xFF], [1.5, 2.0]
        ),
        COMPONENTS: (["components"], [EVENT_COLOUR], [2.0]),
        ON_AIR: (["robots on the air"], [SOURCE_COLOUR], [2.0]),
    }  # fmt: skip
    steps = rr.components.InterpolationMode.StepAfter
    for path, (names, paint, widths) in curves.items():
        sink.static(
            path,
            rr.SeriesLines.from_fields(
                names=names,
                colors=np.array(paint, np.uint32),
                widths=widths,
                interpolation_mode=None if path in (FLEET_ENERGY, TOTAL_ENERGY) else steps,
            ),
        )
