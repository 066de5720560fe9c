"""Models find the coefficients that trips were made with."""

from __future__ import annotations

import numpy as np
import pytest

from fleet.experiments.energy.models import (
    CORRECTED,
    EQ1,
    LINE,
    MODELS,
    PLANNED,
    STRAIGHT_LAUNCH,
    TURNED,
    fit,
    halves,
    held_out,
)


def test_a_launch_is_found(make_trips):
    (launch,) = fit(CORRECTED, make_trips(launch=5.0, detour=1.2)).coefficients
    assert launch == pytest.approx((5.0, 5.0, 5.0))


def test_a_line_is_found(make_trips):
    intercept, slope = fit(LINE, make_trips(launch=4.0)).coefficients
    assert intercept.value == pytest.approx(4.0)
    assert slope.value == pytest.approx(19.3558)


def test_turns_are_told_from_launches(make_trips):
    launch, turn = fit(TURNED, make_trips(launch=2.0, turn=3.0, detour=1.1)).coefficients
    assert (launch.value, turn.value) == pytest.approx((2.0, 3.0))


def test_intervals_cover_the_truth_as_often_as_they_say(make_trips):
    hits = 0
    for seed in range(100):
        trips = make_trips(300, launch=5.0, noise=2.0, placements=30, seed=seed)
        (launch,) = fit(CORRECTED, trips, seed).coefficients
        hits += launch.low <= 5.0 <= launch.high
    assert 85 <= hits <= 100


def test_without_terms_nothing_is_fitted(make_trips):
    trips = make_trips(launch=5.0, detour=1.3)
    for model in (EQ1, PLANNED):
        assert fit(model, trips).coefficients == ()
    assert fit(EQ1, trips).predict(trips) == pytest.approx(19.3558 * trips["straight"])
    assert fit(PLANNED, trips).predict(trips) == pytest.approx(19.3558 * trips["planned"])


def test_no_placement_is_in_both_halves(make_trips):
    mine, others = halves(make_trips(placements=7))
    assert not set(mine["placement"]) & set(others["placement"])
    assert len(mine) + len(others) == 2000


def test_held_out_ranks_models_by_what_they_know(make_trips):
    trips = make_trips(launch=3.0, turn=3.0, detour=1.1, noise=0.3)
    errors = {model.name: held_out(model, trips)[1].rmse for model in MODELS}
    assert errors[TURNED.name] == pytest.approx(0.3, rel=0.1)
    assert errors[TURNED.name] < errors[CORRECTED.name] < errors[PLANNED.name]
    assert errors[CORRECTED.name] < errors[STRAIGHT_LAUNCH.name] < errors[EQ1.name]
    assert held_out(TURNED, trips)[1].r2 > 0.9999


def test_where_eq1_is_true_it_cannot_be_bettered(make_trips):
    trips = make_trips()
    assert held_out(EQ1, trips)[1].rmse == 0.0
    (launch,) = fit(CORRECTED, trips).coefficients
    assert launch.value == pytest.approx(0.0, abs=1e-9)
    assert np.allclose(fit(LINE, trips).predict(trips), trips["drained"])
