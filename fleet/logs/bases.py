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
    samples = samples_of(ground, lag, over)
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


def by_forces(ground: LogGround, chassis: Chassis, start: LawFamily) -> tuple[LawFamily, Chassis]:
    """The law by forces, made linear where it fits best, and the chassis with its onset.

    On the samples of ``start``, the law by motion. Of a log that it fits as closely as only a
    simulation is fitted, on short windows: these tell apart what goes together over whole drives.
    """
    onsets: Sequence[float] = ONSETS
    if ground.settings.scrub_onset is not None or "angle" not in start.richest:
        onsets = (chassis.scrub_onset,)
    fits = [
        _iterated(ground, replace(chassis, scrub_onset=onset), start, start.windows)
        for onset in onsets
    ]
    best = int(np.argmin([squares for _, squares in fits]))
    (family, squares), chassis = fits[best], replace(chassis, scrub_onset=onsets[best])
    typical = float(np.sqrt(np.mean(start.windows.energy**2)))
    if np.sqrt(squares / len(start.windows)) < _CLEAN * typical:
        length = max(_SHORT, 10.0 * start.samples.period)
        family, _ = _iterated(ground, chassis, start, windows(start.samples, length))
    return family, chassis


def _iterated(
    ground: LogGround, chassis: Chassis, start: LawFamily, plain: Pieces
) -> tuple[LawFamily, float]:
    """The law on the windows of ``plain``, and the squares that it leaves.

    Gauss and Newton's iteration from the law by motion; runs that are left out are left out of the
    fit, not of the point at which the law was made linear.
    """
    found = start.law(start.richest)
    scale = np.array([chassis.efficiency, 1.0, chassis.efficiency, 1.0, chassis.efficiency])
    parameters = scale * [found[term] for term in TERMS]
    best, least, family = parameters, np.inf, start
    for _ in range(_ROUNDS):
        samples = start.samples.rated(rates_at(chassis, parameters))
        cut = plain.rated(samples)
        terms, why = identified(cut, plain, turns=ground.turns)
        sums = sums_of(cut)
        error = float(((cut.terms @ parameters + cut.rest - cut.energy) ** 2).sum())
        if error < least:
            best, least = parameters, error
            family = LawFamily("forces", samples, cut, start.trips, sums, [tuple(terms)], why)
        law = sums.law(terms)
        new = np.array([law[term] for term in TERMS])
        done = np.abs(new - parameters).max() <= 1e-4 * max(1.0, float(np.abs(new).max()))
        parameters = new if error <= least else 0.5 * (best + new)
        if done:
            break
    return replace(family, trips=trips(family.samples)), least


def rates_at(chassis: Chassis, parameters: Floats) -> Rates:
    """What the parameters (5,) of a law by forces multiply, near their values."""

    def rates(run: LoggedRun) -> tuple[Floats, Floats]:
        return linearised(chassis, run.time, run.v, run.omega, parameters)

    return rates
