"""Laws of what motion costs, linear in terms of it, and how sure their coefficients are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from fleet.logs.sampling import TERMS, Pieces

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Law = tuple[str, ...]
"""The names of a law's terms, of :data:`fleet.logs.sampling.TERMS`."""

RESAMPLES = 999
CONFIDENCE = 0.95
OWN_SHARE = 0.02  # of a term that the others must leave unexplained
PRECISE = 0.02  # of all energy: a term known to this is told apart, however little is its own
ENOUGH_TURNING = 10.0  # [rad]
_TURNING_WINDOWS, _TURNING_TIME, _TURNING_RUNS = 0.05, 0.2, 3
FOLDS = 16  # in which runs are left out at most
_RICHER = 0.98  # of the error: a law with one more term has to be better by this


@dataclass(frozen=True, slots=True)
class MotionLaw:
    """Energy as a sum of terms of motion, each times a coefficient of 0 or more."""

    terms: tuple[str, ...]  # of sampling.TERMS
    coefficients: tuple[float, ...]  # [J/m], [W], [J/rad], [W], [W·s²/m²]

    def predict(self, pieces: Pieces) -> Floats:
        """The energy of each piece (k,) [J]."""
        energies: Floats = pieces.matrix(self.terms) @ np.array(self.coefficients) + pieces.rest
        return energies

    def __getitem__(self, term: str) -> float:
        """A coefficient by its term; 0 if the law leaves it out."""
        return dict(zip(self.terms, self.coefficients, strict=True)).get(term, 0.0)


@dataclass(frozen=True, slots=True)
class Sums:
    """What least squares need of each run: AᵀA and Aᵀy over all terms."""

    runs: tuple[int, ...]
    square: Floats  # (r, p, p)
    product: Floats  # (r, p)

    def law(self, terms: Sequence[str], weights: Floats | None = None) -> MotionLaw:
        """The law with these terms, each run ``weights`` (r,) times in it; by default once."""
        weights = np.ones(len(self.runs)) if weights is None else weights
        return MotionLaw(tuple(terms), tuple(self.laws(terms, weights[None])[0].tolist()))

    def laws(self, terms: Sequence[str], weights: Floats) -> Floats:
        """The coefficients (m, p) of laws with these terms, for ``weights`` (m, r) of the runs."""
        columns = [TERMS.index(name) for name in terms]
        square = self.square[:, columns][:, :, columns]
        return non_negative(np.tensordot(weights, square, 1), weights @ self.product[:, columns])


def sums_of(pieces: Pieces) -> Sums:
    """The sums of each run's pieces."""
    runs = np.unique(pieces.run)
    square = np.empty((len(runs), len(TERMS), len(TERMS)))
    product = np.empty((len(runs), len(TERMS)))
    for number, run in enumerate(runs):
        mine = pieces.run == run
        terms, asked = pieces.terms[mine], pieces.energy[mine] - pieces.rest[mine]
        square[number], product[number] = terms.T @ terms, terms.T @ asked
    return Sums(tuple(runs.tolist()), square, product)


def non_negative(square: Floats, product: Floats) -> Floats:
    """The c ≥ 0 (m, p) that minimise ‖A c − y‖² for each AᵀA (m, p, p) and Aᵀy (m, p).

    Lawson and Hanson, Solving Least Squares Problems, 1974, chapter 23, on the Cholesky factor of
    AᵀA with its columns scaled to one; where least squares alone are not negative, these.
    """
    from scipy.optimize import nnls

    scale = np.sqrt(np.einsum("mii->mi", square))
    scale = np.where(scale > 0.0, scale, 1.0)
    scaled = square / (scale[:, :, None] * scale[:, None, :]) + 1e-12 * np.eye(scale.shape[1])
    asked = product / scale
    found: Floats = np.linalg.solve(scaled, asked[:, :, None])[:, :, 0]
    for row in np.flatnonzero((found < 0.0).any(axis=1)):
        factor = np.linalg.cholesky(scaled[row])
        found[row] = nnls(factor.T, np.linalg.solve(factor, asked[row]))[0]
    return found / scale


def identified(
    windows: Pieces, motion: Pieces, *, turns: bool
) -> tuple[tuple[str, ...], dict[str, str]]:
    """The terms that these windows can tell apart, and why not the others.

    ``motion`` are the same windows with plain terms, which say how much the robot turned.

    A term is told apart if at least 2 % of it is not explained by the others, or if its share of
    the energy is known to 2 % all the same.
    """
    found, why = ["distance"], {}
    speeds = motion.term("distance") / motion.term("time")
    low, high = (
        np.quantile(speeds[speeds > 0.05], [0.05, 0.95]) if (speeds > 0.05).any() else (0, 0)
    )
    if _apart(windows, found, "time"):
        found.append("time")
    else:
        middle = float(np.median(speeds))
        why["time"] = (
            f"one speed only, {middle:.2f} m/s: energy per metre and per second cannot be told"
            f" apart"
        )
    if not turns:
        why["angle"] = why["turning"] = "this log shows no heading"
    elif not _turns_enough(motion):
        why["angle"] = why["turning"] = _on_turning(motion)
    elif _apart(windows, found, "angle"):
        found.append("angle")
        if _apart(windows, found, "turning"):
            found.append("turning")
        else:
            why["turning"] = (
                "one turning rate only: energy per radian and per second of turning cannot be told"
                " apart"
            )
    else:
        why["angle"] = why["turning"] = "it turns in all runs alike"
    if "time" in found and _apart(windows, found, "square", spread=high > 1.8 * max(low, 0.05)):
        found.append("square")
    else:
        why["square"] = f"speeds from {low:.2f} to {high:.2f} m/s only"
    return tuple(found), why


def _apart(windows: Pieces, others: Sequence[str], term: str, *, spread: bool = True) -> bool:
    """Whether a term can be told from ``others``."""
    matrix, mine = windows.matrix([*others, term]), windows.term(term)
    free = len(windows) - matrix.shape[1]
    whole = float((mine**2).sum())
    if free < matrix.shape[1] or whole == 0.0:
        return False
    own = _residual(windows.matrix(others), mine)
    if spread and own >= OWN_SHARE * whole:
        return True
    if own <= 1e-12 * whole:
        return False
    error = 3.0 * sqrt(_residual(matrix, windows.energy - windows.rest) / free / own)
    return error * float(mine.sum()) <= PRECISE * abs(float(windows.energy.sum()))


def _residual(matrix: Floats, values: Floats) -> float:
    """The squares that least squares leave."""
    found = np.linalg.lstsq(matrix, values, rcond=None)[0]
    return float(((values - matrix @ found) ** 2).sum())


def _turns_enough(windows: Pieces) -> bool:
    share = windows.term("turning") / windows.term("time")
    runs = np.unique(windows.run[share > _TURNING_TIME])
    return (
        len(runs) >= min(_TURNING_RUNS, len(np.unique(windows.run)))
        and float((share > _TURNING_TIME).mean()) >= _TURNING_WINDOWS
        and float(windows.term("angle").sum()) > ENOUGH_TURNING
    )


def _on_turning(windows: Pieces) -> str:
    angle = float(windows.term("angle").sum())
    share = 100.0 * float(windows.term("turning").sum() / windows.term("time").sum())
    if angle < 1.0:
        return "this log never turns"
    return f"this log hardly turns: {angle:.0f} rad in all, {share:.0f} % of the time"


def nested(terms: Sequence[str]) -> list[Law]:
    """The laws of these terms, each with one more than the one before."""
    return [tuple(terms[: k + 1]) for k in range(len(terms))]


def errors_left_out(windows: Pieces, sums: Sums, laws: Sequence[Law], among: Mask) -> Floats:
    """How far each law is off on runs left out in turn, of the runs ``among`` (r,): sums of [J]."""
    errors = np.zeros(len(laws))
    inside = np.flatnonzero(among)
    for fold in np.array_split(inside, min(len(inside), FOLDS)):
        weights = among.astype(float)
        weights[fold] = 0.0
        out = windows.take(np.isin(windows.run, [sums.runs[k] for k in fold]))
        for number, terms in enumerate(laws):
            predicted = sums.law(terms, weights).predict(out)
            errors[number] += float(np.abs(predicted - out.energy).sum())
    return errors


def simplest(errors: Sequence[float]) -> int:
    """The law with the least error; a later, richer one has to be better by 2 %."""
    best = 0
    for number, error in enumerate(errors):
        if error < _RICHER * errors[best]:
            best = number
    return best


def unsure(terms: Sequence[str], why: Mapping[str, str]) -> tuple[str, ...]:
    """Terms that are not fitted because the log cannot tell them from others, and yet may be."""
    apart = {"square": "time" in terms, "turning": "angle" in terms}
    return tuple(term for term, may_be in apart.items() if term in why and may_be)


def intervals(
    sums: Sums, terms: Sequence[str], perhaps: Sequence[str] = (), seed: int = 0
) -> Mapping[str, tuple[float, float]]:
    """95 % intervals of a law's coefficients, by drawing whole runs again.

    Percentiles of :data:`RESAMPLES` laws, spread about the estimate as the t distribution is wider
    than the normal one for so many runs. They have room for what the coefficients would be with the
    terms ``perhaps``, which a log does not tell from these.
    """
    rng = np.random.default_rng(seed)
    count = len(sums.runs)
    centre = np.array(sums.law(terms).coefficients)
    if count < 2:
        return {term: (0.0, float("inf")) for term in terms}
    weights = rng.multinomial(count, np.full(count, 1.0 / count), RESAMPLES).astype(float)
    low, high = np.full(len(terms), np.inf), np.full(len(terms), -np.inf)
    for law in dict.fromkeys(((*terms,), (*terms, *perhaps))):
        drawn = sums.laws(law, weights)[:, : len(terms)]
        ends = np.quantile(drawn, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0)
        low, high = np.minimum(low, ends[0]), np.maximum(high, ends[1])
    wider = widening(count)
    low = np.maximum(0.0, centre - wider * np.maximum(0.0, centre - low))
    high = centre + wider * np.maximum(0.0, high - centre)
    return {term: (float(a), float(b)) for term, a, b in zip(terms, low, high, strict=True)}


def widening(count: int) -> float:
    """How much wider a bootstrap over ``count`` runs has to be, so few are they."""
    from scipy.special import ndtri, stdtrit

    if count < 2:
        return float("inf")
    half = 0.5 + 0.5 * CONFIDENCE
    return float(stdtrit(count - 1, half) / ndtri(half)) * sqrt(count / (count - 1))
