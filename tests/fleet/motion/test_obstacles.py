"""The worlds with obstacles: robots drive around pits and shelves and through doors, in traffic."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from math import dist, inf, pi

import numpy as np
import pytest
from gaps import least_gap

from fleet.motion.driven import DrivenMotion
from fleet.power import Battery
from fleet.robot import PRESETS, Robot
from worlds.catalogue import WORLDS

SMALL = replace(PRESETS["small"], capacity=1e4)
BIG = replace(SMALL, radius=0.2)
JAMMED = pytest.mark.xfail(
    strict=True,
    reason="robots half as wide as a door get stuck in dense traffic",
)


def fleet_in(world, count, spec, seed=0):
    """A fleet in a world of the catalogue: (motion, robots, its arena, rng)."""
    rng = np.random.default_rng(seed)
    made = WORLDS[world].function()
    points = made.place(made.arena, count, spec.radius, rng).tolist()
    motion = DrivenMotion(spec, made.arena, engine=True)
    robots = [
        Robot(k, (x, y), float(rng.uniform(-pi, pi)), Battery(spec.capacity), 2.5, [], motion)
        for k, (x, y) in enumerate(points)
    ]
    motion.place(robots)
    return motion, robots, made.arena, rng


def gap_among(robots, arena):
    """The least gap around any of the robots [m]."""
    places = np.array([robot.position for robot in robots])
    return least_gap(places, robots[0]._motion.spec.radius, arena)


def keep_busy(motion, robots, arena, rng, movers, tasks, halts=0.0):
    """Send robots anywhere, so many at once: (trips, least gap at any step [m])."""
    idle, trips, gap = list(robots), [], inf
    while tasks or motion.moving:
        while tasks and idle and len(motion.moving) < movers:
            site = tuple(rng.uniform(0.0, (arena.width, arena.height)).tolist())
            motion.depart(idle.pop(int(rng.integers(len(idle)))), site)
            tasks -= 1
        if motion.moving and rng.random() < halts:
            motion.halt(motion.moving[int(rng.integers(len(motion.moving)))])
        ended = motion.advance(motion.now + motion.options.dt)
        gap = min(gap, gap_among(robots, arena))
        trips += ended
        able = (trip for trip in ended if trip.outcome in ("arrived", "no path", "stuck"))
        idle += [robots[trip.robot] for trip in able]
        tasks = tasks if idle or motion.moving else 0
        assert motion.now < 1e4
    return trips, gap


@pytest.mark.parametrize(
    ("spec", "count"),
    [(SMALL, 80), pytest.param(BIG, 40, marks=[pytest.mark.slow, JAMMED])],
)
@pytest.mark.parametrize("world", ["pit", "rooms", "warehouse"])
def test_fifty_at_once_touch_neither_each_other_nor_obstacles(spec, count, world):
    motion, robots, arena, rng = fleet_in(world, count, spec)
    before = gap_among(robots, arena)
    trips, gap = keep_busy(motion, robots, arena, rng, 50, 80)
    assert gap >= min(before, 0.0009)
    assert all(trip.contacts == 0 for trip in trips)
    outcomes = Counter(trip.outcome for trip in trips)
    assert outcomes["arrived"] + outcomes["no path"] == 80
    assert outcomes["arrived"] >= (72 if spec is SMALL else 40)


@pytest.mark.parametrize(
    ("world", "capacity"),
    [
        ("rooms", 120.0),
        ("pit", 1e4),
        *(
            pytest.param(world, capacity, marks=pytest.mark.slow)
            for world, capacity in [
                ("pit", 120.0), ("warehouse", 120.0), ("rooms", 1e4), ("warehouse", 1e4)
            ]
        ),
    ],
)  # fmt: skip
def test_breakdowns_and_empty_batteries_in_traffic_stop_nobody_else(world, capacity):
    spec = replace(SMALL, capacity=capacity)
    motion, robots, arena, rng = fleet_in(world, 60, spec, seed=5)
    trips, gap = keep_busy(motion, robots, arena, rng, 30, 80, halts=0.01)
    assert gap >= -0.001
    outcomes = Counter(trip.outcome for trip in trips)
    assert outcomes["broken down"] > 2
    assert outcomes["battery empty"] > 5 or capacity > 120.0
    assert outcomes["arrived"] > 2
    for robot in robots:
        drained = sum(trip.energy for trip in trips if trip.robot == robot.id)
        assert robot.battery.charge + drained == pytest.approx(capacity, abs=1e-9)


def crossings(track, arena):
    """How often a track (k, 2) goes through a wall line of 3 × 3 rooms, and how far off a door's
    middle at most [m].
    """
    room = (arena.width - 0.3) / 3
    doors = room / 2 + (room + 0.15) * np.arange(3)
    count, off = 0, 0.0
    for axis in (0, 1):
        for line in (room + 0.075, 2 * room + 0.225):
            over = np.flatnonzero(np.diff(track[:, axis] > line))
            count += len(over)
            for k in over:
                off = max(off, np.abs(track[k, 1 - axis] - doors).min())
    return count, off


def test_the_way_between_rooms_leads_through_doors():
    motion, (robot,), arena, _ = fleet_in("rooms", 1, SMALL)
    for site in ((1.6, 1.6), (8.4, 8.4), (1.6, 8.4), (5.0, 5.0)):
        track = [robot.position]
        motion.depart(robot, site)
        while motion.moving:
            (trip,) = motion.advance(motion.now + 0.05) or (None,)
            track.append(robot.position)
        assert trip.outcome == "arrived"
        assert trip.end == pytest.approx(site, abs=1e-3)
        count, off = crossings(np.array(track), arena)
        assert count >= (2 if dist(track[0], site) > 5.0 else 0)
        assert off <= 0.45 - SMALL.radius


def test_a_blocked_door_is_gone_around_or_there_is_no_way():
    room = (10.0 - 0.15) / 2.0
    made = WORLDS["rooms"].function(columns=2, rows=1)  # the door is 0.9 m wide, around y = 5 m
    plug = [(5.0, y) for y in (4.66, 4.88, 5.12, 5.34)]
    motion = DrivenMotion(SMALL, made.arena, engine=True)
    robots = [
        Robot(k, place, 0.0, Battery(1e4), 2.5, [], motion)
        for k, place in enumerate([(1.0, 5.0), *plug])
    ]
    motion.place(robots)
    assert robots[0].cost_to((9.0, 5.0)) == inf
    assert robots[0].cost_to((room - 0.5, 5.0)) < inf
    motion.depart(robots[0], (9.0, 5.0))
    (trip,) = motion.advance(inf)
    assert (trip.outcome, trip.energy) == ("no path", 0.0)
    for robot in robots[2:4]:  # they clear the door one after another
        motion.depart(robot, (8.0, robot.position[1]))
        (trip,) = motion.advance(inf)
        assert trip.outcome == "arrived"
    motion.depart(robots[0], (9.0, 5.5))
    (trip,) = motion.advance(inf)
    assert trip.outcome == "arrived"
    assert trip.end == pytest.approx((9.0, 5.5), abs=1e-3)


@pytest.mark.parametrize("world", ["pit", "rooms", "warehouse"])
def test_sites_inside_obstacles_are_served_from_beside_them(world):
    motion, robots, arena, _ = fleet_in(world, 20, SMALL)
    for polygon in arena.obstacles:
        site = tuple(np.mean(polygon.corners, axis=0).tolist())
        covered = not arena.is_free(np.array([site]))[0]
        robot = min(robots, key=lambda robot: dist(robot.position, site))
        motion.depart(robot, site)
        (trip,) = motion.advance(inf)
        assert trip.outcome == "arrived"
        assert trip.offset >= (SMALL.radius if covered else 0.0)
        assert polygon.distance(np.array([trip.end]))[0] >= SMALL.radius
