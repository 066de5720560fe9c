"""What can be said about a few runs: means, shares, paired differences and lifetimes.

Every interval is one of confidence, 95 % unless said otherwise. Arrays are of one value a run.
"""

from __future__ import annotations

import warnings
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
    chance: float = nan  # p of as large a mean difference by chance, of Student's paired test
    deviation: float = nan  # standard deviation of the differences


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


def mean_interval(
    values: ArrayLike,
    possible: tuple[float, float] = (-inf, inf),
    confidence: float = CONFIDENCE,
) -> Interval:
    """The mean and its t interval: exact for normal values, good for means of many others.

    The part of it that is ``possible`` is as likely to hold the mean as all of it. Of shares
    that are 0 or 1 each it is Wilson's.
    """
    from scipy.special import stdtrit

    sample = np.asarray(values, float)
    if possible == (0.0, 1.0) and {*sample.tolist()} == {0.0, 1.0}:
        return wilson_interval(int(sample.sum()), len(sample), confidence)
    if len(sample) == 0:
        return Interval(nan, nan, nan)
    mean = float(sample.mean())
    if len(sample) == 1:
        return Interval(mean, nan, nan)
    error = float(sample.std(ddof=1)) / sqrt(len(sample))
    half = float(stdtrit(len(sample) - 1, 0.5 + 0.5 * confidence)) * error
    low, high = possible
    return Interval(mean, max(mean - half, min(low, mean)), min(mean + half, max(high, mean)))


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
    effect = cohens_d(differences)
    pairs = len(differences)
    deviation = float(differences.std(ddof=1)) if pairs > 1 else nan
    return Difference(mean, low, high, effect, pairs, _chance(effect, pairs), deviation)


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


def holm(chances: ArrayLike) -> NDArray[np.float64]:
    """Chances (p values) of several tests, raised so that 5 % is the risk of them all together.

    Holm, Scand. J. Stat. 6(2):65, 1979. NaN: there is no such test, and it counts for nothing.
    """
    raw = np.asarray(chances, float)
    found = np.full(len(raw), nan)
    there = np.flatnonzero(np.isfinite(raw))
    order = there[np.argsort(raw[there], kind="stable")]
    raised = raw[order] * np.arange(len(order), 0, -1)
    found[order] = np.minimum(np.maximum.accumulate(raised), 1.0)
    return found


def pairs_needed(deviation: float, least: float, power: float = 0.8) -> float:
    """How many pairs show a mean difference of ``least``, with that chance, at 95 % confidence.

    ``deviation`` is the standard deviation of the differences. By the normal approximation, Cohen
    (1988), section 2.4, and two more pairs for the t distribution; inf: no number does.
    """
    from scipy.special import ndtri

    if not least > 0.0:
        return inf
    quantiles = float(ndtri(0.5 + 0.5 * CONFIDENCE) + ndtri(power))
    return float(np.ceil((quantiles * deviation / least) ** 2) + 2.0)


def survival(
    lifetimes: ArrayLike, ended: ArrayLike | None = None, confidence: float = CONFIDENCE
) -> Survival:
    """The share of runs that outlive each time, of Kaplan and Meier.

    J. Am. Stat. Assoc. 53(282):457, 1958; the interval is Greenwood's on the scale of
    log(-log). Where ``ended`` is false the run was still going when it was last seen.
    """
    from scipy.stats import CensoredData, ecdf

    times = np.asarray(lifetimes, float)
    over = np.ones(len(times), bool) if ended is None else np.asarray(ended, bool)
    if not over.any():
        return Survival(*(np.empty(0) for _ in range(4)))
    found = ecdf(CensoredData(uncensored=times[over], right=times[~over])).sf
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)  # where the share is 0, told next
        bounds = found.confidence_interval(confidence, method="log-log")
    steps = np.isin(found.quantiles, times[over])
    share, low, high = (curve.probabilities[steps] for curve in (found, bounds.low, bounds.high))
    inside = (share > 0.0) & (share < 1.0)
    return Survival(
        found.quantiles[steps], share, np.where(inside, low, share), np.where(inside, high, share)
    )


def restricted(lifetimes: ArrayLike, ended: ArrayLike, horizon: float) -> NDArray[np.float64]:
    """A value a run (n,) whose mean is the mean lifetime up to ``horizon``, the cut-off ones too.

    Pseudo-observations of the area under Kaplan and Meier's curve: Andersen, Hansen and Klein,
    Lifetime Data Anal. 10:335, 2004. Where nothing was cut off before the horizon they are the
    lifetimes, those beyond it as long as it.
    """
    times, over = np.asarray(lifetimes, float), np.asarray(ended, bool)
    if not np.any(~over & (times < horizon)):
        return np.asarray(np.minimum(times, horizon))
    count = len(times)
    whole = _area(times, over, horizon)
    without = np.array(
        [_area(np.delete(times, i), np.delete(over, i), horizon) for i in range(count)]
    )
    values: NDArray[np.float64] = count * whole - (count - 1) * without
    return values


def _area(times: NDArray[np.float64], over: NDArray[np.bool_], horizon: float) -> float:
    """The area under Kaplan and Meier's curve, from 0 to the horizon."""
    steps, deaths = np.unique(times[over], return_counts=True)
    at_risk = len(times) - np.searchsorted(np.sort(times), steps, side="left")
    share = np.concatenate([[1.0], np.cumprod(1.0 - deaths / at_risk)])
    edges = np.minimum(np.concatenate([[0.0], steps, [horizon]]), horizon)
    return float((share * np.maximum(np.diff(edges), 0.0)).sum())


def _chance(effect: float, pairs: int) -> float:
    """The p of Student's paired test, two-sided."""
    from scipy.special import stdtr

    if pairs < 2:
        return nan
    return 1.0 if effect == 0.0 else float(2.0 * stdtr(pairs - 1, -abs(effect) * sqrt(pairs)))


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
