"""The prediction: what a trip costs and takes, against closed forms and a slow integrator."""

from __future__ import annotations

from dataclasses import replace
from math import dist, fsum, hypot, inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet.motion.builds import resistance_of
from fleet.motion.kernels.records import ARC, LINE
from fleet.power import ExtraPower, PowerModel
from fleet.robot import PRESETS, RobotSpec
from worlds.arena import Arena
from worlds.shapes import Polygon

SPEC = RobotSpec(capacity=1e4)
EQ1 = SPEC.power.per_metre(SPEC.cruise)
BLOCK = Arena(obstacles=(Polygon(((4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0))),))
spot = st.tuples(st.floats(0.5, 3.5), st.floats(0.5, 9.5))
far = st.tuples(st.floats(6.5, 9.5), st.floats(0.5, 9.5))


def trip_of(driving, start, site, spec=SPEC, arena=None, heading=0.0, **keys):
    motion, (robot,) = driving([start], spec, arena, headings=[heading], **keys)
    motion.depart(robot, site)
    (trip,) = motion.advance(inf)
    return trip


def trapezoid(length, top, rate):
    """Peak speed, time to speed up, and time at the peak, from rest to rest."""
    peak = min(top, sqrt(rate * length))
    return peak, peak / rate, (length - peak * peak / rate) / peak if length else 0.0


def slow(spec, length, top, rate, force, drag, still):
    """∫P dt [J] of a trapezoid: both wheels push with force(acceleration) + drag(speed) [N] at
    this speed, each half of it, or hold back; ``still`` [W] comes on top.
    """
    peak, ramp, even = trapezoid(length, top, rate)
    energy = 0.0
    for change, time in ((rate, ramp), (0.0, even), (-rate, ramp)):
        at = (np.arange(4000) + 0.5) * time / 4000
        speed = peak + 0.0 * at
        if change:
            speed = change * at if change > 0.0 else peak + change * at
        push = force(change) + drag(speed)
        power = np.where(push > 0.0, push * speed / spec.efficiency, 0.0)
        power += spec.windings * push**2 / 2.0 + still
        energy += power.mean() * time
    return energy


@given(spot, far, st.floats(-3.1, 3.1), st.floats(0.2, 3.0), st.floats(1.0, 20.0))
@settings(max_examples=40, deadline=None)
def test_a_straight_trip_is_a_pivot_and_a_trapezoid(driving, start, site, heading, rate, turning):
    spec = replace(SPEC, acceleration=rate, turn_acceleration=turning)
    trip = trip_of(driving, start, site, spec, heading=heading)
    angle = abs(np.angle(np.exp(1j * (np.arctan2(*np.subtract(site, start)[::-1]) - heading))))
    rolling, viscous, electronics = resistance_of(spec)
    drive = slow(
        spec, dist(start, site), spec.cruise, rate, lambda a: spec.mass * a,
        lambda v: rolling + viscous * v, electronics,
    )  # fmt: skip
    half = spec.wheel_track / 2.0
    inertia = spec.mass * spec.radius**2 / 2.0
    pivot = slow(
        spec, half * angle, half * spec.turn_rate, half * turning,
        lambda a: inertia * a / half**2 + spec.scrub / half, lambda v: rolling + viscous * v,
        electronics,
    )  # fmt: skip
    assert trip.outcome == "arrived"
    assert trip.end == pytest.approx(site, abs=1e-9)
    assert trip.path == pytest.approx(dist(start, site), abs=1e-9)
    assert trip.energy == pytest.approx(drive + pivot, rel=0.005, abs=0.15)
    _, turn_ramp, turn_even = trapezoid(angle, spec.turn_rate, turning)
    _, ramp, even = trapezoid(dist(start, site), spec.cruise, rate)
    time = 2.0 * (turn_ramp + ramp) + turn_even + even
    assert 0.0 <= trip.ended - trip.departed - time < 2.0 / 60.0 + 1e-6


@pytest.mark.parametrize("engine", [True, False])
@pytest.mark.parametrize("preset", PRESETS)
def test_steady_straight_driving_costs_eq_1(driving, preset, engine):
    spec = replace(PRESETS[preset], capacity=1e5)
    arena = Arena(60.0, 4.0)
    short, long = (
        trip_of(driving, (1.0, 2.0), (1.0 + far, 2.0), spec, arena, engine=engine)
        for far in (10.0 * spec.cruise, 60.0 * spec.cruise)
    )
    eq1 = spec.power.per_metre(spec.cruise)
    more = 50.0 * spec.cruise
    assert long.energy - short.energy == pytest.approx(eq1 * more, rel=1e-9)
    assert long.path - short.path == pytest.approx(more, rel=1e-9)


def test_any_power_model_is_kept(driving):
    for power in (
        PowerModel(0.0, 12.0, 3.0),
        PowerModel(20.0, 0.0, 1.0),
        PowerModel(3.0, 5.0, 0.5),
    ):
        spec = replace(SPEC, power=power, windings=0.005)
        energies = [
            trip_of(driving, (1.0, 2.0), (x, 2.0), spec, Arena(60.0, 4.0), engine=True).energy
            for x in (10.12, 48.12)
        ]
        assert energies[1] - energies[0] == pytest.approx(power.per_metre(0.76) * 38.0, rel=1e-9)


def test_without_inertia_a_trip_costs_eq_1(driving):
    ideal = replace(PRESETS["ideal"], capacity=1e4)
    for engine in (True, False):
        for dt, near in ((1.0 / 60.0, 0.005), (1.0 / 480.0, 0.001)):
            for site in ((9.0, 2.0), (4.0, 9.0)):
                trip = trip_of(driving, (1.0, 1.0), site, ideal, engine=engine, dt=dt)
                assert trip.energy == pytest.approx(EQ1 * dist((1.0, 1.0), site), rel=near)


@pytest.mark.parametrize("preset", PRESETS)
def test_accounts_add_up_to_what_was_drained(crowd, preset):
    spec = replace(PRESETS[preset], capacity=1e5)
    motion, robots, rng = crowd(8, 2, spec)
    for robot in robots:
        motion.depart(robot, tuple(rng.uniform(0.7, 9.3, 2).tolist()))
        (trip,) = motion.advance(inf)
        assert fsum(trip.accounts) == pytest.approx(trip.energy, abs=1e-9)
        assert trip.accounts.slip == trip.accounts.contact == 0.0
        assert min(trip.accounts) >= -1e-9


@given(spot, far, st.sampled_from([None, BLOCK]), st.floats(2.0, 150.0), st.booleans())
@settings(max_examples=30, deadline=None)
def test_a_battery_runs_empty_to_the_last_joule(driving, start, site, arena, charge, engine):
    keys = {"arena": arena, "heading": 2.0, "engine": engine}
    trip = trip_of(driving, start, site, charge=charge, **keys)
    assert fsum(trip.accounts) == pytest.approx(trip.energy, abs=1e-9)
    if trip.outcome == "arrived":
        assert trip.energy <= charge
        return
    assert trip.outcome == "battery empty"
    assert trip.energy == charge
    rich = trip_of(driving, start, site, charge=1e4, **keys)
    assert rich.outcome == "arrived"
    assert rich.energy > charge
    assert trip.path < rich.path


def test_speed_and_acceleration_stay_within_the_robot(crowd):
    motion, robots, rng = crowd(80, 5, SPEC, interval=0.01)
    dt, spec = motion.options.dt, motion.spec
    for _ in range(30):
        robot = robots[int(rng.integers(80))]
        before, heading = robot.position, robot.heading
        motion.depart(robot, tuple(rng.uniform(0.3, 9.7, 2).tolist()))
        motion.advance(inf)
        rows = motion.samples()
        if not len(rows):
            continue
        places = np.vstack([before, rows[:, 2:4]])
        speeds = np.hypot(*np.diff(places, axis=0).T) / dt
        assert speeds.max() <= spec.cruise * (1.0 + 1e-9)
        assert np.abs(np.diff([0.0, *speeds])).max() <= spec.acceleration * dt * 1.01
        turns = np.diff(np.unwrap([heading, *rows[:, 4]])) / dt
        assert np.abs(turns).max() <= spec.turn_rate * (1.0 + 1e-9)


def test_wheels_that_are_weak_are_asked_for_less(driving):
    """Speeding up stays within what motors can give and the floor can hold."""
    for spec, most in (
        (replace(SPEC, mass=30.0, motor=12.0), 1.6 * (12.0 - 4.4) / 30.0),
        (replace(SPEC, traction=0.15), 0.8 * 0.6 * 0.15 * 9.81),
    ):
        motion, (robot,) = driving([(1.0, 1.0)], spec, interval=0.01)
        motion.depart(robot, (8.0, 1.0))
        motion.advance(inf)
        speeds = np.diff(motion.samples()[:, 2]) * 60.0
        assert np.diff(speeds).max() * 60.0 == pytest.approx(most, rel=0.02)


def test_a_robot_that_can_reverse_turns_less(driving):
    start, site = (5.0, 5.0), (2.0, 5.0)
    backwards = replace(SPEC, reverse=True)
    for engine in (True, False):
        forwards = trip_of(driving, start, site, engine=engine)
        reverse = trip_of(driving, start, site, backwards, engine=engine)
        ahead = trip_of(driving, start, site, heading=pi, engine=engine)
        assert reverse.energy == pytest.approx(ahead.energy, rel=1e-6)
        assert reverse.energy < forwards.energy - 4.0
        assert reverse.path == pytest.approx(3.0, abs=1e-3)
        around = trip_of(driving, (3.0, 5.0), (8.0, 5.1), backwards, BLOCK, pi, engine=engine)
        other = trip_of(driving, (3.0, 5.0), (8.0, 5.1), backwards, BLOCK, 0.0, engine=engine)
        assert around.outcome == "arrived"
        assert around.energy == pytest.approx(other.energy, rel=1e-3)


def test_a_holonomic_robot_never_turns(driving):
    spec = replace(SPEC, drive="holonomic")
    for engine in (True, False):
        motion, (robot,) = driving([(3.0, 5.0)], spec, BLOCK, headings=[0.7], engine=engine)
        motion.depart(robot, (8.0, 5.1))
        (trip,) = motion.advance(inf)
        assert robot.heading == pytest.approx(0.7)
        assert trip.accounts.scrub == 0.0
        assert trip.outcome == "arrived"


def test_waiting_costs_idle_power_only(driving):
    for idle in (0.0, 2.0):
        spec = RobotSpec(capacity=1e4, extra=ExtraPower(idle=idle))
        motion, (one, two) = driving([(1.0, 1.0), (5.0, 3.0)], spec, headings=[0.0, -pi / 2])
        motion.depart(one, (9.0, 1.0))
        motion.advance(2.6)
        motion.depart(two, (5.0, 0.2))
        trips = []
        while motion.moving:
            trips += motion.advance(inf)
        (late,) = (trip for trip in trips if trip.robot == 1)
        assert late.waited > 0.2
        assert late.accounts.waiting == pytest.approx(idle * late.waited)


def test_lines_and_arcs_are_what_plans_are_made_of(crowd):
    motion, robots, _ = crowd(100, 8)
    kinds = set()
    for robot in robots[:30]:
        plan = motion._planner.plan(robot.id, robot.position, (5.0, 5.0))
        kinds |= {int(segment["kind"]) for segment in plan.segments}
    assert kinds == {LINE, ARC}
    assert hypot(*np.subtract(plan.goal, (5.0, 5.0))) < 0.5
