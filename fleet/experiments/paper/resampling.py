"""Intervals by network: networks are drawn anew, and all that was run on one goes with it.

The bootstrap of pairs, stratified by range: Efron and Tibshirani, An Introduction to the Bootstrap,
1993, chapters 7 and 13. Percentile intervals of few networks are too narrow; they are expanded by
what Student's t and the spread of so few fall short: Hesterberg, Am. Stat. 69(4):371, 2015.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from fleet.experiments.paper.campaign_runs import Results
from fleet.study.statistics import CONFIDENCE, Interval

DRAWS = 2000
SEED = 2021
GUARDED = 0.999
"""The confidence of a verdict from fewer networks than the full campaign has: it should be one
that the full campaign gives too, or none."""


@dataclass(frozen=True)
class Resampled:
    """A figure of the campaign (1 + draws,): as it is, then with the networks drawn anew.

    Sums, differences, products and quotients of figures keep what they have in common: a draw of
    one is the same draw of the other.
    """

    values: NDArray[np.float64]
    strata: int  # ranges that it is of
    networks: int  # in all of them
    decisive: float = CONFIDENCE  # confidence that a verdict takes

    @property
    def value(self) -> float:
        """The figure as it is."""
        return float(self.values[0])

    def interval(self, confidence: float = CONFIDENCE) -> Interval:
        """The figure and its interval; NaN bounds: too few networks to say."""
        from scipy.special import ndtri, stdtrit

        freedom = self.networks - self.strata
        drawn = self.values[1:]
        if freedom < 1 or not np.isfinite(self.values).all():
            return Interval(self.value, nan, nan)
        tail = 50.0 * (1.0 - CONFIDENCE)  # [%]
        low, high = np.percentile(drawn, [tail, 100.0 - tail])
        each = self.networks / self.strata
        wider = float(stdtrit(freedom, 0.5 + 0.5 * confidence) / ndtri(0.5 + 0.5 * CONFIDENCE))
        wider *= sqrt(each / (each - 1.0))
        return Interval(
            self.value,
            self.value - wider * (self.value - float(low)),
            self.value + wider * (float(high) - self.value),
        )

    def __add__(self, other: Resampled | float) -> Resampled:
        return self._with(other, np.add)

    def __sub__(self, other: Resampled | float) -> Resampled:
        return self._with(other, np.subtract)

    def __mul__(self, other: Resampled | float) -> Resampled:
        return self._with(other, np.multiply)

    def __truediv__(self, other: Resampled | float) -> Resampled:
        return self._with(other, np.divide)

    def _with(self, other: Resampled | float, how: np.ufunc) -> Resampled:
        theirs = other.values if isinstance(other, Resampled) else float(other)
        with np.errstate(divide="ignore", invalid="ignore"):
            values = how(self.values, theirs)
        fewer = self
        if isinstance(other, Resampled) and _freedom(other) < _freedom(self):
            fewer = other
        return replace(fewer, values=values)


@dataclass(frozen=True)
class Networks:
    """The networks of some runs, and how often each is drawn.

    ``complete``: as many for each range as the full campaign has.
    """

    runs: Results
    complete: int

    @cached_property
    def _places(self) -> dict[tuple[float, int], int]:
        both = zip(
            self.runs.numbers("radio_range").round(6).tolist(),
            self.runs.numbers("seed").astype(int).tolist(),
            strict=True,
        )
        return {network: place for place, network in enumerate(sorted(set(both)))}

    @cached_property
    def _drawn(self) -> NDArray[np.float64]:
        """How often each network is in each draw (1 + draws, networks); first: once each."""
        rng = np.random.default_rng(SEED)
        ranges = np.array([radio_range for radio_range, _ in self._places])
        drawn = np.ones((1 + DRAWS, len(ranges)))
        for radio_range in np.unique(ranges):
            there = np.flatnonzero(ranges == radio_range)
            count = len(there)
            drawn[1:, there] = rng.multinomial(count, np.full(count, 1.0 / count), DRAWS)
        return drawn

    @property
    def each(self) -> int:
        """Networks for a range, where there are fewest."""
        found: dict[float, int] = {}
        for radio_range, _ in self._places:
            found[radio_range] = found.get(radio_range, 0) + 1
        return min(found.values(), default=0)

    @property
    def decisive(self) -> float:
        """The confidence that verdicts take."""
        return CONFIDENCE if self.each >= self.complete else GUARDED

    def mean(self, runs: Results, values: NDArray[np.float64]) -> Resampled:
        """The mean of ``values`` (n,), one a run, over runs on these networks."""
        total, count = np.zeros((2, len(self._places)))
        ranges = runs.numbers("radio_range").round(6).tolist()
        for radio_range, seed, value in zip(
            ranges, runs.numbers("seed").astype(int).tolist(), values.tolist(), strict=True
        ):
            place = self._places[radio_range, seed]
            total[place] += value
            count[place] += 1.0
        with np.errstate(invalid="ignore"):
            means = (self._drawn @ total) / (self._drawn @ count)
        strata = len(set(ranges))
        return Resampled(means, strata, int(np.count_nonzero(count)), self.decisive)


def _freedom(figure: Resampled) -> float:
    return figure.networks - figure.strata if figure.strata else -inf
