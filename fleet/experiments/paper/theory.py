"""Claims that need no lifetimes: about graphs, placements and bounds, on sampled networks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from math import log, pi, sqrt

import numpy as np

from fleet.experiments.paper.cases import RANGES
from fleet.experiments.paper.claims import Claim
from fleet.experiments.paper.complexity import LEMMA_NETWORKS, lemmas_3_and_4
from fleet.experiments.paper.verdicts import Band, above, judge_interval, never
from fleet.study.statistics import mean_interval, wilson_interval
from protocols.geometry import crossing
from protocols.topology import connected, edges
from worlds.arena import Arena, FloatArray
from worlds.scattering import scatter

ROBOTS, SEED = 100, 2021
LEMMA_1_SLACK = 0.02  # of a share that is told from 1000 draws


def theory_claims(networks: Mapping[float, int] = LEMMA_NETWORKS) -> list[Claim]:
    """All of them; a few seconds of work, the same every time.

    Lemmas 3 and 4 are held against so many ``networks`` of each topology, by radio range [m].
    """
    rng = np.random.default_rng(SEED)
    return [*_graphs(rng), _threshold(rng), *_lemma_1(rng), *lemmas_3_and_4(networks)]


def _graphs(rng: np.random.Generator) -> Iterator[Claim]:
    degrees: dict[str, list[float]] = {"udg": [], "gabriel": [], "rng": []}
    crossed = missing = networks = 0
    for radio_range in RANGES[1:]:
        for _ in range(3):
            points = scatter(Arena(), ROBOTS, 0.0, rng)
            graphs = {name: edges(points, radio_range, name) for name in ("udg", "gabriel", "rng")}
            for name, pairs in graphs.items():
                degrees[name].append(2.0 * len(pairs) / ROBOTS)
            crossed += count_crossings(points, graphs["gabriel"]) > 0
            tree = set(map(tuple, edges(points, radio_range, "emst").tolist()))
            missing += not tree <= set(map(tuple, graphs["gabriel"].tolist()))
            networks += 1
    yield Claim(
        "Section 3",
        "d(UDG) > d(GG) > d(RNG), mean degrees",
        [
            judge_interval(
                mean_interval(np.divide(degrees[more], degrees[less])), above(1.0),
                f"{more} over {less}",
            )
            for more, less in (("udg", "gabriel"), ("gabriel", "rng"))
        ],
    )  # fmt: skip
    yield Claim(
        "Section 3",
        "the Gabriel graph is planar and contains the Euclidean minimum spanning tree",
        [
            never(crossed, networks, "networks with links that cross"),
            never(missing, networks, "networks without a link of the tree"),
        ],
    )


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
    hits, tried = 0, 300
    for _ in range(tried):
        points = scatter(Arena(), ROBOTS, 0.0, rng)
        hits += connected(ROBOTS, edges(points, 10.0 * critical, "udg"))
    return Claim(
        "Section 5",
        "below r_C = √(ln n/(πn)) ≈ 0.12 the network is not connected",
        [
            judge_interval(
                wilson_interval(hits, tried), Band(0.0, 0.05, "at most 5 %"),
                f"connected at r_C = {critical:.3f}", percent=True,
            )
        ],
    )  # fmt: skip


def lemma_1_bound(radius: float) -> float:
    """The least chance of a robot within ``radius`` [m] of an event in the 10 m square, Lemma 1.

    An event in a corner has a quarter of its disc on the floor.
    """
    return 1.0 - (1.0 - pi * (radius / 10.0) ** 2 / 4.0) ** (ROBOTS - 1)


def _lemma_1(rng: np.random.Generator) -> Iterator[Claim]:
    parts = []
    for radius in (1.0, 2.0, 3.0, 4.0):
        bound = lemma_1_bound(radius)
        hits, tried = 0, 1000
        for _ in range(tried):
            points = rng.uniform(0.0, 10.0, (ROBOTS, 2))
            hits += bool((np.hypot(*(points - rng.uniform(0.0, 10.0, 2)).T) <= radius).any())
        least = Band(bound - LEMMA_1_SLACK, 1.0, f"{bound:.2f} or more, but for 0.02")
        name = f"within {radius:.0f}SR" if radius > 1.0 else "within SR"
        parts.append(judge_interval(wilson_interval(hits, tried), least, name, percent=True))
    yield Claim(
        "Lemma 1",
        "a robot within SR, 2SR, 3SR, 4SR of an event: at least 0.54, 0.96, 1, 1",
        parts,
    )
