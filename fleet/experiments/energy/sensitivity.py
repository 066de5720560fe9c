"""What the comparisons between protocols hang on: ratios of lifetimes, robot by robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fleet.experiments.energy.accuracy import ratio_interval
from fleet.experiments.energy.exhibits import Column, Exhibit
from fleet.experiments.energy.settings import BIDS, COMPARED, HEADLINES, PAPER
from fleet.study.report.style import INK, MARKERS, SERIES, WIDTH
from fleet.study.statistics import Interval

Rows = Sequence[Mapping[str, Any]]


def ratios(rows: Rows) -> dict[str, dict[tuple[str, str], Interval]]:
    """For each robot the ratio of mean lifetimes of each pair compared, over seeds in common."""
    cells: dict[tuple[str, str], dict[int, float]] = {}
    for row in rows:
        cell = cells.setdefault((row["setting"], row["protocol"]), {})
        cell[row["seed"]] = float(row["lifetime"])
    found: dict[str, dict[tuple[str, str], Interval]] = {}
    for setting in HEADLINES:
        for pair in COMPARED:
            one, other = (cells.get((setting, protocol), {}) for protocol in pair)
            if seeds := sorted(set(one) & set(other)):
                found.setdefault(setting, {})[pair] = ratio_interval(
                    [one[s] for s in seeds], [other[s] for s in seeds], seeds
                )
    return found


def headlines(rows: Rows) -> Exhibit:
    """Whether who lives longer hangs on the robot."""
    found = ratios(rows)
    runs = {name: len({row["seed"] for row in rows if row["setting"] == name}) for name in found}
    return Exhibit(
        "headlines",
        "Ratios of mean lifetimes, open floor, 100 robots that bid by Eq. (1) on the straight line,"
        " with one thing different in all robots at a time. The paper’s robot scrubs with 0.2 N·m."
        " Whiskers are 95 % intervals over the seeds, the same for all.",
        [
            Column("robot"), Column("seeds", ","),
            *(Column(f"{one} / {other}", ".2f") for one, other in COMPARED),
        ],
        [[name, runs[name], *(pairs[pair] for pair in COMPARED)] for name, pairs in found.items()
         if len(pairs) == len(COMPARED)],
        _ratios(found),
    )  # fmt: skip


def _ratios(found: Mapping[str, Mapping[tuple[str, str], Interval]]) -> Figure:
    figure = Figure(figsize=(WIDTH, 0.6 + 0.24 * len(found)))
    panels = figure.subplots(1, len(COMPARED), sharey=True, squeeze=False)[0]
    places = [-float(number) for number in range(len(found))]
    for number, (axes, pair) in enumerate(zip(panels, COMPARED, strict=True)):
        value, low, high = np.array([pairs[pair] for pairs in found.values()], float).T
        axes.hlines(places, low, high, color=SERIES[number], lw=1.3)
        axes.plot(value, places, MARKERS[number], color=SERIES[number], ms=4.0)
        axes.axvline(1.0, color=INK, lw=0.8, zorder=1.5)
        axes.set_title(f"{pair[0]} / {pair[1]}")
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0.0)
    panels[0].set_yticks(places, list(found))
    return figure


def on_headlines(rows: Rows) -> str:
    """How far each ratio goes down and up, and whether an order is turned."""
    found, said = ratios(rows), []
    for pair in COMPARED:
        mine = {name: pairs[pair] for name, pairs in found.items() if pair in pairs}
        if PAPER not in mine:
            continue
        least, most = (f(mine, key=lambda name: mine[name].value) for f in (min, max))
        turned = [
            name
            for name, one in mine.items()
            if (one.value - 1.0) * (mine[PAPER].value - 1.0) < 0.0
        ]
        sure = [
            name
            for name in turned
            if (mine[name].high < 1.0 if mine[name].value < 1.0 else mine[name].low > 1.0)
        ]
        order = "the order is the same with all robots"
        if turned:
            order = (
                f"the order is turned with {len(turned)} of {len(mine)} robots, in"
                f" {len(sure)} of these cases beyond the interval"
            )
        said.append(
            f"{pair[0]} / {pair[1]} is {_written(mine[PAPER])} with the paper’s robot,"
            f" {_written(mine[least])} ({least}) to {_written(mine[most])} ({most}): {order}."
        )
    return " ".join(said)


def _written(ratio: Interval) -> str:
    if not np.isfinite(ratio.low):
        return f"{ratio.value:.2f}"
    return f"{ratio.value:.2f} [{ratio.low:.2f}, {ratio.high:.2f}]"


def misled(rows: Rows) -> Iterator[tuple[str, str, int, Interval, float]]:
    """Place, protocol, choices, the share in which Eq. (1) misleads [%], regret of one [J]."""
    cells: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for row in rows:
        if row.get("bids") == BIDS[-1]:
            cells.setdefault((row["place"], row["protocol"]), []).append(row)
    for (place, protocol), mine in cells.items():
        made, wrong = ([float(row[name]) for row in mine] for name in ("choices", "misled"))
        if not sum(made):  # it never asks two
            continue
        if not sum(wrong):
            share = Interval(0.0, 0.0, 0.0)
        else:
            share = ratio_interval(wrong, made, [row["seed"] for row in mine])
        regret = sum(row["regret"] for row in mine) / max(1.0, sum(wrong))
        yield place, protocol, int(sum(made)), Interval(*(100.0 * x for x in share)), regret


def choices(rows: Rows) -> Exhibit:
    """In which share of choices Eq. (1) takes another robot, and what that costs."""
    table = [list(row) for row in misled(rows)]
    return Exhibit(
        "choices",
        "Robots that were asked, could afford the trip, and bid what it takes them: how often"
        " Eq. (1) on the straight line would choose another one for the most energy left, and how"
        " much less energy that robot keeps. In brackets 95 % intervals over seeds.",
        [
            Column("place"), Column("protocol"), Column("choices", ","),
            Column("another robot [%]", ".1f"), Column("regret of one [J]", ".2f"),
        ],
        table,
    )  # fmt: skip


def on_choices(rows: Rows) -> str:
    """The same in a sentence for each place."""
    said: dict[str, list[str]] = {}
    for place, protocol, _, share, regret in misled(rows):
        said.setdefault(place, []).append(f"{protocol} {share.value:.0f} % ({regret:.2f} J each)")
    return " ".join(
        f"In the place “{place}” Eq. (1) would send another robot in this share of choices, at"
        f" this loss: {', '.join(parts)}."
        for place, parts in said.items()
    )
