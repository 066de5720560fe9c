"""Fleets to drive, and looking at their paths without the kernels that made them."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from fleet.motion.driven import DrivenMotion
from fleet.motion.kernels.records import LINE
from fleet.motion.options import DriveOptions
from fleet.power import Battery
from fleet.robot import Robot, RobotSpec
from worlds.arena import Arena
from worlds.scattering import scatter


@pytest.fixture(scope="session")
def driving():
    """driving(points, spec, arena, engine=, headings=, charge=, **options): (motion, robots)."""

    def make(
        points,
        spec=None,
        arena=None,
        *,
        engine=False,
        headings=None,
        charge=None,
        interval=None,
        rng=None,
        **options,
    ):
        spec, arena = spec or RobotSpec(), arena or Arena()
        motion = DrivenMotion(
            spec, arena, DriveOptions(**options), engine=engine, sample_interval=interval, rng=rng
        )
        headings = [0.0] * len(points) if headings is None else headings
        robots = [
            Robot(
                id,
                (float(x), float(y)),
                float(heading),
                Battery(spec.capacity if charge is None else charge),
                2.5,
                [{}] * len(points),
                motion,
            )
            for id, ((x, y), heading) in enumerate(zip(points, headings, strict=True))
        ]
        motion.place(robots)
        return motion, robots

    return make


@pytest.fixture(scope="session")
def crowd(driving):
    """crowd(count, seed, spec, arena, **): a fleet scattered at random: (motion, robots, rng)."""

    def make(count, seed, spec=None, arena=None, **keys):
        spec, arena = spec or RobotSpec(), arena or Arena()
        rng = np.random.default_rng(seed)
        points = scatter(arena, count, spec.radius, rng)
        headings = rng.uniform(-pi, pi, count)
        motion, robots = driving(points, spec, arena, headings=headings, **keys)
        return motion, robots, rng

    return make


@pytest.fixture(scope="session")
def trace():
    """trace(segments, step): points (k, 2) along a path, ``step`` [m] apart at most."""

    def points_of(segment, step):
        count = max(2, int(segment["length"] / step) + 2)
        along = np.linspace(0.0, segment["length"], count)
        if segment["kind"] == LINE:
            return np.column_stack(
                [
                    segment["x"] + along * cos(segment["angle"]),
                    segment["y"] + along * sin(segment["angle"]),
                ]
            )
        angle = segment["angle"] + segment["sense"] * along / segment["radius"]
        return np.column_stack(
            [
                segment["x"] + segment["radius"] * np.cos(angle),
                segment["y"] + segment["radius"] * np.sin(angle),
            ]
        )

    def make(segments, step=0.01):
        return np.vstack([points_of(segment, step) for segment in segments])

    return make
