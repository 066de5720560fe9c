"""The campaign under one reading: what its runs come to, by network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.cases import NETWORKS, WORLDS, otherwise
from fleet.experiments.paper.readings import ANY, DEFAULT, Bids, SearchReading, ge_series
from fleet.experiments.paper.resampling import Networks, Resampled

TWO_SR = 2.0  # [m]


@dataclass(frozen=True)
class Sample:
    """The runs of one reading, and of what has none, on the networks that the reading was run on.

    ``bids`` says whose messages are RFTA2GE's; lifetimes are the same for all of them.
    """

    runs: Results
    networks: Networks
    reading: SearchReading
    bids: Bids

    @classmethod
    def of(
        cls, results: Results, reading: SearchReading = DEFAULT, bids: Bids = "relayed"
    ) -> Sample:
        """The sample of a reading among the campaign's runs of one motion."""
        complete = NETWORKS if reading == DEFAULT else otherwise(NETWORKS)
        mine = results.where(reading=str(reading))
        shared = results.where(reading=ANY)
        there = set(_networks(mine))
        kept = [network in there for network in _networks(shared)]
        runs = mine.with_rows_of(shared.take(np.array(kept, bool)))
        return cls(runs, Networks(runs, complete), reading, bids)

    def counting(self, bids: Bids) -> Sample:
        """The same, with bids counted another way."""
        return Sample(self.runs, self.networks, self.reading, bids)

    def ranges(self, series: str) -> list[float]:
        """The radio ranges that a series was run at [m]."""
        return [float(r) for r in self.runs.where(series=series).values("radio_range")]

    def lifetime(self, series: str, world: str = WORLDS[0], **more: float) -> Resampled:
        """Mean lifetime [rounds] at 2SR, over all ranges unless one is given."""
        return self.figure("lifetime", series, world, **more)

    def closest(self, series: str, world: str = WORLDS[0], **more: float) -> Resampled:
        """Mean share of routings that end at the robot nearest to the event."""
        return self.figure("closest_found", series, world, **more)

    def figure(self, name: str, series: str, world: str = WORLDS[0], **more: float) -> Resampled:
        """The mean of a figure of the summary at 2SR, over all ranges unless one is given."""
        chosen = self._chosen(series, world, more)
        return self.networks.mean(chosen, chosen.numbers(name))

    def messages(self, series: str, world: str = WORLDS[0], **more: float) -> Resampled:
        """Mean messages a round at 2SR, over all ranges unless one is given."""
        if series == "rfta2ge" and more.get("search_radius", TWO_SR) == TWO_SR:
            series = ge_series(self.bids)
        chosen = self._chosen(series, world, more)
        return self.networks.mean(chosen, chosen.per_event())

    def longest(self, series: str, world: str = WORLDS[0]) -> tuple[float, Resampled]:
        """The range [m] at which a series lives longest, and how long [rounds]."""
        found = [(r, self.lifetime(series, world, radio_range=r)) for r in self.ranges(series)]
        return max(found, key=lambda each: each[1].value)

    def _chosen(self, series: str, world: str, more: dict[str, float]) -> Results:
        return self.runs.where(series=series, world=world, **{"search_radius": TWO_SR, **more})


def _networks(runs: Results) -> Sequence[tuple[float, int]]:
    ranges: NDArray[np.float64] = runs.numbers("radio_range").round(6)
    return list(zip(ranges.tolist(), runs.numbers("seed").astype(int).tolist(), strict=True))
