"""Robots sent to places that are no events: seen to leave, on the way, and where they came to."""

from __future__ import annotations

from math import dist

import numpy as np
import pytest

from fleet.replay import scheme
from fleet.replay.readback import Recording
from fleet.replay.rerun_recorder import RerunRecorder
from fleet.replay.scheme import SIM_TIME

from .conftest import Witness, simulation

STREAM = {"time": {"name": "stream", "rate": 1.0, "duration": 60.0}}


class SeesRelocations(Witness):
    """Keeps the orders that were carried out."""

    def __init__(self):
        super().__init__()
        self.orders, self.ends = [], []

    def relocating(self, event, move, time):
        self.orders.append((event, move, time))

    def relocated(self, event, trip):
        self.ends.append(trip)


@pytest.fixture(
    scope="module", params=[{"rounds": 30}, STREAM, {"rounds": 30, "motion": "path"}], ids=str
)
def run(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("relocations") / "run.rrd"
    witness = SeesRelocations()
    watching = RerunRecorder(path, key="k", properties={}, flush_rounds=3, strict=True)
    settings = {"protocol": "rfta3", "robots": 25, "range": 2.0, "seed": 0, **request.param}
    prepared = simulation([witness, watching], **settings)
    summary = prepared.run()
    assert prepared.tally.relocations == len(witness.orders) > 0
    return Recording(path), witness, summary, prepared


def on_the_way(recording, robot, time):
    names = recording.at(scheme.MOVERS, "Points2D:labels", SIM_TIME, time)
    return None if f"r{robot} relocates" not in names else names.index(f"r{robot} relocates")


def test_they_are_movers_from_when_they_are_sent(run):
    recording, witness, *_ = run
    samples = np.concatenate(witness.samples)
    for _, (robot, place), time in witness.orders:
        seen = samples[(samples[:, 0] == robot) & (samples[:, 1] > time)]
        for _, at, x, y, *_ in seen[:3].tolist():
            index = on_the_way(recording, robot, at)
            shown = recording.at(scheme.MOVERS, "Points2D:positions", SIM_TIME, at)[index]
            assert shown == pytest.approx((x, y), abs=1e-5)
            rest = recording.at(scheme.ROBOTS, "Points2D:positions", SIM_TIME, at)
            assert np.isnan(rest[robot]).all()
        dashes = recording.at(scheme.RELOCATION, "LineStrips2D:strips", SIM_TIME, float(seen[0, 1]))
        assert min(dist(dash[-1], place) for dash in dashes) < 0.3


def test_they_come_to_rest(run):
    recording, _, _, prepared = run
    end = recording.span(SIM_TIME)[1]
    shown = recording.at(scheme.ROBOTS, "Points2D:positions", SIM_TIME, end)
    energy = recording.at(scheme.ROBOTS, "Robot:energy", SIM_TIME, end)
    resting = ~np.isnan(shown[:, 0])
    assert resting.sum() > 15
    for robot in prepared.fleet.robots:
        if resting[robot.id]:
            assert shown[robot.id] == pytest.approx(robot.position, abs=1e-5)
            assert energy[robot.id] == pytest.approx(robot.battery.charge, abs=1e-3)


def test_the_log_and_the_card_tell_of_them(run):
    recording, witness, *_ = run
    said = [text[0] for text in recording.rows(scheme.LOG, "TextLog:text").values]
    cards = [text[0] for text in recording.rows(scheme.CARD, "TextDocument:text").values]
    for event, (robot, (x, y)), _ in witness.orders:
        assert f"event {event.id + 1}: r{robot} is sent to ({x:.2f}, {y:.2f}) m" in said
    assert any(
        card.startswith(f"## Event {event.id + 1}: carried on")
        for card in cards
        for event, *_ in witness.orders
    )
    back = sum("has relocated" in line for line in said)
    assert back == len(witness.ends) > 0


def test_their_energy_is_counted_too(run):
    recording, _, summary, _ = run
    foreseen, _ = recording.rows(scheme.TOTAL_ENERGY, "Scalars:scalars").values[-1]
    under_way = recording.at(scheme.MOVERS, "Points2D:positions", SIM_TIME, 1e6)
    if not len(under_way):
        assert foreseen == pytest.approx(summary.energy_predicted)
