"""Means, paired differences and lifetimes of a study's cells: the figures' and tables' numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fleet.study.report.derived import possible
from fleet.study.report.layout import Layout
from fleet.study.report.runs import Runs, ended
from fleet.study.statistics import (
    Difference,
    Interval,
    Survival,
    holm,
    mean_interval,
    paired_difference,
    pairs_needed,
    survival,
)

ROBOTS_AT = np.linspace(0.0, 100.0, 101)  # [%] of the robots, for the distribution of energy


@dataclass(frozen=True, slots=True)
class Coordinates:
    """Where in a study an estimate belongs: values of the facets, the series and x."""

    facet: tuple[Any, ...]
    series: Any
    x: Any


@dataclass(frozen=True, slots=True)
class Mean:
    """The mean of a measure over a cell's runs."""

    cell: Coordinates
    measure: str
    runs: int
    estimate: Interval


@dataclass(frozen=True, slots=True)
class Contrast:
    """How a measure differs from the baseline's, over runs of the same seed."""

    cell: Coordinates
    measure: str
    difference: Difference
    chance: float = nan  # p of it, raised for all comparisons of the report


@dataclass(frozen=True, slots=True)
class Curve:
    """How long the networks of a cell live."""

    cell: Coordinates
    runs: int
    cut: int  # runs that were still going at their limit of rounds
    curve: Survival


@dataclass(frozen=True, slots=True)
class Energies:
    """The energy that the robots of a cell have left [J], least first, at ROBOTS_AT (101,)."""

    cell: Coordinates
    robots: int
    left: NDArray[np.float64]


def means(runs: Runs, layout: Layout, measures: Sequence[str]) -> list[Mean]:
    """The mean and its interval, for every cell and measure."""
    return [
        Mean(cell, measure, len(values), mean_interval(values, possible(measure)))
        for cell, group in _cells(runs, layout)
        for measure in measures
        for values in [_finite(group[measure])]
    ]


def contrasts(runs: Runs, layout: Layout, measures: Sequence[str]) -> list[Contrast]:
    """The paired difference from the baseline, for every other series, cell and measure."""
    if layout.series is None:
        return []
    groups = dict(_cells(runs, layout))
    found = []
    for cell, group in groups.items():
        base = groups.get(Coordinates(cell.facet, layout.baseline, cell.x))
        if base is None or cell.series == layout.baseline:
            continue
        _, mine, theirs = np.intersect1d(group["seed"], base["seed"], return_indices=True)
        for measure in measures:
            values, baseline = group[measure][mine], base[measure][theirs]
            there = np.isfinite(values) & np.isfinite(baseline)
            difference = paired_difference(values[there], baseline[there])
            found.append(Contrast(cell, measure, difference))
    raised = holm([contrast.difference.chance for contrast in found])
    return [replace(c, chance=float(p)) for c, p in zip(found, raised, strict=True)]


def pairs_for(
    found: Sequence[Contrast], base: Sequence[Mean], baseline: Any, share: float
) -> dict[str, float]:
    """How many seeds each measure needs to show a difference of that share of the baseline's mean.

    Of the cell that needs most; four times out of five, at 95 % confidence.
    """
    means = {(m.cell, m.measure): m.estimate.value for m in base}
    needed: dict[str, float] = {}
    for contrast in found:
        there = Coordinates(contrast.cell.facet, baseline, contrast.cell.x)
        least = share * abs(means.get((there, contrast.measure), nan))
        pairs = pairs_needed(contrast.difference.deviation, least)
        if isfinite(pairs):
            needed[contrast.measure] = max(needed.get(contrast.measure, 0.0), pairs)
    return needed


def curves(runs: Runs, layout: Layout) -> list[Curve]:
    """The survival of networks, for every cell; none where no run came to its network's end."""
    if "lifetime" not in runs.columns or "scenario" not in runs.columns or not len(runs):
        return []
    over = ended(runs)
    if not over.any():
        return []
    marked = Runs({**runs.columns, "ended": over}, runs.axes)
    return [
        Curve(
            cell,
            len(group),
            int(np.count_nonzero(~group["ended"])),
            survival(group["lifetime"], group["ended"]),
        )
        for cell, group in _cells(marked, layout)
    ]


def energies(robots: Runs, layout: Layout) -> list[Energies]:
    """How evenly the energy that is left is spread, for every cell."""
    return [
        Energies(cell, len(group), np.percentile(group["energy_left"], ROBOTS_AT))
        for cell, group in _cells(robots, layout)
    ]


def _cells(runs: Runs, layout: Layout) -> Iterator[tuple[Coordinates, Runs]]:
    names = [*layout.facets, *(name for name in (layout.series, layout.x) if name is not None)]
    for values, group in runs.groups(names):
        rest = list(values[len(layout.facets) :])
        series = rest.pop(0) if layout.series is not None else None
        x = rest.pop(0) if layout.x is not None else None
        yield Coordinates(values[: len(layout.facets)], series, x), group


def _finite(column: NDArray[Any]) -> NDArray[np.float64]:
    return np.array(column[np.isfinite(column)], float)
