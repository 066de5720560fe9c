"""The six figures of a log's report."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fleet.logs.judging import Judgement
from fleet.logs.sentences import NAMES, shares
from fleet.study.report.style import DIM, INK, SERIES

Floats = NDArray[np.float64]

LINEAR, FITTED = SERIES[1], SERIES[0]
TURNING = LinearSegmentedColormap.from_list("turning", [SERIES[5], SERIES[2], SERIES[4], SERIES[1]])
_SIZE = (4.4, 3.1)  # [inch]
_MOST = 3000  # dots
_WORST = 1.5  # error at which axes end


def _axes() -> tuple[Figure, Axes]:
    figure = Figure(figsize=_SIZE)
    return figure, figure.subplots()


def _some(count: int) -> NDArray[np.intp]:
    """At most :data:`_MOST` of so many dots, always the same."""
    return np.sort(np.random.default_rng(0).permutation(count)[:_MOST])


def _dots(axes: Axes, x: Floats, y: Floats, turning: Floats, label: str) -> None:
    chosen = _some(len(x))
    most = float(np.quantile(turning, 0.98)) if len(turning) else 0.0
    drawn = axes.scatter(
        x[chosen], y[chosen], c=turning[chosen], s=13, cmap=TURNING, vmin=0.0, vmax=max(most, 1e-3),
        linewidths=0, rasterized=len(chosen) > 1500,
    )  # fmt: skip
    bar = axes.figure.colorbar(drawn, ax=axes, pad=0.02, aspect=28)
    bar.set_label(label, size=8.0, labelpad=6.0)
    bar.outline.set_visible(False)


def trip_energies(judgement: Judgement) -> Figure:
    """Energy against distance, trip by trip, coloured by turning, and the line with its band."""
    figure, axes = _axes()
    trips, plain = judgement.trips, judgement.motion.trips
    slope = float((trips.metres * trips.energy).sum() / (trips.metres**2).sum())
    ends = np.array([0.0, 1.05 * float(trips.metres.max())])
    band = judgement.band
    axes.fill_between(
        ends, slope * (1 - band) * ends, slope * (1 + band) * ends, color=DIM, alpha=0.2, lw=0
    )
    axes.plot(ends, slope * ends, color=INK, lw=1.0, label=f"{slope:.3g} J/m ± {100 * band:g} %")
    _dots(axes, trips.metres, trips.energy, plain.term("angle") / trips.metres, "turning [rad/m]")
    axes.set(xlabel="distance of a trip [m]", ylabel="energy [J]", xlim=ends, ylim=(0.0, None))
    axes.legend(loc="upper left")
    return figure


def error_shares(judgement: Judgement) -> Figure:
    """The share of held-out trips by error, of distance alone and of the fitted law."""
    figure, axes = _axes()
    for left_out, colour, label in (
        (judgement.linear, LINEAR, "distance alone"),
        (judgement.best.left_out, FITTED, "fitted law"),
    ):
        errors = 100.0 * np.sort(np.abs(left_out.errors))
        steps = np.r_[0.0, errors], np.r_[0.0, np.arange(1, len(errors) + 1) / len(errors)]
        axes.step(*steps, where="post", color=colour, label=label)
    axes.axvline(100.0 * judgement.band, color=INK, lw=0.8)
    axes.set(
        xlabel="error of a held-out trip, at most [%]", ylabel="share of trips", xlim=(0.0, 100.0),
        ylim=(0.0, 1.0),
    )  # fmt: skip
    axes.legend(loc="lower right")
    return figure


def predictions(judgement: Judgement) -> Figure:
    """What the laws say of trips of runs that they have not seen, against what was measured."""
    figure, axes = _axes()
    chosen = _some(len(judgement.linear.energy))
    most = 1.1 * float(judgement.linear.energy.max())
    axes.plot([0.0, most], [0.0, most], color=INK, lw=0.8)
    for left_out, colour, marker, label in (
        (judgement.linear, LINEAR, "s", "distance alone"),
        (judgement.best.left_out, FITTED, "o", "fitted law"),
    ):
        axes.plot(
            left_out.energy[chosen], left_out.predicted[chosen], marker, ms=3.2, color=colour,
            label=label, alpha=0.85, mew=0, rasterized=len(chosen) > 1500,
        )  # fmt: skip
    axes.set(xlabel="measured [J]", ylabel="predicted [J]", xlim=(0, most), ylim=(0, most))
    axes.legend(loc="upper left")
    return figure


def powers(judgement: Judgement) -> Figure:
    """Mean power of windows against their mean speed, coloured by how fast they turn."""
    figure, axes = _axes()
    windows = judgement.motion.windows
    time = windows.term("time")
    _dots(
        axes, windows.metres / time, windows.energy / time, windows.term("angle") / time,
        "turning [rad/s]",
    )  # fmt: skip
    axes.set(xlabel="mean speed of a window [m/s]", ylabel="mean power [W]", xlim=(0.0, None))
    axes.set_ylim(min(0.0, axes.get_ylim()[0]), None)
    return figure


def energy_shares(judgement: Judgement) -> Figure:
    """Where the energy goes, by the richest law of motion."""
    figure, axes = _axes()
    parts = shares(judgement)
    names = [NAMES[term] for term in parts]
    values = [100.0 * value for value in parts.values()]
    axes.barh(names[::-1], values[::-1], 0.62, color=FITTED)
    for row, value in enumerate(values[::-1]):
        axes.annotate(
            f"{value:.0f} %", (value, row), (4, 0), textcoords="offset points", va="center"
        )
    axes.set(xlabel="share of all energy of driving [%]", xlim=(0.0, 1.18 * max(*values, 1.0)))
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0.0)
    return figure


def errors_by_run(judgement: Judgement) -> Figure:
    """The errors of each run's trips, left out: what varies from run to run."""
    figure, axes = _axes()
    runs, index = np.unique(judgement.linear.run, return_inverse=True)
    chosen = _some(len(index))
    axes.axhspan(-100 * judgement.band, 100 * judgement.band, color=DIM, alpha=0.2, lw=0)
    axes.axhline(0.0, color=INK, lw=0.8)
    for left_out, shift, colour, marker, label in (
        (judgement.linear, 0.16, LINEAR, "s", "distance alone"),
        (judgement.best.left_out, -0.16, FITTED, "o", "fitted law"),
    ):
        errors = 100.0 * np.clip(left_out.errors, -1.0, _WORST)
        axes.plot(
            index[chosen] + 1 + shift,
            errors[chosen],
            marker,
            ms=3.2,
            color=colour,
            label=label,
            mew=0,
        )
    axes.set(
        xlabel="run, or what stands for one", ylabel="error of its trips [%]", ylim=(-105, 195),
        xlim=(0.4, len(runs) + 0.6),
    )  # fmt: skip
    axes.legend(loc="upper left", ncols=2)
    axes.grid(visible=False, axis="x")
    return figure


Drawing = Callable[[Judgement], Figure]

FIGURES: Sequence[tuple[str, str, Drawing, str]] = (
    ("trips", "Energy against distance", trip_energies,
     ("Each dot is a trip, from standing to standing. If energy were linear in distance, all would"
     " lie in the band about the line, the best through zero.")),
    ("errors", "How far off the laws are", error_shares,
     "The share of trips whose error is at most so large, on runs that were left out of the fit."),
    ("predictions", "Predicted and measured", predictions,
     "Each trip twice: what distance alone and what the fitted law says of it, without its run."),
    ("powers", "Power, speed and turning", powers,
     ("Each dot is a window of about five seconds. One power at one speed would make energy linear"
     " in distance.")),
    ("shares", "Where the energy goes", energy_shares,
     "The terms of the richest law of motion that the log can tell apart."),
    ("runs", "Run by run", errors_by_run,
     ("The error of each trip, run by run. What all trips of a run share no law of motion explains:"
     " the ground, the load, the robot that day.")),
)  # fmt: skip
"""Name, title, drawing and caption of each figure."""
