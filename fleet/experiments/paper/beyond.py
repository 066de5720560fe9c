"""Beyond the paper: RFTA3 on the paper's own campaign, beside one who knows all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.cases import first_seed
from fleet.experiments.paper.paper_figures import (
    LIFETIME,
    MESSAGES,
    NAMES,
    WORLDS,
    Numbered,
    by_protocol,
    interval,
)
from fleet.scenario.model import Scenario
from fleet.study.bounds import Bounds, bounds

PROTOCOLS = ("gfgf2a", "rfta2", "rfta2ge", "rfta3", "optimum")
NETWORKS = 3  # that the bounds are told from: they vary by a few per cent


class Outreach(NamedTuple):
    """What one protocol comes to on one topology; shares are of rounds."""

    protocol: str
    short: float  # lifetime at r = 0.15 [rounds]
    longer: float  # lifetime at r ≥ 0.2 [rounds], 95 % confidence interval ±
    within: float
    messages: float  # a round, at r ≥ 0.2
    all_knowing: float  # share of the lifetime of whoever knows all robots
    nearest: float  # share of the rounds that all joules last for, by the nearest robot
    foresight: float  # share of what anybody could reach who knew all events in advance


def typical_bounds(world: str) -> Bounds:
    """The mean bounds of a few of the campaign's networks."""
    found = [
        bounds(Scenario.of(world=world, range=2.5, seed=first_seed(2.5) + k))
        for k in range(NETWORKS)
    ]
    nearest, foresight = np.mean(found, axis=0).tolist()
    return Bounds(nearest, foresight)


def reaches(runs: Results, limits: Bounds) -> Iterator[Outreach]:
    """What each protocol comes to in these runs of one world and one motion."""
    at_2sr = runs.where(search_radius=2.0)
    all_knowing = _from_02(at_2sr.where(series="optimum")).numbers("lifetime").mean()
    for protocol in PROTOCOLS:
        mine = at_2sr.where(series=protocol)
        longer = _from_02(mine)
        mean, within = interval(longer.numbers("lifetime"))
        yield Outreach(
            protocol,
            float(mine.where(radio_range=1.5).numbers("lifetime").mean()),
            mean,
            within,
            float(longer.per_event().mean()),
            float(mean / all_knowing),
            mean / limits.nearest,
            mean / limits.foresight,
        )


def draw_beyond(results: Results) -> Iterator[Numbered]:
    """Figures 18 and 19: they go on where the paper's end. To be drawn in the style of reports."""
    yield by_protocol(
        18, "Network lifetime at 2SR: RFTA3, the paper’s algorithms, and the all-knowing", results,
        PROTOCOLS, LIFETIME,
    )  # fmt: skip
    yield by_protocol(
        19, "Communication costs at 2SR: RFTA3 and the paper’s algorithms", results,
        PROTOCOLS[:-1], MESSAGES,
    )  # fmt: skip


def lines(found: Sequence[Outreach]) -> list[list[str]]:
    """The cells of a table, one line a protocol."""
    return [
        [
            NAMES[reach.protocol],
            f"{reach.short:.0f}",
            f"{reach.longer:.0f} ± {reach.within:.0f}",
            f"{reach.messages:.1f}" if reach.messages else "none",
            f"{reach.all_knowing:.0%}",
            f"{reach.nearest:.0%}",
            f"{reach.foresight:.0%}",
        ]
        for reach in found
    ]


HEADER = (
    "",
    "lifetime at r = 0.15 [rounds]",
    "lifetime at r ≥ 0.2 [rounds]",
    "messages a round",
    "of the all-knowing",
    "of the energy at the nearest robot’s distance",
    "of perfect foresight, all batteries as one",
)
TITLES = {world: f"Beyond the paper: {title[4:]}" for world, title in WORLDS.items()}


def _from_02(runs: Results) -> Results:
    return runs.take(runs.numbers("radio_range") > 1.75)
