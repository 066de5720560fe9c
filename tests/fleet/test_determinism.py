"""One scenario, one seed, one platform: one result, to the last bit, in any process."""

from __future__ import annotations

import hashlib
import json
import platform
import struct
import subprocess
import sys

import pytest

import fleet
from fleet.observer import Observer

CASES = {
    "straight": {"motion": "straight", "seed": 11},
    "physics": {"motion": "physics", "seed": 11, "rounds": 120},
    "hole": {"motion": "physics", "world": "random-hole", "protocol": "gfgf2a", "seed": 12},
}
GOLDEN = {
    "straight": "e68805c4083acfa5",
    "physics": "7cd9b7f23c100562",
    "hole": "43ac5b4dfd47231a",
}
HERE = (platform.system(), platform.machine())


class Trajectories(Observer):
    """A hash of every pose under way."""

    sample_interval = 1 / 60

    def __init__(self):
        self.hash = hashlib.sha256()

    def moved(self, samples):
        self.hash.update(samples.tobytes())

    def trip_ended(self, event, trip):
        self.hash.update(struct.pack("<3d", *trip.end, trip.energy))


# Figures of the first release: what later ones tell besides changes no hash.
FIGURES = [
    "protocol", "motion", "world", "seed", "robots", "radio_range", "search_radius", "lifetime",
    "events", "served", "failed", "messages", "messages_per_robot", "messages_by_kind",
    "hops_greedy", "hops_face", "energy_initial", "energy_predicted", "energy_drained",
    "energy_left_mean", "energy_left_min", "energy_left_sd", "reactions_per_robot",
    "distance_per_robot", "path_per_robot", "closest_found", "simulated_time",
]  # fmt: skip


def fingerprint(case):
    trajectories = Trajectories()
    result = fleet.run(fleet.Scenario.of(**CASES[case]), [trajectories]).as_dict()
    figures = {name: result[name] for name in FIGURES}
    trajectories.hash.update(json.dumps(figures, sort_keys=True).encode())
    return trajectories.hash.hexdigest()[:16]


@pytest.mark.parametrize("case", CASES)
def test_two_processes_agree_to_the_bit(case):
    script = f"import test_determinism as t; print(t.fingerprint({case!r}))"
    other = subprocess.run(
        [sys.executable, "-c", script], cwd=__file__.rpartition("/")[0],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert other.stdout.strip() == fingerprint(case)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.skipif(HERE != ("Linux", "x86_64"), reason="pinned on Linux on x86-64")
def test_results_are_those_of_the_last_release(case):
    """A change here changes every result: it belongs into the changelog."""
    assert fingerprint(case) == GOLDEN[case]


def test_the_seed_decides():
    runs = [fleet.run(fleet.Scenario.of(motion="straight", rounds=30, seed=s)) for s in (1, 2)]
    assert runs[0].energy_drained != runs[1].energy_drained


def test_one_seed_is_one_network_and_one_row_of_events_for_every_protocol():
    class Seen(Observer):
        def __init__(self):
            self.events = []

        def run_started(self, fleet):
            self.start = [robot.position for robot in fleet.robots]

        def event_raised(self, event, source, time):
            self.events.append((event, source))

    rows = []
    for protocol in ("rfta2", "gfgf2a"):
        seen = Seen()
        fleet.run(
            fleet.Scenario.of(protocol=protocol, motion="straight", rounds=40, seed=9), [seen]
        )
        rows.append((seen.start, seen.events))
    assert rows[0] == rows[1]
