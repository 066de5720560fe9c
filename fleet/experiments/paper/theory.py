"""Claims that need no lifetimes: about graphs, placements and bounds, on sampled networks."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from math import log, pi, sqrt

import numpy as np

from fleet.assembly import run
from fleet.experiments.paper.cases import RANGES
from fleet.experiments.paper.claims import Claim, judged
from fleet.fleet import Fleet
from fleet.observer import Excerpt, Observer
from fleet.scenario.model import Scenario
from protocols.geometry import crossing
from protocols.messages import Award, Event
from protocols.topology import connected, edges
from worlds.arena import Arena, FloatArray
from worlds.scattering import scatter

ROBOTS, SEED = 100, 2021


def theory_claims() -> list[Claim]:
    """All of them; a few seconds of work, the same every time."""
    rng = np.random.default_rng(SEED)
    return [*_graphs(rng), _threshold(rng), *_lemma_1(rng), *_lemmas_3_and_4()]


def _graphs(rng: np.random.Generator) -> Iterator[Claim]:
    degrees: dict[str, list[float]] = {"udg": [], "gabriel": [], "rng": []}
    crossings, kept = 0, True
    for radio_range in RANGES[1:]:
        for _ in range(3):
            points = scatter(Arena(), ROBOTS, 0.0, rng)
            graphs = {name: edges(points, radio_range, name) for name in ("udg", "gabriel", "rng")}
            for name, pairs in graphs.items():
                degrees[name].append(2.0 * len(pairs) / ROBOTS)
            crossings += count_crossings(points, graphs["gabriel"])
            tree = set(map(tuple, edges(points, radio_range, "emst").tolist()))
            kept &= tree <= set(map(tuple, graphs["gabriel"].tolist()))
    means = {name: float(np.mean(values)) for name, values in degrees.items()}
    yield Claim(
        "Section 3", "d(UDG) > d(GG) > d(RNG), mean degrees",
        f"{means['udg']:.1f} > {means['gabriel']:.1f} > {means['rng']:.1f}",
        judged(means["udg"] > means["gabriel"] > means["rng"]),
    )  # fmt: skip
    yield Claim(
        "Section 3", "the Gabriel graph is planar and contains the Euclidean minimum spanning tree",
        f"{crossings} crossings; contained in {'all' if kept else 'not all'} of {3 * 8} networks",
        judged(crossings == 0 and kept),
    )  # fmt: skip


def count_crossings(points: FloatArray, pairs: np.ndarray) -> int:
    """How many pairs of links cross."""
    places = [(x, y) for x, y in points.tolist()]
    return sum(
        crossing(places[a], places[b], places[c], places[d]) is not None
        for (a, b), (c, d) in combinations(pairs.tolist(), 2)
        if len({a, b, c, d}) == 4
    )


def _threshold(rng: np.random.Generator) -> Claim:
    critical = sqrt(log(ROBOTS) / (pi * ROBOTS))
    shares = []
    for radio_range in (10.0 * critical, 1.5, 2.0):
        hits = 0
        for _ in range(300):
            points = scatter(Arena(), ROBOTS, 0.0, rng)
            hits += connected(ROBOTS, edges(points, radio_range, "udg"))
        shares.append(hits / 300)
    return Claim(
        "Section 5", "below r_C = √(ln n/(πn)) ≈ 0.12 the network is not connected",
        f"connected at r_C = {critical:.3f}: {shares[0]:.0%}, at 0.15: {shares[1]:.0%},"
        f" at 0.20: {shares[2]:.0%} of random placements",
        judged(shares[0] < 0.05 < shares[1]),
    )  # fmt: skip


def lemma_1_bound(radius: float) -> float:
    """The least chance of a robot within ``radius`` [m] of an event in the 10 m square, Lemma 1.

    An event in a corner has a quarter of its disc on the floor.
    """
    return 1.0 - (1.0 - pi * (radius / 10.0) ** 2 / 4.0) ** (ROBOTS - 1)


def _lemma_1(rng: np.random.Generator) -> Iterator[Claim]:
    bounds, measured = [], []
    for radius in (1.0, 2.0, 3.0, 4.0):
        bounds.append(lemma_1_bound(radius))
        hits = 0
        for _ in range(1000):
            points = rng.uniform(0.0, 10.0, (ROBOTS, 2))
            hits += bool((np.hypot(*(points - rng.uniform(0.0, 10.0, 2)).T) <= radius).any())
        measured.append(hits / 1000)
    yield Claim(
        "Lemma 1", "a robot within SR, 2SR, 3SR, 4SR of an event: at least 0.54, 0.96, 1, 1",
        ", ".join(f"{share:.2f}" for share in measured),
        judged(all(m >= b - 0.02 for m, b in zip(measured, bounds, strict=True))),
    )  # fmt: skip


class BoundsWitness(Observer):
    """Steps and messages of each round, as shares of what Lemmas 3 and 4 allow."""

    def __init__(self) -> None:
        self.steps: list[float] = []
        self.messages: list[float] = []
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
        self.messages.append(self._said / ((c - n + 2) * max(degrees) + 2))
        self._hops = self._said = 0


def _lemmas_3_and_4() -> Iterator[Claim]:
    witness = BoundsWitness()
    for seed in range(3):
        run(Scenario.of(protocol="rfta2", motion="straight", range=2.0, seed=seed), [witness])
    yield Claim(
        "Lemma 3", "RFTA2 takes at most n·c routing steps",
        f"at most {max(witness.steps):.1%} of that, in {len(witness.steps)} rounds",
        judged(max(witness.steps) <= 1.0),
    )  # fmt: skip
    yield Claim(
        "Lemma 4", "RFTA2 takes at most (F + 1)·deg + 2 messages, F = c − n + 1 inner faces",
        f"at most {max(witness.messages):.0%} of that, deg being the largest degree",
        judged(max(witness.messages) <= 1.0),
    )  # fmt: skip
