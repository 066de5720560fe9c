"""Motion, measured within one run: python benchmarks/motion.py.

A lifetime's work is what RFTA2 sends 100 robots of radius 0.1 m to do, at a step of 1/60 s. It
is driven by this project; by a plain program over pymunk's public interface, along the same
paths by the same profile, its bodies told their velocities; and, for the floor, the engine alone
makes as many steps with one body moving. Then come the figures that must hold: who arrives, what
touches, who waits, and what the step does to the energy. Aims stand in brackets.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from functools import cache
from math import cos, dist, fsum, inf, pi, sin, sqrt
from pathlib import Path
from statistics import fmean, median
from time import process_time

import numpy as np
import pymunk
from plain_pymunk import DT, SPEC, PlainWorld

import fleet
from fleet.motion.chipmunk import connect, step_space
from fleet.motion.driven import DrivenMotion
from fleet.motion.options import DriveOptions
from fleet.motion.planning import Planner
from fleet.observer import Observer
from fleet.power import Battery
from fleet.robot import Robot, RobotSpec
from protocols.compiled import kernel
from worlds.arena import Arena
from worlds.catalogue import WORLDS
from worlds.scattering import scatter


class Work(Observer):
    """Keeps where a lifetime begins, and who is sent where."""

    def run_started(self, fleet):
        self.points = np.array([robot.position for robot in fleet.robots])
        self.headings = np.array([robot.heading for robot in fleet.robots])
        self.tasks = []

    def trip_ended(self, event, trip):
        self.tasks.append((trip.robot, trip.site))


@cache
def work(seed):
    """What RFTA2 has its robots do."""
    seen = Work()
    fleet.run(fleet.Scenario.of(protocol="rfta2", motion="physics", seed=seed), [seen])
    return seen


def crew(points, headings, arena=None, *, engine=True, spec=SPEC, **options):
    """A fleet in place: (motion, robots)."""
    motion = DrivenMotion(spec, arena or Arena(), DriveOptions(**options), engine=engine)
    robots = [
        Robot(id, (x, y), heading, Battery(spec.capacity), 2.5, [], motion)
        for id, ((x, y), heading) in enumerate(zip(points.tolist(), headings.tolist(), strict=True))
    ]
    motion.place(robots)
    return motion, robots


@cache
def engine_steps(seed):
    """In how many steps of a lifetime the engine is called."""
    wanted, made = work(seed), 0
    motion, robots = crew(wanted.points, wanted.headings, dt=DT, bridge=False)
    step = motion._engine.step

    def counted(*arguments):
        nonlocal made
        made += 1
        step(*arguments)

    motion._engine.step = counted
    for robot, site in wanted.tasks:
        motion.depart(robots[robot], site)
        motion.advance(inf)
    return made


def lifetime(seed, *, engine):
    """Drive it here: (CPU time [s], steps, energy [J])."""
    wanted = work(seed)
    began = process_time()
    motion, robots = crew(wanted.points, wanted.headings, engine=engine, dt=DT)
    steps, energy = 0, 0.0
    for robot, site in wanted.tasks:
        motion.depart(robots[robot], site)
        (trip,) = motion.advance(inf)
        steps += trip.steps
        energy += trip.energy
    return process_time() - began, steps, energy


def plain_lifetime(seed):
    """The same by the plain program: (CPU time [s], steps, energy [J])."""
    wanted = work(seed)
    began = process_time()
    world = PlainWorld(wanted.points, wanted.headings)
    took = process_time() - began
    places = [(x, y) for x, y in wanted.points.tolist()]
    planner = Planner(Arena(), SPEC.radius, places, DriveOptions().clearances)
    began, steps, energy = process_time(), 0, 0.0
    for robot, site in wanted.tasks:
        plan = planner.plan(robot, places[robot], site)
        if plan.segments is None or not len(plan.segments):
            continue
        names = plan.segments.dtype.names
        segments = [dict(zip(names, segment.tolist(), strict=True)) for segment in plan.segments]
        made, drained = world.drive(robot, segments)
        steps += made
        energy += drained
        places[robot] = tuple(world.bodies[robot].position)
        planner.rest(robot, places[robot])
    return took + process_time() - began, steps, energy


@kernel
def _step_alone(calls, steps, dt):
    for _ in range(steps):
        step_space(calls, dt)


def bare_steps(steps):
    """The engine alone, one body moving among the parked: CPU time of so many steps [s]."""
    world = PlainWorld(work(0).points, work(0).headings)
    world.bodies[0].body_type = pymunk.Body.DYNAMIC
    world.bodies[0].velocity = (1e-6, 0.0)
    wires, _keep = connect(world.space, world.bodies)
    _step_alone(wires.calls, 1, DT)
    began = process_time()
    _step_alone(wires.calls, steps, DT)
    return process_time() - began


def print_speed(seeds):
    """Compare the ways to drive a lifetime's work.

    Ours are short, and others at work on the machine would tip the scales: each is taken some
    times right before and right after the plain program, the median counts, and so does that of
    the lifetimes' ratios.
    """
    for engine in (True, False):
        lifetime(0, engine=engine)
    rows = []
    for seed in seeds:
        physics, path, floor = [], [], []
        for half in range(2):
            for _ in range(5):
                physics.append(lifetime(seed, engine=True))
                path.append(lifetime(seed, engine=False))
                floor.append(bare_steps(engine_steps(seed)))
            if half == 0:
                plain = plain_lifetime(seed)
        ours, without = (median(run[0] for run in runs) for runs in (physics, path))
        rows.append((ours, without, plain[0], median(floor), plain[2] / physics[0][2]))
    ours, without, slow, floor, same = np.array(rows).T
    count = len(rows)
    tasks = sum(len(work(seed).tasks) for seed in seeds)
    print(f"what RFTA2 has 100 robots do, {count} lifetimes of {tasks // count} tasks:")
    row = "  {:34} {:8.1f} ms {}".format
    print(row("physics", 1e3 * median(ours), f"{1.0 / median(ours):.0f} lifetimes a second"))
    print(row("path", 1e3 * median(without), f"{ratios(ours, without)} x as fast as physics"))
    print(
        row(
            "plain pymunk", 1e3 * median(slow),
            f"physics is {ratios(slow, ours)} x as fast [15]; energy {fmean(same):.3f} of ours",
        )
    )  # fmt: skip
    print(
        row(
            "the engine alone, as many steps", 1e3 * median(floor),
            f"physics has {ratios(floor, ours)} of that speed [0.15]",
        )
    )  # fmt: skip


def ratios(above, below):
    """Their ratio lifetime by lifetime: the median, the least and the greatest."""
    each = np.array(above) / np.array(below)
    return f"{median(each):.3g} ({each.min():.3g} to {each.max():.3g})"


def serve(radius, fleets=20, tasks=100):
    """One robot at a time, the third nearest of those that can go: (trips, refused)."""
    spec, trips, refused = RobotSpec(radius=radius, capacity=1e6), [], 0
    for seed in range(fleets):
        rng = np.random.default_rng(seed)
        points = scatter(Arena(), 100, radius, rng)
        motion, robots = crew(points, rng.uniform(-pi, pi, 100), spec=spec, dt=DT)
        for site in rng.uniform(0.0, 10.0, (tasks, 2)).tolist():
            near = sorted(robots, key=lambda robot: dist(robot.position, site))
            ranked = (r for r in near[2:] + near[:2] if motion.cost(r, tuple(site)) < inf)
            robot = next(ranked, None)
            if robot is None:
                refused += 1
                continue
            motion.depart(robot, tuple(site))
            trips += motion.advance(inf)
    return trips, refused


def at_once(world, radius, robots, *, movers=50, tasks=1000):
    """``movers`` robots are under way at all times, to sites up to 3 m away that they believe
    they can reach: (trips, refused).
    """
    spec, rng = RobotSpec(radius=radius, capacity=1e6), np.random.default_rng(3)
    floor = WORLDS[world].function()
    points = floor.place(floor.arena, robots, radius, rng)
    headings = rng.uniform(-pi, pi, robots)
    motion, all_robots = crew(points, headings, floor.arena, spec=spec, dt=DT)
    idle, trips, refused, stranded = list(all_robots), [], 0, []
    while len(trips) < tasks:
        while idle and len(motion.moving) < movers:
            robot = idle.pop(int(rng.integers(len(idle))))
            way, turn = rng.uniform(0.2, 3.0), rng.uniform(-pi, pi)
            x, y = robot.position[0] + way * cos(turn), robot.position[1] + way * sin(turn)
            site = (min(max(x, radius), 10 - radius), min(max(y, radius), 10 - radius))
            if motion.cost(robot, site) < inf:
                motion.depart(robot, site)
            else:
                stranded.append(robot)
        ended = motion.advance(inf)
        trips += ended
        idle += [all_robots[trip.robot] for trip in ended] + stranded
        refused += len(stranded)
        stranded.clear()
    return trips, refused


def print_outcomes():
    """Count who arrives, what touches, and how long they wait."""
    print("2000 tasks, one robot at a time, 100 robots:")
    for radius, aim in ((0.1, "100"), (0.2, "99.5")):
        trips, refused = serve(radius)
        arrived = sum(trip.outcome == "arrived" for trip in trips)
        print(
            f"  radius {radius} m     {arrived / (len(trips) + refused):8.2%} arrived [{aim} %],"
            f" {sum(trip.contacts for trip in trips)} contacts [0]"
        )
    print("50 robots under way at all times, 1000 trips:")
    for world, radius, robots in (
        ("random", 0.1, 100), ("random", 0.2, 100), ("pit", 0.1, 100), ("rooms", 0.1, 100),
        ("rooms", 0.2, 75), ("warehouse", 0.1, 100), ("warehouse", 0.2, 75),
    ):  # fmt: skip
        trips, refused = at_once(world, radius, robots)
        waits = [trip.waited for trip in trips]
        arrived = [trip.outcome for trip in trips].count("arrived")
        print(
            f"  {world:9} {radius} m   {arrived / len(trips):8.2%} arrived,"
            f" {sum(trip.contacts for trip in trips)} contacts [0],"
            f" waited {fmean(waits):.2f} s on average, {max(waits):.1f} s at most;"
            f" {refused} had no path and were not sent"
        )


def print_energy():
    """Compare the energy of trips at two steps, and with the sum of its parts."""
    found = []
    for dt in (DT, 1.0 / 240.0):
        motion, robots = crew(work(0).points, work(0).headings, dt=dt)
        trips = []
        for robot, site in work(0).tasks:
            motion.depart(robots[robot], site)
            trips += [trip for trip in motion.advance(inf) if trip.energy]
        found.append(np.array([trip.energy for trip in trips]))
        parts = [fsum(trip.accounts) for trip in trips]
    off = np.abs(found[0] / found[1] - 1.0)
    split = np.abs(np.array(parts) / found[1] - 1.0).max()
    print("energy of a trip:")
    print(
        f"  step 1/60 s against 1/240 s: off by {off.mean():.1e} on average [1e-3], {off.max():.1e}"
    )
    print(f"  the sum of its parts: off by {split:.1e} at most [1e-3]")


def everybody(count, *, engine, seconds=20.0):
    """All ``count`` robots drive all the time, at one robot a square metre.

    Returns CPU time for 0.1 s [s]: of driving, and of sending; and how many were sent.
    """
    side = sqrt(count)
    arena, rng = Arena(side, side), np.random.default_rng(3)
    points = scatter(arena, count, SPEC.radius, rng)
    motion, robots = crew(points, rng.uniform(-pi, pi, count), arena, engine=engine, dt=DT)
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
    motion, robots = crew(np.array([[1.0, 1.0], [3.0, 3.1]]), np.zeros(2))
    motion.depart(robots[0], (5.0, 5.0))
    motion.advance(inf)
    print(process_time() - began)


def main():
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--repeat", type=int, default=9, help="lifetimes of each kind")
    print_speed(range(parser.parse_args().repeat))
    print_outcomes()
    print_energy()
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
