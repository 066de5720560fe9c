"""Is energy linear in distance for this robot on this ground? By runs that were not fitted to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor, sqrt
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fleet.logs.bases import LawFamily, by_forces, by_motion, rates_at
from fleet.logs.fitting import (
    CONFIDENCE,
    FOLDS,
    RESAMPLES,
    Law,
    Mask,
    MotionLaw,
    errors_left_out,
    intervals,
    simplest,
    unsure,
    widening,
)  # fmt: skip
from fleet.logs.forces import Chassis, chassis_of
from fleet.logs.grounds import LogGround
from fleet.logs.matching import reading_of
from fleet.logs.sampling import FEWEST, TERMS, Pieces
from fleet.scenario.errors import bad
from fleet.study.statistics import Interval, wilson_interval

Floats = NDArray[np.float64]
Answer = Literal["holds", "fails", "cannot tell"]
Outcome = Literal["accurate", "a law is", "no law is", "cannot tell"]

LINEAR: Law = ("distance",)  # fitted to trips, which is its best chance; all others to windows
NEEDED = 0.9  # share of trips within the band, for the linear law to hold
_FAR = 0.1  # of the total, within which it holds for totals
_MOST_TRIPS = 10_000


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Energies of trips, and what laws say that were fitted without their runs."""

    run: NDArray[np.intp]  # (k,)
    energy: Floats  # (k,) [J]
    predicted: Floats  # (k,) [J]

    @property
    def errors(self) -> Floats:
        """Relative errors of the trips (k,)."""
        errors: Floats = self.predicted / self.energy - 1.0
        return errors

    @property
    def total(self) -> float:
        """The relative error of the sum over all trips."""
        return float(self.predicted.sum() / self.energy.sum()) - 1.0

    @property
    def median(self) -> float:
        """Half of the trips are off by less."""
        return float(np.median(np.abs(self.errors)))

    def within(self, band: float) -> float:
        """The share of trips that are off by no more than ``band``."""
        return float((np.abs(self.errors) <= band).mean())


@dataclass(frozen=True, slots=True)
class LawJudged:
    """One law of the nested ones: how far it is off on runs left out."""

    family: str
    terms: Law
    law: MotionLaw  # of all runs
    left_out: LeftOut


@dataclass(frozen=True, slots=True)
class Judgement:
    """What the logs of one ground say."""

    ground: LogGround
    motion: LawFamily
    forces: LawFamily
    chassis: Chassis
    nested: Sequence[LawJudged]  # by motion, distance first; then by forces
    best: LawJudged  # of motion, as the logs choose; for runs left out, as the others choose
    intervals: dict[str, Interval]  # of the best law's coefficients
    preset: LawJudged  # by forces: what a simulated robot is made of
    preset_intervals: dict[str, Interval]
    linear: LeftOut
    share: Interval  # of trips that the linear law has within the band
    total: Interval  # relative error of all trips together
    better: Interval  # by how much the best law is nearer, mean absolute error
    by_trip: Answer
    by_total: Answer
    outcome: Outcome
    reading: str  # how slow power was matched with motion
    band: float

    @property
    def trips(self) -> Pieces:
        """The trips that were asked about."""
        return self.motion.trips


def judge(ground: LogGround) -> Judgement:
    """Judge the runs of one ground.

    Raises:
        BadInput: they never drive as far as a trip, or take no energy.
    """
    motion, forces, chassis, reading = _families(ground)
    linear = _linear(motion.trips)
    nested = [
        LawJudged(
            family.name, terms, family.law(terms),
            linear if terms == LINEAR else _left_out(family, terms),
        )
        for family in (motion, forces)
        for terms in family.laws
    ]  # fmt: skip
    best = _best(motion, nested)
    band = 0.01 * ground.settings.within
    share = _share(linear, band)
    total = _by_run(
        linear.run, lambda k: float(linear.predicted[k].sum() / linear.energy[k].sum()) - 1
    )
    gain = np.abs(linear.errors) - np.abs(best.left_out.errors)
    better = _by_run(linear.run, lambda k: float(gain[k].mean()))
    enough = len(np.unique(linear.run)) >= FEWEST
    by_trip = _answer(share.low >= NEEDED, share.high < NEEDED) if enough else "cannot tell"
    if by_trip == "holds" and motion.samples.files < FEWEST:
        by_trip = "cannot tell"
    by_total = (
        _answer(max(-total.low, total.high) <= _FAR, total.low > _FAR or total.high < -_FAR)
        if enough
        else "cannot tell"
    )
    return Judgement(
        ground, motion, forces, chassis, nested, best,
        _with_offset(motion, ground, intervals(motion.sums, best.terms), best.law),
        nested[-1],
        _with_offset(motion, ground, intervals(
            forces.sums, forces.richest, unsure(forces.richest, forces.why)
        ), nested[-1].law),
        linear, share, total, better, by_trip, by_total, _outcome(by_trip, better), reading, band,
    )  # fmt: skip


def _families(ground: LogGround) -> tuple[LawFamily, LawFamily, Chassis, str]:
    """Both families of laws, the chassis, and how slow power was matched with motion.

    Where power is slow it is matched twice: inertia takes power before the robot goes fast, which
    only the law by forces knows.
    """
    lag, over, reading = reading_of(ground)
    motion = by_motion(ground, lag, over)
    _check(ground, motion)
    forces, chassis = by_forces(ground, chassis_of(ground.settings), motion)
    if reading:
        law = forces.law(forces.richest)
        rates = rates_at(chassis, np.array([law[term] for term in TERMS]))
        lag, over, reading = reading_of(ground, rates)
        motion = by_motion(ground, lag, over)
        forces, chassis = by_forces(ground, chassis, motion)
    return motion, forces, chassis, reading


def _check(ground: LogGround, motion: LawFamily) -> None:
    driven = float(motion.windows.term("distance").sum()) if len(motion.windows) else 0.0
    if not len(motion.trips):
        raise bad(
            "--log", f"{ground.name}: it drives {driven:.2g} m and never as far as a metre between"
            " two stands; expected trips of a metre or more",
        )  # fmt: skip
    if float(motion.trips.energy.sum()) <= 0.0:
        raise bad(
            "--log", f"{ground.name}: driving takes no energy (mean power"
            f" {float(motion.trips.energy.sum() / motion.trips.term('time').sum()):.3g} W); is the"
            " sign of the current right? --log-column 'current=COLUMN*-1'",
        )  # fmt: skip


def _outcome(by_trip: Answer, better: Interval) -> Outcome:
    if by_trip == "holds":
        return "accurate"
    if by_trip == "cannot tell":
        return "cannot tell"
    return "a law is" if better.low > 0.0 else "no law is"


def _answer(holds: bool, fails: bool) -> Answer:
    return "holds" if holds else "fails" if fails else "cannot tell"


def _linear(trips: Pieces) -> LeftOut:
    """Energy as one number times distance: its best number for the trips of the other runs."""
    distance, energy = trips.term("distance"), trips.energy
    product, square = distance * energy, distance**2
    runs, index = np.unique(trips.run, return_inverse=True)
    if len(runs) < 2:
        slope = product.sum() / square.sum()
        return LeftOut(trips.run, energy, slope * distance)
    top = product.sum() - np.bincount(index, product)
    bottom = square.sum() - np.bincount(index, square)
    return LeftOut(trips.run, energy, (top / bottom)[index] * distance)


def _left_out(family: LawFamily, terms: Law) -> LeftOut:
    predicted = np.empty(len(family.trips))
    for among in folds(family):
        mine = _asked(family, among)
        predicted[mine] = family.law(terms, among).predict(family.trips.take(mine))
    return LeftOut(family.trips.run, family.trips.energy, predicted)


def folds(family: LawFamily) -> Iterator[Mask]:
    """The runs (r,) that are left in, each run left out once: alone, or with few of very many."""
    count = len(family.sums.runs)
    for out in np.array_split(np.arange(count), min(count, FOLDS)):
        among = np.ones(count, bool)
        among[out] = count == 1
        yield among


def _asked(family: LawFamily, among: Mask) -> Mask:
    """The trips (k,) of the runs that are left out; all, if there is only one run."""
    out = ~among if not among.all() else among
    return np.isin(family.trips.run, np.array(family.sums.runs)[out])


def _best(motion: LawFamily, nested: Sequence[LawJudged]) -> LawJudged:
    """The law of motion that runs choose; for those that are left out, without them."""
    predicted = np.empty(len(motion.trips))
    for among in folds(motion):
        terms = motion.laws[_chosen(motion, among)]
        mine = _asked(motion, among)
        predicted[mine] = motion.law(terms, among).predict(motion.trips.take(mine))
    chosen = nested[_chosen(motion, np.ones(len(motion.sums.runs), bool))]
    left_out = LeftOut(motion.trips.run, motion.trips.energy, predicted)
    return replace(chosen, left_out=left_out)


def _chosen(motion: LawFamily, among: Mask) -> int:
    """Which of the nested laws runs ``among`` (r,) choose."""
    return simplest(errors_left_out(motion.windows, motion.sums, motion.laws, among).tolist())


def _share(left_out: LeftOut, band: float) -> Interval:
    """The share of trips within the band; the wider of two intervals.

    By drawing runs again, and Wilson's on the number of trips over their design effect: with few
    runs that all agree, the first alone is too sure.
    """
    good = np.abs(left_out.errors) <= band
    count, runs = len(good), np.unique(left_out.run)
    share = float(good.mean())
    means = np.array([good[left_out.run == run].mean() for run in runs])
    chance = share * (1.0 - share) / count
    effect = 1.0
    if chance > 0.0 and len(runs) > 1:
        effect = min(count / len(runs), max(1.0, float(means.var(ddof=1)) / len(runs) / chance))
    wilson = _wilson(share, count / effect)
    drawn = _by_run(left_out.run, lambda k: float(good[k].mean()))
    return Interval(
        share, max(0.0, min(drawn.low, wilson.low)), min(1.0, max(drawn.high, wilson.high))
    )


def _wilson(share: float, count: float) -> Interval:
    """Wilson's interval of a share of so many trips, which need be no whole number."""
    from scipy.special import ndtri

    z = float(ndtri(0.5 + 0.5 * CONFIDENCE))
    scale = 1.0 + z * z / count
    centre = (share + 0.5 * z * z / count) / scale
    half = z / scale * sqrt(share * (1.0 - share) / count + 0.25 * z * z / count**2)
    return Interval(share, centre - half, centre + half)


def trips_needed(
    share: float, answer: Literal["holds", "fails"], need: float = NEEDED
) -> int | None:
    """How many independent trips would settle it, at such a share within the band; None: never."""
    for count in range(1, _MOST_TRIPS):
        good = ceil(share * count) if answer == "fails" else floor(share * count)
        found = wilson_interval(good, count)
        if (answer == "holds" and found.low >= need) or (answer == "fails" and found.high < need):
            return count
    return None


def _by_run(
    run: NDArray[np.intp], of: Callable[[NDArray[np.intp]], float], seed: int = 0
) -> Interval:
    """A figure of trips with its interval, by drawing whole runs again."""
    value = of(np.arange(len(run)))
    runs, index = np.unique(run, return_inverse=True)
    if len(runs) < 2:
        return Interval(value, -np.inf, np.inf)
    rows = [np.flatnonzero(index == k) for k in range(len(runs))]
    rng = np.random.default_rng(seed)
    drawn = np.array([
        of(np.concatenate([rows[k] for k in rng.integers(len(runs), size=len(runs))]))
        for _ in range(RESAMPLES)
    ])  # fmt: skip
    low, high = np.quantile(drawn, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE])
    wider = widening(len(runs))
    return Interval(
        value, value - wider * max(0.0, value - low), value + wider * max(0.0, high - value)
    )


def _with_offset(
    motion: LawFamily, ground: LogGround,
    found: Mapping[str, tuple[float, float]], law: MotionLaw,
) -> dict[str, Interval]:  # fmt: skip
    """Coefficients with their intervals; that of the constant has room for an offset.

    What a battery's current reads at standstill may be what standing costs, or its sensor's offset;
    nothing in a log tells them apart.
    """
    known = {term: Interval(law[term], *found[term]) for term in law.terms}
    standing = motion.samples.standing
    if ground.drive_only or ground.settings.offset is not None or not np.isfinite(standing):
        return known
    if "time" in known:
        term, per = "time", standing
    else:
        cut = motion.windows
        term = "distance"
        per = standing * float(cut.term("time").sum() / cut.term("distance").sum())
    value, low, high = known[term]
    known[term] = Interval(value, max(0.0, low - max(0.0, per)), high + max(0.0, -per))
    return known
