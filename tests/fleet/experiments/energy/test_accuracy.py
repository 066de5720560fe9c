"""Bias, RMSE, R² and ratios against what is worked out by hand."""

from __future__ import annotations

from math import inf, isnan, sqrt

import numpy as np
import pytest

from fleet.experiments.energy.accuracy import (
    accuracy,
    ratio_interval,
    resampled,
    usable_from,
    worst_bin,
)


def test_accuracy_is_what_it_is_by_hand():
    found = accuracy([1.0, 2.0, 3.0, 6.0], [0.0, 2.0, 3.0, 3.0])
    assert found.trips == 4
    assert found.drained == 3.0
    assert found.bias == -1.0
    assert found.rmse == pytest.approx(sqrt(10.0 / 4.0))
    assert found.r2 == pytest.approx(1.0 - 10.0 / 14.0)
    assert found.ratio == 1.5


def test_a_perfect_prediction_and_the_mean():
    drained = np.array([1.0, 2.0, 4.0])
    assert accuracy(drained, drained)[2:] == (0.0, 0.0, 1.0, 1.0)
    assert accuracy(drained, np.full(3, drained.mean())).r2 == pytest.approx(0.0)


def test_of_nothing_nothing_is_said():
    assert accuracy([], []).trips == 0
    assert isnan(accuracy([], []).rmse)
    assert isnan(accuracy([2.0, 2.0], [1.0, 1.0]).r2)


def test_each_resample_draws_as_many_groups_as_there_are():
    weights = resampled(7, 1)
    assert (weights.sum(axis=1) == 7).all()
    assert weights.mean() == pytest.approx(1.0)
    assert np.array_equal(weights, resampled(7, 1))


def test_the_ratio_s_interval_covers_the_truth_as_often_as_it_says():
    rng = np.random.default_rng(5)
    hits = 0
    for number in range(200):
        shift = np.repeat(rng.normal(0.0, 0.2, 20), 10)  # trips of a placement are alike
        said = rng.uniform(1.0, 2.0, 200)
        found = ratio_interval(said * (1.3 + shift), said, np.arange(200) // 10, seed=number)
        hits += found.low <= 1.3 <= found.high
    assert 0.87 <= hits / 200 <= 0.99


def test_one_placement_has_a_ratio_without_bounds():
    found = ratio_interval([2.0, 4.0], [1.0, 2.0], [3, 3])
    assert found.value == 2.0
    assert isnan(found.low)


def test_usable_from_where_a_launch_no_longer_shows():
    assert usable_from(5.0, 20.0, 20.0, 0.1, to=7.0) == pytest.approx(2.25, abs=0.011)
    assert usable_from(5.0, 20.0, 20.0, 0.1, to=2.0) == inf
    assert usable_from(0.0, 20.0, 20.0, 0.1, to=7.0) == 0.0
    assert usable_from(0.0, 24.0, 20.0, 0.1, to=7.0) == inf
    assert usable_from(0.0, 16.0, 20.0, 0.1, to=7.0) == inf


def test_the_worst_bin_is_that_whose_sum_is_off_most():
    straight, drained = [0.1, 0.4, 0.6, 1.2], [1.0, 1.0, 10.0, 10.0]
    assert worst_bin(straight, drained, [0.5, 1.5, 10.0, 10.0]) == 0.0
    assert worst_bin(straight, drained, [1.0, 1.0, 8.0, 11.0]) == pytest.approx(0.2)
    assert worst_bin(straight, drained, [1.0, 1.0, 10.0, 13.0]) == pytest.approx(0.3)


@pytest.mark.parametrize("groups", [5, 8, 20])
def test_intervals_over_few_groups_cover_what_they_promise(groups):
    """Trips of a group share an effect; the percentile interval would cover 0.8 to 0.92."""
    rng = np.random.default_rng(groups)
    which = np.repeat(np.arange(groups), 10)
    covered = 0
    for _ in range(400):
        said = rng.uniform(1.0, 9.0, len(which))
        drained = said * (1.3 + rng.normal(0.0, 0.1, groups)[which]) + rng.normal(
            0.0, 0.1, len(which)
        )
        found = ratio_interval(drained, said, which)
        covered += found.low <= 1.3 <= found.high
    assert 0.905 <= covered / 400 <= 0.98
