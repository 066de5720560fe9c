"""Single tasks: Eq. (1) against what was drained, by distance, by part, by setting, by model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fleet.experiments.energy.accuracy import accuracy, ratio_interval
from fleet.experiments.energy.exhibits import Column, Exhibit
from fleet.experiments.energy.launching import launch_cost
from fleet.experiments.energy.linearity import TOLERABLE as TOLERANCE
from fleet.experiments.energy.linearity import linearity
from fleet.experiments.energy.models import CORRECTED, MODELS, Fit, fit, halves
from fleet.experiments.energy.settings import SHORTEST, Subject
from fleet.experiments.energy.trip_table import PARTS, TripTable
from fleet.scenario.loading import merged, scenario_from
from fleet.study.report.style import DIM, INK, MARKERS, SERIES, WIDTH

EDGES = (SHORTEST, 0.25, 0.5, 1.0, 2.0, 3.5, 5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0)  # [m]
MOST_DOTS = 3000
PART_COLOURS = dict(
    zip(PARTS, (SERIES[5], SERIES[1], SERIES[2], SERIES[4], SERIES[3]), strict=True)
)


def edges(longest: float) -> tuple[float, ...]:
    """Of buckets of straight distance up to the ``longest`` [m]."""
    return (*(edge for edge in EDGES if edge < longest), longest + 1e-9)


def by_distance(trips: TripTable, line: Fit, subject: Subject) -> Exhibit:
    """Eq. (1) on the straight line, in buckets of it; and the cloud of trips."""
    rows = []
    for low, high, some in trips.by_distance(edges(subject.longest)):
        if not len(some):
            continue
        found = accuracy(some["drained"], some.eq1)
        rows.append([
            f"{low:g} to {high:.3g}", found.trips, found.drained, found.bias, found.rmse, found.r2,
            ratio_interval(some["drained"], some.eq1, some["placement"]),
        ])  # fmt: skip
    found = accuracy(trips["drained"], trips.eq1)
    rows.append([
        "all", found.trips, found.drained, found.bias, found.rmse, found.r2,
        ratio_interval(trips["drained"], trips.eq1, trips["placement"]),
    ])  # fmt: skip
    return Exhibit(
        "distance",
        "What trips drained, against the straight distance: on the left trip by trip, with Eq. (1)"
        " and the best straight line; on the right as a multiple of Eq. (1), the middle 80 % of"
        " trips shaded. Single tasks on"
        f" {subject.floor}. Bias is predicted less drained; R² is"
        " that of Eq. (1) as it stands; in brackets are 95 % intervals.",
        [
            Column("straight distance [m]"), Column("trips", ","), Column("drained [J]", ".1f"),
            Column("bias [J]", ".2f"), Column("RMSE [J]", ".2f"), Column("R²", ".3f"),
            Column("drained / Eq. (1)", ".3f"),
        ],
        rows,
        _cloud(trips, line, subject.longest),
    )  # fmt: skip


def _cloud(trips: TripTable, line: Fit, longest: float) -> Figure:
    figure = Figure(figsize=(WIDTH, 3.0))
    left, right = figure.subplots(1, 2)
    chosen = np.random.default_rng(0).permutation(len(trips))[:MOST_DOTS]
    straight, drained = trips["straight"], trips["drained"]
    left.plot(
        straight[chosen], drained[chosen], ".", ms=1.6, color=SERIES[5], alpha=0.6, rasterized=True
    )
    ends = np.array([0.0, longest])
    rate = float(trips["per_metre"][0])
    intercept, slope = (c.value for c in line.coefficients)
    left.plot(ends, rate * ends, color=SERIES[1], label="Eq. (1)")
    left.plot(
        ends, intercept + slope * ends, color=INK, ls=(0, (4, 1.5)),
        label=f"best line: {intercept:.1f} J + {slope:.1f} J/m",
    )  # fmt: skip
    left.set(xlabel="straight distance [m]", ylabel="drained [J]", xlim=(0, longest))
    left.set_ylim(0.0, max(1.15 * rate * longest, float(np.quantile(drained, 0.99))))
    left.legend(loc="upper left")
    middles, quantiles = [], []
    for low, high, some in trips.by_distance(np.linspace(0.0, longest, 29).tolist()):
        if len(some) > 4:
            middles.append(0.5 * (low + high))
            quantiles.append(np.quantile(some["drained"] / some.eq1, [0.1, 0.5, 0.9]))
    low, middle, high = np.array(quantiles).T
    right.fill_between(middles, low, high, color=SERIES[5], alpha=0.35, linewidth=0.0)
    right.plot(middles, middle, color=SERIES[0], label="median")
    right.axhline(1.0, color=SERIES[1], label="Eq. (1)")
    right.axhline(1.0 + TOLERANCE, color=DIM, lw=0.9, ls=(0, (1, 1)), label="10 % more")
    right.set(xlabel="straight distance [m]", ylabel="drained / Eq. (1)", xlim=(0, longest))
    right.set_yscale("log")
    ticks = [1.0, 1.1, 1.25, 1.5, 2.0, 3.0, 5.0]
    right.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    right.minorticks_off()
    right.set_ylim(min(0.95, 0.95 * float(low.min())), max(2.0, 1.1 * float(high.max())))
    right.legend(loc="upper right")
    return figure


def by_part(trips: TripTable, subject: Subject) -> Exhibit:
    """What trips took beyond Eq. (1), and what for."""
    rows = []
    labels = []
    for low, high, some in trips.by_distance(edges(subject.longest)):
        if len(some):
            labels.append(f"{low:g} to\n{high:.3g}")
            means = [float(some.part(name).mean()) for name in PARTS]
            rows.append([f"{low:g} to {high:.3g}", len(some), float(some.eq1.mean()), *means])
    figure = Figure(figsize=(WIDTH, 2.7))
    left, right = figure.subplots(1, 2)
    for axes, scale, label in (
        (left, False, "beyond Eq. (1) [J]"),
        (right, True, "in % of Eq. (1)"),
    ):
        below = np.zeros(len(rows))
        for number, name in enumerate(PARTS[:3]):
            values = np.array([row[3 + number] for row in rows])
            if scale:
                values = 100.0 * values / np.array([row[2] for row in rows])
            axes.bar(labels, values, 0.72, bottom=below, color=PART_COLOURS[name], label=name)
            below += np.maximum(values, 0.0)
        axes.set(xlabel="straight distance [m]", ylabel=label)
        axes.grid(visible=False, axis="x")
        axes.tick_params(axis="x", labelsize=7.5)
    right.legend(loc="upper right")
    return Exhibit(
        "parts",
        "Where the rest goes: the detour round others; the launch, which is speeding up, braking"
        " and the time that turning takes; and scrub of tyres that turn on the spot; per trip, and"
        " as a share of Eq. (1). Single tasks on"
        f" {subject.floor}, where"
        " nobody else moves: nobody waits, nothing touches. Detours are less than"
        " nothing where robots stop short of sites that another one covers.",
        [
            Column("straight distance [m]"), Column("trips", ","), Column("Eq. (1) [J]", ".2f"),
            *(Column(f"{name} [J]", ".2f") for name in PARTS),
        ],
        rows,
        figure,
    )  # fmt: skip


def by_setting(trips: TripTable, subject: Subject) -> Exhibit:
    """The same for other robots, crowds and floors."""
    rows = []
    for setting in subject.settings:
        tried = trips.where(setting=setting.name)
        some = tried.arrived()
        if not len(some):
            continue
        short, long = (
            some.take(mask) for mask in (some["straight"] < 1.0, some["straight"] >= 3.5)
        )
        found = accuracy(some["drained"], some.eq1)
        rows.append([
            setting.name, len(some), float(np.mean(tried["outcome"] != "arrived")) * 100.0,
            found.bias, found.rmse, found.r2,
            ratio_interval(short["drained"], short.eq1, short["placement"]),
            ratio_interval(long["drained"], long.eq1, long["placement"]),
            linearity(some).within_10,
            100.0 * float(some.part("detour").sum() / some.eq1.sum()),
            *fit(CORRECTED, some).coefficients,
            launch_cost(scenario_from(merged(subject.base, setting.scenario)).robot),
        ])  # fmt: skip
    return Exhibit(
        "settings",
        "One thing different at a time: what a launch costs beyond Eq. (1) on the planned path,"
        " and what trips drain as a multiple of Eq. (1) on the straight line, where that is"
        " shorter than 1 m and where it is 3.5 m or longer. Whiskers are 95 % intervals. Foreseen"
        " is a straight drive on an empty floor that begins with a turn from any heading, without"
        " the turns on the way.",
        [
            Column("setting"), Column("trips", ","), Column("no way [%]", ".1f"),
            Column("bias [J]", ".2f"), Column("RMSE [J]", ".2f"), Column("R²", ".3f"),
            Column("drained / Eq. (1), below 1 m", ".2f"),
            Column("drained / Eq. (1), from 3.5 m", ".2f"), Column("within 10 % from [m]", ".2f"),
            Column("detour [%]", ".1f"), Column("a launch [J]", ".2f"),
            Column("foreseen [J]", ".2f"),
        ],
        rows,
        _settings(rows, {s.name: s.group for s in subject.settings}),
    )  # fmt: skip


def _settings(rows: Sequence[Sequence[object]], group_of: Mapping[str, str]) -> Figure:
    groups = [group_of[str(row[0])] for row in rows]
    places, at = [], 0.0
    for before, group in zip([groups[0], *groups], groups, strict=False):
        at -= 1.0 if group == before else 1.6
        places.append(at)
    figure = Figure(figsize=(WIDTH, 0.3 + 0.215 * len(rows)))
    left, right = figure.subplots(1, 2, sharey=True)
    _whiskers(left, places, [row[10] for row in rows], SERIES[0], MARKERS[0])
    left.plot(
        [row[11] for row in rows], places, "|", color=INK, ms=9.0, label="foreseen"
    )  # fmt: skip
    left.legend(loc="upper right")
    left.set_xlabel("a launch costs [J]")
    left.set_xlim(left=min(0.0, left.get_xlim()[0]))
    for column, label, shade in ((6, "below 1 m", 1), (7, "from 3.5 m", 0)):
        _whiskers(right, places, [row[column] for row in rows], SERIES[shade], MARKERS[shade])
        right.plot([], [], MARKERS[shade], color=SERIES[shade], label=label)
    right.axvline(1.0, color=INK, lw=0.8, zorder=1.5)
    right.set_xlabel("drained / Eq. (1) on the straight line")
    right.legend(loc="upper right")
    left.set_yticks(places, [str(row[0]) for row in rows])
    for axes in (left, right):
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0.0)
    return figure


def _whiskers(
    axes: Axes, places: Sequence[float], intervals: Sequence[object], colour: str, marker: str
) -> None:
    value, low, high = np.array(intervals, float).T
    axes.hlines(places, low, high, color=colour, lw=1.3)
    axes.plot(value, places, marker, color=colour, ms=4.0)


def by_model(trips: TripTable) -> Exhibit:
    """The models on placements that they were not fitted on."""
    mine, others = halves(trips)
    rows, curves = [], []
    for model in MODELS:
        fitted = fit(model, mine)
        said = fitted.predict(others)
        found = accuracy(others["drained"], said)
        short = others["straight"] < 1.0
        near = accuracy(others["drained"][short], said[short])
        terms = "; ".join(
            f"{c.value:.2f} [{c.low:.2f}, {c.high:.2f}] {unit} {name}"
            for (name, unit, _), c in zip(model.terms, fitted.coefficients, strict=True)
        )
        rows.append([
            model.name, terms or "–", found.trips, found.bias, found.rmse, found.r2, near.rmse,
            near.r2,
        ])  # fmt: skip
        curves.append((model.name, list(_errors(others, said))))
    figure = Figure(figsize=(WIDTH, 2.9))
    left, right = figure.subplots(1, 2)
    for number, (name, points) in enumerate(curves):
        middle, rmse, share = np.array(points).T
        line = {"color": SERIES[number], "marker": MARKERS[number], "ms": 3.0, "lw": 1.1}
        left.plot(middle, share, label=name, **line)
        right.plot(middle, rmse, **line)
    left.axhline(0.0, color=INK, lw=0.8, zorder=1.5)
    left.set(xlabel="straight distance [m]", ylabel="predicted − drained [% of drained]")
    right.set(xlabel="straight distance [m]", ylabel="RMSE [J]", ylim=(0.0, None))
    figure.legend(loc="outside upper left", ncols=3, columnspacing=1.4, handlelength=1.8)
    return Exhibit(
        "models",
        "Models of what a trip costs, fitted on half of the placements and tried on the others:"
        " bias and RMSE by distance. A launch is a constant for each trip.",
        [
            Column("model"), Column("fitted"), Column("trips", ","), Column("bias [J]", ".2f"),
            Column("RMSE [J]", ".2f"), Column("R²", ".4f"), Column("RMSE below 1 m [J]", ".2f"),
            Column("R² below 1 m", ".3f"),
        ],
        rows,
        figure,
    )  # fmt: skip


def _errors(trips: TripTable, said: np.ndarray) -> Iterator[tuple[float, float, float]]:
    """The middle of each bin [m], RMSE [J] and bias [%] there."""
    longest = float(trips["straight"].max())
    near = (SHORTEST, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0)
    edges = [edge for edge in near if edge < 0.9 * longest]
    for low, high in pairwise([*edges, *np.arange(7.0, 0.9 * longest, 2.0).tolist(), longest]):
        there = (trips["straight"] >= low) & (trips["straight"] < high)
        if there.sum() > 4:
            drained = trips["drained"][there]
            errors = said[there] - drained
            yield (
                0.5 * (low + high),
                float(np.sqrt((errors**2).mean())),
                100.0 * float(errors.sum() / drained.sum()),
            )
