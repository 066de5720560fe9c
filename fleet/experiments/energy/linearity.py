"""Linear and proportional: what a line in the distance is worth, and what Eq. (1) is."""

from __future__ import annotations

from dataclasses import dataclass

from fleet.experiments.energy.accuracy import accuracy, usable_from, worst_bin
from fleet.experiments.energy.models import LINE, fit, held_out
from fleet.experiments.energy.trip_table import TripTable
from fleet.study.statistics import Interval

TOLERABLE = 0.10  # share by which a prediction may be off and still be used


@dataclass(frozen=True, slots=True)
class Linearity:
    """How trips of one robot depend on their straight distance."""

    trips: int
    intercept: Interval  # of the best line [J]
    slope: Interval  # [J/m]
    rate: float  # of Eq. (1) [J/m]
    r2: float  # of the line, on placements that it was not fitted on
    line_off: float  # share by which the line is off in its worst bin of distance
    eq1_r2: float  # of Eq. (1) as it stands
    within_10: float  # straight distance from which on Eq. (1) is within a tenth of the line [m]
    within_5: float  # and within a twentieth [m]

    @property
    def linear(self) -> bool:
        """Whether the line is tolerable at all lengths."""
        return self.line_off <= TOLERABLE


def linearity(trips: TripTable) -> Linearity:
    """Of trips that arrived, of one setting."""
    line = fit(LINE, trips)
    intercept, slope = line.coefficients
    rate = float(trips["per_metre"][0])
    within = [
        usable_from(intercept.value, slope.value, rate, share, float(trips["straight"].max()))
        for share in (TOLERABLE, 0.5 * TOLERABLE)
    ]
    return Linearity(
        trips=len(trips),
        intercept=intercept,
        slope=slope,
        rate=rate,
        r2=held_out(LINE, trips)[1].r2,
        line_off=worst_bin(trips["straight"], trips["drained"], line.predict(trips)),
        eq1_r2=accuracy(trips["drained"], trips.eq1).r2,
        within_10=within[0],
        within_5=within[1],
    )
