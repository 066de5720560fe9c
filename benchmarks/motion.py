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
from math import atan2, copysign, cos, dist, hypot, inf, pi, remainder, sin, sqrt, tau
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


def tasks(seed):
    """Where everybody starts, and where they are wanted."""
    rng = np.random.default_rng(seed)
    points = scatter(Arena(), ROBOTS, SPEC.radius, rng)
    return points, rng.uniform(-pi, pi, ROBOTS), rng.uniform(0.0, 10.0, (TASKS, 2))


def third_nearest(points, site):
    """The robot that a task is for."""
    return int(np.argpartition(((points - site) ** 2).sum(axis=1), 2)[2])


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
    points, headings, sites = tasks(seed)
    start = process_time()
    motion, robots = fleet(points, headings, Arena(), engine)
    steps, energy = 0, 0.0
    for site in sites:
        robot = third_nearest(points, site)
        motion.depart(robots[robot], (float(site[0]), float(site[1])))
        (trip,) = motion.advance(inf)
        points[robot] = trip.end
        steps += trip.steps
        energy += trip.energy
    return process_time() - start, steps, energy


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
        for a, b in (((0, 0), (10, 0)), ((10, 0), (10, 10)), ((10, 10), (0, 10)), ((0, 10), (0, 0))):
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
    """The first ``share`` tasks by the plain program: (CPU time of all [s], of them steps)."""
    points, headings, sites = tasks(seed)
    start = process_time()
    world = PlainWorld(points, headings)
    built = process_time() - start
    planner = Planner(Arena(), SPEC.radius, [(x, y) for x, y in points.tolist()], (0.03, 0.001))
    start, steps, energy = process_time(), 0, 0.0
    for site in sites[:share]:
        robot = third_nearest(points, site)
        here = (float(points[robot, 0]), float(points[robot, 1]))
        plan = planner.plan(robot, here, (float(site[0]), float(site[1])))
        names = plan.pieces.dtype.names
        pieces = [dict(zip(names, piece.tolist(), strict=True)) for piece in plan.pieces]
        if pieces:
            made, drained = world.drive(robot, pieces)
            steps += made
            energy += drained
        points[robot] = world.bodies[robot].position
        planner.rest(robot, (float(points[robot, 0]), float(points[robot, 1])))
    took = (process_time() - start) * TASKS / share
    return built + took, steps * TASKS / share, energy * TASKS / share


@kernel
def _step_alone(calls, steps, dt):
    for _ in range(steps):
        step_space(calls, dt)


def bare_steps(steps):
    """The engine alone, one body moving among the parked: CPU time of so many steps [s]."""
    points, headings, _ = tasks(0)
    world = PlainWorld(points, headings)
    world.bodies[0].body_type = pymunk.Body.DYNAMIC
    world.bodies[0].velocity = (1e-6, 0.0)
    wires, _keep = connect(world.space, world.bodies)
    _step_alone(wires.calls, 1, DT)
    start = process_time()
    _step_alone(wires.calls, steps, DT)
    return process_time() - start


def everybody(count, *, engine, seconds=20.0):
    """All ``count`` robots drive all the time, at one robot a square metre.

    Returns CPU time for 0.1 s [s]: in all, of it driving, of it sending; and how many were sent.
    """
    side = sqrt(count)
    arena, rng = Arena(side, side), np.random.default_rng(3)
    points = scatter(arena, count, SPEC.radius, rng)
    motion, robots = fleet(points, rng.uniform(-pi, pi, count), arena, engine)
    driving = sending = 0.0
    sent, idle, ticks = 0, list(robots), 0
    while ticks < 10 * seconds:
        start = process_time()
        for robot in idle:
            way, turn = rng.uniform(1.0, 4.0), rng.uniform(-pi, pi)
            x = min(max(robot.position[0] + way * cos(turn), 0.2), side - 0.2)
            y = min(max(robot.position[1] + way * sin(turn), 0.2), side - 0.2)
            motion.depart(robot, (x, y))
        middle = process_time()
        if ticks >= 20:  # past the rush of the start
            sent += len(idle)
            sending += middle - start
        idle = [robots[trip.robot] for trip in motion.advance(0.1 * (ticks + 1))]
        if ticks >= 20:
            driving += process_time() - middle
        if not idle:
            ticks += 1
    parts = 10.0 * seconds - 20
    return (driving + sending) / parts, driving / parts, sending / parts, sent / parts


def start_up():
    """Seconds until the first trip of a process, compiling and from the cache."""
    code = (
        "from benchmarks_motion import lifetime" if False else
        "import sys; sys.path.insert(0, sys.argv[1]); import motion; motion.first_trip()"
    )
    here = os.path.dirname(os.path.abspath(__file__))
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        for label in ("compiling", "from the cache"):
            run = subprocess.run(
                [sys.executable, "-c", code, here],
                env=environment, capture_output=True, text=True, check=True,
            )  # fmt: skip
            print(f"  first trip, {label:16s} {float(run.stdout):6.2f} s")


def first_trip():
    """Print the CPU time of one trip in physics, imports excluded."""
    start = process_time()
    motion, robots = fleet(*tasks(0)[:2], Arena(), engine=True)
    motion.depart(robots[0], (5.0, 5.0))
    motion.advance(inf)
    print(process_time() - start)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--repeat", type=int, default=9)
    repeat = parser.parse_args().repeat
    for engine in (True, False):
        lifetime(0, engine=engine)
    physics, path = ([lifetime(s, engine=e) for s in range(repeat)] for e in (True, False))
    assert [run[1:] for run in physics] == [run[1:] for run in path]
    ours, without = (median(run[0] for run in runs) for runs in (physics, path))
    steps = median(run[1] for run in physics)
    plain = [plain_lifetime(seed, 60) for seed in range(3)]
    slow = median(run[0] for run in plain)
    floor = min(bare_steps(int(steps)) for _ in range(5))
    print(f"one lifetime: {TASKS} tasks, {steps:.0f} steps")
    print(f"  physics                {ours * 1e3:8.1f} ms  {1.0 / ours:6.1f} a second")
    print(f"  path                   {without * 1e3:8.1f} ms  {ours / without:6.2f} x physics")
    print(f"  plain pymunk           {slow * 1e3:8.1f} ms  physics is {slow / ours:5.1f} x as fast")
    print(f"  the engine's steps     {floor * 1e3:8.1f} ms  physics has {floor / ours:5.2f} of that speed")
    gap = median(run[2] for run in plain) / median(run[2] for run in physics[:3]) - 1.0
    print(f"  energy, plain against physics: {gap:+.1%}")
    print("everybody drives, CPU time for 0.1 s:")
    for count in (100, 1000):
        for engine in (False, True):
            total, driving, sending, sent = everybody(count, engine=engine)
            name = "physics" if engine else "path"
            print(
                f"  {count:5d} robots, {name:8s} {total * 1e6:7.0f} us: driving"
                f" {driving * 1e6:6.0f}, sending {sent:4.1f} robots {sending * 1e6:6.0f}"
            )
    print("starting:")
    start_up()


if __name__ == "__main__":
    main()
