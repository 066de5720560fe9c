"""Taking turns in a run: what robots hear, what collides, what it costs."""

from __future__ import annotations

import numpy as np
import pytest
from hand_drawn import random_connected

import fleet
from fleet.agenda import Agenda
from fleet.radio.csma import STANDARDS, CsmaSpec
from fleet.radio.hearsay import Scattered
from protocols.messages import Transmission
from protocols.topology import Topology
from worlds.arena import Arena


def radio(points, *, radio_range=2.5, seed=1, **spec):
    agenda = Agenda()
    scattered = Scattered(points, radio_range, "gabriel", Arena())
    return CsmaSpec(**spec).over(scattered, seed, agenda), agenda


def run_until(agenda, time):
    while agenda.next_time <= time:
        agenda.take()()


def sent(air, agenda, transmission, time=0.01):
    """What becomes of it, and when that is told."""
    told = []
    agenda.at(time, lambda: air.send(transmission, time, lambda *what: told.append(what)))
    run_until(agenda, time + 1.0)
    ((reception, when),) = told
    return reception, when


def stream(protocol="rfta2", rate=1.0, duration=40.0, **changed):
    return {
        "protocol": protocol, "motion": "straight", "seed": 3, "radio": {"name": "csma"},
        "time": {"name": "stream", "rate": rate, "duration": duration}, **changed,
    }  # fmt: skip


def test_a_lone_frame_takes_its_back_off_its_bits_and_its_acknowledgement():
    air, agenda = radio([(0.0, 0.0), (1.0, 0.0)], beacon_interval=4.0)
    reception, when = sent(air, agenda, Transmission("bid", 0, 1))
    bits = 8 * (16 + 11)
    fixed = 128e-6 + 192e-6 + 192e-6 + bits / 250e3 + 192e-6 + 352e-6
    assert reception.heard == (1,)
    assert reception.attempts == 1
    back_off = (when - 0.01 - fixed) / 320e-6
    assert back_off == pytest.approx(round(back_off), abs=1e-3)
    assert 0 <= round(back_off) < 8


def test_a_neighbour_that_does_not_answer_is_struck_off_after_the_standard_s_attempts():
    air, agenda = radio([(0.0, 0.0), (1.0, 0.0)], beacon_interval=4.0)
    air.on_air[1] = False
    reception, _ = sent(air, agenda, Transmission("route-greedy", 0, 1))
    assert (reception.heard, reception.attempts) == ((), 1 + STANDARDS["802.15.4"].retries)
    assert 1 not in air.tables[0]


def test_robots_know_one_another_by_beacons_that_compete_for_the_air():
    points = random_connected(60, 9.0, 2.5, np.random.default_rng(2))
    air, agenda = radio(points)
    run_until(agenda, 5.0)
    true = Topology(points, 2.5, "gabriel").neighbours
    known = air.tables
    missing = sum(set(true[k]) != set(known[k]) for k in range(60))
    assert missing <= 3  # a beacon may drown, the one before is still valid
    counts = air.counts()
    assert counts.beacons == pytest.approx(60 * 6, abs=60)
    assert counts.frames == pytest.approx(60 * 5, abs=60)


def test_a_lost_acknowledgement_leaves_the_sender_of_a_packet_in_doubt():
    """With half of all frames lost and no second attempt, three fates of four are uncertain."""
    doubts, heard, count = 0, 0, 400
    for seed in range(count):
        air, agenda = radio(
            [(0.0, 0.0), (1.0, 0.0)], seed=seed, loss=0.5, retries=0, beacon_interval=4.0
        )
        reception, _ = sent(air, agenda, Transmission("route-greedy", 0, 1))
        heard += reception.heard == (1,)
        doubts += air.doubts
    error = 4 * np.sqrt(0.25 * 0.75 / count)
    assert doubts / count == pytest.approx(0.25, abs=error)
    assert heard / count == pytest.approx(0.25, abs=error)


def test_one_seed_decides_a_run_and_another_another():
    one, same, other = (
        fleet.run(fleet.Scenario.of(**stream(seed=seed))).as_dict() | {"wall_time": 0.0}
        for seed in (3, 3, 4)
    )
    assert one == same
    assert one != other


def test_flooding_pays_for_flooding():
    """At four events a second k-SAAP's frames drown others far more often than RFTA2's."""
    drowned = {}
    for protocol in ("rfta2", "k-saap"):
        summary = fleet.run(fleet.Scenario.of(**stream(protocol, rate=4.0, duration=20.0)))
        drowned[protocol] = summary.frames_drowned / summary.frames_on_air
    assert drowned["k-saap"] > 1.5 * drowned["rfta2"]


def test_receiving_and_listening_cost_energy():
    free = fleet.run(fleet.Scenario.of(**stream()))
    paid = fleet.run(
        fleet.Scenario.of(**stream(robot={"extra": {"reception": 1e-3, "listening": 0.056}}))
    )
    listening = 0.056 * 40.0 * 100
    radio = paid.energy_by_account["radio"]
    assert free.energy_by_account["radio"] == 0.0
    assert listening < radio < listening + 1e-3 * 40 * paid.messages
    assert sum(paid.energy_by_account.values()) == pytest.approx(paid.energy_drained, abs=1e-9)


@pytest.mark.parametrize(
    "wrong",
    [
        {"standard": "zigbee"}, {"rate": 0.0}, {"retries": -1}, {"capture": 0.0},
        {"sensing": float("nan")}, {"loss": 2.0},
    ],
)  # fmt: skip
def test_bad_values_are_refused_with_a_sentence(wrong):
    with pytest.raises(ValueError, match="expected"):
        CsmaSpec(**wrong)
