"""The figures of a report: estimates with their intervals, distributions and survival curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import ceil
from textwrap import fill
from typing import Any, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fleet.notebook_figure import NotebookFigure
from fleet.study.report.estimates import ROBOTS_AT, Contrast, Coordinates, Curve, Energies, Mean
from fleet.study.report.layout import Layout
from fleet.study.report.quantities import name_of, short_name
from fleet.study.report.style import DASHES, INK, MARKERS, SERIES, WIDTH
from fleet.study.statistics import Interval

T = TypeVar("T", Mean, Contrast, Curve, Energies)
M = TypeVar("M", Mean, Contrast)  # of a measure

PANEL = 2.15  # height of a panel [inch]
MOST_SIDE_BY_SIDE = 3
LONG = 16  # letters of a name beside a row
LETTERS = 92  # of the legend that fit into a line


def draw_means(means: Sequence[Mean], layout: Layout) -> NotebookFigure:
    """A panel for each measure: its mean over x, or in a row for each of the series."""
    return _panels(means, layout, lambda mean: mean.estimate, name_of, zero=False)


def draw_contrasts(contrasts: Sequence[Contrast], layout: Layout) -> Figure:
    """A panel for each measure: how much more or less than the baseline."""

    def interval(contrast: Contrast) -> Interval:
        return Interval(*contrast.difference[:3])

    return _panels(contrasts, layout, interval, lambda name: f"Δ {name_of(name)}", zero=True)


def draw_energies(energies: Sequence[Energies], layout: Layout) -> Figure:
    """The energy left in the robots, from the emptiest to the fullest; a panel for some x."""
    figure, panels, shades = _by_x(energies, layout)
    for axes, group in panels:
        for item in group:
            axes.plot(item.left, ROBOTS_AT, **_line(shades[item.cell.series]))
        axes.set(xlabel="energy left [J]", ylim=(0.0, 100.0), xlim=(0.0, None))
    panels[0][0].set_ylabel("robots with less [%]")
    _legend(figure, layout, shades, lines=True)
    return figure


def draw_curves(curves: Sequence[Curve], layout: Layout) -> Figure:
    """The share of networks that outlive each round; a panel for some x."""
    figure, panels, shades = _by_x(curves, layout)
    for axes, group in panels:
        for item in group:
            times = np.concatenate([[0.0], item.curve.times])
            line = _line(shades[item.cell.series])
            axes.step(times, 100.0 * _from_one(item.curve.share), where="post", **line)
            axes.fill_between(
                times, 100.0 * _from_one(item.curve.low), 100.0 * _from_one(item.curve.high),
                step="post", color=line["color"], alpha=0.13, linewidth=0.0,
            )  # fmt: skip
        axes.set(xlabel="round", ylim=(0.0, 103.0))
    panels[0][0].set_ylabel("networks alive [%]")
    panels[0][0].set_xlim(0.0, 1.02 * max(item.curve.times.max(initial=1.0) for item in curves))
    _legend(figure, layout, shades, lines=True)
    return figure


def some(values: Sequence[Any]) -> list[Any]:
    """The first, the middle and the last of many values; all, of a few."""
    if len(values) <= MOST_SIDE_BY_SIDE:
        return list(values)
    return [values[0], values[len(values) // 2], values[-1]]


def _panels(
    items: Sequence[M],
    layout: Layout,
    interval: Callable[[M], Interval],
    title: Callable[[str], str],
    *,
    zero: bool,
) -> NotebookFigure:
    measures = list(dict.fromkeys(item.measure for item in items))
    shades = _shades((item.cell for item in items), layout)
    columns = len(measures) if len(measures) <= MOST_SIDE_BY_SIDE else 3 if len(measures) > 4 else 2
    rows = ceil(len(measures) / columns)
    height = PANEL if layout.x is not None else max(1.1, 0.45 + 0.24 * len(shades))
    figure = NotebookFigure(figsize=(WIDTH, rows * height + 0.3))
    grid = figure.subplots(rows, columns, squeeze=False, sharex=layout.x is not None)
    for axes in grid.flat[len(measures) :]:
        axes.set_visible(False)
    for number, (axes, measure) in enumerate(zip(grid.flat, measures, strict=False)):
        chosen = [item for item in items if item.measure == measure]
        points = [(item.cell, interval(item)) for item in chosen]
        axes.set_title(title(measure), fontsize=8.5)
        if layout.x is None:
            _rows(axes, points, shades, named=number % columns == 0)
        else:
            _over_x(axes, points, shades)
            if number + columns >= len(measures):
                axes.set_xlabel(name_of(layout.x))
                axes.tick_params(labelbottom=True)
        if zero:
            (axes.axvline if layout.x is None else axes.axhline)(0.0, color=INK, lw=0.8, zorder=1.5)
    if layout.x is not None:
        _legend(figure, layout, shades)
    return figure


def _over_x(
    axes: Axes, points: Sequence[tuple[Coordinates, Interval]], shades: dict[Any, int]
) -> None:
    places = sorted({cell.x for cell, _ in points})
    spread = 0.012 * (places[-1] - places[0]) if len(places) > 1 else 0.0
    for series, shade in shades.items():
        mine = sorted((cell.x, *value) for cell, value in points if cell.series == series)
        if not mine:
            continue
        x, value, low, high = np.array(mine, float).T
        x = x + spread * (shade - 0.5 * (len(shades) - 1))
        axes.plot(x, value, marker=MARKERS[shade % len(MARKERS)], **_line(shade))
        axes.vlines(x, low, high, color=SERIES[shade % len(SERIES)], lw=1.0)
    axes.ticklabel_format(axis="y", scilimits=(-3, 6))
    gaps = np.diff(places)
    if len(places) <= 7 and len(gaps) and gaps.min() > 0.1 * (places[-1] - places[0]):
        axes.set_xticks(places, [f"{place:g}" for place in places])


def _rows(
    axes: Axes,
    points: Sequence[tuple[Coordinates, Interval]],
    shades: dict[Any, int],
    *,
    named: bool,
) -> None:
    rows = {series: -row for row, series in enumerate(shades)}
    for cell, (value, low, high) in points:
        row = rows[cell.series]
        colour = SERIES[shades[cell.series] % len(SERIES)]
        axes.hlines(row, low, high, color=colour, lw=1.6)
        axes.plot(value, row, MARKERS[shades[cell.series] % len(MARKERS)], color=colour, ms=4.5)
    names = ["all runs" if series is None else _folded(str(series)) for series in shades]
    axes.set_yticks(list(rows.values()), names if named else [""] * len(names))
    axes.set_ylim(-len(shades) + 0.4, 0.6)
    axes.tick_params(axis="y", length=0.0)
    axes.grid(visible=False, axis="y")
    axes.locator_params(axis="x", nbins=4)
    axes.ticklabel_format(axis="x", scilimits=(-2, 6))


def _by_x(
    items: Sequence[T], layout: Layout
) -> tuple[Figure, list[tuple[Axes, list[T]]], dict[Any, int]]:
    """Panels side by side for some values of x, with the items of each."""
    chosen = some(sorted({item.cell.x for item in items}) if layout.x is not None else [None])
    width = WIDTH if len(chosen) > 1 else 0.66 * WIDTH
    figure = Figure(figsize=(width, PANEL + 0.45))
    grid = figure.subplots(1, len(chosen), squeeze=False, sharey=True, sharex=True)
    panels = []
    for axes, x in zip(grid.flat, chosen, strict=True):
        if layout.x is not None:
            axes.set_title(f"{short_name(layout.x)} {x:g}")
        panels.append((axes, [item for item in items if item.cell.x == x]))
    return figure, panels, _shades((item.cell for item in items), layout)


def _shades(cells: Iterable[Coordinates], layout: Layout) -> dict[Any, int]:
    """A number for each of the series that there are: its colour and its marker."""
    there = {cell.series for cell in cells}
    return {name: number for number, name in enumerate(layout.order) if name in there}


def _line(shade: int) -> dict[str, Any]:
    return {
        "color": SERIES[shade % len(SERIES)],
        "linestyle": DASHES[shade // len(SERIES) % len(DASHES)],
    }


def _legend(figure: Figure, layout: Layout, shades: dict[Any, int], *, lines: bool = False) -> None:
    if layout.series is None or len(shades) < 1:
        return
    handles = [
        figure.axes[0].plot(
            [], [], marker=None if lines else MARKERS[shade % len(MARKERS)], **_line(shade),
            label=f"{series:g}" if isinstance(series, float) else str(series),
        )[0]
        for series, shade in shades.items()
    ]  # fmt: skip
    longest = max(len(str(series)) for series in shades) + 6
    figure.legend(
        handles=handles, loc="outside upper left", borderaxespad=0.1, handlelength=1.8,
        ncols=max(1, min(len(shades), LETTERS // longest)), columnspacing=1.6,
        title=None if isinstance(next(iter(shades)), str) else name_of(layout.series),
        title_fontsize=8.5, alignment="left",
    )  # fmt: skip


def _folded(name: str) -> str:
    """A long name on two lines."""
    return fill(name, max(LONG, len(name) // 2 + 2), break_long_words=False)


def _from_one(share: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.concatenate([[1.0], share])
