"""Bounds on lifetime, against exhaustive search and against runs."""

from __future__ import annotations

from itertools import product
from math import dist

import numpy as np
import pytest

import fleet
from fleet.study.bounds import bounds, shortest_service


def by_trying_all(starts, sites):
    """The shortest of all ways to choose a robot for each site."""
    best = np.inf
    for chosen in product(range(len(starts)), repeat=len(sites)):
        places, length = [tuple(p) for p in starts], 0.0
        for robot, site in zip(chosen, sites, strict=True):
            length += dist(places[robot], site)
            places[robot] = tuple(site)
        best = min(best, length)
    return best


@pytest.mark.parametrize("seed", range(12))
def test_no_way_to_serve_all_is_shorter(seed):
    rng = np.random.default_rng(seed)
    starts, sites = rng.random((3, 2)), rng.random((seed % 6 + 1, 2))
    assert shortest_service(starts, sites) == pytest.approx(by_trying_all(starts, sites))


def test_nothing_to_serve_costs_nothing():
    assert shortest_service(np.zeros((2, 2)), np.empty((0, 2))) == 0.0


@pytest.mark.parametrize("protocol", ["rfta3", "optimum"])
@pytest.mark.parametrize("world", ["random", "random-hole"])
def test_no_protocol_outlives_foresight(protocol, world):
    scenario = fleet.Scenario.of(
        protocol=protocol, world=world, robots=30, range=4.0, motion="straight", seed=3
    )
    most = bounds(scenario)
    assert 0 < fleet.run(scenario).lifetime <= most.foresight
    assert most.nearest < most.foresight  # foresight may leave the nearest robot where it is


def test_a_bound_beyond_the_events_first_looked_at_is_found(monkeypatch):
    scenario = fleet.Scenario.of(robots=20, range=9.0, robot={"capacity": 60.0}, seed=1)
    expected = bounds(scenario).foresight
    monkeypatch.setattr("fleet.study.bounds.SITES", 20)
    assert bounds(scenario).foresight == expected > 40
