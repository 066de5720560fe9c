"""What can be said about a few runs: means, shares, paired differences and lifetimes.

Every interval is one of confidence, 95 % unless said otherwise. Arrays are of one value a run.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, nan, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

CONFIDENCE = 0.95
RESAMPLES = 9999
BATCH = 500  # resamples in memory at a time


class Interval(NamedTuple):
    """An estimate and the interval around it; NaN bounds: there is too little to say."""

    value: float
    low: float
    high: float


class Difference(NamedTuple):
    """How two treatments differ over pairs of runs."""

    mean: float
    low: float
    high: float
    effect: float  # Cohen's d of the pairs
    pairs: int


class Survival(NamedTuple):
    """The share of runs that outlive a time, with its interval; steps at ``times`` (k,)."""

    times: NDArray[np.float64]
    share: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @property
    def median(self) -> float:
        """The first time that half of the runs, or fewer, outlive; inf: more do to the end."""
        over = np.flatnonzero(self.share <= 0.5)
        return float(self.times[over[0]]) if len(over) else inf


def mean_interval(values: ArrayLike, confidence: float = CONFIDENCE) -> Interval:
    """The mean and its t interval: exact for normal values, good for means of many others."""
    from scipy.special import stdtrit

    sample = np.asarray(values, float)
    if len(sample) == 0:
        return Interval(nan, nan, nan)
    mean = float(sample.mean())
    if len(sample) == 1:
        return Interval(mean, nan, nan)
    error = float(sample.std(ddof=1)) / sqrt(len(sample))
    half = float(stdtrit(len(sample) - 1, 0.5 + 0.5 * confidence)) * error
    return Interval(mean, mean - half, mean + half)


def wilson_interval(successes: int, trials: int, confidence: float = CONFIDENCE) -> Interval:
    """A share and its score interval: Wilson, J. Am. Stat. Assoc. 22(158):209, 1927.

    Raises:
        ValueError: there are more successes than trials, or fewer than none.
    """
    from scipy.special import ndtri

    if not 0 <= successes <= trials:
        raise ValueError(f"{successes} successes of {trials}; expected 0 to {trials}")
    if trials == 0:
        return Interval(nan, nan, nan)
    z = float(ndtri(0.5 + 0.5 * confidence))
    share = successes / trials
    scale = 1.0 + z * z / trials
    centre = (share + 0.5 * z * z / trials) / scale
    half = z / scale * sqrt(share * (1.0 - share) / trials + 0.25 * z * z / trials**2)
    low = 0.0 if successes == 0 else centre - half
    high = 1.0 if successes == trials else centre + half
    return Interval(share, low, high)


def paired_difference(
    values: ArrayLike, baseline: ArrayLike, confidence: float = CONFIDENCE, seed: int = 0
) -> Difference:
    """The mean of ``values - baseline`` over pairs, with its BCa bootstrap interval.

    Efron, J. Am. Stat. Assoc. 82(397):171, 1987, with :data:`RESAMPLES` resamples that
    ``seed`` decides. The i-th entries of both arrays are a pair: runs of one seed.

    Raises:
        ValueError: the arrays are not of one length.
    """
    first, second = np.asarray(values, float), np.asarray(baseline, float)
    if first.shape != second.shape:
        raise ValueError(f"{first.shape} values and {second.shape} in the baseline; expected pairs")
    differences = first - second
    if len(differences) == 0:
        return Difference(nan, nan, nan, nan, 0)
    mean = float(differences.mean())
    low, high = _bca(differences, confidence, seed)
    return Difference(mean, low, high, cohens_d(differences), len(differences))


def cohens_d(differences: ArrayLike) -> float:
    """Effect size of paired differences: their mean over their standard deviation, d_z.

    Cohen, Statistical Power Analysis for the Behavioral Sciences, 2nd ed., 1988, section 2.3.5.
    0 if there is no difference at all; infinite if all differences are the same.
    """
    sample = np.asarray(differences, float)
    if len(sample) < 2:
        return nan
    mean, deviation = float(sample.mean()), float(sample.std(ddof=1))
    if deviation <= 1e-12 * abs(mean):  # nothing but rounding
        return inf if mean > 0.0 else -inf if mean < 0.0 else 0.0
    return mean / deviation


def pooled_sd(groups: Iterable[ArrayLike]) -> float:
    """The standard deviation within groups, each about its own mean, weighted by n - 1."""
    squares, freedom = 0.0, 0
    for group in groups:
        sample = np.asarray(group, float)
        squares += float(((sample - sample.mean()) ** 2).sum()) if len(sample) else 0.0
        freedom += max(0, len(sample) - 1)
    return sqrt(squares / freedom) if freedom else nan


def survival(
    lifetimes: ArrayLike, ended: ArrayLike | None = None, confidence: float = CONFIDENCE
) -> Survival:
    """The share of runs that outlive each time, of Kaplan and Meier.

    J. Am. Stat. Assoc. 53(282):457, 1958; the interval is Greenwood's on the scale of
    log(-log). Where ``ended`` is false the run was still going when it was last seen.
    """
    from scipy.special import ndtri

    times = np.asarray(lifetimes, float)
    over = np.ones(len(times), bool) if ended is None else np.asarray(ended, bool)
    steps = np.unique(times[over])
    at_risk = len(times) - np.searchsorted(np.sort(times), steps, side="left")
    deaths = np.array([np.count_nonzero(times[over] == step) for step in steps])
    share = np.cumprod(1.0 - deaths / at_risk, dtype=np.float64)
    z = float(ndtri(0.5 + 0.5 * confidence))
    with np.errstate(divide="ignore", invalid="ignore"):
        greenwood = np.cumsum(deaths / (at_risk * (at_risk - deaths)))
        width = z * np.sqrt(greenwood) / np.abs(np.log(share))
        low, high = share ** np.exp(width), share ** np.exp(-width)
    inside = (share > 0.0) & (share < 1.0)
    return Survival(steps, share, np.where(inside, low, share), np.where(inside, high, share))


def _bca(sample: NDArray[np.float64], confidence: float, seed: int) -> tuple[float, float]:
    if len(sample) < 2:
        return nan, nan
    if np.ptp(sample) <= 1e-12 * np.abs(sample).max():  # the same everywhere, to rounding
        return float(sample.mean()), float(sample.mean())
    from scipy.stats import bootstrap

    found = bootstrap(
        (sample,), np.mean, n_resamples=RESAMPLES, batch=BATCH, vectorized=True,
        confidence_level=confidence, method="BCa", rng=np.random.default_rng(seed),
    ).confidence_interval  # fmt: skip
    return float(found.low), float(found.high)
