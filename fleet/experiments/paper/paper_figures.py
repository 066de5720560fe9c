"""Figures 6 to 17 of the paper and what goes on from there, with 95 % confidence intervals.

Each has its numbers as a table, the paper's own beside them where it prints any.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.cases import BASELINE_RANGE, DEPTHS, HOPMAX, SEARCH_RADII
from fleet.experiments.paper.published import FIGURES, TABLES
from fleet.experiments.paper.readings import ANY, DEFAULT, SEARCHES
from fleet.study.report.style import DASHES, DIM, MARKERS, SERIES
from fleet.study.statistics import Interval, mean_interval

WORLDS = {"random": "(a) random topology", "random-hole": "(b) random topology with hole"}
NAMES = {
    "rfta1": "RFTA1", "rfta2": "RFTA2", "rfta2ge": "RFTA2GE", "gfgf2": "GFGF2",
    "gfgf2a": "GFGF2A", "7-saap": "7-SAAP", "bfs-7": "BFS-7", "bfs-10": "BFS-10",
    "rfta2ge-aggregated": "RFTA2GE, aggregated",
    "rfta2ge-outbid": "RFTA2GE, outbidding only", "rfta3": "RFTA3", "optimum": "all-knowing",
}  # fmt: skip
COLOURS = {
    "rfta2": 0, "rfta2ge": 1, "gfgf2a": 2, "rfta1": 3, "gfgf2": 2, "7-saap": 4, "bfs-7": 5,
    "bfs-10": 6, "rfta2ge-aggregated": 4, "rfta2ge-outbid": 3, "rfta3": 3, "optimum": 6,
}  # fmt: skip
HEAD = ("panel", "series", "x", "quantity", "mean", "low", "high", "runs", "the paper")
TWO_SR = {"search_radius": 2.0}


class Quantity(NamedTuple):
    """What an axis shows, how it is read off the runs (runs,), and what is possible of it."""

    label: str
    of: Callable[[Results], NDArray[np.float64]]
    possible: tuple[float, float] = (0.0, inf)
    key: str = ""  # a row of the paper's tables

    def interval(self, runs: Results) -> Interval:
        """The mean over runs and its interval, the part of it that is possible."""
        return mean_interval(self.of(runs), self.possible)


MESSAGES = Quantity("messages per round", Results.per_event)
TOTAL = Quantity("messages per lifetime", lambda runs: runs.numbers("messages"))
LIFETIME = Quantity("lifetime [rounds]", lambda runs: runs.numbers("lifetime"), key="lifetime")
CLOSEST = Quantity(
    "closest robot found [%]", lambda runs: 100.0 * runs.numbers("closest_found"), (0.0, 100.0)
)


@dataclass(frozen=True, slots=True)
class Numbered:
    """A figure of the paper, by its number there, with its numbers as lines of a table."""

    number: int
    caption: str
    figure: Figure
    rows: list[list[Any]] = field(default_factory=list)
    head: tuple[str, ...] = HEAD

    @property
    def printed(self) -> str:
        """What the paper's text says of it, as a sentence."""
        said = dict.fromkeys(FIGURES.get(self.number, {}).values())
        return f"The paper: {'; '.join(said)}." if said else ""


class RangeCurve(NamedTuple):
    """A line of a figure: its name, its runs, and what the paper calls it."""

    label: str
    runs: Results
    colour: str
    series: str
    tabled: bool = True  # the paper's tables have its mean over all ranges


def draw_all(results: Results, energies: dict[str, NDArray[np.float64]]) -> Iterator[Numbered]:
    """Figures 6 to 17; ``energies``: what each robot holds [J] after RFTA2 and RFTA2GE (n,).

    To be drawn in the style of reports. The runs are those of the default reading.
    """
    runs = results.where(reading=str(DEFAULT)).with_rows_of(results.where(reading=ANY))
    pair, three = ("rfta1", "gfgf2"), ("rfta2", "gfgf2a", "rfta2ge")
    counted = (*three, "rfta2ge-aggregated", "rfta2ge-outbid")
    bars = ("rfta2", "rfta2ge", "7-saap", "bfs-7", "bfs-10")
    yield _by_radius(6, "Communication costs of RFTA1", runs, "rfta1", MESSAGES)
    yield by_protocol(7, "Communication costs of RFTA1 and GFGF2 at 2SR", runs, pair, MESSAGES)
    yield by_protocol(
        8, "How often the closest robot is found by RFTA1 and GFGF2 at 2SR", runs, pair, CLOSEST
    )
    yield _bars(
        9, "Total communication for task assignment (random topology, 2SR, r = 0.2)", runs, bars,
        [TOTAL],
    )  # fmt: skip
    yield _bars(
        10, "Network lifetime and communication costs (random topology, 2SR, r = 0.2)", runs, bars,
        [LIFETIME, MESSAGES],
    )  # fmt: skip
    yield _by_radius(11, "Network lifetime of RFTA2", runs, "rfta2", LIFETIME)
    yield _by_radius(12, "Communication costs of RFTA2", runs, "rfta2", MESSAGES)
    yield _by_radius(13, "Network lifetime of RFTA2GE", runs, "rfta2ge", LIFETIME)
    yield _by_radius(14, "Communication costs of RFTA2GE", runs, "rfta2ge", MESSAGES)
    yield by_protocol(
        15, "Communication costs of RFTA2, GFGF2A and RFTA2GE at 2SR, bids of RFTA2GE counted in"
        " three ways", runs, counted, MESSAGES,
    )  # fmt: skip
    yield by_protocol(
        16, "Network lifetime of RFTA2, GFGF2A and RFTA2GE at 2SR", runs, three, LIFETIME
    )
    yield _energies(energies)


def draw_further(results: Results) -> Iterator[Numbered]:
    """How k and hopmax were chosen, and what the readings of the search come to."""
    yield _depths(results.where(reading=ANY))
    if len(results.where(reading=str(SEARCHES[-1]))):
        yield _readings(results)


def _by_radius(
    number: int, caption: str, results: Results, series: str, quantity: Quantity
) -> Numbered:
    """One protocol over the range, a curve for each search radius, a panel for each world."""
    runs = results.where(series=series)
    curves = [
        RangeCurve(_radius(radius), runs.where(search_radius=radius), colour, series, radius == 2.0)
        for radius, colour in zip(SEARCH_RADII, SERIES, strict=False)
    ]
    return _panels(number, caption, curves, quantity)


def by_protocol(
    number: int, caption: str, results: Results, series: Sequence[str], quantity: Quantity
) -> Numbered:
    """Several protocols at 2SR over the range, a panel for each world."""
    curves = [
        RangeCurve(NAMES[name], results.where(series=name, **TWO_SR), SERIES[COLOURS[name]], name)
        for name in series
    ]
    return _panels(number, caption, curves, quantity)


def _panels(
    number: int, caption: str, curves: Sequence[RangeCurve], quantity: Quantity
) -> Numbered:
    figure = Figure(figsize=(7.4, 3.0))
    rows: list[list[Any]] = []
    for axes, (world, title) in zip(
        figure.subplots(1, 2, sharey=True), WORLDS.items(), strict=True
    ):
        for place, curve in enumerate(curves):
            runs = curve.runs.where(world=world)
            x = 0.1 * np.array(runs.values("radio_range"))
            points = [quantity.interval(runs.where(radio_range=r)) for r in 10.0 * x]
            _line(axes, x, points, curve, place)
            said = FIGURES.get(number, {}).get((world, curve.series), "") if curve.tabled else ""
            rows += [
                [world, curve.label, f"r = {r:.2f}", quantity.label, *point, *_count(runs, r), said]
                for r, point in zip(x, points, strict=True)
            ]
            rows += _pooled(runs, world, curve, quantity)
        axes.set_title(title)
    figure.supxlabel("communication radius r  [unit square; × 10 m]", fontsize=8.5)
    figure.axes[0].set_ylabel(quantity.label)
    figure.axes[0].set_ylim(bottom=0.0)  # after both are drawn: they share it
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right center")
    return Numbered(number, caption, figure, rows)


def _count(runs: Results, at: float) -> list[int]:
    return [len(runs.where(radio_range=10.0 * at))]


def _pooled(runs: Results, world: str, curve: RangeCurve, quantity: Quantity) -> list[list[Any]]:
    """The mean over all ranges, where the paper's tables have it."""
    protocol = curve.series.partition("-")[0]
    table = TABLES[world].get(protocol)
    if table is None or not curve.tabled or not len(runs):
        return []
    if quantity is MESSAGES:
        printed = 100.0 * table["messages_per_robot"].mean / table["lifetime"].mean
    elif quantity.key:
        printed = table[quantity.key].mean
    else:
        return []
    found = quantity.interval(runs)
    return [[world, curve.label, "all r", quantity.label, *found, len(runs), f"{printed:.2f}"]]


def _line(
    axes: Axes, x: NDArray[np.float64], points: Sequence[Interval], curve: RangeCurve, place: int
) -> None:
    if not len(x):
        return
    mean, low, high = np.array(points, float).T
    axes.fill_between(x, low, high, color=curve.colour, alpha=0.2, linewidth=0.0)
    axes.plot(
        x, mean, color=curve.colour, marker=MARKERS[place % len(MARKERS)],
        linestyle=DASHES[place % len(DASHES)], label=curve.label,
    )  # fmt: skip


def _bars(
    number: int,
    caption: str,
    results: Results,
    series: Sequence[str],
    quantities: Sequence[Quantity],
) -> Numbered:
    figure = Figure(figsize=(3.7 * len(quantities), 3.0))
    chosen = results.where(world="random", radio_range=BASELINE_RANGE, **TWO_SR)
    rows: list[list[Any]] = []
    for axes, quantity in zip(
        figure.subplots(1, len(quantities), squeeze=False)[0], quantities, strict=True
    ):
        for place, name in enumerate(series):
            runs = chosen.where(series=name)
            found = quantity.interval(runs)
            rows.append(
                ["random", NAMES[name], "r = 0.20", quantity.label, *found, len(runs),
                 FIGURES.get(number, {}).get(("random", name), "")]
            )  # fmt: skip
            axes.bar(place, found.value, color=SERIES[COLOURS[name]], width=0.7)
            if np.isfinite(found.low):
                axes.plot([place, place], found[1:], color=DIM, linewidth=1.4)
        axes.set_xticks(range(len(series)), [NAMES[name] for name in series])
        axes.set_ylabel(quantity.label)
        axes.grid(visible=False, axis="x")
    return Numbered(number, caption, figure, rows)


def _energies(energies: dict[str, NDArray[np.float64]]) -> Numbered:
    figure = Figure(figsize=(7.4, 3.0))
    rows: list[list[Any]] = []
    for axes, (series, left) in zip(
        figure.subplots(1, 2, sharey=True), energies.items(), strict=True
    ):
        axes.bar(np.arange(len(left)), left, width=1.0, color=SERIES[COLOURS[series]])
        axes.axhline(left.mean(), color=DIM, linewidth=1.0, linestyle="--")
        axes.set_title(f"{NAMES[series]}: mean {left.mean():.1f} J, SD {left.std():.1f} J")
        axes.set_xlabel("robot")
        rows += [[NAMES[series], robot, float(energy)] for robot, energy in enumerate(left)]
    figure.axes[0].set_ylabel("energy left [J, of 100]")
    caption = "Robot energies after the lifetime, on one random network (SR = 0.2, r = 0.25)"
    return Numbered(17, caption, figure, rows, ("series", "robot", "energy left [J]"))


def _depths(runs: Results) -> Numbered:
    """Lifetime and messages over k of k-SAAP and hopmax of BFS, r = 0.2."""
    figure = Figure(figsize=(7.4, 3.0))
    rows: list[list[Any]] = []
    floods = (("k-SAAP over k", "{}-saap", DEPTHS), ("BFS over hopmax", "bfs-{}", HOPMAX))
    for axes, quantity in zip(figure.subplots(1, 2), (LIFETIME, MESSAGES), strict=True):
        for place, (label, name, depths) in enumerate(floods):
            there = [d for d in depths if len(runs.where(series=name.format(d)))]
            each = [runs.where(series=name.format(depth)) for depth in there]
            points = [quantity.interval(some) for some in each]
            curve = RangeCurve(label, runs, SERIES[COLOURS[("7-saap", "bfs-7")[place]]], name)
            _line(axes, np.array(there, float), points, curve, place)
            rows += [
                ["random", label, depth, quantity.label, *point, len(some),
                 {("{}-saap", 7): "chosen", ("bfs-{}", 7): "chosen", ("bfs-{}", 10): "chosen"}
                 .get((name, depth), "")]
                for depth, some, point in zip(there, each, points, strict=True)
            ]  # fmt: skip
        axes.set_ylabel(quantity.label)
        axes.set_xlabel("hops")
        axes.set_ylim(bottom=0.0)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right center")
    caption = "How deep 7-SAAP, BFS-7 and BFS-10 ask (random topology, r = 0.2)"
    return Numbered(20, caption, figure, rows)


def _readings(results: Results) -> Numbered:
    """Lifetime of RFTA2 over the search radius, a curve for each reading of the search."""
    figure = Figure(figsize=(7.4, 3.0))
    rows: list[list[Any]] = []
    for axes, (world, title) in zip(
        figure.subplots(1, 2, sharey=True), WORLDS.items(), strict=True
    ):
        for place, reading in enumerate(SEARCHES):
            runs = results.where(series="rfta2", world=world, reading=str(reading))
            each = [runs.where(search_radius=radius) for radius in SEARCH_RADII]
            points = [LIFETIME.interval(some) for some in each]
            curve = RangeCurve(str(reading), runs, SERIES[place], "rfta2")
            _line(axes, np.array(SEARCH_RADII), points, curve, place)
            rows += [
                [world, str(reading), _radius(radius), LIFETIME.label, *point, len(some),
                 "best" if radius == 2.0 else ""]
                for radius, some, point in zip(SEARCH_RADII, each, points, strict=True)
            ]  # fmt: skip
        axes.set_xticks(SEARCH_RADII, [_radius(radius) for radius in SEARCH_RADII])
        axes.set_title(title)
    figure.axes[0].set_ylabel(LIFETIME.label)
    figure.axes[0].set_ylim(bottom=0.0)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right center")
    caption = "Network lifetime of RFTA2 over the search radius, under each reading (all ranges)"
    return Numbered(21, caption, figure, rows)


def interval(values: NDArray[np.float64]) -> tuple[float, float]:
    """Mean and half width of its 95 % confidence interval; nan where too little is known."""
    if not len(values):
        return nan, nan
    mean, low, high = mean_interval(values)
    return mean, 0.5 * (high - low)


def _radius(radius: float) -> str:
    return f"{radius:.0f}SR" if radius > 1.0 else "SR"
