"""Lemmas 3 and 4 and Table 1, measured: steps and messages against what they are bounded by.

Lemma 4's inequality, M ≤ (F + 1)·deg + 2, says that deg is the average degree; the auction's calls
go to the neighbours of one robot, whose degree may be larger. It is measured as printed, with the
degree that the proof approximates, and with the largest.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import nan, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.assembly import run
from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.cases import GROWN, GROWTH, WORLDS, first_seed
from fleet.experiments.paper.claims import NAMES, Claim
from fleet.experiments.paper.verdicts import never
from fleet.fleet import Fleet
from fleet.observer import Excerpt, Observer
from fleet.scenario.model import Scenario
from fleet.study.statistics import CONFIDENCE, Interval
from protocols.messages import Award, Event

AREA = 100.0  # of the floor [m²]
LEMMA_NETWORKS = {1.5: 20, 2.5: 4}
"""Of each topology, for whole lifetimes, by radio range r [m]: most where lifetimes are short."""

DEGREES = {
    "average": "the average degree, as printed",
    "formula": "(n − 1)·πr²/A, as the proof approximates it",
    "largest": "the largest degree",
}
"""What deg in Lemma 4 may be."""

ORDERS = {  # as Table 1 prints them
    "bfs-all": ("BFS", "O(diam · |E|)"),
    "7-saap": ("k-SAAP, k = 7", "N/A"),
    "aap": ("after AAP", "N/A"),
    "mia-ta": ("after MIA-TA", "O(n²)"),
    "rfta2": ("RFTA2", "O(n² + n)"),
    "rfta2ge": ("RFTA2GE", "O(n · c) steps"),
}


class BoundsWitness(Observer):
    """Steps and messages of each round, as shares of what Lemmas 3 and 4 allow."""

    def __init__(self, radio_range: float) -> None:
        self.steps: list[float] = []
        self.messages: dict[str, list[float]] = {name: [] for name in DEGREES}
        self._range = radio_range
        self._hops = self._said = 0

    def run_started(self, fleet: Fleet) -> None:
        """Keep the live topology."""
        self._neighbours = fleet.topology.neighbours

    def transmitted(self, excerpt: Excerpt) -> None:
        """Count."""
        self._said += len(excerpt.transmissions)
        self._hops += sum(t.kind.startswith("route") for t in excerpt.transmissions)

    def awarded(self, event: Event, award: Award, time: float) -> None:
        """Compare with the bounds of the graph as it is now."""
        degrees = [len(near) for near in self._neighbours]
        n, c = len(degrees), sum(degrees) // 2
        self.steps.append(self._hops / (n * c))
        taken = {
            "average": 2.0 * c / n,
            "formula": (n - 1) * pi * self._range**2 / AREA,
            "largest": float(max(degrees)),
        }
        for name, degree in taken.items():
            self.messages[name].append(self._said / ((c - n + 2) * degree + 2))
        self._hops = self._said = 0


def lemmas_3_and_4(networks: Mapping[float, int] = LEMMA_NETWORKS) -> Iterator[Claim]:
    """Both lemmas, over whole lifetimes of RFTA2 on both topologies."""
    import protocols.topology.relinking  # noqa: F401  # with it runs take the compiled topology

    for world in WORLDS:
        steps: list[float] = []
        messages: dict[str, list[float]] = {name: [] for name in DEGREES}
        for radio_range, count in networks.items():
            for k in range(count):
                witness = BoundsWitness(radio_range)
                seed = first_seed(radio_range) + k
                run(
                    Scenario.of(protocol="rfta2", motion="straight", world=world,
                                range=radio_range, seed=seed),
                    [witness],
                )  # fmt: skip
                steps += witness.steps
                for name, shares in witness.messages.items():
                    messages[name] += shares
        yield Claim(
            f"Lemma 3, {NAMES[world]}",
            "RFTA2 takes at most n·c routing steps",
            [never(_exceeding(steps), len(steps), f"at most {max(steps):.1%} of that; more")],
        )
        for name, shares in messages.items():
            yield Claim(
                f"Lemma 4, {NAMES[world]}",
                f"RFTA2 takes at most (F + 1)·deg + 2 messages, deg being {DEGREES[name]}",
                [never(_exceeding(shares), len(shares), f"at most {max(shares):.2f} × that; more")],
            )


def _exceeding(shares: list[float]) -> int:
    return sum(share > 1.0 for share in shares)


class Growth(NamedTuple):
    """How the messages, or the steps, of one protocol grow with the number of robots."""

    name: str
    printed: str  # its complexity in Table 1
    way: str  # how n grew
    messages: Interval  # exponent p of n^p
    steps: Interval
    networks: int


def growths(results: Results) -> list[Growth]:
    """Table 1, measured: an exponent for each protocol and way to grow."""
    found = []
    for series in GROWTH:
        name, printed = ORDERS[series]
        for way in GROWN:
            runs = results.where(series=series, reading=way)
            if not len(runs):
                continue
            robots = runs.numbers("robots")
            found.append(
                Growth(
                    name, printed, way, exponent(robots, runs.per_event()),
                    exponent(robots, runs.hops()), len(runs.values("seed")),
                )
            )  # fmt: skip
    return found


def exponent(sizes: NDArray[np.float64], counts: NDArray[np.float64]) -> Interval:
    """The p of n^p that fits counts (n,) of sizes (n,) best, by least squares of logarithms.

    With its t interval. NaN: what is counted does not happen.
    """
    from scipy.special import stdtrit
    from scipy.stats import linregress

    there = counts > 0.0
    if np.count_nonzero(there) < 3 or len(np.unique(sizes[there])) < 2:
        return Interval(nan, nan, nan)
    line = linregress(np.log(sizes[there]), np.log(counts[there]))
    half = float(stdtrit(np.count_nonzero(there) - 2, 0.5 + 0.5 * CONFIDENCE)) * line.stderr
    return Interval(float(line.slope), float(line.slope - half), float(line.slope + half))
