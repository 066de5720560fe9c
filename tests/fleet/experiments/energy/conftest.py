"""Trips that were never driven, made so that the right answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from fleet.experiments.energy.trip_table import TripTable

RATE = 19.3558  # [J/m]


@pytest.fixture
def make_trips():
    """Make ``count`` trips that cost Eq. (1), ``launch`` [J], and ``turn`` [J/√rad]."""

    def make(count=2000, launch=0.0, detour=1.0, turn=0.0, noise=0.0, placements=10, seed=0):
        rng = np.random.default_rng(seed)
        straight = rng.uniform(0.05, 7.0, count)
        planned = straight * (1.0 + (detour - 1.0) * rng.random(count) * 2.0)
        angle = rng.uniform(0.0, np.pi, count)
        ramps = launch + noise * rng.normal(size=count)
        pivots = turn * np.sqrt(angle)
        nothing = np.zeros(count)
        return TripTable(
            {
                "outcome": np.full(count, "arrived", object),
                "part": np.full(count, "single", object),
                "setting": np.full(count, "the paper’s", object),
                "place": np.full(count, "open floor", object),
                "protocol": np.full(count, "rfta2", object),
                "placement": np.arange(count) % placements,
                "seed": np.arange(count) % placements,
                "straight": straight,
                "planned": planned,
                "path": planned,
                "turn": angle,
                "per_metre": np.full(count, RATE),
                "drained": RATE * planned + ramps + pivots,
                "energy_path": RATE * planned,
                "energy_launch": ramps,
                "energy_scrub": pivots,
                "energy_waiting": nothing,
                "energy_contact": nothing,
                "waited": nothing,
                "contacts": nothing,
            }
        )

    return make
