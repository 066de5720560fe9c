"""Trips as columns, and whether their parts add up."""

from __future__ import annotations

import numpy as np
import pytest

from fleet.experiments.energy.trip_table import PARTS, TripTable, closure


def test_parts_and_eq1_are_what_was_drained(make_trips):
    trips = make_trips(launch=5.0, detour=1.2, turn=2.0)
    assert trips.parts_sum == pytest.approx(trips["drained"])
    assert trips.part("detour") == pytest.approx(19.3558 * (trips["planned"] - trips["straight"]))
    assert closure(trips) < 1e-12


@pytest.mark.parametrize("name", PARTS[1:])
def test_a_part_that_is_missing_is_noticed(make_trips, name):
    trips = make_trips(launch=5.0, turn=2.0)
    columns = dict(trips.columns)
    columns[f"energy_{name}"] = columns[f"energy_{name}"] + 0.01 * columns["drained"]
    assert closure(TripTable(columns)) == pytest.approx(0.01)


def test_trips_are_chosen_by_value_and_by_distance(make_trips):
    trips = make_trips(100, placements=4)
    assert len(trips.where(placement=1, outcome="arrived")) == 25
    assert len(trips.where(outcome="stuck")) == 0
    buckets = list(trips.by_distance((0.0, 1.0, 3.0, 8.0)))
    assert sum(len(some) for _, _, some in buckets) == 100
    for low, high, some in buckets:
        assert ((some["straight"] >= low) & (some["straight"] < high)).all()
    assert closure(trips.take(np.zeros(100, bool))) == 0.0
