"""When a power was read that is read less often than the motion: at once, or as a mean."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fleet.logs.grounds import LoggedRun, LogGround
from fleet.logs.sampling import Rates, Spans, between_instants, rates, stands, to_rest

Floats = NDArray[np.float64]

_LAGS = 1.5  # readings, to both sides
_STEPS = 31
_CLEARLY = 0.98  # of the error: any other reading than the mean until then has to be better by this
_Seen = tuple[LoggedRun, Floats, Floats]  # a run, rates of its terms, and powers less their rest


def plain(run: LoggedRun) -> tuple[Floats, Floats]:
    """:func:`fleet.logs.sampling.rates`, and no rest."""
    return rates(run.v, run.omega), np.zeros(len(run.time))


def reading_of(ground: LogGround, basis: Rates = plain) -> tuple[float, float, str]:
    """By how much readings lag behind the motion [s], over how long they average [s], a sentence.

    A battery that is read once a second says either what it was at that moment, or the mean of that
    second, and its clock may be off; whichever fits the motion best is taken, by the terms of
    ``basis``. (0, 0, "") where power is read as often as motion.
    """
    slow = [run for run in ground.runs if run.slow]
    if not slow:
        return 0.0, 0.0, ""
    period = float(np.median([np.median(np.diff(run.meter)) for run in slow]))
    seen = [(run, *_while_moving(run, basis)) for run in slow]
    lags = np.linspace(-_LAGS, _LAGS, _STEPS) * period
    errors = {
        (float(lag), over): _error(seen, float(lag), over) for over in (0.0, period) for lag in lags
    }
    usual = (float(lags[np.argmin(np.abs(lags - 0.5 * period))]), period)
    best = min(errors, key=errors.__getitem__)
    lag, over = best if errors[best] <= _CLEARLY * errors[usual] else usual
    if basis is not plain:
        lag = _finer(seen, lag, over, float(lags[1] - lags[0]))
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


def _while_moving(run: LoggedRun, basis: Rates) -> tuple[Floats, Floats]:
    """The terms (n - 1, p) while the robot moves, and the rest (n - 1, 1)."""
    driven = to_rest(~stands(run.time, run.v, run.omega), run.v, run.omega)
    moves = (driven[1:] | driven[:-1]).astype(float)[:, None]
    terms, rest = basis(run)
    count = len(run.time)
    return (
        between_instants(terms, count) * moves,
        between_instants(rest[:, None], count) * moves,
    )


def _finer(seen: list[_Seen], lag: float, over: float, step: float) -> float:
    """The lag near one of a grid that fits best [s]."""
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda near: _error(seen, near, over), bounds=(lag - step, lag + step), method="bounded",
        options={"xatol": 0.01 * step},
    )  # fmt: skip
    return float(found.x)


def _error(seen: list[_Seen], lag: float, over: float) -> float:
    """The squares that least squares leave of the readings."""
    terms, powers = [], []
    for run, rated, rest in seen:
        half = 0.5 * max(over, float(np.median(np.diff(run.time))))
        spans = Spans(run.time, run.meter - lag - half, run.meter - lag + half)
        terms.append(spans.means(rated))
        powers.append(run.power - spans.means(rest)[:, 0])
    matrix, power = np.vstack(terms), np.concatenate(powers)
    matrix = np.column_stack([matrix, np.ones(len(power))])
    found = np.linalg.lstsq(matrix, power, rcond=None)[0]
    return float(((power - matrix @ found) ** 2).sum())
