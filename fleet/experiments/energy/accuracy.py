"""How far a prediction is from what was drained: bias, RMSE, R², and the ratio of the sums."""

from __future__ import annotations

from math import inf, nan, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fleet.study.statistics import CONFIDENCE, Interval

RESAMPLES = 2000


class Accuracy(NamedTuple):
    """A prediction [J] against what was drained, over so many trips."""

    trips: int
    drained: float  # mean [J]
    bias: float  # mean of predicted - drained [J]; negative: too little is predicted
    rmse: float  # [J]
    r2: float  # 1 - squared errors over squared deviations from the mean; may be negative
    ratio: float  # sum of drained over sum of predicted


def accuracy(drained: ArrayLike, predicted: ArrayLike) -> Accuracy:
    """Compare a prediction with what was drained, trip by trip [J]."""
    truth, said = np.asarray(drained, float), np.asarray(predicted, float)
    if len(truth) == 0:
        return Accuracy(0, nan, nan, nan, nan, nan)
    errors = said - truth
    squares = float(((truth - truth.mean()) ** 2).sum())
    return Accuracy(
        trips=len(truth),
        drained=float(truth.mean()),
        bias=float(errors.mean()),
        rmse=float(np.sqrt((errors**2).mean())),
        r2=1.0 - float((errors**2).sum()) / squares if squares > 0.0 else nan,
        ratio=float(truth.sum() / said.sum()) if said.sum() > 0.0 else inf,
    )


def ratio_interval(
    drained: ArrayLike, predicted: ArrayLike, groups: ArrayLike, seed: int = 0
) -> Interval:
    """The ratio of the sums, with an expanded percentile bootstrap interval over groups.

    Trips of one placement are alike, so placements are drawn again, not trips: Davison and
    Hinkley, Bootstrap Methods and their Application, 1997, section 3.8.
    """
    truth, said = np.asarray(drained, float), np.asarray(predicted, float)
    _, which = np.unique(np.asarray(groups), return_inverse=True)
    above, below = np.bincount(which, truth), np.bincount(which, said)
    ratio = float(truth.sum() / said.sum()) if said.sum() > 0.0 else nan
    if len(above) < 2:
        return Interval(ratio, nan, nan)
    weights = resampled(len(above), seed)
    found = (weights @ above) / np.maximum(weights @ below, 1e-300)
    low, high = np.quantile(found, expanded(len(above)))
    return Interval(ratio, float(low), float(high))


def resampled(groups: int, seed: int) -> NDArray[np.float64]:
    """How often each group is drawn in each resample (:data:`RESAMPLES`, groups)."""
    rng = np.random.default_rng(seed)
    return rng.multinomial(groups, np.full(groups, 1.0 / groups), RESAMPLES).astype(float)


def expanded(groups: int) -> tuple[float, float]:
    """The quantiles of resamples over so few ``groups`` that bound an interval of confidence.

    Those of the percentile interval are too near for few groups; these are as far out as those
    of a t interval: Hesterberg, The American Statistician 69(4):371, 2015, section 5.3.
    """
    from scipy.special import ndtr, stdtrit

    t = float(stdtrit(groups - 1, 0.5 - 0.5 * CONFIDENCE))
    tail = float(ndtr(t * sqrt(groups / (groups - 1))))
    return tail, 1.0 - tail


def worst_bin(
    straight: ArrayLike, drained: ArrayLike, predicted: ArrayLike, width: float = 0.5
) -> float:
    """By which share a prediction is off in the worst bin of ``width`` [m] of straight distance.

    The sums over the bins are compared, as a share of what was drained.
    """
    bins = np.floor(np.asarray(straight, float) / width + 1e-9).astype(int)
    above = np.bincount(bins, np.asarray(drained, float))
    below = np.bincount(bins, np.asarray(predicted, float))
    there = above > 0.0
    return float(np.abs(below[there] / above[there] - 1.0).max()) if there.any() else nan


def usable_from(intercept: float, slope: float, rate: float, tolerance: float, to: float) -> float:
    """From which distance [m] on ``rate`` [J/m] is within a relative ``tolerance`` of a line.

    The line, ``intercept`` [J] and ``slope`` [J/m], is what trips drain. A line is asked, not bins
    of trips, so that few trips find what many do. To the centimetre; inf: not even at ``to`` [m].
    """
    distance = np.arange(1, round(100.0 * to) + 1) / 100.0
    drained = intercept + slope * distance
    off = np.abs(rate * distance - drained) > (tolerance + 1e-9) * np.abs(drained)
    if off[-1]:
        return inf
    return float(distance[np.flatnonzero(off)[-1]] + 0.01) if off.any() else 0.0
