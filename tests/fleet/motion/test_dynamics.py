"""What happens: bodies that wheels push differ from the prediction, and from one another."""

from __future__ import annotations

from dataclasses import replace
from math import dist, fsum, inf, pi

import numpy as np
import pymunk
import pytest
from gaps import least_gap
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet.motion.builds import builds_of, resistance_of
from fleet.motion.engine import Engine
from fleet.motion.params import limits_of, margin_of
from fleet.power import Battery
from fleet.robot import PRESETS, Robot, RobotSpec
from worlds.arena import Arena
from worlds.catalogue import WORLDS

SPEC = RobotSpec(capacity=1e5)
ARENAS = [None, *(WORLDS[name].function().arena for name in ("pit", "rooms", "warehouse"))]


def trip_of(driving, spec=SPEC, start=(1.0, 5.0), site=(5.0, 5.0), heading=0.0, **keys):
    motion, (robot,) = driving([start], spec, headings=[heading], engine=True, **keys)
    motion.depart(robot, site)
    (trip,) = motion.advance(inf)
    return trip


def trips_of(crowd, spec, robots, count, seed, arena=None, **keys):
    """Trips to random sites, one after the other, what was bid for each, and the worst distance
    from the plan at any step [m].
    """
    keys = {"engine": True, "interval": 0.001, "belief": "driven"} | keys
    motion, fleet, rng = crowd(robots, seed, replace(spec, capacity=1e7), arena, **keys)
    trips, bids, off = [], [], 0.0
    for _ in range(count):
        robot = fleet[int(rng.integers(robots))]
        site = tuple(rng.uniform(0.7, 9.3, 2).tolist())
        bid = robot.cost_to(site)
        if not 0.0 < bid < inf:
            continue
        motion.depart(robot, site)
        trips += motion.advance(inf)
        bids.append(bid)
        rows = motion.samples()
        off = max(off, np.hypot(*(rows[:, 2:4] - rows[:, 6:8]).T).max(initial=0.0))
    return trips, np.array(bids), off


@pytest.mark.parametrize(
    ("preset", "robots", "near"),
    [("small", 100, 0.003), ("pioneer", 20, 0.003), ("husky", 8, 0.01)],
)
def test_the_prediction_is_near_what_happens(crowd, preset, robots, near):
    for seed in range(2):
        trips, bids, off = trips_of(crowd, PRESETS[preset], robots, 60, seed)
        energies = np.array([trip.energy for trip in trips])
        assert {trip.outcome for trip in trips} == {"arrived"}
        assert np.abs(energies / bids - 1.0).max() < near
        assert (energies != bids).all()
        assert off < margin_of(PRESETS[preset])
        for trip in trips:
            assert fsum(trip.accounts) == pytest.approx(trip.energy, abs=1e-9)
            assert trip.contacts == 0


def test_heavier_robots_cost_more_and_a_payload_more_still(driving):
    """Eq. (1) is calibrated for any mass: what more mass costs is launching it."""
    energies = [
        trip_of(driving, replace(SPEC, mass=mass)).energy for mass in (3.0, 9.0, 20.0, 40.0)
    ]
    assert energies == sorted(energies)
    assert energies[3] > energies[1] + 5.0
    loaded = trip_of(driving, replace(SPEC, payload=11.0))
    heavy = trip_of(driving, replace(SPEC, mass=20.0))
    assert loaded.energy > heavy.energy + 10.0  # it presses on the wheels all the way
    assert loaded.outcome == "arrived"


def test_scrub_costs_pivots_and_nothing_else(driving):
    twice = replace(SPEC, scrub=2.0 * SPEC.scrub)
    straight = [trip_of(driving, spec) for spec in (SPEC, twice)]
    assert straight[0].energy == pytest.approx(straight[1].energy, abs=1e-6)
    turning = [trip_of(driving, spec, heading=pi / 2) for spec in (SPEC, twice)]
    scrub = [trip.accounts.scrub for trip in turning]
    assert scrub[0] == pytest.approx(SPEC.scrub * pi / 2 / SPEC.efficiency, rel=0.01)
    assert scrub[1] == pytest.approx(2.0 * scrub[0], rel=0.01)
    others = [trip.energy - trip.accounts.scrub - trip.accounts.windings for trip in turning]
    assert others[0] == pytest.approx(others[1], rel=0.002)


@pytest.mark.parametrize("drive", ["differential", "holonomic"])
def test_a_slippery_floor_that_is_known_is_slower(crowd, drive):
    firm, icy = (
        trips_of(crowd, replace(SPEC, traction=traction, drive=drive), 60, 20, 1, belief="straight")
        for traction in (0.7, 0.1)
    )
    for one, other in zip(firm[0], icy[0], strict=True):
        assert other.outcome == one.outcome == "arrived"
        assert other.contacts == 0
    assert sum(t.ended - t.departed for t in icy[0]) > sum(t.ended - t.departed for t in firm[0])


@pytest.mark.parametrize("drive", ["differential", "holonomic"])
def test_ice_that_nobody_knows_of_is_slower_and_dearer(driving, drive):
    """Wheels spin, the ledger still closes, and nobody ends in a wall."""
    spec = replace(SPEC, drive=drive, acceleration=2.0)
    trips = []
    for grip in (None, 4.0):
        motion, (robot,) = driving([(1.0, 5.0)], spec, engine=True, traffic="free")
        motion.depart(robot, (4.0, 5.0))
        if grip is not None:
            motion._movers.traffic.builds["grip"][0] = grip  # [N] of a wheel
        trips += motion.advance(inf)
        assert 0.1 <= robot.position[0] <= 9.9
    firm, icy = trips
    assert firm.accounts.slip == pytest.approx(0.0, abs=1e-9)
    assert icy.accounts.slip > 0.1
    assert icy.energy > 1.01 * firm.energy
    assert icy.ended > firm.ended
    assert fsum(icy.accounts) == pytest.approx(icy.energy, abs=1e-9)


@pytest.mark.parametrize("preset", ["small", "pioneer", "husky"])
def test_finer_steps_change_little(crowd, preset):
    robots = {"small": 60, "pioneer": 20, "husky": 8}[preset]
    default, fine = (
        trips_of(crowd, PRESETS[preset], robots, 25, 3, belief="path", dt=dt)[0]
        for dt in (1.0 / 60.0, 1.0 / 480.0)
    )
    energies = [np.array([trip.energy for trip in trips]) for trips in (default, fine)]
    assert energies[0].sum() == pytest.approx(energies[1].sum(), rel=0.005)
    if preset != "husky":  # whose pivots are most of it
        assert energies[0] == pytest.approx(energies[1], rel=0.015)


@pytest.mark.parametrize(
    ("drive", "push", "spin"),
    [
        ("differential", (0.0, 0.5), 0.0),
        ("differential", (-0.5, 0.0), 0.0),
        ("differential", (0.0, 0.0), 6.0),
        ("differential", (0.3, -0.4), 3.0),
        ("holonomic", (0.0, 0.5), 0.0),
        ("holonomic", (-0.5, 0.0), 0.0),
    ],
)
def test_shoves_are_taken_back(driving, drive, push, spin):
    motion, (robot,) = driving(
        [(1.0, 5.0)], replace(SPEC, drive=drive), engine=True, traffic="free", interval=0.001
    )
    motion.depart(robot, (6.0, 5.0))
    motion.advance(3.0)
    body = motion._engine.bodies[0]
    body.velocity = (body.velocity[0] + push[0], body.velocity[1] + push[1])
    body.angular_velocity += spin
    motion.samples()
    (trip,) = motion.advance(inf)
    rows = motion.samples()
    off = np.hypot(*(rows[:, 2:4] - rows[:, 6:8]).T)
    assert trip.outcome == "arrived"
    assert dist(trip.end, (6.0, 5.0)) < 0.005
    assert 0.004 < off.max() < 0.12
    assert off[rows[:, 1] > 5.5].max() < 0.005


@pytest.mark.parametrize("aside", [0.0, 0.1])
def test_two_that_bump_without_motors_keep_their_momentum(aside):
    """A heavy body hits a light one, head on or on its side: no energy comes of it."""
    places = [(4.0, 5.0), (4.5, 5.0 + aside)]
    robots = [Robot(k, xy, 0.0, Battery(1.0), 1.0, [], None) for k, xy in enumerate(places)]
    builds = builds_of(SPEC, 2, np.random.default_rng(0))
    builds["mass"][:2] = 30.0, 5.0
    engine = Engine(Arena(), SPEC.radius, builds, robots)
    for body, speed in zip(engine.bodies, (0.7, -0.3), strict=True):
        body.body_type = pymunk.Body.DYNAMIC
        body.velocity = (speed, 0.0)

    def state():
        masses = [body.mass for body in engine.bodies]
        moved = [np.array(body.velocity) * body.mass for body in engine.bodies]
        return masses, sum(moved), sum(body.kinetic_energy for body in engine.bodies)

    masses, momentum, energy = state()
    for _ in range(120):
        engine.space.step(1.0 / 60.0)
    _, after, left = state()
    assert masses == pytest.approx([30.0, 5.0])
    assert after == pytest.approx(momentum, abs=1e-9)
    assert 0.0 < left < 0.99 * energy


def test_two_that_meet_lose_energy_and_their_accounts_close(driving):
    """One that drives hits one that drives."""
    spec = replace(SPEC, drive="holonomic")
    motion, robots = driving(
        [(2.0, 5.0), (5.0, 5.05)], spec, engine=True, traffic="free", replans=0
    )
    for robot, site in zip(robots, ((8.0, 5.0), (0.5, 5.05)), strict=True):
        motion.depart(robot, site)
    before = [robot.battery.charge for robot in robots]
    trips = []
    while motion.moving:
        trips += motion.advance(motion.now + 0.1)
    taken = fsum(trip.accounts.contact for trip in trips)
    assert taken > 0.1  # inelastic: contacts take energy, and never give it
    for robot, held, trip in zip(robots, before, sorted(trips), strict=True):
        assert trip.contacts > 0
        assert robot.battery.charge + trip.energy == pytest.approx(held, abs=1e-9)
        assert fsum(trip.accounts) == pytest.approx(trip.energy, abs=1e-9)


def test_a_robot_against_a_wall_stalls_and_heats(driving):
    """Its battery goes into windings and spinning wheels; nothing is pushed through."""
    motion, (robot,) = driving([(9.0, 5.0)], SPEC, engine=True, traffic="free", replans=0)
    motion.depart(robot, (9.8, 5.0))
    ways = motion._movers.traffic.references[:, :, 0]  # it believes the wall half a metre off
    ways[:] = np.where(ways > 9.0, 9.0 + 1.6 * (ways - 9.0), ways)
    (trip,) = motion.advance(inf)
    assert trip.outcome == "stuck"
    assert trip.contacts > 0
    assert robot.position[0] <= 9.9 + 0.001
    assert fsum(trip.accounts) == pytest.approx(trip.energy, abs=1e-9)
    assert trip.ended < 10.0


@pytest.mark.parametrize("drive", ["differential", "holonomic"])
def test_who_bumps_a_broken_robot_gets_away_or_is_stuck(driving, drive):
    for offset in (0.0, 0.05, 0.15):
        motion, (still, robot) = driving(
            [(5.0, 5.0 + offset), (2.0, 5.0)], replace(SPEC, drive=drive), engine=True,
            traffic="free", replans=3,
        )  # fmt: skip
        motion.depart(still, (5.0, 9.0))
        motion.depart(robot, (8.0, 5.0))
        motion.halt(still)
        trips = []
        while motion.moving:
            trips += motion.advance(motion.now + 1.0)
            assert motion.now < 60.0
        assert trips[-1].outcome in ("arrived", "stuck")
        assert fsum(trips[-1].accounts) == pytest.approx(trips[-1].energy, abs=1e-9)


def test_robots_differ_by_seed_and_their_controllers_do_not_know(crowd):
    spec = replace(SPEC, error=0.2)
    one, same, other = (builds_of(spec, 50, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert (one == same).all()
    assert (one[:-1] != other[:-1]).all()
    assert one[-1] == other[-1]
    for name in ("mass", "rolling", "viscous", "scrub", "grip"):
        share = one[name][:-1] / one[name][-1]
        assert 0.6 < share.min() < 0.9
        assert 1.1 < share.max() < 1.5
    energies = []
    for seed in (1, 2):
        motion, (robot, *_), _ = crowd(5, 0, spec, engine=True, rng=np.random.default_rng(seed))
        motion.depart(robot, (5.0, 5.0))
        energies += [trip.energy for trip in motion.advance(inf)]
    assert energies[0] != energies[1]


def test_true_parameters_off_by_a_fifth_stay_within_the_margin(crowd):
    spec = replace(SPEC, error=0.2)
    for seed in range(2):
        trips, _, off = trips_of(crowd, spec, 80, 60, seed, belief="straight")
        assert {trip.outcome for trip in trips} == {"arrived"}
        assert 0.0015 < off < margin_of(spec)


@given(
    st.integers(0, 2**31),
    st.floats(1.0, 60.0),
    st.floats(0.05, 0.3),
    st.floats(0.3, 0.95),
    st.floats(0.0, 1.0),
    st.floats(0.15, 1.0),
    st.floats(0.0, 1.0),
    st.floats(0.0, 0.3),
    st.sampled_from(["differential", "holonomic"]),
    st.booleans(),
    st.sampled_from(ARENAS),
)
@settings(max_examples=8, deadline=None)
def test_whatever_the_robot_the_ledger_closes_and_nobody_is_lost(
    crowd,
    seed,
    mass,
    radius,
    efficiency,
    regeneration,
    traction,
    scrub,
    error,
    drive,
    reverse,
    arena,
):
    spec = RobotSpec(
        mass=mass, radius=radius, efficiency=efficiency, regeneration=regeneration, motor=60.0,
        traction=traction, scrub=0.5 * scrub * traction * mass * radius, error=error, drive=drive,
        reverse=reverse, capacity=1e5,
    )  # fmt: skip
    try:
        limits_of(spec, resistance_of(spec))
    except ValueError:
        return
    motion, robots, rng = crowd(12, seed, spec, arena, engine=True)
    size = (motion._arena.width, motion._arena.height)
    for robot in robots:
        motion.depart(robot, tuple(rng.uniform(0.0, size).tolist()))
    while motion.moving:
        for trip in motion.advance(motion.now + 2.0):
            assert trip.outcome in ("arrived", "no path", "stuck")
            assert fsum(trip.accounts) == pytest.approx(trip.energy, abs=1e-9)
            assert min(trip.accounts.rolling, trip.accounts.viscous) >= -1e-9
            assert trip.accounts.slip >= -1e-4 * trip.energy  # side grip turns, but for rounding
        places = np.array([robot.position for robot in robots])
        assert least_gap(places, radius, motion._arena) > -0.001
        assert motion.now < 2000.0


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"motor": 2.0}, "robot motor is 2.0 N; at 0.76 m/s its resistance takes 4.25 N of each"),
        ({"scrub": 30.0}, "robot traction is 0.7; .* cannot turn against a scrub of 30.0 N·m"),
        (
            {"scrub": 5.0, "motor": 20.0},
            "robot motor is 20.0 N; .* enough for 33.3 N of each wheel",
        ),
        (
            {"windings": 20.0},
            "robot windings is 20.0 W/N²; .* power.constant, 3.66 W; expected less",
        ),
    ],
)
def test_robots_that_cannot_drive_are_refused(driving, keys, message):
    with pytest.raises(ValueError, match=message):
        driving([(1.0, 1.0)], replace(SPEC, **keys), engine=True)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"efficiency": 0.0}, "efficiency is 0.0; expected more than 0 to 1"),
        ({"regeneration": 1.5}, "regeneration is 1.5; expected 0 to 1"),
        ({"error": 0.7}, "error is 0.7; expected 0 to 0.5"),
        ({"payload": -1.0}, "payload is -1.0; expected 0 or more"),
        ({"traction": 0.0}, "traction is 0.0; expected more than 0"),
        ({"inertia": 0.0}, "inertia is 0.0; expected more than 0"),
    ],
)
def test_values_out_of_range_are_refused(keys, message):
    with pytest.raises(ValueError, match=message):
        RobotSpec(**keys)
