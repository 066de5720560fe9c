"""What the paper ran, as scenarios: which protocol, where, at which ranges, how often."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

WORLDS = ("random", "random-hole")
RANGES = tuple(round(1.5 + 0.5 * k, 1) for k in range(9))  # r = 0.15 ... 0.55 [m × 0.1]
SEARCH_RADII = (1.0, 2.0, 3.0, 4.0)  # SR ... 4SR [m]
BASELINE_RANGE = 2.0  # r = 0.2, of Figures 9 and 10 [m]
NETWORKS, NETWORKS_QUICK = 100, 10
SEEDS = 1000  # networks are the same for all protocols, but others at each range
SHORT = {"rounds": 10, "robot": {"capacity": 1e6}}
"""Costs of single tasks: a few rounds in which energy plays no part."""


@dataclass(frozen=True, slots=True)
class Series:
    """A curve or a bar of the paper: one protocol over ranges and search radii."""

    name: str
    protocol: Any  # as in a scenario
    search_radii: tuple[float, ...] = SEARCH_RADII
    ranges: tuple[float, ...] = RANGES
    short: bool = False  # single tasks, not lifetimes


SERIES = (
    Series("rfta2", "rfta2"),
    Series("rfta2ge", "rfta2ge"),
    Series("gfgf2a", "gfgf2a", search_radii=(2.0,)),
    Series("rfta2ge-aggregated", {"name": "rfta2ge", "aggregate": True}, (2.0,)),
    Series("rfta2ge-outbid", {"name": "rfta2ge", "aggregate": True, "outbid": True}, (2.0,)),
    Series("rfta1", "rfta1", short=True),
    Series("gfgf2", "gfgf2", short=True),
    Series("gfgf1", "gfgf1", search_radii=(2.0,), short=True),
    Series("rfta3", "rfta3", (2.0,)),  # beyond the paper
    Series("optimum", {"name": "optimum", "metric": "company-share"}, (2.0,)),  # knows all robots
    Series("7-saap", {"name": "k-saap", "hops": 7}, (2.0,), (BASELINE_RANGE,)),
    Series("bfs-7", {"name": "bfs", "hopmax": 7}, (2.0,), (BASELINE_RANGE,)),
    Series("bfs-10", {"name": "bfs", "hopmax": 10}, (2.0,), (BASELINE_RANGE,)),
)


def cases(networks: int, motion: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every run of the campaign: the name of its series, and its scenario."""
    for series in SERIES:
        for world in WORLDS:
            for radio_range in series.ranges:
                first = SEEDS * RANGES.index(radio_range)
                for search_radius in series.search_radii:
                    for seed in range(first, first + networks):
                        scenario = {
                            "protocol": series.protocol,
                            "world": world,
                            "motion": motion,
                            "range": radio_range,
                            "search_radius": search_radius,
                            "seed": seed,
                        }
                        yield series.name, scenario | (SHORT if series.short else {})
