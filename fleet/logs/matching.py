"""When a power was read that is read less often than the motion: at once, or as a mean."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fleet.logs.grounds import LogGround
from fleet.logs.sampling import Averages, rates, stands

Floats = NDArray[np.float64]

_LAGS = 1.5  # readings, to both sides
_STEPS = 31
_CLEARLY = 0.98  # of the error: any other reading than the mean until then has to be better by this


def reading_of(ground: LogGround) -> tuple[float, float, str]:
    """By how much readings lag behind the motion [s], over how long they average [s], a sentence.

    A battery that is read once a second says either what it was at that moment, or the mean of that
    second, and its clock may be off; whichever fits the motion best is taken. (0, 0, "") where
    power is read as often as motion.
    """
    slow = [run for run in ground.runs if run.slow]
    if not slow:
        return 0.0, 0.0, ""
    period = float(np.median([np.median(np.diff(run.meter)) for run in slow]))
    prepared = []
    for run in slow:
        moving = 1.0 - stands(run.time, run.v, run.omega)
        terms = rates(run.v, run.omega) * moving[:, None]
        least = float(np.median(np.diff(run.time)))
        prepared.append((run.meter, run.power, Averages(run.time, terms), least))
    lags = np.linspace(-_LAGS, _LAGS, _STEPS) * period
    errors = {
        (float(lag), over): _error(prepared, float(lag), over)
        for over in (0.0, period)
        for lag in lags
    }
    usual = (float(lags[np.argmin(np.abs(lags - 0.5 * period))]), period)
    best = min(errors, key=errors.__getitem__)
    if errors[best] > _CLEARLY * errors[usual]:
        best = usual
    lag, over = best
    what = f"the mean over {over:.2g} s" if over else "the value of a moment"
    return (
        lag,
        over,
        (
            f"power is read every {period:.2g} s, {_often(period)}: taken as {what},"
            f" {lag - 0.5 * over:+.2f} s"
            " from its time, which fits the motion best"
        ),
    )


def _often(period: float) -> str:
    return "ten readings a phase of a drive need 5 a second" if period > 0.2 else "often enough"


def _error(
    prepared: list[tuple[Floats, Floats, Averages, float]], lag: float, over: float
) -> float:
    """The squares that least squares leave of the readings."""
    terms, powers = [], []
    for meter, power, averages, least in prepared:
        half = 0.5 * max(over, least)
        terms.append(averages.between(meter - lag - half, meter - lag + half))
        powers.append(power)
    matrix, power = np.vstack(terms), np.concatenate(powers)
    matrix = np.column_stack([matrix, np.ones(len(power))])
    found = np.linalg.lstsq(matrix, power, rcond=None)[0]
    return float(((power - matrix @ found) ** 2).sum())
