"""Logs with a known truth: what a robot that obeys a law would have left behind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

TRUTH = {"distance": 20.0, "time": 5.0, "angle": 12.0, "turning": 3.0}  # J/m, W, J/rad, W
STANDING = 2.0  # [W]


def drive(seed, seconds=150.0, rate=20.0, speeds=(0.2, 0.8), turning=True):
    """Times [s], speeds [m/s] and turning rates [rad/s]: stand, pivot, straight or arc, again."""
    rng = np.random.default_rng(seed)
    count = round(seconds * rate)
    v, omega, at = np.zeros(count), np.zeros(count), round(2.0 * rate)
    while at < count:
        if turning and rng.random() < 0.7:
            until = at + round(rng.uniform(0.8, 3.0) * rate)
            omega[at:until] = rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 1.5)
            at = until
        until = at + round(rng.uniform(4.0, 14.0) * rate)
        v[at:until] = rng.uniform(*speeds)
        if turning and rng.random() < 0.4:
            omega[at:until] = rng.uniform(-0.5, 0.5)
        at = until + round(rng.uniform(1.5, 4.0) * rate)
    return np.arange(count) / rate, v, omega


def power_of(v, omega, truth=TRUTH, standing=STANDING):
    """The power that the law of ``truth`` takes (n,) [W]."""
    speed, turn = np.abs(v), np.abs(omega)
    moves = (speed > 0.02) | (turn > 0.05)
    constant = np.where(moves, truth["time"], standing)
    return (
        constant + truth["distance"] * speed + truth["angle"] * turn + truth["turning"] * (turn > 0)
    )


def logged(seed, **keys):
    """A log as columns: time, v, omega, power."""
    time, v, omega = drive(seed, **keys)
    return {"time": time, "v": v, "omega": omega, "power": power_of(v, omega)}


def table(path, columns, separator=",", head=None):
    """Write columns as a text file."""
    rows = np.column_stack(list(columns.values()))
    names = separator.join(columns) if head is None else head
    lines = [names, *(separator.join(f"{x:.10g}" for x in row) for row in rows)]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def folder_of(path, runs=6, change=lambda columns: columns, **keys):
    """A folder with a log for each seed, each changed on the way."""
    for seed in range(runs):
        table(path / f"run-{seed}.csv", change(logged(seed, **keys)))
    return path


FLEETS = {"small": (12, 10.0), "pioneer": (12, 14.0), "husky": (8, 20.0), "ideal": (12, 10.0)}


def exported(folder, preset, motion="path", rounds=16):
    """A ground of trips at three speeds, and the robot that drove them."""
    from fleet.assembly import run
    from fleet.logs.exporting import TripExport
    from fleet.logs.gathering import gather
    from fleet.scenario.loading import scenario_from

    robots, side = FLEETS[preset]
    scenario = scenario_from({
        "robots": robots, "rounds": rounds, "motion": motion, "range": 30.0,
        "world": {"width": side, "height": side}, "robot": {"preset": preset, "capacity": 1e5},
    })  # fmt: skip
    for number, share in enumerate((1.0, 0.7, 0.4)):
        robot = replace(scenario.robot, cruise=share * scenario.robot.cruise)
        run(replace(scenario, robot=robot), [TripExport(folder, robot, run=number)])
    return gather([folder])[0], scenario.robot
