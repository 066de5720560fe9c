"""Whole runs: what they count, keep, and do when things go wrong."""

from __future__ import annotations

from collections import Counter
from math import dist, fsum

import pytest

import fleet
from fleet.observer import Observer
from fleet.radio import BrokenProtocol
from fleet.radio.ideal import IdealRadio
from protocols.messages import Transmission
from protocols.topology import Topology


class Witness(Observer):
    """Keeps all it is told."""

    sample_interval = 0.2
    link_interval = 0.5

    def __init__(self):
        self.said, self.trips, self.awards, self.raised, self.poses = [], [], [], [], []
        self.summary, self.over, self.relinks = None, 0, 0

    def run_started(self, fleet):
        self.fleet = fleet

    def event_raised(self, event, source, time):
        self.raised.append((event, source, time))

    def transmitted(self, excerpt):
        self.said.extend(excerpt.lines())

    def awarded(self, event, award, time):
        self.awards.append(award)

    def moved(self, samples):
        self.poses.extend(samples.tolist())

    def relinked(self, time):
        self.relinks += 1

    def trip_ended(self, event, trip):
        self.trips.append(trip)

    def run_ended(self, summary):
        self.summary = summary

    def closed(self):
        self.over += 1


@pytest.fixture(params=["straight", "physics"])
def motion(request):
    return request.param


@pytest.fixture(params=["rfta2", "gfgf2a"])
def protocol(request):
    return request.param


def test_the_summary_is_what_the_witness_saw(protocol, motion):
    witness = Witness()
    scenario = fleet.Scenario.of(protocol=protocol, motion=motion, seed=3, rounds=40)
    summary = fleet.run(scenario, [witness])
    assert witness.summary == summary
    assert witness.over == 1
    kinds = Counter(sent.transmission.kind for sent in witness.said)
    assert summary.messages_by_kind == {k: kinds[k] for k in summary.messages_by_kind}
    assert summary.messages == len(witness.said) == witness.said[-1].number
    assert summary.served == sum(trip.outcome == "arrived" for trip in witness.trips)
    assert summary.failed == len(witness.trips) - summary.served
    assert summary.lifetime == summary.served
    assert summary.events == len({event.id for event, _, _ in witness.raised})
    drained = fsum(trip.energy for trip in witness.trips)
    assert summary.energy_drained == pytest.approx(drained, abs=1e-6)
    left = fsum(robot.energy for robot in witness.fleet.robots)
    assert summary.energy_initial - left == pytest.approx(summary.energy_drained, abs=1e-9)
    assert summary.path_per_robot == pytest.approx(sum(t.path for t in witness.trips) / 100)
    assert summary.simulated_time == witness.trips[-1].ended


def test_the_topology_follows_the_bodies(motion):
    class Comparing(Witness):
        def relinked(self, time):
            super().relinked(time)
            live = self.fleet.topology
            for robot in self.fleet.robots:
                assert live.positions[robot.id] == robot.position
            if self.relinks % 10 == 0:
                whole = Topology(live.positions, live.radio_range)
                assert list(live.neighbours) == list(whole.neighbours)

    witness = Comparing()
    fleet.run(fleet.Scenario.of(motion=motion, seed=4, rounds=15), [witness])
    assert witness.relinks > 15  # also on the way


def test_watching_changes_nothing(protocol, motion):
    scenario = fleet.Scenario.of(protocol=protocol, motion=motion, seed=5, rounds=30)
    alone, watched = fleet.run(scenario).as_dict(), fleet.run(scenario, [Witness()]).as_dict()
    del alone["wall_time"], watched["wall_time"]
    assert alone == watched


def test_straight_motion_drains_what_eq_1_predicts():
    summary = fleet.run(fleet.Scenario.of(motion="straight", seed=6, rounds=50))
    assert summary.energy_drained == pytest.approx(summary.energy_predicted, abs=1e-6)
    assert summary.path_per_robot == pytest.approx(summary.distance_per_robot)


def test_physics_drains_more_than_eq_1_predicts():
    summary = fleet.run(fleet.Scenario.of(motion="physics", seed=6, rounds=50))
    assert 1.05 < summary.energy_drained / summary.energy_predicted < 2.0
    assert summary.path_per_robot >= summary.distance_per_robot * (1 - 1e-9)


def test_life_ends_at_the_first_event_that_nobody_takes():
    witness = Witness()
    summary = fleet.run(
        fleet.Scenario.of(motion="straight", robots=20, range=5.0, seed=1), [witness]
    )
    assert witness.awards[-1].winner is None
    assert all(award.winner is not None for award in witness.awards[:-1])
    assert summary.events == summary.lifetime + 1


def test_a_robot_that_dies_on_the_way_is_counted_and_the_event_is_raised_again():
    """Batteries so small that the launch, which Eq. (1) leaves out, empties some."""
    witness = Witness()
    scenario = fleet.Scenario.of(motion="physics", robot={"capacity": 20.0}, seed=2)
    summary = fleet.run(scenario, [witness])
    died = [trip for trip in witness.trips if trip.outcome == "battery empty"]
    assert died
    assert summary.failed >= len(died)
    for trip in died:
        robot = witness.fleet.robots[trip.robot]
        assert robot.energy == 0.0
        assert not robot.alive
        assert robot.id not in {v for near in witness.fleet.topology.neighbours for v in near}
    raised = Counter(event.id for event, _, _ in witness.raised)
    assert max(raised.values()) > 1


def test_the_nearest_robot_counts_as_found_when_it_ends_the_search_or_wins():
    witness = Witness()
    scenario = fleet.Scenario.of(protocol="gfgf2a", search_radius=0.0, motion="straight", rounds=30)
    assert fleet.run(scenario, [witness]).closest_found == 1.0  # GFGF1, by the theorem
    event, _, _ = witness.raised[0]
    first = witness.awards[0].winner
    assert dist(witness.trips[0].origin, event.position) == pytest.approx(
        dist(witness.trips[0].origin, witness.trips[0].site)
    )
    assert first == witness.trips[0].robot


def test_a_run_that_breaks_off_still_closes_its_observers():
    class Failing(Witness):
        def awarded(self, event, award, time):
            raise RuntimeError("disk full")

    witness = Failing()
    with pytest.raises(RuntimeError, match="disk full"):
        fleet.run(fleet.Scenario.of(motion="straight", rounds=3), [witness])
    assert witness.over == 1


def test_a_protocol_that_sends_where_nobody_is_is_stopped():
    radio = IdealRadio(Topology([(0.0, 0.0), (1.0, 0.0), (5.0, 0.0)], 2.0))
    assert radio.transmit(Transmission("call", 0, None), 0.0).heard == (1,)
    with pytest.raises(BrokenProtocol, match="robot 2"):
        radio.transmit(Transmission("route-greedy", 0, 2), 0.0)
