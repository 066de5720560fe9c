"""The radio that loses frames: chance, ranges, beacons, and what robots know by them."""

from __future__ import annotations

from math import dist

import numpy as np
import pytest
from hand_drawn import random_connected, random_points
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fleet.agenda import Agenda
from fleet.power import Battery
from fleet.radio import BrokenProtocol, propagation
from fleet.radio.hearsay import Scattered
from fleet.radio.lossy import RadioSpec
from fleet.radio.shadowing import shadow
from fleet.radio.walls import crossings, walls
from fleet.robot import Robot
from protocols.messages import Transmission
from protocols.topology import Topology
from worlds.arena import Arena
from worlds.shapes import Polygon, square


def radio(points, *, radio_range=2.5, graph="gabriel", seed=1, **spec):
    return RadioSpec(**spec).over(Scattered(points, radio_range, graph, Arena()), seed, Agenda())


def robot_at(id, place):
    return Robot(id, place, 0.0, Battery(1.0), 2.5, [{}] * 99, None)


def connected_components_of(n, links):
    graph = coo_array((np.ones(len(links)), tuple(np.array(sorted(links)).T)), (n, n))
    return connected_components(graph)[0]


def test_chance_is_even_and_depends_on_everything():
    draws = np.array([propagation.chance(1, 1, k, 2, 3) for k in range(20_000)])
    assert draws.min() >= 0.0
    assert draws.max() < 1.0
    assert draws.mean() == pytest.approx(0.5, abs=0.01)
    assert np.histogram(draws, 10, (0, 1))[0] == pytest.approx([2000] * 10, rel=0.1)
    assert abs(np.corrcoef(draws[:-1], draws[1:])[0, 1]) < 0.03
    one = propagation.chance(1, 1, 1, 2, 3)
    others = [(2, 1, 1, 2, 3), (1, 2, 1, 2, 3), (1, 1, 1, 3, 2), (1, 1, 1, 2, 4)]
    assert all(propagation.chance(*other) != one for other in others)


@pytest.mark.parametrize("graph", ["gabriel", "udg", "rng"])
def test_without_loss_robots_know_the_graph_as_it_is(graph):
    points = random_connected(60, 9.0, 2.5, np.random.default_rng(2))
    known = radio(points, graph=graph).tables
    true = Topology(points, 2.5, graph).neighbours
    assert [dict(near) for near in known] == [dict(near) for near in true]


def test_the_graph_of_everybody_cannot_be_known():
    with pytest.raises(ValueError, match="no robot can tell"):
        radio([(0.0, 0.0)], graph="emst")


def test_a_moved_robot_is_known_when_it_has_beaconed_and_forgotten_in_the_end():
    points = [(0.0, 0.0), (2.0, 0.0), (9.0, 0.0)]
    air = radio(points, beacon_interval=1.0, validity=4.5)
    assert air.tables[0] == {1: (2.0, 0.0)}
    moved = robot_at(1, (0.0, 1.0))
    air.refresh([moved], 0.01)
    assert air.tables[0][1] == (2.0, 0.0)  # it has not said so yet
    air.refresh([], 1.5)
    assert air.tables[0][1] == (0.0, 1.0)
    air.refresh([robot_at(1, (8.0, 0.0))], 1.6)
    assert 1 in air.tables[0]
    air.refresh([], 8.0)
    assert air.tables[0] == {}
    assert air.tables[2] == {1: (8.0, 0.0)}


def test_beacons_are_sent_once_an_interval():
    points = random_points(50, 9.0, np.random.default_rng(3))
    air = radio(points, beacon_interval=2.0)
    before = air.beacons
    air.refresh([], 100.0)
    assert (air.beacons - before) / 50 == pytest.approx(50.0, rel=0.03)


def test_a_neighbour_that_does_not_answer_is_struck_off():
    air = radio([(0.0, 0.0), (1.0, 0.0)], retries=2, timeout=0.05, latency=0.01)
    air.silence(robot_at(1, (1.0, 0.0)))
    assert 1 in air.tables[0]
    reception = air.transmit(Transmission("route-greedy", 0, 1), 0.1)
    assert reception.heard == ()
    assert reception.attempts == 3
    assert reception.delay == pytest.approx(2 * 0.05 + 0.01)
    assert 1 not in air.tables[0]
    air.restore(robot_at(1, (1.0, 0.0)))
    air.refresh([], 3.0)
    assert 1 in air.tables[0]


def test_who_hears_a_frame_knows_where_its_sender_is():
    air = radio([(0.0, 0.0), (1.0, 0.0)])
    air.refresh([robot_at(0, (0.5, 0.0))], 0.001)
    assert air.tables[1][0] == (0.0, 0.0)
    assert air.transmit(Transmission("call", 0, None), 0.002).heard == (1,)
    assert air.tables[1][0] == (0.5, 0.0)


@pytest.mark.parametrize(("loss", "retries"), [(0.0, 3), (0.3, 0), (0.3, 1), (0.6, 2)])
def test_frames_are_lost_as_often_as_asked(loss, retries):
    """With acknowledgements lost alike, a frame gets through if one of its copies does."""
    air = radio([(0.0, 0.0), (1.0, 0.0)], loss=loss, retries=retries)
    through = sum(
        air.transmit(Transmission("bid", 0, 1), 0.001 * k).heard == (1,) for k in range(3000)
    )
    at_least, at_most = (1 - loss), 1 - loss ** (retries + 1)
    expected = 1 - loss ** (retries + 1)
    assert through / 3000 == pytest.approx(expected, abs=0.03)
    assert at_least - 0.03 <= through / 3000 <= at_most + 0.03


def test_loss_grows_with_distance():
    def share(distance):
        air = radio([(0.0, 0.0), (distance, 0.0)], loss_at_range=0.8, falloff=4.0, retries=0)
        sent = [air.transmit(Transmission("bid", 0, 1), 0.001 * k).heard for k in range(2000)]
        return sum(map(bool, sent)) / 2000

    assert share(0.5) > 0.98
    assert share(2.5) == pytest.approx(0.2, abs=0.04)
    assert share(2.0) == pytest.approx(1 - 0.8 * 0.8**4, abs=0.04)


def test_shadowing_and_walls_change_how_far_a_link_reaches_the_same_both_ways():
    wall = Arena(10.0, 10.0, obstacles=(square(5.0, 5.0, 0.5),))
    plain, shadowed, walled, both = (
        RadioSpec(shadowing=s, wall_loss=w).air(Scattered([], 2.5, "gabriel", wall), 5)
        for s, w in ((0.0, 0.0), (4.0, 0.0), (0.0, 6.0), (4.0, 6.0))
    )
    rng = np.random.default_rng(3)
    for ax, ay, bx, by in rng.uniform(0.0, 10.0, (50, 4)):
        reaches = [propagation.reach(air, ax, ay, bx, by) for air in (plain, shadowed, walled)]
        decibels = shadow(shadowed.shadows, ax, ay, bx, by)
        assert reaches[0] == 2.5
        assert reaches[1] == pytest.approx(2.5 * 10.0 ** (decibels / 30.0))
        assert reaches[1] <= propagation.farthest(shadowed)
        together = reaches[1] * reaches[2] / 2.5
        assert propagation.reach(both, ax, ay, bx, by) == pytest.approx(together)
        assert propagation.reach(both, bx, by, ax, ay) == pytest.approx(together)
    through, beside = (4.0, 5.0, 6.0, 5.0), (4.0, 6.0, 6.0, 6.0)
    assert propagation.reach(walled, *through) == pytest.approx(2.5 * 10.0 ** (-6.0 / 30.0))
    assert propagation.reach(walled, *beside) == 2.5


def test_walls_are_counted_one_by_one_however_thin():
    """Three shelves of a centimetre: between none and three are crossed, as by their corners."""
    thin = tuple(
        Polygon(((x, 2.0), (x + 0.01, 2.0), (x + 0.01, 8.0), (x, 8.0))) for x in (2.0, 4.0, 6.0)
    )
    floor = walls(Arena(10.0, 10.0, obstacles=thin), 3.0)
    assert [crossings(floor, 1.0, 5.0, x, 5.0) for x in (1.5, 3.0, 5.0, 7.0)] == [0, 1, 2, 3]
    assert crossings(floor, 1.0, 9.0, 7.0, 9.0) == 0
    assert crossings(floor, 3.0, 3.0, 3.0, 7.0) == 0


@pytest.mark.parametrize("shadowing", [3.0, 6.0])
def test_under_shadowing_a_link_is_cut_only_by_witnesses_that_both_ends_hear(shadowing):
    """So that who is connected on the air stays connected in the routing graph."""
    points = random_connected(80, 10.0, 2.5, np.random.default_rng(8))
    air = radio(points, shadowing=shadowing)
    hear = {
        (u, v)
        for u in range(80)
        for v in range(80)
        if u != v
        and dist(points[u], points[v]) <= propagation.reach(air.air, *points[u], *points[v])
    }
    for u, near in enumerate(air.tables):
        for v in near:
            assert (u, v) in hear
        for v in {v for a, v in hear if a == u} - set(near):
            middle = [(points[u][k] + points[v][k]) / 2 for k in (0, 1)]
            inside = [w for w in range(80) if dist(points[w], middle) <= dist(points[u], middle)]
            assert any((u, w) in hear and (v, w) in hear for w in inside)
    on_air = connected_components_of(80, hear)
    routed = {(u, v) for u, near in enumerate(air.tables) for v in near}
    assert connected_components_of(80, routed) == on_air


def test_two_radios_of_one_seed_agree_whatever_was_sent_before():
    points = random_points(30, 6.0, np.random.default_rng(6))
    one, other = (radio(points, loss=0.4, seed=9) for _ in range(2))
    for _ in range(5):
        one.transmit(Transmission("call", 3, None), 0.0)
        other.transmit(Transmission("call", 3, None), 0.0)
    for air in (one, other):
        air.refresh([], 20.0)
    assert [dict(t) for t in one.tables] == [dict(t) for t in other.tables]


def test_nobody_talks_to_nobody():
    with pytest.raises(BrokenProtocol):
        radio([(0.0, 0.0), (1.0, 0.0)]).transmit(Transmission("bid", 0, 7), 0.0)


def test_tables_hold_the_nearest_in_time_when_there_is_no_room():
    rng = np.random.default_rng(7)
    crowd = random_points(300, 1.0, rng)
    air = radio(crowd, radio_range=0.4)
    for robot in (0, 100, 299):
        for other, place in air.tables[robot].items():
            assert place == crowd[other]
            assert dist(crowd[robot], place) <= 0.4


@pytest.mark.parametrize(
    "wrong",
    [
        {"loss": 1.2}, {"latency": -1.0}, {"retries": 99}, {"validity": 0.5}, {"path_loss": 0.0},
        {"beacon_interval": 0.0}, {"shadowing": float("nan")}, {"wall_loss": -1.0},
        {"shadow_distance": 0.0},
    ],
)  # fmt: skip
def test_bad_values_are_refused_with_a_sentence(wrong):
    with pytest.raises(ValueError, match="expected"):
        RadioSpec(**wrong)
