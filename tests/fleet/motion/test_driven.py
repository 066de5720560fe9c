"""The interface: time in steps, trips that end, what robots believe, poses for observers."""

from __future__ import annotations

from dataclasses import replace
from math import cos, dist, inf, nan, pi, sin

import numpy as np
import pytest

from fleet.motion.driven import DrivenMotion
from fleet.motion.motions import MOTIONS
from fleet.motion.options import DriveOptions
from fleet.motion.params import ladder_of, margin_of
from fleet.power import ExtraPower
from fleet.robot import PRESETS, RobotSpec
from worlds.arena import Arena
from worlds.shapes import Polygon

SPEC = RobotSpec(capacity=1e4)
EQ1 = SPEC.power.per_metre(SPEC.cruise)
BLOCK = Arena(obstacles=(Polygon(((4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0))),))
RING = [(5.0 + 0.41 * cos(k * pi / 6), 5.0 + 0.41 * sin(k * pi / 6)) for k in range(12)]


def test_now_is_the_last_step_not_after_until(driving):
    motion, (robot,) = driving([(1.0, 1.0)], SPEC, dt=1.0 / 60.0)
    for until, steps in ((0.1, 6), (0.109, 6), (0.2, 12), (1.0, 60), (1.0 + 1e-12, 60)):
        assert motion.advance(until) == []
        assert motion.now == pytest.approx(steps / 60.0, abs=1e-15)
    motion.depart(robot, (9.0, 1.0))
    for k in range(50):
        motion.advance(1.0 + 0.1 * k)
        assert motion.now == pytest.approx(1.0 + 0.1 * k, abs=1e-12)
    motion.advance(motion.now - 0.5)
    assert motion.now == pytest.approx(5.9)
    motion.advance(inf)
    ended = motion.now
    assert motion.advance(inf) == []
    assert motion.now == ended


def test_advance_returns_as_soon_as_a_trip_ends(driving):
    motion, (one, two) = driving([(1.0, 1.0), (1.0, 5.0)], SPEC)
    motion.depart(one, (3.0, 1.0))
    motion.depart(two, (2.0, 5.0))
    assert motion.moving == (one, two)
    assert one.cost_to((5.0, 5.0)) == inf
    (first,) = motion.advance(100.0)
    assert (first.robot, first.ended) == (1, motion.now)
    assert two.position == pytest.approx((2.0, 5.0))
    assert 1.0 < one.position[0] < 3.0
    assert one.battery.charge < 1e4
    assert motion.moving == (one,)
    (second,) = motion.advance(100.0)
    assert second.robot == 0
    assert motion.now < 100.0
    assert motion.advance(100.0) == []
    assert motion.now == pytest.approx(100.0)


def test_without_a_path_the_trip_is_over_at_once(driving):
    motion, robots = driving([(5.0, 5.0), *RING], SPEC)
    assert robots[0].cost_to((8.0, 8.0)) == inf
    motion.depart(robots[0], (8.0, 8.0))
    (trip,) = motion.advance(100.0)
    assert (trip.outcome, trip.energy, trip.path, trip.ended) == ("no path", 0.0, 0.0, 0.0)
    assert motion.now == 0.0
    assert motion.moving == ()
    assert robots[0].position == trip.end == (5.0, 5.0)


def test_who_is_there_already_arrives_at_once(driving):
    motion, (robot,) = driving([(5.0, 5.0)], SPEC, engine=True)
    motion.depart(robot, (5.0, 5.0))
    (trip,) = motion.advance(1.0)
    assert (trip.outcome, trip.energy, trip.steps, motion.now) == ("arrived", 0.0, 0, 0.0)
    motion.depart(robot, (6.0, 5.0))
    (trip,) = motion.advance(inf)
    assert trip.end == pytest.approx((6.0, 5.0), abs=5e-4)


def test_a_robot_under_way_cannot_be_sent(driving):
    motion, (robot,) = driving([(5.0, 5.0)], SPEC)
    motion.depart(robot, (6.0, 5.0))
    with pytest.raises(ValueError, match="robot 0 is under way"):
        motion.depart(robot, (7.0, 5.0))


def test_a_site_must_be_a_place(driving):
    motion, (robot,) = driving([(5.0, 5.0)], SPEC)
    for site in ((nan, 5.0), (5.0, inf)):
        with pytest.raises(ValueError, match="expected two numbers"):
            motion.depart(robot, site)


def test_free_traffic_needs_an_engine():
    with pytest.raises(ValueError, match="'free' without an engine"):
        DrivenMotion(SPEC, Arena(), DriveOptions(traffic="free"), engine=False)


def test_what_a_robot_believes(driving):
    start, site = (3.0, 5.0), (7.0, 5.0)
    straight = EQ1 * 4.0
    (motion, (robot,)) = driving([start], SPEC, BLOCK)
    assert robot.cost_to(site) == pytest.approx(straight)
    motion, (robot,) = driving([start], SPEC, BLOCK, belief="path")
    path = robot.cost_to(site)
    assert path > 1.1 * straight
    motion.depart(robot, site)
    (trip,) = motion.advance(inf)
    assert path == pytest.approx(EQ1 * trip.planned)
    motion, (robot,) = driving(
        [start], SPEC, BLOCK, belief="corrected", per_metre=20.0, per_launch=5.0
    )
    assert robot.cost_to(site) == pytest.approx(20.0 * trip.planned + 5.0)


@pytest.mark.parametrize(
    "spec",
    [
        SPEC,
        PRESETS["pioneer"],
        replace(SPEC, drive="holonomic"),
        replace(SPEC, reverse=True, acceleration=0.4),
        replace(SPEC, efficiency=0.9, regeneration=0.5, scrub=1.0, turning=3.0),
    ],
)
def test_a_robot_that_knows_its_drive_pays_what_it_bid(crowd, spec):
    spec = replace(spec, capacity=1e4)
    motion, robots, rng = crowd(20, 5, spec, BLOCK, belief="driven")
    gone = 0
    for robot in robots:
        site = tuple(rng.uniform(0.5, 9.5, 2).tolist())
        bid = robot.cost_to(site)
        motion.depart(robot, site)
        for trip in motion.advance(inf):
            assert trip.energy == pytest.approx(bid if trip.outcome == "arrived" else 0.0, rel=1e-9)
            gone += trip.outcome == "arrived"
    assert gone > 10


def test_where_it_stands_already_a_drive_costs_nothing(driving):
    motion, (one, two) = driving([(0.5, 0.5), (5.0, 5.0)], SPEC, belief="driven")
    corner = (0.02, 0.01)  # nobody gets nearer to it than to its radius and clearance
    motion.depart(one, corner)
    motion.advance(inf)
    assert two.cost_to((9.0, 9.0)) > 100.0  # what is left of that must not be taken for a way
    assert one.cost_to(corner) == 0.0
    motion.depart(one, corner)
    (trip,) = motion.advance(inf)
    assert (trip.outcome, trip.energy) == ("arrived", 0.0)


def test_reachability_is_asked_for_only_if_wanted(driving):
    for wanted in (True, False):
        motion, robots = driving([(5.0, 5.0), *RING], SPEC, reachability=wanted)
        believed = motion.cost(robots[0], (8.0, 8.0))
        assert believed == (inf if wanted else pytest.approx(EQ1 * dist((5, 5), (8, 8))))
        assert bool(motion._planner._known) == wanted


def test_the_winner_departs_by_the_plan_of_its_bid(driving, monkeypatch):
    motion, (one, two) = driving([(3.0, 5.0), (1.0, 1.0)], SPEC, BLOCK)
    one.cost_to((7.0, 5.0))
    two.cost_to((7.0, 5.0))
    monkeypatch.setattr(motion._planner, "_plan", None)
    motion.depart(one, (7.0, 5.0))
    (trip,) = motion.advance(inf)
    assert trip.outcome == "arrived"


def test_a_broken_robot_stops_where_it_is(driving):
    for engine in (True, False):
        motion, (robot, other) = driving([(1.0, 1.0), (8.0, 8.0)], SPEC, engine=engine)
        motion.depart(robot, (9.0, 1.0))
        motion.advance(3.0)
        here, charge = robot.position, robot.battery.charge
        motion.halt(robot)
        motion.halt(other)
        (trip,) = motion.advance(10.0)
        assert trip.outcome == "broken down"
        assert trip.end == robot.position == here
        assert trip.energy == pytest.approx(1e4 - charge)
        assert trip.ended == motion.now == pytest.approx(3.0)
        motion.depart(other, (5.0, 1.0))
        (trip,) = motion.advance(inf)
        assert dist(trip.end, here) >= 0.2


def test_samples_are_rows_of_poses_on_the_way(driving):
    motion, robots = driving(
        [(1.0, 1.0), (1.0, 3.0)], SPEC, headings=[0.0, 3.0], engine=True, interval=0.1
    )
    motion.depart(robots[0], (3.0, 1.0))
    motion.advance(0.25)
    motion.depart(robots[1], (3.0, 3.0))
    rows = [motion.samples()]
    while motion.moving:
        motion.advance(motion.now + 0.5)
        rows.append(motion.samples())
    rows = np.vstack(rows)
    assert rows.shape[1] == 8
    assert (np.diff(rows[:, 1]) >= 0.0).all()
    for robot in robots:
        own = rows[rows[:, 0] == robot.id]
        assert np.diff(own[:-1, 1]) == pytest.approx(0.1)
        assert own[-1, 2:6] == pytest.approx([*robot.position, robot.heading, robot.battery.charge])
        assert (np.diff(own[:, 5]) <= 0.0).all()
        assert np.hypot(*(own[:, 2:4] - own[:, 6:8]).T).max() < 0.0015
        assert (np.abs(own[:, 4]) <= pi).all()
    assert len(motion.samples()) == 0


def test_plans_are_told_at_departure_and_after_a_breakdown(driving):
    places = [(2.0, 5.0), (3.0, 1.0), (5.0, 3.0)]
    motion, (one, two, breaks) = driving(places, SPEC, BLOCK, interval=0.05)
    motion.depart(one, (8.0, 5.0))
    ((robot, way),) = motion.plans()
    assert robot == 0
    assert (tuple(way[0]), tuple(way[-1])) == (one.position, pytest.approx((8.0, 5.0)))
    assert dist(*way[[0, -1]]) < np.hypot(*np.diff(way, axis=0).T).sum()
    (trip,) = motion.advance(inf)
    assert np.hypot(*np.diff(way, axis=0).T).sum() == pytest.approx(trip.planned, rel=2e-3)
    assert motion.plans() == []

    motion.depart(breaks, (5.0, 1.0))
    motion.advance(motion.now + 1.5)
    motion.depart(two, (8.0, 1.0))
    motion.plans()
    motion.halt(breaks)  # somewhere on the other's way
    motion.advance(inf)
    again = [way for robot, way in motion.plans() if robot == two.id]
    assert all(dist(way[-1], (8.0, 1.0)) < 1e-6 for way in again)


def test_without_an_interval_there_are_no_samples(driving):
    motion, (robot,) = driving([(1.0, 1.0)], SPEC)
    motion.depart(robot, (3.0, 1.0))
    motion.advance(inf)
    assert motion.samples().shape == (0, 8)
    assert motion.plans() == []


def test_many_samples_fit(driving):
    points = [(0.5 + k % 10, 0.5 + k // 10) for k in range(60)]
    motion, robots = driving(points, SPEC, interval=0.01)
    for robot in robots:
        motion.depart(robot, (robot.position[0], robot.position[1] + 0.45))
    trips = []
    while motion.moving:
        trips += motion.advance(inf)
    rows = motion.samples()
    assert len(rows) == sum(trip.steps for trip in trips) > 1024


def test_long_trips_and_many_pieces_fit(driving):
    arena = Arena(200.0, 5.0)
    columns = [[0.1 + 0.21 * k for k in range(20)], [4.9 - 0.21 * k for k in range(20)]]
    slalom = [(x, y) for k, x in enumerate(range(10, 200, 8)) for y in columns[k % 2]]
    motion, robots = driving([(1.0, 2.0), *slalom], SPEC, arena)
    plan = motion._planner.plan(0, (1.0, 2.0), (199.0, 2.0))
    assert len(plan.segments) > 32
    motion.depart(robots[0], (199.0, 2.0))
    motion.depart(robots[1], (8.0, 1.0))
    trips = []
    while motion.moving:
        trips += motion.advance(inf)
    assert [trip.outcome for trip in trips] == ["arrived", "arrived"]
    assert trips[1].path == pytest.approx(plan.length)
    assert trips[1].ended > 200.0


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"dt": 0.0}, "dt is 0.0; expected more than 0"),
        ({"dt": 0.2}, "dt is 0.2 s; expected 0.0001 to 0.1"),
        ({"traffic": "wild"}, "traffic is 'wild'; expected 'reserved' or 'free'"),
        ({"belief": "hope"}, "belief is 'hope'; expected 'straight' or 'path'"),
        ({"clearances": ()}, r"clearances are \(\); expected"),
        ({"clearances": (0.03, -0.1)}, "expected numbers above 0"),
        ({"per_metre": 0.0}, "per_metre is 0.0 J; expected more than 0"),
        ({"per_launch": -1.0}, "per_launch is -1.0 J; expected 0 or more"),
        ({"headway": 0.0}, "headway is 0.0; expected more than 0"),
        ({"replans": -1}, "replans is -1; expected 0 or more"),
    ],
)
def test_bad_options_are_refused(keys, message):
    with pytest.raises(ValueError, match=message):
        DriveOptions(**keys)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"drive": "legs"}, "drive is 'legs'; expected 'differential' or 'holonomic'"),
        ({"track": 0.5}, "track is 0.5; expected more than 0, at most 0.2"),
        ({"acceleration": 0.0}, "acceleration is 0.0; expected more than 0"),
    ],
)
def test_bad_robots_are_refused(keys, message):
    with pytest.raises(ValueError, match=message):
        RobotSpec(**keys)


def test_bad_extra_power_is_refused():
    with pytest.raises(ValueError, match=r"idle power is -1.0; expected 0 or more"):
        ExtraPower(idle=-1.0)


def test_clearances_leave_room_for_what_a_robot_strays():
    rungs = (0.03, 0.015, 0.005)
    assert ladder_of(SPEC, DriveOptions()) == (*rungs, margin_of(SPEC))
    unknown = replace(SPEC, error=0.2)
    assert ladder_of(unknown, DriveOptions()) == (*rungs[:2], margin_of(unknown))
    assert ladder_of(SPEC, DriveOptions(clearances=(0.05,))) == (0.05,)


def test_wide_arcs_are_tried_first_where_narrow_ones_are_slow():
    slow = replace(SPEC, turn_rate=2.0)
    assert ladder_of(slow, DriveOptions())[0] == pytest.approx(0.76 / (0.95 * 2.0) - 0.2)
    assert ladder_of(replace(slow, drive="holonomic"), DriveOptions())[0] == 0.03
    slippery = replace(SPEC, traction=0.3)
    assert ladder_of(slippery, DriveOptions())[0] == pytest.approx(0.76**2 / (0.15 * 9.81) - 0.2)


@pytest.mark.parametrize("name", ["path", "physics"])
@pytest.mark.parametrize("preset", PRESETS)
def test_the_catalogue_makes_them(name, preset, crowd):
    entry = MOTIONS[name]
    motion = entry.function(PRESETS[preset], Arena(), entry.options(), None, None)
    assert isinstance(motion, DrivenMotion)
    assert entry.solid
