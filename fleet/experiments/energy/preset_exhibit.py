"""The robots that have a name: is a line true of them, and is Eq. (1)?"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from fleet.experiments.energy.exhibits import Column, Exhibit
from fleet.experiments.energy.linearity import linearity
from fleet.experiments.energy.settings import LONGEST, PRESETS
from fleet.experiments.energy.trip_table import TripTable
from fleet.study.report.style import INK, SERIES, WIDTH


def by_preset(single: TripTable) -> Exhibit:
    """Slope, intercept and R² of the best line for each, and where Eq. (1) comes near it."""
    there = {
        preset: some
        for preset, setting in PRESETS.items()
        if len(some := single.where(setting=setting).arrived())
    }
    found = {preset: linearity(some) for preset, some in there.items()}
    figure = Figure(figsize=(WIDTH, 2.7))
    panels = figure.subplots(1, len(there), sharey=True, squeeze=False)[0]
    ends = np.array([0.0, LONGEST])
    for axes, (preset, some) in zip(panels, there.items(), strict=True):
        one = found[preset]
        axes.plot(
            some["straight"], some["drained"] / one.rate, ".", ms=1.4, color=SERIES[5], alpha=0.5,
            rasterized=True,
        )  # fmt: skip
        axes.plot(ends, ends, color=SERIES[1], label="Eq. (1)")
        line = (one.intercept.value + one.slope.value * ends) / one.rate
        axes.plot(ends, line, color=INK, ls=(0, (4, 1.5)), label="best line")
        axes.set_title(preset)
        axes.set(xlabel="straight distance [m]", xlim=(0.0, LONGEST), ylim=(0.0, 3.0 * LONGEST))
    panels[0].set_ylabel("drained / Eq. (1) of a metre [m]")
    panels[0].legend(loc="upper left", fontsize=8.0)
    return Exhibit(
        "presets",
        "What single trips drain, in metres that Eq. (1) of the same robot pays for. Linear:"
        " the cloud follows a line; proportional: it follows Eq. (1), through the origin. R² of the"
        " line is that on placements that it was not fitted on; how far the line is off is that of"
        " the means over the worst half metre; in brackets are 95 % intervals over placements.",
        [
            Column("robot"), Column("trips", ","), Column("intercept [J]", ".1f"),
            Column("slope [J/m]", ".1f"), Column("Eq. (1) [J/m]", ".1f"), Column("R², line", ".3f"),
            Column("line off by at most [%]", ".0f"), Column("R², Eq. (1)", ".3f"),
            Column("Eq. (1) within 10 % from [m]", ".1f"),
        ],
        [
            [preset, one.trips, one.intercept, one.slope, one.rate, one.r2, 100.0 * one.line_off,
             one.eq1_r2, one.within_10]
            for preset, one in found.items()
        ],
        figure,
    )  # fmt: skip
