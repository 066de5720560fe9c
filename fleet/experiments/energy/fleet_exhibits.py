"""Fleets at work: the trips of whole lifetimes, traffic, and what bids do to lifetimes."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fleet.experiments.energy.accuracy import accuracy, ratio_interval
from fleet.experiments.energy.exhibits import Column, Exhibit
from fleet.experiments.energy.lives import BASELINE, MEASURES, Life, find
from fleet.experiments.energy.models import Fit
from fleet.experiments.energy.settings import AS_IN_THE_PAPER, PROTOCOLS, RATES, Place
from fleet.experiments.energy.trip_exhibits import PART_COLOURS
from fleet.experiments.energy.trip_table import PARTS, TripTable
from fleet.study.report.style import INK, MARKERS, SERIES, WIDTH
from fleet.study.statistics import Interval, mean_interval

WAYS = {AS_IN_THE_PAPER: 6, "straight": 1, "path": 2, "corrected": 0, "driven": 3}
"""Ways to bid, with their shades; the first is not only bid but driven in straight lines."""
ALL = "all"
BETTER = ("path", "corrected", "driven")
SAID = {
    AS_IN_THE_PAPER: "bid and driven by Eq. (1), as in the paper",
    "straight": "bids: Eq. (1), straight",
    "path": "bids: Eq. (1), planned path",
    "corrected": "bids: planned path + launch",
    "driven": "bids: the whole drive, foreseen",
}


def by_protocol(trips: TripTable, corrected: Fit, places: Sequence[Place]) -> Exhibit:
    """The trips that protocols really ask for."""
    rows = []
    fitted = places[0].name  # where the correction was
    for place in places:
        here = trips.where(place=place.name).arrived()
        for protocol in (*PROTOCOLS, *([ALL] if place.name == fitted else [])):
            some = here if protocol == ALL else here.where(protocol=protocol)
            if not len(some):
                continue
            found, better = (
                accuracy(some["drained"], said) for said in (some.eq1, corrected.predict(some))
            )
            known = place.name == fitted
            rows.append([
                place.name, protocol, found.trips, float(np.mean(some["straight"])), found.drained,
                found.bias, found.rmse, found.r2,
                ratio_interval(some["drained"], some.eq1, some["seed"]),
                *(100.0 * float(some.part(name).sum() / some.eq1.sum()) for name in PARTS[:3]),
                better.rmse if known else nan, better.r2 if known else nan,
            ])  # fmt: skip
    return Exhibit(
        "lifetimes-trips",
        "The trips of whole lifetimes that arrived, of the first seeds of each place, robots"
        " bidding by Eq. (1) on the straight line: what they drained beyond it, in % of it, and"
        " what for. Detours are less than nothing where robots stop short of sites that another"
        " one covers. Corrected is Eq. (1) on the planned path and a launch, fitted on the single"
        f" tasks of the place “{fitted}”.",
        [
            Column("place"), Column("protocol"), Column("trips", ","),
            Column("straight distance, mean [m]", ".2f"), Column("drained, mean [J]", ".1f"),
            Column("bias [J]", ".2f"), Column("RMSE [J]", ".2f"), Column("R²", ".3f"),
            Column("drained / Eq. (1)", ".3f"),
            *(Column(f"{name} [% of Eq. (1)]", ".1f") for name in PARTS[:3]),
            Column("corrected: RMSE [J]", ".2f"), Column("corrected: R²", ".4f"),
        ],
        rows,
        _stacks([row for row in rows if row[1] != ALL]),
    )  # fmt: skip


def _stacks(rows: Sequence[Sequence[Any]]) -> Figure:
    places = list(dict.fromkeys(row[0] for row in rows))
    figure = Figure(figsize=(WIDTH, 2.5))
    grid = figure.subplots(1, len(places), sharey=True, squeeze=False)[0]
    for axes, place in zip(grid, places, strict=True):
        mine = [row for row in rows if row[0] == place]
        below = np.zeros(len(mine))
        for number, name in enumerate(PARTS[:3]):
            values = np.array([row[9 + number] for row in mine])
            axes.bar(
                [row[1] for row in mine], values, 0.72, bottom=below, color=PART_COLOURS[name],
                label=name,
            )  # fmt: skip
            below += np.maximum(values, 0.0)
        axes.set_title(place)
        axes.tick_params(axis="x", rotation=45, labelsize=7.5)
        axes.grid(visible=False, axis="x")
    grid[0].set_ylabel("beyond Eq. (1) [% of it]")
    figure.legend(*grid[0].get_legend_handles_labels(), loc="outside upper left", ncols=3)
    return figure


def in_traffic(trips: TripTable) -> Exhibit:
    """Streams: several movers at once, who wait for one another or push one another."""
    rows = []
    for traffic in ("reserved", "free"):
        for radius in (0.1, 0.2):
            for rate in RATES:
                some = trips.where(traffic=traffic, radius=radius, rate=rate).arrived()
                if not len(some):
                    continue
                rows.append([
                    traffic, radius, rate, len(some),
                    ratio_interval(some["drained"], some.eq1, some["seed"]),
                    mean_interval(_by_seed(some, "waited")),
                    float(np.mean(some["contacts"])),
                    *(100.0 * float(some.part(n).sum() / some["drained"].sum()) for n in PARTS),
                ])  # fmt: skip
    return Exhibit(
        "traffic",
        "Several robots under way at once. Reserved traffic: who would cross another’s way waits"
        " before setting off, at 3.66 W, and nobody touches. Free traffic: all set off at once,"
        " touch and push. Whiskers are 95 % intervals over seeds.",
        [
            Column("traffic"), Column("radius [m]", "g"), Column("events a second", "g"),
            Column("trips", ","), Column("drained / Eq. (1)", ".3f"),
            Column("waited a trip [s]", ".2f"), Column("contacts a trip", ".2f"),
            *(Column(f"{name} [% of drained]", ".2f") for name in PARTS),
        ],
        rows,
        _traffic(rows),
    )  # fmt: skip


def _by_seed(trips: TripTable, name: str) -> list[float]:
    return [float(np.mean(trips.where(seed=seed)[name])) for seed in np.unique(trips["seed"])]


def _traffic(rows: Sequence[Sequence[Any]]) -> Figure:
    figure = Figure(figsize=(WIDTH, 2.6))
    panels = figure.subplots(1, 3)
    for number, (traffic, radius) in enumerate(dict.fromkeys((row[0], row[1]) for row in rows)):
        mine = [row for row in rows if (row[0], row[1]) == (traffic, radius)]
        rates = [row[2] for row in mine]
        line = {
            "color": SERIES[0 if traffic == "reserved" else 1], "marker": MARKERS[number],
            "ls": "-" if radius == 0.1 else (0, (4, 1.5)),
        }  # fmt: skip
        ratio, low, high = np.array([row[4] for row in mine], float).T
        panels[0].plot(rates, ratio, **line, label=f"{traffic}, radius {radius} m")
        panels[0].vlines(rates, low, high, color=line["color"], lw=1.0)
        panels[1].plot(rates, [row[10] for row in mine], **line)
        panels[2].plot(rates, [row[11] for row in mine], **line)
    for axes, title in zip(
        panels,
        ("drained / Eq. (1)", "waiting [% of drained]", "contact [% of drained]"),
        strict=True,
    ):
        axes.set_title(title)
        axes.set_xlabel("events a second")
        axes.set_xticks(RATES, [f"{rate:g}" for rate in RATES])
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
    return figure


def lifetimes(listed: Sequence[Life]) -> Exhibit:
    """How long networks live, by what robots bid."""
    rows = [
        [life.place, life.protocol, SAID[life.bids], life.runs, *life.means.values()]
        for life in listed
    ]
    return Exhibit(
        "lifetimes",
        "How long networks live: events served before the first that nobody takes. Means of"
        " whole lifetimes on the same networks and events; whiskers are 95 % intervals.",
        [
            Column("place"), Column("protocol"), Column("way"), Column("runs"),
            *(Column(name, ".1f") for name in MEASURES.values()),
        ],
        rows,
        _panels(listed, "lifetime"),
    )  # fmt: skip


def _panels(listed: Sequence[Life], measure: str) -> Figure:
    places = list(dict.fromkeys(life.place for life in listed))
    ways = [way for way in WAYS if any(life.bids == way for life in listed)]
    figure = Figure(figsize=(WIDTH, 2.6))
    grid = figure.subplots(1, len(places), sharey=True, squeeze=False)[0]
    for axes, place in zip(grid, places, strict=True):
        for number, way in enumerate(ways):
            _dots(axes, [find(listed, place, p, way) for p in PROTOCOLS], measure, number, way)
        axes.set_xticks(range(len(PROTOCOLS)), PROTOCOLS, rotation=45, fontsize=8.0)
        axes.set_title(place)
        axes.grid(visible=False, axis="x")
    grid[0].set(ylabel="lifetime [events]", ylim=(0.0, None))
    handles = [
        grid[0].plot([], [], MARKERS[number], color=SERIES[WAYS[way]], label=SAID[way])[0]
        for number, way in enumerate(ways)
    ]
    figure.legend(handles=handles, loc="outside upper left", ncols=2)
    return figure


def _dots(axes: Any, lives: Sequence[Life | None], measure: str, number: int, way: str) -> None:
    for at, life in enumerate(lives):
        if life is not None:
            value, low, high = life.means[measure]
            x = at + 0.15 * (number - 2.0)
            axes.vlines(x, low, high, color=SERIES[WAYS[way]], lw=1.2)
            axes.plot(x, value, MARKERS[number], color=SERIES[WAYS[way]], ms=3.6)


def differences(listed: Sequence[Life]) -> Exhibit:
    """What other bids change, over runs of the same seed."""
    others = [life for life in listed if life.bids in BETTER]
    rows = []
    for life in others:
        base = find(listed, life.place, life.protocol, BASELINE)
        if base is None:
            continue
        rows.append([
            life.place, life.protocol, SAID[life.bids],
            *(_difference(life, name) for name in MEASURES),
            100.0 * life.differences["lifetime"].mean / base.means["lifetime"].value,
        ])  # fmt: skip
    return Exhibit(
        "differences",
        "What better bids change, against bids by Eq. (1) on the straight line, over pairs of runs"
        " of one seed: the lifetime; the events served before the first robot dies on its way;"
        " and the trips that fail. Whiskers are 95 % BCa bootstrap intervals.",
        [
            Column("place"), Column("protocol"), Column("way"),
            *(Column(f"Δ {name}", "+.1f") for name in MEASURES.values()),
            Column("Δ lifetime [%]", "+.1f"),
        ],
        rows,
        _contrasts(others),
    )  # fmt: skip


def _difference(life: Life, name: str) -> Interval:
    return Interval(*life.differences[name][:3])


def _contrasts(listed: Sequence[Life]) -> Figure:
    measures = {
        "lifetime": "Δ lifetime:\nevents before nobody goes",
        "unbroken": "Δ events before a\nrobot dies on its way",
        "failed": "Δ trips that fail\nin a lifetime",
    }
    names = list(dict.fromkeys((life.place, life.protocol) for life in listed))
    places: dict[tuple[str, str], float] = {}
    at = 0.0
    for number, name in enumerate(names):
        at -= 1.0 if number == 0 or name[0] == names[number - 1][0] else 1.5
        places[name] = at
    figure = Figure(figsize=(WIDTH, max(1.8, 0.6 + 0.2 * len(names))))
    panels = figure.subplots(1, 3, sharey=True)
    for axes, (measure, title) in zip(panels, measures.items(), strict=True):
        for number, way in enumerate(BETTER):
            mine = [life for life in listed if life.bids == way]
            if not mine:
                continue
            y = [places[life.place, life.protocol] + 0.24 * (1 - number) for life in mine]
            value, low, high = np.array([_difference(life, measure) for life in mine]).T
            axes.hlines(y, low, high, color=SERIES[WAYS[way]], lw=1.2)
            axes.plot(
                value, y, MARKERS[number + 2], color=SERIES[WAYS[way]], ms=3.4, label=SAID[way]
            )
        axes.axvline(0.0, color=INK, lw=0.8, zorder=1.5)
        axes.set_title(title)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0.0)
        axes.locator_params(axis="x", nbins=5)
    panels[0].set_yticks(list(places.values()), [f"{place}, {p}" for place, p in names])
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
    return figure
