"""The paper's motion: positions are a function of time, energy is Eq. (1)."""

from __future__ import annotations

from math import dist, inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fleet.motion.straight import StraightMotion
from fleet.power import Battery
from fleet.robot import Robot, RobotSpec

SPEC = RobotSpec()
PER_METRE = SPEC.power.per_metre(SPEC.cruise)
place = st.tuples(st.floats(0.0, 10.0), st.floats(0.0, 10.0))


def fleet(*positions, charge=100.0, interval=None):
    motion = StraightMotion(SPEC, interval)
    robots = [
        Robot(id, position, 0.0, Battery(charge), 2.5, [{}] * len(positions), motion)
        for id, position in enumerate(positions)
    ]
    motion.place(robots)
    return motion, robots


@given(place, place, st.floats(1.0, 300.0))
def test_a_trip_costs_eq_1_or_all_there_is(start, site, charge):
    motion, (robot,) = fleet(start, charge=charge)
    believed = robot.cost_to(site)
    motion.depart(robot, site)
    (trip,) = motion.advance(inf)
    assert robot.position == trip.end
    assert trip.energy + robot.battery.charge == pytest.approx(charge, abs=1e-9)
    if believed <= charge:
        assert trip.outcome == "arrived"
        assert robot.position == site
        assert trip.energy == believed
        assert motion.now == pytest.approx(dist(start, site) / SPEC.cruise)
    else:
        assert trip.outcome == "battery empty"
        assert robot.battery.charge == 0.0
        assert trip.path == pytest.approx(charge / PER_METRE)


def test_advancing_in_slices_is_the_same_as_at_once():
    whole, (a,) = fleet((1.0, 1.0), interval=0.1)
    sliced, (b,) = fleet((1.0, 1.0), interval=0.1)
    for motion, robot in ((whole, a), (sliced, b)):
        motion.depart(robot, (4.0, 5.0))
    (trip,) = whole.advance(inf)
    trips = []
    while not trips:
        trips = sliced.advance(sliced.now + 0.37)
        if not trips:
            share = sliced.now * SPEC.cruise / 5.0
            assert b.position == pytest.approx((1.0 + 3.0 * share, 1.0 + 4.0 * share))
            assert b.battery.charge == pytest.approx(100.0 - 5.0 * share * PER_METRE)
    assert trips == [trip]
    np.testing.assert_array_equal(whole.samples(), sliced.samples())


def test_samples_follow_the_robot_to_its_end():
    motion, (robot,) = fleet((0.0, 0.0), interval=0.25)
    motion.depart(robot, (1.0, 0.0))
    motion.advance(inf)
    rows = motion.samples()
    assert rows[:-1, 1] == pytest.approx([0.25, 0.5, 0.75, 1.0, 1.25])
    assert rows[:, 2] == pytest.approx(rows[:, 1] * SPEC.cruise)
    assert rows[-1, 2] == 1.0
    assert rows[-1, 5] == robot.battery.charge
    assert len(motion.samples()) == 0


def test_trips_end_in_the_order_of_time():
    motion, (near, far) = fleet((0.0, 0.0), (9.0, 0.0))
    motion.depart(far, (5.0, 0.0))
    motion.depart(near, (1.0, 0.0))
    assert [trip.robot for trip in motion.advance(inf)] == [0]
    assert list(motion.moving) == [far]
    assert [trip.robot for trip in motion.advance(inf)] == [1]
    assert not motion.moving


def test_a_clock_without_robots_just_goes_on():
    motion, _ = fleet((0.0, 0.0))
    assert motion.advance(7.0) == []
    assert motion.now == 7.0


def test_a_robot_whose_motor_fails_stops_where_it_is():
    motion, (robot,) = fleet((0.0, 0.0))
    motion.depart(robot, (5.0, 0.0))
    motion.advance(2.0)
    motion.halt(robot)
    (trip,) = motion.advance(inf)
    assert trip.outcome == "broken down"
    assert trip.end == robot.position == pytest.approx((2.0 * SPEC.cruise, 0.0))
    assert trip.energy == pytest.approx(2.0 * SPEC.cruise * PER_METRE)
