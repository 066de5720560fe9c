"""Statistics against published examples, and against what they promise."""

from __future__ import annotations

from math import exp, inf, isnan, nan, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import stdtr
from scipy.stats import ttest_rel

from fleet.study.statistics import (
    cohens_d,
    holm,
    mean_interval,
    paired_difference,
    pairs_needed,
    restricted,
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
    assert paired_difference(same, same) == (0.0, 0.0, 0.0, 0.0, 3, 1.0, 0.0)
    assert paired_difference(same + 2.0, same) == (2.0, 2.0, 2.0, inf, 3, 0.0, 0.0)
    assert paired_difference(same, same + 2.0).effect == -inf
    assert isnan(paired_difference([1.0], [0.0]).low)
    assert paired_difference([], []).pairs == 0


def test_arrays_of_different_lengths_are_no_pairs():
    with pytest.raises(ValueError, match="expected pairs"):
        paired_difference([1.0, 2.0], [1.0])


def test_cohens_d_by_hand():
    assert cohens_d([1.0, 2.0, 3.0]) == pytest.approx(2.0)


def test_an_interval_holds_nothing_that_cannot_be():
    poor = [10.0, 12.0, 4000.0]
    plain, within = mean_interval(poor), mean_interval(poor, (0.0, inf))
    assert plain.low < 0.0 == within.low
    assert plain.high == within.high
    shares = mean_interval([0.9, 1.0, 0.7], (0.0, 1.0))
    assert shares.high == 1.0 > shares.value > shares.low
    assert mean_interval([1.0, 1.0, 0.0, 1.0], (0.0, 1.0)) == wilson_interval(3, 4)


@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=30))
@settings(max_examples=50, deadline=None)
def test_an_interval_of_shares_is_one_of_shares(values):
    found = mean_interval(values, (0.0, 1.0))
    assert 0.0 <= found.low <= found.value + 1e-12
    assert found.value - 1e-12 <= found.high <= 1.0


def test_holm_by_hand():
    """Three tests: the least is tripled, the next doubled, and none is below one before it."""
    assert holm([0.01, 0.04, 0.03]).tolist() == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.9, nan, 0.5]).tolist() == pytest.approx([1.0, nan, 1.0], nan_ok=True)
    assert len(holm([])) == 0


def test_holm_keeps_the_risk_of_any_false_alarm():
    """Forty comparisons without a difference: 5 % of studies say that there is one, not 87 %."""
    rng = np.random.default_rng(5)
    alarms = raw = 0
    for _ in range(400):
        samples = rng.normal(size=(40, 12))
        effects = samples.mean(axis=1) / samples.std(axis=1, ddof=1)
        chances = 2.0 * stdtr(11, -np.abs(effects) * sqrt(12))
        raw += bool((chances < 0.05).any())
        alarms += bool((holm(chances) < 0.05).any())
    assert raw > 300
    assert alarms < 36  # 20 are expected; 36 is four standard deviations more


def test_the_pairs_that_a_difference_needs_show_it_as_often_as_said():
    """Power by simulation: a difference of 0.5 of 1 SD, four times out of five."""
    count = int(pairs_needed(1.0, 0.5))
    assert 32 <= count <= 35
    rng = np.random.default_rng(6)
    samples = rng.normal(0.5, 1.0, (4000, count))
    t = samples.mean(axis=1) / samples.std(axis=1, ddof=1) * sqrt(count)
    assert np.mean(2.0 * stdtr(count - 1, -np.abs(t)) < 0.05) == pytest.approx(0.8, abs=0.03)
    assert pairs_needed(1.0, 0.0) == inf


def test_the_chance_of_a_difference_is_that_of_the_paired_t_test():
    a, b = [3.1, 4.0, 5.2, 4.4, 6.1], [2.9, 4.1, 4.0, 4.4, 5.0]
    assert paired_difference(a, b).chance == pytest.approx(ttest_rel(a, b).pvalue)


def test_restricted_lifetimes_are_lifetimes_where_none_was_cut_off_before_the_horizon():
    found = restricted([3.0, 9.0, 12.0], [True, True, False], 10.0)
    assert found.tolist() == [3.0, 9.0, 10.0]


def test_the_mean_of_restricted_lifetimes_is_the_area_under_the_curve():
    """By hand: shares 3/4 from 1 to 5, then 3/4 · 1/2 from 5 to 7; the third was lost at 4."""
    found = restricted([1.0, 5.0, 4.0, 9.0], [True, True, False, False], 7.0)
    assert found.mean() == pytest.approx(1.0 + 4.0 * 0.75 + 2.0 * 0.375)


def test_cut_off_lifetimes_are_not_taken_for_short_ones():
    """Exponential lives, half of them cut off: the mean up to 1 is 1 - 1/e."""
    rng = np.random.default_rng(8)
    life, cut = rng.exponential(1.0, 400), rng.exponential(1.2, 400)
    seen = np.minimum(life, cut)
    found = mean_interval(restricted(seen, life <= cut, 1.0))
    assert found.low < 1.0 - exp(-1.0) < found.high
    assert np.minimum(seen, 1.0).mean() < found.low


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


def test_less_confidence_is_a_narrower_interval():
    shares, lives = [0.0, 1.0, 1.0, 0.0, 1.0], [1.0, 2.0, 3.0, 5.0, 8.0]
    wide, narrow = (mean_interval(shares, (0.0, 1.0), confidence) for confidence in (0.95, 0.8))
    assert wide.low < narrow.low < narrow.high < wide.high
    assert narrow == wilson_interval(3, 5, 0.8)
    wide, narrow = survival(lives), survival(lives, confidence=0.8)
    assert (wide.low[:-1] < narrow.low[:-1]).all()
    assert (narrow.high[:-1] < wide.high[:-1]).all()


def test_no_chance_is_above_one_and_no_interval_is_made_up():
    assert holm([0.8, 0.9]).tolist() == [1.0, 1.0]
    assert all(isnan(bound) for bound in mean_interval([]))
    assert all(isnan(bound) for bound in mean_interval([3.0])[1:])


def test_twice_the_scatter_needs_four_times_the_pairs():
    once, twice = pairs_needed(1.0, 0.1), pairs_needed(2.0, 0.1)
    assert once == 787.0  # (1.959964 + 0.841621)² · 100 = 784.9, and two more
    assert twice - 2.0 == pytest.approx(4.0 * (once - 2.0), abs=4.0)


def test_a_lifetime_cut_off_at_the_horizon_is_as_long_as_it():
    assert restricted([3.0, 10.0, 7.0], [True, False, True], 10.0).tolist() == [3.0, 10.0, 7.0]
