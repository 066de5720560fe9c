"""How fast robots drive, as ratios within one run: ``python benchmarks/motion.py``.

One lifetime's work is 350 tasks for 100 robots of radius 0.1 m on 10 m × 10 m, each for the
third nearest robot, at a step of 1/60 s. It is driven by this project; by a plain program over
pymunk's public interface, along the same paths by the same law; and, for the floor, the engine
alone makes as many steps with one body moving. Then everybody drives at once.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from functools import cache
from math import atan2, copysign, cos, hypot, inf, pi, remainder, sin, sqrt, tau
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np
import pymunk

from fleet.energy import Battery
from fleet.motion.chipmunk import connect, step_space
from fleet.motion.driven import DrivenMotion
from fleet.motion.kernels.records import LINE
from fleet.motion.options import DriveOptions
from fleet.motion.planning import Planner
from fleet.robot import Robot, RobotSpec
from protocols.compiled import kernel
from worlds.arena import Arena, scatter

DT = 1.0 / 60.0  # [s]
TASKS = 350
ROBOTS = 100
SPEC = RobotSpec(capacity=1e6)


def start(seed):
    """Where everybody starts: points (n, 2) [m] and headings (n,) [rad]."""
    rng = np.random.default_rng(seed)
    return scatter(Arena(), ROBOTS, SPEC.radius, rng), rng.uniform(-pi, pi, ROBOTS)


@cache
def tasks(seed):
    """Who goes where: the third nearest robot to each of so many random sites."""
    points, headings = start(seed)
    motion, robots = fleet(points, headings, Arena(), engine=False)
    found = []
    for site in np.random.default_rng([seed, 1]).uniform(0.0, 10.0, (TASKS, 2)):
        robot = int(np.argpartition(((points - site) ** 2).sum(axis=1), 2)[2])
        found.append((robot, (float(site[0]), float(site[1]))))
        motion.depart(robots[robot], found[-1][1])
        (trip,) = motion.advance(inf)
        points[robot] = trip.end
    return found


def fleet(points, headings, arena, engine, options=None):
    """A fleet in place: (motion, robots)."""
    motion = DrivenMotion(SPEC, arena, options or DriveOptions(dt=DT), engine=engine)
    robots = [
        Robot(id, (x, y), heading, Battery(SPEC.capacity), 2.5, [], motion)
        for id, ((x, y), heading) in enumerate(zip(points.tolist(), headings.tolist(), strict=True))
    ]
    motion.place(robots)
    return motion, robots


def lifetime(seed, *, engine):
    """Drive it here: (CPU time [s], steps, energy [J])."""
    (points, headings), wanted = start(seed), tasks(seed)
    began = process_time()
    motion, robots = fleet(points, headings, Arena(), engine)
    steps, energy = 0, 0.0
    for robot, site in wanted:
        motion.depart(robots[robot], site)
        (trip,) = motion.advance(inf)
        steps += trip.steps
        energy += trip.energy
    return process_time() - began, steps, energy


class PlainWorld:
    """What one writes first: pymunk's public interface, and a loop in Python."""

    def __init__(self, points, headings):
        self.space = pymunk.Space()
        self.space.collision_slop = 1e-4
        self.bodies = []
        for point, heading in zip(points.tolist(), headings.tolist(), strict=True):
            body = pymunk.Body(body_type=pymunk.Body.STATIC)
            body.position, body.angle = tuple(point), heading
            circle = pymunk.Circle(body, SPEC.radius)
            circle.mass = SPEC.mass
            self.space.add(body, circle)
            self.bodies.append(body)
        for a, b in (
            ((0, 0), (10, 0)),
            ((10, 0), (10, 10)),
            ((10, 10), (0, 10)),
            ((0, 10), (0, 0)),
        ):
            self.space.add(pymunk.Segment(self.space.static_body, a, b, 0.0))

    def drive(self, robot, pieces):
        """Turn towards the path, then follow it: (steps, energy [J])."""
        body = self.bodies[robot]
        body.body_type = pymunk.Body.DYNAMIC
        steps, energy = self._turn(body, pieces[0])
        rest = [sum(piece["length"] for piece in pieces[k + 1 :]) for k in range(len(pieces))]
        speed = 0.0
        for k, piece in enumerate(pieces):
            while True:
                along, off, heading, bend = locate(piece, body.position)
                if along >= piece["length"] - 1e-4:
                    break
                to_go = piece["length"] - along + rest[k]
                braking = sqrt(2.0 * SPEC.acceleration * max(to_go - 0.5 * speed * DT, 0.0))
                last = min(SPEC.cruise, speed + SPEC.acceleration * DT, braking)
                mean = min(0.5 * (speed + last), to_go / DT)
                error = remainder(body.angle - heading, tau)
                spin = mean * bend - mean * off / 0.04 - 10.0 * mean * error
                middle = body.angle + 0.5 * spin * DT
                body.velocity = (mean * cos(middle), mean * sin(middle))
                body.angular_velocity = spin
                self.space.step(DT)
                steps += 1
                square = (speed * speed + speed * last + last * last) / 3.0
                power = 6.25 * square + 9.79 * 0.5 * (speed + last) + 3.66
                energy += power * DT
                speed = last
                if to_go < 1e-3:
                    break
        body.body_type = pymunk.Body.STATIC
        return steps, energy

    def _turn(self, body, piece):
        steps, spin = 0, 0.0
        goal = locate(piece, body.position)[2]
        ease = SPEC.turn_acceleration * DT
        while True:
            error = remainder(goal - body.angle, tau)
            if abs(error) < 0.02 and abs(spin) <= ease:
                return steps, 3.66 * DT * steps
            wish = copysign(min(SPEC.turn_rate, sqrt(2.0 * ease / DT * abs(error))), error)
            spin = min(max(wish, spin - ease), spin + ease)
            body.velocity = (0.0, 0.0)
            body.angular_velocity = spin
            self.space.step(DT)
            steps += 1


def locate(piece, position):
    """Where on a piece of path: how far along, how far to the left, heading, curvature."""
    dx, dy = position.x - piece["x"], position.y - piece["y"]
    if piece["kind"] == LINE:
        along = dx * piece["cos"] + dy * piece["sin"]
        return along, dy * piece["cos"] - dx * piece["sin"], piece["angle"], 0.0
    sense, radius = piece["sense"], piece["radius"]
    angle = atan2(dy, dx)
    half = 0.5 * piece["length"] / radius
    ahead = remainder(sense * (angle - piece["angle"]) - half, tau) + half
    heading = angle + sense * 0.5 * pi
    return radius * ahead, sense * (radius - hypot(dx, dy)), heading, sense / radius


def plain_lifetime(seed, share):
    """The same by the plain program, from its first ``share`` tasks."""
    (points, headings), wanted = start(seed), tasks(seed)
    began = process_time()
    world = PlainWorld(points, headings)
    built = process_time() - began
    places = [(x, y) for x, y in points.tolist()]
    planner = Planner(Arena(), SPEC.radius, places, DriveOptions().clearances)
    began, steps, energy = process_time(), 0, 0.0
    for robot, site in wanted[:share]:
        plan = planner.plan(robot, places[robot], site)
        names = plan.pieces.dtype.names
        pieces = [dict(zip(names, piece.tolist(), strict=True)) for piece in plan.pieces]
        made, drained = world.drive(robot, pieces)
        steps += made
        energy += drained
        places[robot] = tuple(world.bodies[robot].position)
        planner.rest(robot, places[robot])
    took = process_time() - began
    return built + took * TASKS / share, steps * TASKS / share, energy * TASKS / share


@kernel
def _step_alone(calls, steps, dt):
    for _ in range(steps):
        step_space(calls, dt)


def bare_steps(steps):
    """The engine alone, one body moving among the parked: CPU time of so many steps [s]."""
    world = PlainWorld(*start(0))
    world.bodies[0].body_type = pymunk.Body.DYNAMIC
    world.bodies[0].velocity = (1e-6, 0.0)
    wires, _keep = connect(world.space, world.bodies)
    _step_alone(wires.calls, 1, DT)
    began = process_time()
    _step_alone(wires.calls, steps, DT)
    return process_time() - began


def everybody(count, *, engine, seconds=20.0):
    """All ``count`` robots drive all the time, at one robot a square metre.

    Returns CPU time for 0.1 s [s]: of driving, and of sending; and how many were sent.
    """
    side = sqrt(count)
    arena, rng = Arena(side, side), np.random.default_rng(3)
    points = scatter(arena, count, SPEC.radius, rng)
    motion, robots = fleet(points, rng.uniform(-pi, pi, count), arena, engine)
    driving = sending = 0.0
    sent, idle, ticks = 0, list(robots), 0
    while ticks < 10 * seconds:
        began = process_time()
        for robot in idle:
            way, turn = rng.uniform(1.0, 4.0), rng.uniform(-pi, pi)
            x = min(max(robot.position[0] + way * cos(turn), 0.2), side - 0.2)
            y = min(max(robot.position[1] + way * sin(turn), 0.2), side - 0.2)
            motion.depart(robot, (x, y))
        middle = process_time()
        trips = motion.advance(0.1 * (ticks + 1))
        if ticks >= 20:  # past the rush of the start
            sent += len(idle)
            sending += middle - began
            driving += process_time() - middle
        idle = [robots[trip.robot] for trip in trips if trip.outcome != "no path"]
        if not trips:
            ticks += 1
    parts = 10.0 * seconds - 20
    return driving / parts, sending / parts, sent / parts


def start_up():
    """Seconds until the first trip of a process, compiling and from the cache."""
    here = Path(__file__).parent
    code = f"import sys; sys.path.insert(0, {str(here)!r}); import motion; motion.first_trip()"
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        for label in ("compiling", "from the cache"):
            run = subprocess.run(
                [sys.executable, "-c", code],
                env=environment, capture_output=True, text=True, check=True,
            )  # fmt: skip
            print(f"  first trip, {label:16s} {float(run.stdout):6.2f} s")


def first_trip():
    """Print the CPU time of one trip in physics, imports excluded."""
    began = process_time()
    motion, robots = fleet(*start(0), Arena(), engine=True)
    motion.depart(robots[0], (5.0, 5.0))
    motion.advance(inf)
    print(process_time() - began)


def main():
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--repeat", type=int, default=9, help="lifetimes of each kind")
    seeds = range(parser.parse_args().repeat)
    for engine in (True, False):
        lifetime(0, engine=engine)
    physics, path = ([lifetime(s, engine=e) for s in seeds] for e in (True, False))
    assert [run[1:] for run in physics] == [run[1:] for run in path]
    plain = [plain_lifetime(seed, 60) for seed in range(3)]
    ours, without, slow = (median(run[0] for run in runs) for runs in (physics, path, plain))
    steps = int(median(run[1] for run in physics))
    floor = min(bare_steps(steps) for _ in range(5))
    print(f"one lifetime: {TASKS} tasks, {steps} steps")
    print(f"  physics             {ours * 1e3:8.1f} ms {1.0 / ours:7.1f} a second")
    print(
        f"  path                {without * 1e3:8.1f} ms {ours / without:7.2f} x as fast as physics"
    )
    print(f"  plain pymunk        {slow * 1e3:8.1f} ms; physics is {slow / ours:.1f} x as fast")
    print(
        f"  the engine's steps  {floor * 1e3:8.1f} ms; physics has {floor / ours:.2f} of that speed"
    )
    print("everybody drives, CPU time for 0.1 s:")
    for count in (100, 1000):
        for engine in (False, True):
            driving, sending, sent = everybody(count, engine=engine)
            print(
                f"  {count:5d} robots, {'physics' if engine else 'path':8s}"
                f" driving {driving * 1e6:6.0f} us, sending {sent:4.1f} robots"
                f" {sending * 1e6:6.0f} us"
            )
    print("starting:")
    start_up()


if __name__ == "__main__":
    main()
