"""Where robots start: one network, or a refusal at once that says what would do, truly."""

from __future__ import annotations

import re
import time

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fleet
from fleet.assembly import prepare, streams
from fleet.observer import Observer
from fleet.placement import ATTEMPTS, critical_range, start
from worlds.arena import Arena, ImpossibleWorld
from worlds.catalogue import World
from worlds.ground import ground_of
from worlds.scattering import given as place_given


def refused(**keys):
    """What is said, and how many CPU seconds that takes."""
    began = time.process_time()
    with pytest.raises(ImpossibleWorld) as caught:
        prepare(fleet.Scenario.of(motion="straight", **keys))
    return str(caught.value), time.process_time() - began


@given(st.integers(0, 2**31), st.sampled_from([1, 2, 3, 40, 260]))
@settings(deadline=None, max_examples=20)
def test_the_critical_range_is_that_of_the_unit_disc_graph(seed, count):
    positions = np.random.default_rng(seed).random((count, 2)) * 10.0
    needed = critical_range(positions)

    def joined(reach):
        graph = nx.random_geometric_graph(count, reach, pos=dict(enumerate(positions.tolist())))
        return nx.is_connected(graph)

    assert joined(needed + 1e-9)
    if count > 1:
        assert not joined(needed - 1e-6)


@pytest.mark.parametrize(
    "keys",
    [
        {"range": 0.5},
        {"robots": 20, "range": 1.2},
        {"world": "warehouse", "range": 0.9, "seed": 3},
        {"world": {"name": "random", "width": 60.0, "height": 60.0}},
        {"robots": 4, "range": 0.2},
    ],
)
def test_what_a_refusal_proposes_does(keys):
    said, took = refused(**keys)
    assert took < 2.0
    reach = float(re.search(r"range = ([\d.]+)", said)[1])
    prepare(fleet.Scenario.of(motion="straight", **{**keys, "range": reach}))
    robots = re.search(r"robots = (\d+) would do", said)
    if robots:
        prepare(fleet.Scenario.of(motion="straight", **{**keys, "robots": int(robots[1])}))


@pytest.mark.parametrize("keys", [{"robots": 2500}, {"world": "rooms", "robots": 1900}])
def test_too_many_bodies_are_refused_with_a_number_that_fits(keys):
    began = time.process_time()
    with pytest.raises(ImpossibleWorld, match=r"do not fit .*; robots = \d+ would do") as caught:
        prepare(fleet.Scenario.of(motion="path", **keys))
    assert time.process_time() - began < 3.0
    robots = int(re.search(r"robots = (\d+)", str(caught.value))[1])
    scenario = fleet.Scenario.of(motion="path", **{**keys, "robots": robots})
    world = World(Arena())
    assert len(start(world, ground_of(Arena(), 0.1), scenario, streams(0)["placement"])) == robots


def test_what_may_still_be_found_is_looked_for():
    """A placement that only one in dozens of draws makes is not given up."""

    class Watch(Observer):
        tried = 0

        def placement_tried(self, tried, most):
            assert (tried, most) == (self.tried + 1, ATTEMPTS)
            self.tried = tried

    watch = Watch()
    prepare(fleet.Scenario.of(motion="straight", robots=40, range=1.78, seed=1), [watch])
    assert watch.tried > 30


def test_a_fixed_placement_is_judged_by_itself():
    points = np.array([[1.0, 1.0], [1.0, 4.0], [5.0, 4.0]])
    world = World(Arena(), lambda a, n, r, rng: place_given(points, a, n, r, rng), 3, fixed=True)
    scenario = fleet.Scenario.of(range=2.0)
    with pytest.raises(
        ImpossibleWorld, match=r"the placement of 3 robots is not .*range = 4 would"
    ):
        start(world, ground_of(Arena(), 0.0), scenario, np.random.default_rng(0))


def test_many_bodies_are_placed_quickly():
    """All distances of 40,000 would take minutes."""
    arena = Arena(200.0, 200.0)
    began = time.process_time()
    World(arena).place(arena, 40_000, 0.1, np.random.default_rng(1))
    assert time.process_time() - began < 5.0
