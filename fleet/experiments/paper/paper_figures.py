"""Figures 6 to 17 of the paper, drawn from the campaign's runs with 95 % confidence intervals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fleet.experiments.paper.campaign_runs import Results
from fleet.study.statistics import mean_interval

WORLDS = {"random": "(a) random topology", "random-hole": "(b) random topology with hole"}
NAMES = {
    "rfta1": "RFTA1", "rfta2": "RFTA2", "rfta2ge": "RFTA2GE", "gfgf2": "GFGF2",
    "gfgf2a": "GFGF2A", "7-saap": "7-SAAP", "bfs-7": "BFS-7", "bfs-10": "BFS-10",
    "rfta2ge-aggregated": "RFTA2GE, aggregated",
    "rfta2ge-outbid": "RFTA2GE, outbidding only", "rfta3": "RFTA3", "optimum": "all-knowing",
}  # fmt: skip
COLOURS = {  # Okabe and Ito's, which colour-blind readers tell apart
    "rfta2": "#0072B2", "rfta2ge": "#D55E00", "gfgf2a": "#009E73", "rfta1": "#CC79A7",
    "gfgf2": "#009E73", "7-saap": "#E69F00", "bfs-7": "#56B4E9", "bfs-10": "#999999",
    "rfta2ge-aggregated": "#E69F00", "rfta2ge-outbid": "#CC79A7", "rfta3": "#CC79A7",
    "optimum": "#999999",
}  # fmt: skip
RADIUS_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
MARKERS = "osD^v"
STYLE: Any = {
    "font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.alpha": 0.25, "legend.frameon": False, "svg.fonttype": "none", "svg.hashsalt": "fleet",
    "figure.constrained_layout.use": True,
}  # fmt: skip


class Quantity(NamedTuple):
    """What an axis shows, and how it is read off the runs (runs,)."""

    label: str
    of: Callable[[Results], NDArray[np.float64]]


MESSAGES = Quantity("messages per round", Results.per_event)
TOTAL = Quantity("messages per lifetime", lambda runs: runs.numbers("messages"))
LIFETIME = Quantity("lifetime [rounds]", lambda runs: runs.numbers("lifetime"))
CLOSEST = Quantity("closest robot found [%]", lambda runs: 100.0 * runs.numbers("closest_found"))


@dataclass(frozen=True, slots=True)
class Numbered:
    """A figure of the paper, by its number there."""

    number: int
    caption: str
    figure: Figure


def draw_all(results: Results, energies: dict[str, NDArray[np.float64]]) -> Iterator[Numbered]:
    """Every figure; ``energies``: what each robot holds [J] after RFTA2 and RFTA2GE (n,)."""
    with mpl.rc_context(STYLE):
        yield Numbered(6, "Communication costs of RFTA1", _by_radius(results, "rfta1", MESSAGES))
        yield Numbered(
            7, "Communication costs of RFTA1 and GFGF2 at 2SR",
            by_protocol(results, ("rfta1", "gfgf2"), MESSAGES),
        )  # fmt: skip
        yield Numbered(
            8, "How often the closest robot is found by RFTA1 and GFGF2 at 2SR",
            by_protocol(results, ("rfta1", "gfgf2"), CLOSEST),
        )  # fmt: skip
        bars = ("rfta2", "rfta2ge", "7-saap", "bfs-7", "bfs-10")
        yield Numbered(
            9, "Total communication for task assignment (2SR, r = 0.2)",
            _bars(results, bars, [TOTAL]),
        )  # fmt: skip
        yield Numbered(
            10, "Network lifetime and communication costs (random topology, 2SR, r = 0.2)",
            _bars(results, bars, [LIFETIME, MESSAGES]),
        )  # fmt: skip
        yield Numbered(11, "Network lifetime of RFTA2", _by_radius(results, "rfta2", LIFETIME))
        yield Numbered(12, "Communication costs of RFTA2", _by_radius(results, "rfta2", MESSAGES))
        yield Numbered(13, "Network lifetime of RFTA2GE", _by_radius(results, "rfta2ge", LIFETIME))
        yield Numbered(
            14, "Communication costs of RFTA2GE", _by_radius(results, "rfta2ge", MESSAGES)
        )
        three = ("rfta2", "gfgf2a", "rfta2ge")
        yield Numbered(
            15, "Communication costs of RFTA2, GFGF2A and RFTA2GE at 2SR",
            by_protocol(results, (*three, "rfta2ge-aggregated", "rfta2ge-outbid"), MESSAGES),
        )  # fmt: skip
        yield Numbered(
            16, "Network lifetime of RFTA2, GFGF2A and RFTA2GE at 2SR",
            by_protocol(results, three, LIFETIME),
        )  # fmt: skip
        yield Numbered(
            17, "Robot energies after the lifetime, on one random network (SR = 0.2, r = 0.25)",
            _energies(energies),
        )  # fmt: skip


def interval(values: NDArray[np.float64]) -> tuple[float, float]:
    """Mean and half width of its 95 % confidence interval; nan where too little is known."""
    if not len(values):
        return np.nan, np.nan
    mean, low, high = mean_interval(values)
    return mean, 0.5 * (high - low)


def _by_radius(results: Results, series: str, quantity: Quantity) -> Figure:
    """One protocol over the range, a curve for each search radius, a panel for each world."""
    runs = results.where(series=series)
    curves = [
        (f"{radius:.0f}SR" if radius > 1.0 else "SR", colour, runs.where(search_radius=radius))
        for radius, colour in zip(runs.values("search_radius"), RADIUS_COLOURS, strict=False)
    ]
    return _panels(curves, quantity)


def by_protocol(results: Results, series: Sequence[str], quantity: Quantity) -> Figure:
    """Several protocols at 2SR over the range, a panel for each world."""
    curves = [
        (NAMES[name], COLOURS[name], results.where(series=name, search_radius=2.0))
        for name in series
    ]
    return _panels(curves, quantity)


def _panels(curves: Sequence[tuple[str, str, Results]], quantity: Quantity) -> Figure:
    figure = Figure(figsize=(8.0, 3.2))
    for axes, (world, title) in zip(
        figure.subplots(1, 2, sharey=True), WORLDS.items(), strict=True
    ):
        for (label, colour, runs), marker in zip(curves, MARKERS, strict=False):
            _curve(axes, runs.where(world=world), quantity, label, colour, marker)
        axes.set_title(title, fontsize=9.0)
    figure.supxlabel("communication radius r  [unit square; × 10 m]", fontsize=9.0)
    figure.axes[0].set_ylabel(quantity.label)
    figure.axes[0].set_ylim(bottom=0.0)  # after both are drawn: they share it
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right center")
    return figure


def _curve(
    axes: Axes, runs: Results, quantity: Quantity, label: str, colour: str, marker: str
) -> None:
    ranges = runs.values("radio_range")
    if not ranges:
        return
    points = [interval(quantity.of(runs.where(radio_range=r))) for r in ranges]
    mean, half = np.array(points).T
    x = 0.1 * np.array(ranges)
    axes.fill_between(x, mean - half, mean + half, color=colour, alpha=0.2, linewidth=0.0)
    axes.plot(x, mean, color=colour, marker=marker, markersize=4.0, label=label)


def _bars(results: Results, series: Sequence[str], quantities: Sequence[Quantity]) -> Figure:
    figure = Figure(figsize=(4.0 * len(quantities), 3.2))
    chosen = results.where(world="random", search_radius=2.0, radio_range=2.0)
    for axes, quantity in zip(
        figure.subplots(1, len(quantities), squeeze=False)[0], quantities, strict=True
    ):
        points = [interval(quantity.of(chosen.where(series=name))) for name in series]
        mean, half = np.array(points).T
        axes.bar(
            [NAMES[name] for name in series], mean, yerr=half, capsize=3.0,
            color=[COLOURS[name] for name in series],
        )  # fmt: skip
        axes.set_ylabel(quantity.label)
        axes.grid(visible=False, axis="x")
    return figure


def _energies(energies: dict[str, NDArray[np.float64]]) -> Figure:
    figure = Figure(figsize=(8.0, 3.2))
    for axes, (series, left) in zip(
        figure.subplots(1, 2, sharey=True), energies.items(), strict=True
    ):
        axes.bar(np.arange(len(left)), left, width=1.0, color=COLOURS[series])
        axes.axhline(left.mean(), color="0.3", linewidth=1.0, linestyle="--")
        axes.set_title(
            f"{NAMES[series]}: mean {left.mean():.1f} J, SD {left.std():.1f} J", fontsize=9.0
        )
        axes.set_xlabel("robot")
    figure.axes[0].set_ylabel("energy left [J, of 100]")
    return figure
