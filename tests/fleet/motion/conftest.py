"""Fleets to drive, and looking at their paths without the kernels that made them."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from fleet.energy import Battery
from fleet.motion.driven import DrivenMotion
from fleet.motion.kernels.records import LINE
from fleet.motion.options import DriveOptions
from fleet.robot import Robot, RobotSpec
from worlds.arena import Arena, scatter


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
        **options,
    ):
        spec, arena = spec or RobotSpec(), arena or Arena()
        motion = DrivenMotion(
            spec, arena, DriveOptions(**options), engine=engine, sample_interval=interval
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
    """trace(pieces, step): points (k, 2) along a path, ``step`` [m] apart at most."""

    def points_of(piece, step):
        count = max(2, int(piece["length"] / step) + 2)
        along = np.linspace(0.0, piece["length"], count)
        if piece["kind"] == LINE:
            return np.column_stack(
                [
                    piece["x"] + along * cos(piece["angle"]),
                    piece["y"] + along * sin(piece["angle"]),
                ]
            )
        angle = piece["angle"] + piece["sense"] * along / piece["radius"]
        return np.column_stack(
            [
                piece["x"] + piece["radius"] * np.cos(angle),
                piece["y"] + piece["radius"] * np.sin(angle),
            ]
        )

    def make(pieces, step=0.01):
        return np.vstack([points_of(piece, step) for piece in pieces])

    return make
