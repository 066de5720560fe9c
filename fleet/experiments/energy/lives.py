"""What bids cost in network lifetime: runs that differ in nothing but what robots believe."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fleet.study.statistics import Difference, Interval, mean_interval, paired_difference

BASELINE = "straight"  # bids by Eq. (1) on the straight line

MEASURES = {
    "lifetime": "events served before one that nobody takes",
    "unbroken": "events served before a robot dies on its way",
    "failed": "trips that failed",
    "energy_failed": "energy of failed trips [J]",
    "energy_left_mean": "energy left per robot [J]",
}


@dataclass(frozen=True, slots=True)
class Life:
    """One way to bid, of one protocol in one place: means, and differences from the baseline."""

    place: str
    protocol: str
    bids: str
    runs: int
    means: Mapping[str, Interval]
    differences: Mapping[str, Difference]  # over runs of one seed


def lives(rows: Sequence[Mapping[str, Any]]) -> list[Life]:
    """Every place, protocol and way to bid that there are runs of, in the order of the rows."""
    cells: dict[tuple[str, str, str], dict[int, Mapping[str, Any]]] = {}
    for row in rows:
        cell = (row["place"], row["protocol"], row["bids"])
        cells.setdefault(cell, {})[row["seed"]] = row
    return list(_lives(cells))


def _lives(cells: Mapping[tuple[str, str, str], dict[int, Mapping[str, Any]]]) -> Iterator[Life]:
    for (place, protocol, bids), runs in cells.items():
        base = cells.get((place, protocol, BASELINE), {})
        seeds = sorted(set(runs) & set(base))
        yield Life(
            place, protocol, bids, len(runs),
            {name: mean_interval([row[name] for row in runs.values()]) for name in MEASURES},
            {
                name: paired_difference(
                    np.array([runs[seed][name] for seed in seeds], float),
                    np.array([base[seed][name] for seed in seeds], float),
                )
                for name in MEASURES
            },
        )  # fmt: skip


def find(listed: Sequence[Life], place: str, protocol: str, bids: str) -> Life | None:
    """The one of that place, protocol and way to bid, if there is one."""
    same = (
        life for life in listed if (life.place, life.protocol, life.bids) == (place, protocol, bids)
    )
    return next(same, None)
