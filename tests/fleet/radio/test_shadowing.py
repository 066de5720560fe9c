"""Shadowing by place: its spread, its correlation over distance, the same both ways."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from fleet.radio.shadowing import shadow, shadows

FIELDS = [shadows(4.0, 3.0, np.random.default_rng(seed)) for seed in range(1500)]


def ensemble(ax, ay, bx, by):
    return np.array([shadow(field, ax, ay, bx, by) for field in FIELDS])


@pytest.mark.parametrize("length", [0.5, 2.0, 9.0])
def test_its_spread_is_the_one_asked_for_whatever_the_length_of_the_link(length):
    values = ensemble(1.0, 2.0, 1.0 + length, 2.0)
    kept = norm.expect(lambda x: np.clip(x, -2.0, 2.0) ** 2) ** 0.5  # of it, cut off at two
    assert values.std() == pytest.approx(4.0 * kept, rel=0.06)
    assert abs(values.mean()) < 0.4
    assert np.abs(values).max() <= 8.0


def test_it_is_the_same_both_ways_and_only_depends_on_the_places():
    field = FIELDS[0]
    assert shadow(field, 1.0, 2.0, 4.0, 7.0) == pytest.approx(shadow(field, 4.0, 7.0, 1.0, 2.0))
    assert shadow(field, 1.0, 2.0, 4.0, 7.0) != shadow(FIELDS[1], 1.0, 2.0, 4.0, 7.0)


@pytest.mark.parametrize("moved", [0.5, 1.5, 3.0, 6.0])
def test_correlation_falls_off_as_gudmundson_has_it(moved):
    """One end of a long link moves; four standard errors of a correlation."""
    here, there = ensemble(0.0, 0.0, 30.0, 0.0), ensemble(0.0, moved, 30.0, 0.0)
    expected = np.exp(-moved / 3.0)
    error = 4 * (1 - expected**2) / np.sqrt(len(FIELDS))
    assert np.corrcoef(here, there)[0, 1] == pytest.approx(expected, abs=error + 0.02)


def test_without_deviation_there_is_none():
    assert shadow(shadows(0.0, 3.0, np.random.default_rng(1)), 0.0, 0.0, 1.0, 0.0) == 0.0
