"""Runs that were recorded and witnessed at once, so that the two can be compared."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from fleet.assembly import prepare
from fleet.observer import Observer
from fleet.replay.readback import Recording
from fleet.replay.rerun_recorder import RerunRecorder
from fleet.results import Summary
from fleet.scenario.loading import scenario_from


class Witness(Observer):
    """Keeps what it was told, as it was told."""

    sample_interval = 0.05

    def __init__(self):
        self.raised, self.said, self.awards, self.departures, self.trips = [], [], [], [], []
        self.relinks = set()
        self.samples, self.energies, self.over, self.silent = [], [], [], []

    def run_started(self, fleet):
        self.fleet = fleet
        self.start = np.array([robot.position for robot in fleet.robots])

    def event_raised(self, event, source, time):
        self.raised.append((event, source, time, len(self.said)))
        places = np.array([robot.position for robot in self.fleet.robots])
        silent = [robot.id for robot in self.fleet.robots if not robot.on_air]
        self.silent.append((time, places, silent))

    def transmitted(self, excerpt):
        self.said.extend(excerpt.lines())

    def awarded(self, event, award, time):
        self.awards.append((event, award, time, len(self.said)))

    def departed(self, event, robot, time):
        self.departures.append((event, robot, time, len(self.said)))

    def moved(self, samples):
        self.samples.append(samples)

    def relinked(self, time):
        self.relinks.add(round(1e9 * time))

    def trip_ended(self, event, trip):
        self.trips.append((event, trip, len(self.said)))
        self.energies.append([robot.battery.charge for robot in self.fleet.robots])

    def event_closed(self, event, outcome, time):
        self.over.append((event, outcome, time))


@dataclass
class Recorded:
    path: Path
    recording: Recording
    witness: Witness
    summary: Summary


def simulation(observers, **settings):
    settings = {"motion": "straight", "robots": 40, "range": 3.0, "seed": 4, **settings}
    return prepare(scenario_from(settings), observers)


def record(path, *, key="test", flush_rounds=5, **settings):
    """Record a run into a file, in Rerun's strict mode."""
    witness = Witness()
    recorder = RerunRecorder(
        path, key=key, properties={"seed": settings.get("seed", 4), "nested": {"figure": 1.5}},
        flush_rounds=flush_rounds, strict=True,
    )  # fmt: skip
    summary = simulation([witness, recorder], **settings).run()
    return Recorded(path, Recording(path), witness, summary)


@pytest.fixture(scope="session")
def rounds(tmp_path_factory):
    """In rounds, around the hole; some robots run out of energy."""
    return record(
        tmp_path_factory.mktemp("rounds") / "run.rrd", world="random-hole", rounds=60,
        robots=50, robot={"capacity": 60.0, "extra": {"idle": 1.0}}, seed=12,
    )  # fmt: skip


@pytest.fixture(scope="session")
def stream(tmp_path_factory):
    """Several robots under way and several conversations at once, over a radio that loses."""
    return record(
        tmp_path_factory.mktemp("stream") / "run.rrd",
        radio={"name": "lossy", "loss": 0.3},
        time={"name": "stream", "rate": 1.0, "duration": 40.0},
    )
