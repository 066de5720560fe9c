"""Many robots at once: nobody touches, nobody waits forever, nothing is lost."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from math import dist, fsum, inf, pi

import numpy as np
import pytest
from gaps import least_gap
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet.power import ExtraPower
from fleet.robot import PRESETS, RobotSpec
from worlds.arena import Arena
from worlds.catalogue import WORLDS
from worlds.shapes import Polygon

SMALL = replace(PRESETS["small"], capacity=1e4)
BIG = replace(SMALL, radius=0.2)
BLOCK = Arena(obstacles=(Polygon(((4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0))),))

ARENAS = [BLOCK, *(WORLDS[name].function().arena for name in ("pit", "rooms", "warehouse"))]


class Watch:
    """Sees every step of a fleet at work, and keeps what is worst."""

    def __init__(self, motion, robots, arena=None):
        self.motion, self.robots, self.arena = motion, robots, arena or Arena()
        self.radius = motion.spec.radius
        self.trips, self.gap, self.fastest = [], inf, 0.0
        self.held = [robot.battery.charge for robot in robots]
        self.places = self.where()

    def where(self):
        return np.array([robot.position for robot in self.robots])

    def step(self):
        before = self.motion.now
        ended = self.motion.advance(before + self.motion.options.dt)
        self.trips += ended
        places = self.where()
        if self.motion.now > before:
            moved = np.hypot(*(places - self.places).T).max()
            self.fastest = max(self.fastest, moved / (self.motion.now - before))
        self.places = places
        self.gap = min(self.gap, least_gap(places, self.radius, self.arena))
        return ended

    def check(self, gap):
        """Bodies kept apart by ``gap`` [m], batteries lost what trips took, no speed was gained."""
        assert self.gap >= gap
        for robot, held in zip(self.robots, self.held, strict=True):
            drained = fsum(trip.energy for trip in self.trips if trip.robot == robot.id)
            assert robot.battery.charge + drained == pytest.approx(held, abs=1e-9)
        for trip in self.trips:
            assert fsum(trip.accounts) == pytest.approx(trip.energy, abs=1e-9)
            if trip.outcome == "arrived":
                assert dist(trip.end, trip.site) <= trip.offset + 0.025


def work(watch, rng, movers, tasks, reach=3.0, halts=0.0):
    """Keep ``movers`` robots busy until ``tasks`` trips have been sent; outcomes by name."""
    motion, arena, radius = watch.motion, watch.arena, watch.radius
    idle = list(watch.robots)
    while tasks or motion.moving:
        while tasks and idle and len(motion.moving) < movers:
            robot = idle.pop(int(rng.integers(len(idle))))
            way, turn = rng.uniform(0.2, reach), rng.uniform(-pi, pi)
            site = np.array(robot.position) + way * np.array([np.cos(turn), np.sin(turn)])
            site = np.clip(site, radius, np.array([arena.width, arena.height]) - radius)
            motion.depart(robot, tuple(site.tolist()))
            tasks -= 1
        if halts and motion.moving and rng.random() < halts:
            motion.halt(motion.moving[int(rng.integers(len(motion.moving)))])
        for trip in watch.step():
            robot = watch.robots[trip.robot]
            if robot.battery.charge > 0.0 and trip.outcome != "broken down":
                idle.append(robot)
        assert motion.now < 1e4
    return Counter(trip.outcome for trip in watch.trips)


@pytest.mark.parametrize("engine", [True, False])
@pytest.mark.parametrize(
    ("spec", "movers"),
    [(SMALL, 10), (SMALL, 50), (BIG, 10), (replace(SMALL, drive="holonomic"), 50)],
)
def test_reserved_robots_never_touch(crowd, spec, movers, engine):
    motion, robots, rng = crowd(100, 3, spec, engine=engine)
    watch = Watch(motion, robots)
    outcomes = work(watch, rng, movers, 150)
    watch.check(0.0001)
    assert outcomes["arrived"] >= 140
    assert outcomes["arrived"] + outcomes["no path"] == 150
    assert all(trip.contacts == 0 for trip in watch.trips)
    assert np.mean([trip.waited for trip in watch.trips]) < (0.5 if spec.radius < 0.2 else 3.0)
    assert watch.fastest <= spec.cruise * 1.01


@given(
    st.integers(0, 2**31),
    st.sampled_from([0.05, 0.1, 0.2]),
    st.sampled_from([None, *ARENAS]),
    st.sampled_from(["differential", "holonomic"]),
    st.sampled_from([0.3, 1.0, 1e4]),
    st.booleans(),
    st.sampled_from([20.0, 1e4]),
    st.sampled_from([0.0, 0.05]),
    st.booleans(),
)
@settings(max_examples=12, deadline=None)
def test_whatever_happens_nothing_sinks_in_and_nothing_is_lost(
    crowd, seed, radius, arena, drive, acceleration, reverse, capacity, halts, engine
):
    spec = RobotSpec(
        radius=radius, drive=drive, acceleration=acceleration, reverse=reverse, capacity=capacity,
    )  # fmt: skip
    motion, robots, rng = crowd(40, seed, spec, arena, engine=engine)
    watch = Watch(motion, robots, arena)
    work(watch, rng, 15, 40, halts=halts)
    watch.check(-0.001)


@given(
    st.integers(0, 2**31),
    st.sampled_from([0.1, 0.2]),
    st.sampled_from([None, *ARENAS]),
    st.sampled_from([1.0, 1e4]),
)
@settings(max_examples=4, deadline=None)
def test_in_free_traffic_bodies_touch_but_hardly_sink_in(crowd, seed, radius, arena, acceleration):
    spec = replace(SMALL, radius=radius, acceleration=acceleration)
    motion, robots, rng = crowd(40, seed, spec, arena, engine=True, traffic="free")
    watch = Watch(motion, robots, arena)
    outcomes = work(watch, rng, 25, 40)
    watch.check(-0.001)
    assert sum(outcomes.values()) == 40
    assert watch.fastest <= 1.75 * spec.cruise  # 0.3 m/s to catch up, and pushed by others


def test_free_robots_meet_head_on_and_find_around_each_other(driving):
    motion, (one, two) = driving(
        [(2.0, 5.0), (8.0, 5.05)], SMALL, headings=[0.0, pi], engine=True, traffic="free"
    )
    watch = Watch(motion, [one, two])
    motion.depart(one, (7.0, 5.0))
    motion.depart(two, (3.0, 5.05))
    while motion.moving:
        watch.step()
    watch.check(-0.001)
    assert {trip.outcome for trip in watch.trips} == {"arrived"}
    assert all(trip.contacts > 0 and trip.accounts.contact != 0.0 for trip in watch.trips)


@pytest.mark.parametrize(("replans", "outcome"), [(0, "stuck"), (3, "arrived")])
def test_a_robot_that_runs_into_another_plans_anew_or_is_stuck(driving, replans, outcome):
    motion, (one, two) = driving(
        [(3.0, 5.0), (2.0, 5.0)], SMALL, engine=True, traffic="free", replans=replans
    )
    watch = Watch(motion, [one, two])
    motion.depart(one, (9.0, 5.0))
    motion.advance(1.0)
    motion.depart(two, (8.0, 5.0))
    while one.position[0] < 5.0:
        watch.step()
    motion.halt(one)
    while motion.moving:
        watch.step()
    watch.check(-0.001)
    assert [trip.outcome for trip in watch.trips] == ["broken down", outcome]
    if outcome == "stuck":
        assert watch.trips[1].end[0] == pytest.approx(one.position[0] - 0.2, abs=0.002)


def test_robots_that_swap_places_by_reservation(driving):
    motion, (one, two) = driving([(2.0, 5.0), (8.0, 5.0)], SMALL, headings=[0.0, pi])
    watch = Watch(motion, [one, two])
    motion.depart(one, (8.0, 4.0))
    motion.depart(two, (2.0, 5.0))
    while motion.moving:
        watch.step()
    watch.check(0.004)
    assert {trip.outcome for trip in watch.trips} == {"arrived"}


def test_the_site_of_a_robot_under_way_is_taken(driving):
    motion, (one, two) = driving([(2.0, 5.0), (8.0, 5.0)], SMALL)
    motion.depart(one, (5.0, 5.0))
    motion.depart(two, (5.0, 5.0))
    trips = []
    while motion.moving:
        trips += motion.advance(inf)
    offsets = {trip.robot: trip.offset for trip in trips}
    assert offsets[0] == 0.0
    assert offsets[1] == pytest.approx(2.0 * SMALL.radius + 0.03, abs=1e-6)


@pytest.mark.parametrize("engine", [True, False])
def test_a_breakdown_makes_others_stop_and_plan_anew(driving, engine):
    motion, robots = driving(
        [(2.0, 5.0), (5.0, 8.0)], SMALL, headings=[0.0, -pi / 2.0], engine=engine
    )
    watch = Watch(motion, robots)
    motion.depart(robots[0], (8.0, 5.0))
    while robots[0].position[0] < 4.8:
        watch.step()
    motion.depart(robots[1], (5.0, 2.0))
    while robots[0].position[0] < 5.0:
        watch.step()
    motion.halt(robots[0])
    while motion.moving or len(watch.trips) < 2:
        watch.step()
    watch.check(0.0009)
    broken, around = watch.trips
    assert broken.outcome == "broken down"
    assert 4.99 <= broken.end[0] < 5.02
    assert around.outcome == "arrived"
    assert around.path > around.planned + 0.001
    assert around.contacts == 0


def test_slow_starters_take_long_to_stop(driving):
    slow = replace(SMALL, acceleration=0.03)
    motion, robots = driving([(1.0, 20.0), (30.0, 30.0)], slow, Arena(60.0, 40.0))
    watch = Watch(motion, robots, Arena(60.0, 40.0))
    motion.depart(robots[0], (50.0, 20.0))
    motion.depart(robots[1], (30.0, 10.0))
    motion.advance(44.0)
    stopped = motion._movers.stop_short
    motion._stop(motion._voyages[0])
    assert stopped.__self__.traffic.movers[motion._voyages[0].slot].knots > 61
    while motion.moving:
        watch.step()
    watch.check(0.004)
    assert [trip.outcome for trip in watch.trips] == ["arrived", "arrived"]


def test_one_that_waits_for_a_broken_robot_goes_around_it(driving):
    motion, robots = driving([(1.0, 5.0), (5.0, 6.0)], SMALL, headings=[0.0, -pi / 2.0])
    watch = Watch(motion, robots)
    motion.depart(robots[0], (9.0, 5.0))
    while robots[0].position[0] < 3.9:
        watch.step()
    motion.depart(robots[1], (5.0, 4.0))
    assert motion._movers.traffic.movers[motion._voyages[1].slot]["start"] > motion._step
    while robots[0].position[0] < 4.85:
        watch.step()
    motion.halt(robots[0])
    while motion.moving:
        watch.step()
    watch.check(0.0009)
    assert watch.trips[-1].outcome == "arrived"
    assert watch.trips[-1].end == (5.0, 4.0)


def test_a_robot_that_dies_while_it_waits_is_known_to_others(crowd):
    spec = RobotSpec(capacity=30.0, extra=ExtraPower(idle=20.0))
    motion, robots, rng = crowd(60, 4, spec, engine=True)
    watch = Watch(motion, robots)
    for robot in robots:
        motion.depart(robot, tuple(rng.uniform(0.3, 9.7, 2).tolist()))
    while motion.moving:
        watch.step()
    assert watch.gap > -0.001
    outcomes = Counter(trip.outcome for trip in watch.trips)
    assert outcomes["battery empty"] > 20
    assert sum(outcomes.values()) == 60
    assert any(trip.path == 0.0 and trip.accounts.waiting > 0.0 for trip in watch.trips)


@pytest.mark.parametrize(("radius", "served"), [(0.1, 1.0), (0.2, 0.995)])
def test_tasks_are_served(crowd, radius, served):
    """One robot at a time: the third nearest of those that can go, as they believe."""
    spec = replace(SMALL, radius=radius, capacity=1e6)
    arrived = contacts = 0
    for seed in range(20):
        motion, robots, rng = crowd(100, seed, spec, engine=True)
        begun: list[int] = []
        motion._engine.space.on_collision(None, None, begin=lambda *_, begun=begun: begun.append(1))
        for _ in range(100):
            site = tuple(rng.uniform(0.0, 10.0, 2).tolist())
            near = sorted(robots, key=lambda robot: dist(robot.position, site))
            able = (robot for robot in near[2:] + near[:2] if robot.cost_to(site) < inf)
            robot = next(able, None)
            if robot is None:
                continue
            motion.depart(robot, site)
            (trip,) = motion.advance(inf)
            arrived += trip.outcome == "arrived"
            contacts += trip.contacts
        contacts += len(begun)
    assert contacts == 0
    assert arrived >= served * 2000


def test_two_that_push_with_all_their_strength_hardly_sink_in(driving):
    strong = replace(SMALL, drive="holonomic", acceleration=1e4)
    for dt in (1.0 / 60.0, 1.0 / 240.0):
        motion, robots = driving(
            [(3.0, 5.0), (7.0, 5.0)], strong, engine=True, traffic="free", dt=dt, replans=0
        )
        watch = Watch(motion, robots)
        motion.depart(robots[0], (6.0, 5.0))
        motion.depart(robots[1], (4.0, 5.0))
        while motion.moving:
            watch.step()
        watch.check(-0.001)
        assert len(watch.trips) == 2
        assert all(trip.contacts for trip in watch.trips)


@pytest.mark.parametrize("engine", [True, False])
def test_who_is_too_near_to_brake_is_stopped_by_the_body_in_its_way(driving, engine):
    slow = replace(SMALL, acceleration=0.3)
    motion, robots = driving(
        [(2.0, 5.0), (5.0, 8.0)], slow, headings=[0.0, -pi / 2.0], engine=engine
    )
    watch = Watch(motion, robots)
    motion.depart(robots[0], (8.0, 5.0))
    motion.advance(1.0)
    motion.depart(robots[1], (5.0, 2.0))
    while robots[0].position[0] < 4.95:
        watch.step()
    motion.halt(robots[0])
    while motion.moving:
        watch.step()
    watch.check(-0.001)
    broken, late = watch.trips
    assert broken.outcome == "broken down"
    assert late.contacts > 0
    assert late.outcome in ("arrived", "stuck")


@pytest.mark.slow
@pytest.mark.parametrize("world", ["random", "pit", "rooms", "warehouse"])
def test_nobody_touches_though_true_parameters_are_off_by_a_fifth(driving, world):
    """2500 trips on each floor, 50 robots under way at all times."""
    floor = WORLDS[world].function()
    rng = np.random.default_rng(7)
    spec = replace(SMALL, error=0.2, capacity=1e7)
    points = floor.place(floor.arena, 100, spec.radius, rng)
    headings = rng.uniform(-pi, pi, 100)
    motion, robots = driving(
        points, spec, floor.arena, headings=headings, engine=True, rng=np.random.default_rng(8)
    )
    idle, outcomes, contacts, sent = list(robots), Counter(), 0, 0
    while sent < 2500 or motion.moving:
        while sent < 2500 and idle and len(motion.moving) < 50:
            robot = idle.pop(int(rng.integers(len(idle))))
            way, turn = rng.uniform(0.2, 3.0), rng.uniform(-pi, pi)
            x, y = robot.position[0] + way * np.cos(turn), robot.position[1] + way * np.sin(turn)
            size = np.array([floor.arena.width, floor.arena.height])
            site = np.clip([x, y], spec.radius, size - spec.radius)
            motion.depart(robot, tuple(site.tolist()))
            sent += 1
        for trip in motion.advance(inf):
            outcomes[trip.outcome] += 1
            contacts += trip.contacts
            idle.append(robots[trip.robot])
    assert contacts == 0
    assert outcomes["stuck"] == 0
    assert outcomes["arrived"] > 2000


@pytest.mark.slow
def test_a_thousand_robots_at_once(crowd):
    side = 1000**0.5
    motion, robots, rng = crowd(1000, 1, SMALL, Arena(side, side), engine=True)
    watch = Watch(motion, robots, Arena(side, side))
    watch.step()
    least = watch.gap  # as they were scattered
    outcomes = work(watch, rng, 1000, 1500)
    watch.check(min(1e-4, least - 1e-6))
    assert outcomes["arrived"] >= 1480
    assert all(trip.contacts == 0 for trip in watch.trips)
