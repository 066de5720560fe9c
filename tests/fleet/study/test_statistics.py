"""Statistics against published examples, and against what they promise."""

from __future__ import annotations

from math import inf, isnan, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet.study.statistics import (
    cohens_d,
    mean_interval,
    paired_difference,
    pooled_sd,
    survival,
    wilson_interval,
)


def test_t_interval_of_a_sample_worked_by_hand():
    # mean 5, s = sqrt(20/3), t(0.975, 3) = 3.182446
    found = mean_interval([2.0, 4.0, 6.0, 8.0])
    half = 3.182446305284263 * sqrt(20.0 / 3.0) / 2.0
    assert found == pytest.approx((5.0, 5.0 - half, 5.0 + half))


def test_one_value_has_a_mean_and_no_interval():
    found = mean_interval([3.0])
    assert found.value == 3.0
    assert isnan(found.low)
    assert isnan(mean_interval([]).value)


def test_wilson_interval_of_newcombe_s_examples():
    # Newcombe, Statistics in Medicine 17:857, 1998, table I, method 3
    for successes, trials, low, high in (
        (81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718),
    ):  # fmt: skip
        found = wilson_interval(successes, trials)
        assert (found.low, found.high) == pytest.approx((low, high), abs=5e-5)


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_wilson_interval_holds_the_share_and_stays_within_bounds(counts):
    found = wilson_interval(*counts)
    assert 0.0 <= found.low <= found.value <= found.high <= 1.0


def test_wilson_refuses_more_successes_than_trials():
    with pytest.raises(ValueError, match="5 successes of 3"):
        wilson_interval(5, 3)


def test_bca_interval_of_paired_differences_covers_as_promised():
    rng = np.random.default_rng(4)
    covered = 0
    for seed in range(60):
        base = rng.normal(10.0, 5.0, 40)
        values = base + rng.exponential(1.0, 40)  # a skewed difference of mean 1
        found = paired_difference(values, base, seed=seed)
        covered += found.low <= 1.0 <= found.high
        assert found.low < found.mean < found.high
    assert 51 <= covered <= 60


def test_pairs_see_what_groups_do_not():
    rng = np.random.default_rng(1)
    base = rng.normal(0.0, 100.0, 30)
    found = paired_difference(base + 1.0 + rng.normal(0.0, 0.5, 30), base)
    assert found.low > 0.5
    assert found.effect == pytest.approx(2.0, abs=1.0)


def test_paired_difference_is_decided_by_its_seed():
    a, b = np.random.default_rng(2).normal(size=(2, 25))
    assert paired_difference(a, b, seed=1) == paired_difference(a, b, seed=1)
    assert paired_difference(a, b, seed=1) != paired_difference(a, b, seed=2)


@pytest.mark.filterwarnings("error")
def test_pairs_that_do_not_differ_or_differ_all_alike():
    same = np.array([1.0, 2.0, 3.0])
    assert paired_difference(same, same) == (0.0, 0.0, 0.0, 0.0, 3)
    assert paired_difference(same + 2.0, same) == (2.0, 2.0, 2.0, inf, 3)
    assert paired_difference(same, same + 2.0).effect == -inf
    assert isnan(paired_difference([1.0], [0.0]).low)
    assert paired_difference([], []).pairs == 0


def test_arrays_of_different_lengths_are_no_pairs():
    with pytest.raises(ValueError, match="expected pairs"):
        paired_difference([1.0, 2.0], [1.0])


def test_cohens_d_by_hand():
    assert cohens_d([1.0, 2.0, 3.0]) == pytest.approx(2.0)


def test_pooled_sd_by_hand():
    assert pooled_sd([[1.0, 3.0], [10.0, 10.0, 16.0]]) == pytest.approx(sqrt((2.0 + 24.0) / 3.0))
    assert isnan(pooled_sd([[1.0], []]))


def test_survival_of_freireich_s_patients():
    """Weeks of remission under 6-MP: Freireich et al., Blood 21(6):699, 1963; a textbook case."""
    weeks = [6, 6, 6, 6, 7, 9, 10, 10, 11, 13, 16, 17, 19, 20, 22, 23, 25, 32, 32, 34, 35]
    ended = [1, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0]
    found = survival(weeks, np.array(ended, bool))
    assert found.times.tolist() == [6, 7, 10, 13, 16, 22, 23]
    assert found.share == pytest.approx([0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448], abs=5e-4)
    assert found.median == 23
    assert (found.low[0], found.high[0]) == pytest.approx((0.620, 0.952), abs=1e-3)


@given(st.lists(st.integers(0, 50), min_size=1, max_size=60))
@settings(max_examples=50)
def test_survival_without_censoring_is_the_share_that_outlives(lifetimes):
    found = survival(lifetimes)
    for time, share, low, high in zip(*found, strict=True):
        assert share == pytest.approx(np.mean(np.array(lifetimes) > time))
        assert low <= share + 1e-12
        assert share <= high + 1e-12


def test_runs_that_were_all_still_going_have_no_steps():
    found = survival([5, 5, 5], [False, False, False])
    assert len(found.times) == 0
    assert found.median == inf
