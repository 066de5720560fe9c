"""The two families of laws, on the same windows and trips of the same runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fleet.logs.fitting import Law, Mask, MotionLaw, Sums, identified, nested, sums_of
from fleet.logs.forces import ONSETS, Chassis, linearised
from fleet.logs.grounds import LoggedRun, LogGround
from fleet.logs.sampling import (
    STILL_SPEED,
    TERMS,
    Pieces,
    Rates,
    Samples,
    samples_of,
    trips,
    windows,
)  # fmt: skip
from fleet.scenario.errors import bad

Floats = NDArray[np.float64]

_ROUNDS = 8
_CLEAN = 0.02  # root mean square error, of that of the windows' energy
_SHORT = 0.25  # [s] of windows of a log that is as clean as that


@dataclass(frozen=True, slots=True)
class LawFamily:
    """Laws of one form, and what they are fitted to and asked on."""

    name: str
    samples: Samples
    windows: Pieces
    trips: Pieces
    sums: Sums
    laws: Sequence[Law]  # each with one more term than the one before
    why: dict[str, str]  # terms that cannot be told apart

    @property
    def richest(self) -> Law:
        """The law with all terms that can be told apart."""
        return self.laws[-1]

    def law(self, terms: Law, among: Mask | None = None) -> MotionLaw:
        """The law of these terms, fitted on all runs, or on those ``among`` (r,) them."""
        return self.sums.law(terms, None if among is None else among.astype(float))


def by_motion(ground: LogGround, lag: float = 0.0, over: float = 0.0) -> LawFamily:
    """Laws that are linear in metres, seconds, radians, seconds of turning, and v²."""
    samples = samples_of(ground, lag=lag, over=over)
    if not len(samples.step):
        raise bad(
            "--log", f"{ground.name}: it never drives; expected speeds of more than"
            f" {STILL_SPEED:g} m/s",
        )  # fmt: skip
    cut = windows(samples)
    terms, why = identified(cut, cut, turns=ground.turns)
    return LawFamily(
        "motion", samples, cut, trips(samples), sums_of(cut), nested(terms), why
    )  # fmt: skip


def by_forces(
    ground: LogGround, chassis: Chassis, start: LawFamily, lag: float = 0.0, over: float = 0.0
) -> tuple[LawFamily, Chassis]:
    """The law by forces, made linear where it fits best, and the chassis with its onset."""
    onsets: Sequence[float] = ONSETS
    if ground.settings.scrub_onset is not None or "angle" not in start.richest:
        onsets = (chassis.scrub_onset,)
    fitted = [
        (*_linear_where_best(ground, replace(chassis, scrub_onset=onset), start, lag, over), onset)
        for onset in onsets
    ]
    family, _, onset = min(fitted, key=lambda found: found[1])
    return family, replace(chassis, scrub_onset=onset)


def _linear_where_best(
    ground: LogGround, chassis: Chassis, start: LawFamily, lag: float, over: float
) -> tuple[LawFamily, float]:
    """The law by forces of one chassis, and the squares that it leaves.

    Of a log that it fits as closely as only a simulation is fitted, on short windows: these tell
    apart what goes together over whole drives.
    """
    family, error = _iterated(ground, chassis, start, lag, over, None)
    typical = float(np.sqrt(np.mean(family.windows.energy**2)))
    if np.sqrt(error / max(1, len(family.windows))) < _CLEAN * typical:
        return _iterated(ground, chassis, start, lag, over, _SHORT)
    return family, error


def _iterated(
    ground: LogGround, chassis: Chassis, start: LawFamily, lag: float, over: float,
    length: float | None,
) -> tuple[LawFamily, float]:  # fmt: skip
    """The law on windows of one ``length`` [s], and the squares that it leaves.

    Gauss and Newton's iteration from the law by motion; runs that are left out are left out of the
    fit, not of the point at which the law was made linear.
    """
    if length is not None:
        length = max(length, 10.0 * start.samples.period)
    plain = windows(start.samples, length)
    found = start.law(start.richest)
    scale = np.array([chassis.efficiency, 1.0, chassis.efficiency, 1.0, chassis.efficiency])
    parameters = scale * [found[term] for term in TERMS]
    terms, why = start.richest, start.why
    best, least = parameters, np.inf
    for _ in range(_ROUNDS):
        samples = samples_of(ground, _rates_at(chassis, parameters), lag=lag, over=over)
        cut = windows(samples, length)
        terms, why = identified(cut, plain, turns=ground.turns)
        error = float(((cut.terms @ parameters + cut.rest - cut.energy) ** 2).sum())
        if error < least:
            best, least = parameters, error
        law = sums_of(cut).law(terms)
        new = np.array([law[term] for term in TERMS])
        done = np.abs(new - parameters).max() <= 1e-4 * max(1.0, float(np.abs(new).max()))
        parameters = new if error <= least else 0.5 * (best + new)
        if done:
            break
    samples = samples_of(ground, _rates_at(chassis, best), lag=lag, over=over)
    cut = windows(samples, length)
    return LawFamily(
        "forces", samples, cut, trips(samples), sums_of(cut), [tuple(terms)], why
    ), least  # fmt: skip


def _rates_at(chassis: Chassis, parameters: Floats) -> Rates:
    def rates(run: LoggedRun) -> tuple[Floats, Floats]:
        return linearised(chassis, run.time, run.v, run.omega, parameters)

    return rates
