"""The drive: what a trip costs and takes, against the closed form and a slow integrator."""

from __future__ import annotations

from dataclasses import replace
from math import dist, hypot, inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet.motion.kernels.records import ARC, LINE
from fleet.power import ExtraPower, PowerModel
from fleet.robot import PRESETS, RobotSpec
from worlds.arena import Arena
from worlds.shapes import Polygon

SPEC = RobotSpec(capacity=1e4)
POWER = SPEC.power
EQ1 = POWER.per_metre(SPEC.cruise)
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


def integral(power, a, b, time):
    """The integral of P over ``time`` in which the speed changes evenly from a to b."""
    return time * (
        power.quadratic * (a * a + a * b + b * b) / 3.0
        + power.linear * (a + b) / 2.0
        + power.constant
    )


@given(spot, far, st.floats(-3.1, 3.1), st.floats(0.2, 5.0), st.floats(1.0, 20.0))
@settings(max_examples=60, deadline=None)
def test_a_straight_trip_is_a_pivot_and_a_trapezoid(driving, start, site, heading, rate, turning):
    spec = replace(SPEC, acceleration=rate, turn_acceleration=turning)
    trip = trip_of(driving, start, site, spec, heading=heading)
    angle = abs(np.angle(np.exp(1j * (np.arctan2(*np.subtract(site, start)[::-1]) - heading))))
    _, turn_ramp, turn_even = trapezoid(angle, spec.turn_rate, spec.turn_acceleration)
    peak, ramp, even = trapezoid(dist(start, site), spec.cruise, spec.acceleration)
    pivot = POWER.constant * (2.0 * turn_ramp + turn_even)
    drive = 2.0 * integral(POWER, 0.0, peak, ramp) + integral(POWER, peak, peak, even)
    assert trip.outcome == "arrived"
    assert trip.end == pytest.approx(site, abs=1e-9)
    assert trip.path == pytest.approx(dist(start, site), abs=1e-9)
    assert trip.energy_pivots == pytest.approx(pivot, rel=1e-6, abs=3e-4)
    assert trip.energy == pytest.approx(pivot + drive, rel=1e-5)
    assert trip.energy_path == pytest.approx(EQ1 * dist(start, site))
    assert trip.energy_ramps == pytest.approx(drive - trip.energy_path, abs=1e-4)
    time = 2.0 * (turn_ramp + ramp) + turn_even + even
    assert 0.0 <= trip.ended - trip.departed - time < 1.0 / 60.0 + 1e-6


def slow_integral(segments, spec, ds=2e-4):
    """Energy and time of driving along segments, by a forward and a backward pass over samples."""
    limit, count = [], []
    for segment in segments:
        top = spec.cruise
        if segment["kind"] == ARC:
            top = min(top, 0.95 * spec.turn_rate * segment["radius"])
        count.append(max(2, int(segment["length"] / ds)))
        limit += [top] * count[-1]
    steps = np.repeat([p["length"] / n for p, n in zip(segments, count, strict=True)], count)
    square = np.array([*limit, limit[-1]]) ** 2
    square[1:-1] = np.minimum(square[1:-1], square[:-2])
    square[0] = square[-1] = 0.0
    for k, step in enumerate(steps):
        square[k + 1] = min(square[k + 1], square[k] + 2.0 * spec.acceleration * step)
    for k in range(len(steps) - 1, -1, -1):
        square[k] = min(square[k], square[k + 1] + 2.0 * spec.acceleration * steps[k])
    speed = np.sqrt(square)
    times = 2.0 * steps / (speed[:-1] + speed[1:])
    energy = sum(
        integral(spec.power, a, b, t) for a, b, t in zip(speed[:-1], speed[1:], times, strict=True)
    )
    return energy, times.sum()


@pytest.mark.parametrize("preset", ["small", "pioneer"])
@pytest.mark.parametrize("seed", range(6))
def test_a_trip_around_others_costs_what_a_slow_integrator_says(crowd, preset, seed):
    spec = replace(PRESETS[preset], capacity=1e4)
    motion, robots, rng = crowd(60, seed, spec)
    arcs = 0
    for _ in range(6):
        robot = robots[int(rng.integers(60))]
        site = tuple(rng.uniform(0.3, 9.7, 2).tolist())
        plan = motion._planner.plan(robot.id, robot.position, site)
        motion.depart(robot, site)
        (trip,) = motion.advance(inf)
        if plan.segments is None or trip.path < 0.01:
            continue
        arcs += sum(segment["kind"] == ARC for segment in plan.segments)
        energy, _ = slow_integral(plan.segments, spec)
        assert trip.energy - trip.energy_pivots == pytest.approx(energy, rel=2e-3)
        assert trip.path == pytest.approx(plan.length, abs=1e-6)
    assert arcs


def test_without_inertia_a_trip_costs_eq_1(driving):
    ideal = replace(PRESETS["ideal"], capacity=1e4)
    for site in ((9.0, 2.0), (1.5, 1.0), (4.0, 9.0)):
        trip = trip_of(driving, (1.0, 1.0), site, ideal)
        assert trip.energy == pytest.approx(EQ1 * dist((1.0, 1.0), site), rel=1e-3)
    sharp = replace(ideal, acceleration=1e9)
    trip = trip_of(driving, (1.0, 1.0), (9.0, 2.0), sharp)
    assert trip.energy == pytest.approx(EQ1 * dist((1.0, 1.0), (9.0, 2.0)), rel=1e-8)


@pytest.mark.parametrize("preset", ["small", "pioneer", "ideal"])
def test_the_step_does_not_matter(crowd, preset):
    spec = replace(PRESETS[preset], capacity=1e4)
    energies = []
    for dt in (1.0 / 240.0, 1.0 / 60.0, 1.0 / 30.0):
        motion, robots, rng = crowd(80, 3, spec, dt=dt)
        found = []
        for _ in range(40):
            motion.depart(robots[int(rng.integers(80))], tuple(rng.uniform(0.3, 9.7, 2).tolist()))
            found += [trip.energy for trip in motion.advance(inf)]
        energies.append(np.array(found))
    for other in energies[1:]:
        assert energies[0] == pytest.approx(other, rel=1e-9)


@given(spot, far, st.sampled_from([None, BLOCK]), st.floats(2.0, 150.0))
@settings(max_examples=40, deadline=None)
def test_a_battery_runs_empty_to_the_last_joule(driving, start, site, arena, charge):
    trip = trip_of(driving, start, site, arena=arena, heading=2.0, charge=charge)
    if trip.outcome == "arrived":
        assert trip.energy <= charge
        return
    assert trip.outcome == "battery empty"
    assert trip.energy == charge
    rich = trip_of(driving, start, site, arena=arena, heading=2.0, charge=1e4)
    assert rich.outcome == "arrived"
    assert rich.energy > charge
    assert trip.path < rich.path
    parts = (
        trip.energy_path + trip.energy_ramps + trip.energy_pivots
        + trip.energy_waiting + trip.energy_contact
    )  # fmt: skip
    assert parts == pytest.approx(charge, rel=1e-12)


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
        still = speeds < 1e-9
        spins = np.diff(turns)[still[1:] & still[:-1]]
        assert np.abs(spins).max(initial=0.0) <= spec.turn_acceleration * dt * (1.0 + 1e-6)


def test_a_robot_that_can_reverse_turns_less(driving):
    start, site = (5.0, 5.0), (2.0, 5.0)
    forwards = trip_of(driving, start, site)
    reverse = trip_of(driving, start, site, replace(SPEC, reverse=True))
    assert forwards.energy_pivots > 5.0
    assert reverse.energy_pivots == 0.0
    assert reverse.energy == pytest.approx(forwards.energy - forwards.energy_pivots)
    around = trip_of(driving, (3.0, 5.0), (8.0, 5.1), replace(SPEC, reverse=True), BLOCK, pi)
    ahead = trip_of(driving, (3.0, 5.0), (8.0, 5.1), replace(SPEC, reverse=True), BLOCK, 0.0)
    assert around.energy == pytest.approx(ahead.energy)


def test_a_holonomic_robot_never_turns(driving):
    spec = replace(SPEC, drive="holonomic")
    motion, (robot,) = driving([(3.0, 5.0)], spec, BLOCK, headings=[0.7])
    motion.depart(robot, (8.0, 5.1))
    (trip,) = motion.advance(inf)
    assert trip.energy_pivots == 0.0
    assert robot.heading == 0.7
    assert trip.outcome == "arrived"


def test_kinetic_energy_is_paid_at_every_launch(driving):
    plain = trip_of(driving, (1.0, 1.0), (8.0, 1.0))
    paid = trip_of(driving, (1.0, 1.0), (8.0, 1.0), replace(SPEC, extra=ExtraPower(kinetic=True)))
    assert paid.energy - plain.energy == pytest.approx(0.5 * SPEC.mass * SPEC.cruise**2)
    assert paid.energy_ramps - plain.energy_ramps == pytest.approx(paid.energy - plain.energy)


def test_wheels_pay_for_turning(driving):
    wheels = replace(SPEC, extra=ExtraPower(per_wheel=True))
    straight = trip_of(driving, (1.0, 1.0), (8.0, 1.0), wheels)
    assert straight.energy == pytest.approx(trip_of(driving, (1.0, 1.0), (8.0, 1.0)).energy)
    turning = trip_of(driving, (5.0, 1.0), (1.0, 1.0), wheels)
    rate = sqrt(SPEC.turn_acceleration * pi)
    wheel, ramp = rate * SPEC.wheel_track / 2.0, rate / SPEC.turn_acceleration
    assert turning.energy_pivots == pytest.approx(2.0 * integral(POWER, 0.0, wheel, ramp))
    bent = trip_of(driving, (3.0, 5.0), (8.0, 5.1), wheels, BLOCK)
    plain = trip_of(driving, (3.0, 5.0), (8.0, 5.1), SPEC, BLOCK)
    assert bent.energy_ramps > plain.energy_ramps


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
        assert late.energy_waiting == pytest.approx(idle * late.waited)


def test_a_power_model_of_ones_own_is_used(driving):
    spec = replace(SPEC, power=PowerModel(0.0, 2.0, 0.0), turn_acceleration=50.0)
    trip = trip_of(driving, (1.0, 1.0), (4.0, 5.0), spec, heading=1.0)
    assert trip.energy == pytest.approx(2.0 * 5.0)


def test_lines_and_arcs_are_what_plans_are_made_of(crowd):
    motion, robots, _ = crowd(100, 8)
    kinds = set()
    for robot in robots[:30]:
        plan = motion._planner.plan(robot.id, robot.position, (5.0, 5.0))
        kinds |= {int(segment["kind"]) for segment in plan.segments}
    assert kinds == {LINE, ARC}
    assert hypot(*np.subtract(plan.goal, (5.0, 5.0))) < 0.5
