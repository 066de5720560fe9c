"""What the paper ran, as scenarios: which protocol, where, at which ranges, how often."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fleet.experiments.paper.readings import ANY, DEFAULT, SEARCHES, SearchReading

WORLDS = ("random", "random-hole")
RANGES = tuple(round(1.5 + 0.5 * k, 1) for k in range(9))  # r = 0.15 ... 0.55 [m × 0.1]
SEARCH_RADII = (1.0, 2.0, 3.0, 4.0)  # SR ... 4SR [m]
BASELINE_RANGE = 2.0  # r = 0.2, of Figures 9 and 10 [m]
NETWORKS, NETWORKS_QUICK = 100, 10
NETWORKS_OTHERWISE = 0.2  # of these: for the readings that are not the default
SEEDS = 1000
"""Networks are the same for all protocols, but others at each range: their seeds are from 1000
on, a thousand for each range. RFTA3 was tuned on seeds below."""
SHORT = {"rounds": 10, "robot": {"capacity": 1e6}}
"""Costs of single tasks: a few rounds in which energy plays no part."""
DEPTHS = (3, 5, 7, 9, 11)  # k of k-SAAP
HOPMAX = (5, 7, 10, 13)  # of BFS


@dataclass(frozen=True, slots=True)
class Series:
    """A curve or a bar of the paper: one protocol over ranges and search radii."""

    name: str
    protocol: Mapping[str, Any]  # as in a scenario
    search_radii: tuple[float, ...] = SEARCH_RADII
    ranges: tuple[float, ...] = RANGES
    worlds: tuple[str, ...] = WORLDS
    short: bool = False  # single tasks, not lifetimes
    read: bool = True  # a reading of the search makes a difference

    def under(self, reading: SearchReading) -> dict[str, Any]:
        """Its protocol under a reading, as in a scenario."""
        search = {"search": reading.parameters} if self.read and reading.parameters else {}
        return {**self.protocol, **search}


def _flood(name: str, protocol: Mapping[str, Any], *worlds: str) -> Series:
    return Series(
        name, protocol, (2.0,), (BASELINE_RANGE,), worlds=worlds or WORLDS[:1], read=False
    )


SERIES = (
    Series("rfta2", {"name": "rfta2"}),
    Series("rfta2ge", {"name": "rfta2ge"}),
    Series("gfgf2a", {"name": "gfgf2a"}, (2.0,)),
    Series("rfta2ge-aggregated", {"name": "rfta2ge", "aggregate": True}, (2.0,)),
    Series("rfta2ge-outbid", {"name": "rfta2ge", "aggregate": True, "outbid": True}, (2.0,)),
    Series("rfta1", {"name": "rfta1"}, short=True),
    Series("gfgf2", {"name": "gfgf2"}, short=True),
    Series("gfgf1", {"name": "gfgf1"}, (2.0,), short=True),
    Series("rfta3", {"name": "rfta3"}, (2.0,), read=False),  # beyond the paper
    Series("optimum", {"name": "optimum", "metric": "company-share"}, (2.0,), read=False),
    *(_flood(f"{k}-saap", {"name": "k-saap", "hops": k}) for k in DEPTHS),
    *(_flood(f"bfs-{hops}", {"name": "bfs", "hopmax": hops}) for hops in HOPMAX),
)


def otherwise(networks: int) -> int:
    """How many networks the readings that are not the default are run on."""
    return min(networks, max(2, round(NETWORKS_OTHERWISE * networks)))


GROWTH: dict[str, dict[str, Any]] = {  # of Table 1, with what they are run as
    "bfs-all": {"name": "bfs", "hopmax": 1000},
    "7-saap": {"name": "k-saap", "hops": 7},
    "aap": {"name": "aap"},
    "mia-ta": {"name": "mia-ta"},
    "rfta2": {"name": "rfta2"},
    "rfta2ge": {"name": "rfta2ge"},
}
SIZES = (50, 100, 200, 400)  # robots n
GROWN = ("as dense", "as far")
"""How n grows: r shrinks with the spacing of robots, or stays as it is and so degrees grow."""
MOST_GROWTH = 20  # networks of each size, at most


def growth_cases(networks: int) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """The runs that Table 1 is measured by, as of :func:`cases`; n growing in two ways."""
    for name, protocol in GROWTH.items():
        for way in GROWN:
            for robots in SIZES:
                radio_range = 2.5 * (100.0 / robots) ** 0.5 if way == "as dense" else 2.5
                for seed in range(SEEDS, SEEDS + min(networks, MOST_GROWTH)):
                    yield (
                        name,
                        way,
                        {
                            "protocol": dict(protocol),
                            "world": "random",
                            "robots": robots,
                            "range": radio_range,
                            "search_radius": 0.8 * radio_range,
                            "seed": seed,
                            "motion": "straight",
                            **SHORT,
                        },
                    )


def cases(networks: int, motion: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Every run of the campaign: the name of its series, its reading, and its scenario.

    Readings other than the default are for straight motion, the paper's.
    """
    for reading in SEARCHES if motion == "straight" else (DEFAULT,):
        count = networks if reading == DEFAULT else otherwise(networks)
        for series in SERIES:
            if not series.read and reading != DEFAULT:
                continue
            name = str(reading) if series.read else ANY
            for scenario in _scenarios(series, reading, count):
                yield series.name, name, {**scenario, "motion": motion}


def _scenarios(series: Series, reading: SearchReading, networks: int) -> Iterator[dict[str, Any]]:
    for world in series.worlds:
        for radio_range in series.ranges:
            first = first_seed(radio_range)
            for search_radius in series.search_radii:
                for seed in range(first, first + networks):
                    yield {
                        "protocol": series.under(reading),
                        "world": world,
                        "range": radio_range,
                        "search_radius": search_radius,
                        "seed": seed,
                        **(SHORT if series.short else {}),
                    }


def first_seed(radio_range: float) -> int:
    """The seed of the first network at a range [m]."""
    return SEEDS * (1 + RANGES.index(radio_range))
