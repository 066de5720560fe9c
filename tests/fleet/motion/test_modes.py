"""Compiled and not, over the bridge and not, sliced and at once: the same to the bit."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from math import dist, inf

import numpy as np
import pymunk
import pytest

from fleet.motion import chipmunk
from fleet.motion.builds import builds_of
from fleet.motion.engine import Engine
from fleet.robot import PRESETS, RobotSpec
from worlds.arena import Arena
from worlds.catalogue import WORLDS
from worlds.shapes import Polygon

SPECS = [
    replace(PRESETS["small"], capacity=60.0),
    replace(PRESETS["small"], radius=0.2, reverse=True, capacity=1e3),
    replace(PRESETS["small"], drive="holonomic", capacity=1e3),
]
BLOCK = Arena(obstacles=(Polygon(((4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0))),))

ARENAS = [BLOCK, WORLDS["rooms"].function().arena, WORLDS["warehouse"].function().arena]


def play(
    crowd, seed, spec, arena, *, slices=None, movers=4, tasks=25, interval=None, halts=0.0, **keys
):
    """Send robots to random sites, several at once: everything that can be told of it."""
    motion, robots, rng = crowd(40, seed, spec, arena, interval=interval, **keys)
    trips, left = [], tasks
    while left or motion.moving:
        while left and len(motion.moving) < movers:
            robot = robots[int(rng.integers(40))]
            site = tuple(rng.uniform(0.3, 9.7, 2).tolist())
            if robot not in motion.moving and robot.battery.charge:
                motion.depart(robot, site)
                left -= 1
        trips += motion.advance(inf if slices is None else motion.now + slices)
        if halts and motion.moving and rng.random() < halts:
            motion.halt(motion.moving[int(rng.integers(len(motion.moving)))])
    state = [(r.position, r.heading, r.battery.charge) for r in robots]
    return trips, state, motion.samples()


def same(one, two):
    assert one[0] == two[0]
    assert one[1] == two[1]
    assert np.array_equal(one[2], two[2])


@pytest.mark.parametrize(
    ("seed", "traffic"),
    [
        *((seed, "reserved") for seed in range(3)),
        (0, "free"),
        *(pytest.param(seed, "free", marks=pytest.mark.slow) for seed in (1, 2)),
    ],
)
def test_the_bridge_and_the_public_interface_agree(crowd, seed, traffic):
    few = {"movers": 6, "tasks": 6} if traffic == "free" else {"movers": 20}
    keys = {"engine": True, "interval": 0.2, "traffic": traffic, **few}
    over_bridge = play(crowd, seed, SPECS[1], None, **keys)
    openly = play(crowd, seed, SPECS[1], None, bridge=False, **keys)
    same(over_bridge, openly)
    if traffic == "free" and seed == 0:  # in the others nobody meets anybody
        assert any(trip.contacts for trip in over_bridge[0])


@pytest.mark.parametrize("engine", [True, False])
def test_runs_repeat(crowd, engine):
    same(*(play(crowd, 11, SPECS[0], BLOCK, engine=engine, interval=0.5) for _ in range(2)))


def test_slices_of_time_do_not_matter(crowd):
    whole = play(crowd, 4, SPECS[1], None, engine=True, movers=1, interval=0.1)
    sliced = play(crowd, 4, SPECS[1], None, engine=True, movers=1, interval=0.1, slices=0.037)
    same(whole, sliced)


SCRIPT = """
import json, sys
from math import inf, pi
import numpy as np
from fleet.power import Battery
from fleet.motion.driven import DrivenMotion
from fleet.robot import Robot, RobotSpec
from worlds.arena import Arena
from worlds.scattering import scatter
from worlds.shapes import Polygon

arena = Arena(obstacles=(Polygon(((4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0))),))
rng = np.random.default_rng(2)
motion = DrivenMotion(RobotSpec(capacity=1e3), arena, engine=False)
robots = [
    Robot(k, (x, y), 1.0, Battery(1e3), 2.5, [], motion)
    for k, (x, y) in enumerate(scatter(arena, 30, 0.1, rng).tolist())
]
motion.place(robots)
found = []
for _ in range(3):
    for robot in rng.choice(30, 3, replace=False).tolist():
        motion.depart(robots[robot], tuple(rng.uniform(0.3, 9.7, 2).tolist()))
    while motion.moving:
        found += [[t.robot, t.energy, t.path, t.ended, *t.end] for t in motion.advance(inf)]
print(json.dumps(found))
"""


@pytest.mark.slow
def test_the_kernels_do_what_python_does():
    found = []
    for uncompiled in ("0", "1"):
        environment = {**os.environ, "NUMBA_DISABLE_JIT": uncompiled}
        run = subprocess.run(
            [sys.executable, "-c", SCRIPT],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        found.append(json.loads(run.stdout))
    assert len(found[0]) == 9
    assert np.array(found[0]) == pytest.approx(np.array(found[1]), rel=1e-9)


def test_without_the_private_module_the_engine_falls_back(monkeypatch, crowd):
    monkeypatch.setitem(chipmunk.SIGNATURES, "cpSpaceStep", "int(*)(void)")
    chipmunk.trusted.cache_clear()
    try:
        assert not chipmunk.trusted()
        with pytest.raises(chipmunk.NoBridge, match=r"cpSpaceStep is .*; expected int"):
            chipmunk.connect(pymunk.Space(), [])
        engine = Engine(Arena(), 0.1, builds_of(RobotSpec(), 0, np.random.default_rng(0)), [])
        assert engine.wires is None
        fallen_back = play(crowd, 1, SPECS[0], None, engine=True, tasks=5)
    finally:
        chipmunk.trusted.cache_clear()
    monkeypatch.undo()
    assert chipmunk.trusted()
    same(fallen_back, play(crowd, 1, SPECS[0], None, engine=True, tasks=5))


def test_parked_bodies_are_static_and_moving_ones_have_their_mass(crowd):
    motion, robots, _ = crowd(10, 0, engine=True)
    bodies = motion._engine.bodies
    assert {body.body_type for body in bodies} == {pymunk.Body.STATIC}
    before, heading = robots[3].position, robots[3].heading
    motion.depart(robots[3], (5.0, 5.0))
    motion.advance(0.1)
    assert robots[3].heading != heading
    assert dist(robots[3].position, before) < 1e-3  # it turns on the spot
    assert bodies[3].body_type == pymunk.Body.DYNAMIC
    assert bodies[3].mass == pytest.approx(robots[3]._motion.spec.mass)
    motion.advance(inf)
    assert bodies[3].body_type == pymunk.Body.STATIC
    assert tuple(bodies[3].position) == robots[3].position
