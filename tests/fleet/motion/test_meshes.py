"""Paths on ragged floors: clear of everything, as short as the exact ones, and quick."""

from __future__ import annotations

import time
from itertools import islice
from math import dist

import numpy as np
import pytest

from fleet.motion import meshes
from fleet.motion.planning import Planner
from worlds.catalogue import occupancy_map
from worlds.events import uniform_sites
from worlds.ground import ground_of
from worlds.occupancy import FREE, OCCUPIED, OccupancyGrid
from worlds.scattering import scatter

RADIUS = 0.1
LADDER = (0.03, 0.015, 0.005, 0.001)


def ragged(rows, columns, rooms, seed):
    """Rooms with doors, crates, and outlines as a noisy laser draws them, at 5 cm a cell."""
    rng = np.random.default_rng(seed)
    occupied = np.zeros((rows, columns), bool)
    occupied[:2] = occupied[-2:] = occupied[:, :2] = occupied[:, -2:] = True
    for x in np.linspace(0, columns, rooms + 1)[1:-1].astype(int):
        occupied[:, x : x + 2] = True
        door = rng.integers(10, rows - 35)
        occupied[door : door + 20, x : x + 2] = False
    for _ in range(rows * columns // 2500):
        y, x = rng.integers(0, rows - 8), rng.integers(0, columns - 8)
        occupied[y : y + rng.integers(2, 8), x : x + rng.integers(2, 8)] = True
    around = np.pad(occupied, 1)
    beside = around[:-2, 1:-1] | around[2:, 1:-1] | around[1:-1, :-2] | around[1:-1, 2:]
    occupied |= beside & (rng.random(occupied.shape) < 0.4)
    cells = np.where(occupied, OCCUPIED, FREE).astype(np.int8)
    return occupancy_map(file=OccupancyGrid(cells, 0.05), tolerance=0.0)


def put_up(world, robots, seed, monkeypatch=None):
    """A planner with robots in their places, and sites."""
    ground = ground_of(world.arena, RADIUS)
    rng = np.random.default_rng(seed)
    places = [(x, y) for x, y in scatter(world.arena, robots, RADIUS, rng).tolist()]
    if monkeypatch is not None:
        monkeypatch.setattr(meshes, "RAGGED", 10**9)
    return Planner(world.arena, RADIUS, places, LADDER), places, uniform_sites(ground, rng)


def clearance(world, places, me, points):
    """How far points (k, 2) are from obstacles, walls and the other robots' discs [m]."""
    away = np.minimum(points, [world.arena.width, world.arena.height] - points).min(axis=1)
    for polygon in world.arena.obstacles:
        away = np.minimum(away, polygon.distance(points))
    for other, place in enumerate(places):
        if other != me:
            away = np.minimum(away, np.hypot(*(points - place).T) - RADIUS)
    return away


@pytest.mark.parametrize("robots", [1, 25])
def test_paths_are_clear_and_as_short_as_the_exact_ones(trace, robots, monkeypatch):
    world = ragged(120, 120, 2, seed=3)
    corners = sum(len(p.corners) for p in world.arena.obstacles)
    assert corners > meshes.RAGGED
    mapped, places, sites = put_up(world, robots, 5)
    chosen = list(islice(sites, 12))
    found = [mapped.plan(k % robots, places[k % robots], s) for k, s in enumerate(chosen)]
    exact, _, _ = put_up(world, robots, 5, monkeypatch)
    assert not exact.ragged
    for k, (site, plan) in enumerate(zip(chosen, found, strict=True)):
        me = k % robots
        shortest = exact.plan(me, places[me], site)
        assert (plan.segments is None) == (shortest.segments is None)
        if plan.segments is None or not len(plan.segments):
            continue
        # Beside robots either may have to do with the next clearance, which is shorter.
        assert plan.length == pytest.approx(shortest.length, rel=0.005)
        points = trace(plan.segments, 0.02)
        assert dist(points[0], places[me]) < 1e-6
        assert dist(points[-1], plan.goal) < 1e-6
        assert clearance(world, places, me, points).min() > RADIUS + min(LADDER) - 1e-6


def two_doors():
    """Two rooms with two doors between them, 3 × 4 m; (the world, the middles of the doors)."""
    occupied = np.zeros((60, 80), bool)
    occupied[:, 38:41] = True
    occupied[6:13, 38:41] = occupied[44:51, 38:41] = False
    occupied[20:30, 10:14] = occupied[30:40, 60:70] = True
    cells = np.where(occupied, OCCUPIED, FREE).astype(np.int8)
    world = occupancy_map(file=OccupancyGrid(cells, 0.05), tolerance=0.0)
    return world, [(1.975, 0.475), (1.975, 2.375)]


@pytest.mark.parametrize("shut", [(), (0,), (1,), (0, 1)])
def test_doors_that_robots_stand_in_are_not_gone_through(shut, trace, monkeypatch):
    """Door 0 is at one end of the wall; a row and a column of other robots stand about too."""
    world, doors = two_doors()
    about = [(0.6 + 0.3 * k, 2.0) for k in range(4)] + [(2.6, 0.5 + 0.3 * k) for k in range(4)]
    places = [(0.3, 0.3), *(doors[k] for k in shut), *about]
    sites = [(3.7, 2.7), (3.6, 0.4), (2.3, 1.5), (1.6, 2.7), (3.5, 1.75)]
    exact = Planner(world.arena, RADIUS, places, LADDER)
    monkeypatch.setattr(meshes, "RAGGED", 0)
    meshed = Planner(world.arena, RADIUS, places, LADDER)
    assert meshed.ragged
    assert not exact.ragged
    for site in sites:
        plan, shortest = meshed.plan(0, places[0], site), exact.plan(0, places[0], site)
        assert (plan.segments is None) == (shortest.segments is None)
        assert (plan.segments is None) == (len(shut) == 2 and site[0] > 2.0)
        if plan.segments is not None:
            assert plan.length == pytest.approx(shortest.length, rel=0.005)
            points = trace(plan.segments, 0.02)
            assert clearance(world, places, 0, points).min() > RADIUS + min(LADDER) - 1e-6


def test_where_nobody_has_room_there_is_no_mesh():
    cells = np.full((20, 20), OCCUPIED, np.int8)
    cells[8:11, 2:18] = FREE  # 15 cm wide
    arena = occupancy_map(file=OccupancyGrid(cells, 0.05), tolerance=0.0).arena
    assert len(meshes.mesh_of(arena, RADIUS, 0.03, 1).triangles) == 0


def test_a_robot_that_rests_in_the_way_is_gone_around_and_then_is_not():
    world = ragged(120, 120, 1, seed=4)
    planner, places, sites = put_up(world, 2, 1)
    for site in islice(sites, 40):
        planner.rest(1, (0.0, 0.0))
        free = planner.plan(0, places[0], site)
        if free.segments is None or len(free.segments) != 1 or free.length < 1.0:
            continue
        middle = (0.5 * (places[0][0] + site[0]), 0.5 * (places[0][1] + site[1]))
        planner.rest(1, middle)
        around = planner.plan(0, places[0], site)
        assert around.segments is None or around.length > free.length
        planner.rest(1, (0.0, 0.0))
        assert planner.plan(0, places[0], site).length == free.length


@pytest.mark.slow
def test_plans_among_thousands_of_corners_take_milliseconds():
    """The exact search takes seconds here, and where it is at its worst tens of seconds."""
    world = ragged(480, 820, 6, seed=1)
    assert sum(len(p.corners) for p in world.arena.obstacles) > 9500
    planner, places, sites = put_up(world, 100, 2)
    chosen = list(islice(sites, 101))
    planner.plan(0, places[0], chosen[0])  # compiled, and the mesh made
    took = []
    for k, site in enumerate(chosen[1:]):
        began = time.process_time()
        planner.plan(k % 100, places[k % 100], site)
        took.append(time.process_time() - began)
    assert np.median(took) < 0.1


def test_meshes_are_made_once():
    world = ragged(60, 60, 1, seed=6)
    assert meshes.mesh_of(world.arena, RADIUS, 0.03, 1) is meshes.mesh_of(
        world.arena, RADIUS, 0.03, 1
    )
