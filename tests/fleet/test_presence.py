"""Who hears whom while robots drive: by positions that are as fresh as is promised."""

from __future__ import annotations

from math import dist

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fleet
from fleet.observer import Observer
from fleet.presence import REFRESH

CRUISE, STEP = 0.76, 1.0 / 60.0  # [m/s], [s]


class Distances(Observer):
    """How far beyond the range frames were heard, by where robots really are [m]."""

    def __init__(self):
        self.beyond, self.heard = -1.0, 0

    def run_started(self, fleet):
        self.robots, self.range = fleet.robots, fleet.topology.radio_range

    def transmitted(self, excerpt):
        for said, heard in zip(excerpt.transmissions, excerpt.heard, strict=True):
            here = self.robots[said.sender].position
            for robot in heard:
                self.heard += 1
                away = dist(here, self.robots[robot].position)
                self.beyond = max(self.beyond, away - self.range)


def check_range(motion, seed, rate, robots, reach):
    distances = Distances()
    scenario = fleet.Scenario.of(
        motion=motion, seed=seed, robots=robots, range=reach, connected=False,
        protocol="k-saap", robot={"capacity": 1e4}, radio="lossy",
        time={"name": "stream", "rate": rate, "duration": 15.0},
    )  # fmt: skip
    fleet.run(scenario, [distances])
    moved = 2.0 * CRUISE * (REFRESH + (STEP if motion != "straight" else 0.0))
    assert distances.beyond <= moved + 1e-9
    return distances


@pytest.mark.parametrize("motion", ["straight", "path"])
def test_no_frame_is_heard_beyond_the_range(motion):
    """Events come so fast that something is due before links are looked at again, always."""
    assert check_range(motion, 3, 20.0, 60, 2.0).heard > 1000


@pytest.mark.slow
@given(
    st.integers(0, 2**31), st.sampled_from([0.5, 5.0, 40.0]), st.integers(2, 60),
    st.sampled_from([1.0, 2.5]),
)  # fmt: skip
@settings(max_examples=100, deadline=None)
def test_no_frame_is_heard_beyond_the_range_of_random_fleets(seed, rate, robots, reach):
    check_range("straight", seed, rate, robots, reach)
