"""A body that is told how fast to go, moment by moment, as a recorded robot was.

Importing this module loads numba; pymunk is loaded by the first drive.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion.builds import builds_of
from fleet.motion.kernels.loop import run
from fleet.motion.kernels.records import ARRIVED, EFFORT, MOVER, WAITING, Records, Traffic
from fleet.motion.options import DriveOptions
from fleet.motion.params import ladder_of, params_of
from fleet.motion.planning import Planner
from fleet.power import Battery
from fleet.robot import Robot, RobotSpec
from protocols.messages import Point
from worlds.arena import Arena

Floats = NDArray[np.float64]

_HELD = 1e9  # [J] in its battery: enough for any drive
_AFTER = 180  # steps in which it may come to rest
_SPARE = 4  # samples for which there is room behind a reference


class DrivenBody(NamedTuple):
    """What a drive on commands came to."""

    energy: float  # [J]
    path: float  # [m]
    arrived: bool  # it came to rest where the commands lead; otherwise it could not follow


def drive_commanded(
    spec: RobotSpec, v: Floats, omega: Floats, options: DriveOptions | None = None
) -> DrivenBody:
    """Drive one body of ``spec`` by forces at speeds ``v`` (n,) [m/s], turning at ``omega`` (n,)
    [rad/s], a command for each step of ``options.dt``; from rest, to rest.

    Its controller follows the place where commands lead as it follows any plan: a body that cannot
    keep up is let come after.

    Raises:
        ValueError: the robot cannot drive at all.
    """
    from fleet.motion.engine import Engine

    options = options or DriveOptions(traffic="free")
    reference = _reference(np.r_[0.0, v, 0.0], np.r_[0.0, omega, 0.0], options.dt)
    low, high = reference[:, :2].min(axis=0), reference[:, :2].max(axis=0)
    margin = 2.0 * spec.radius + 1.0
    reference[:, :2] += margin - low
    arena = Arena(*(high - low + 2.0 * margin).tolist())
    start = float(reference[0, 0]), float(reference[0, 1])
    planner = Planner(arena, spec.radius, [start], ladder_of(spec, options))
    builds = builds_of(spec, 1, np.random.default_rng(0))
    robot = Robot(0, start, 0.0, Battery(_HELD), 1.0, [], _Unasked())
    engine = Engine(arena, spec.radius, builds, [robot], bridge=options.bridge)
    traffic = _traffic(params_of(spec, options, None), builds, reference, start)
    steps = len(reference) - _SPARE + _AFTER
    mover, active = traffic.movers[0], np.zeros(1, np.int64)
    if engine.wires is not None:
        run(planner.floor, traffic, engine.wires, active, 0, steps, np.zeros((0, 8)))
    else:
        for step in range(steps):
            engine.step(planner.floor, traffic, active, step)
            if mover["phase"] >= ARRIVED:
                break
    return DrivenBody(float(mover["spent"]), float(mover["path"]), bool(mover["phase"] == ARRIVED))


class _Unasked:
    """Nobody asks a body on commands what it believes."""

    def cost(self, robot: Robot, site: Point) -> float:
        raise NotImplementedError


def _reference(v: Floats, omega: Floats, step: float) -> Floats:
    """Where commands (n,) lead: x, y, heading, way after each; and room behind."""
    heading = np.r_[0.0, np.cumsum(omega) * step]
    middle = 0.5 * (heading[1:] + heading[:-1])
    x, y = (np.r_[0.0, np.cumsum(v * side) * step] for side in (np.cos(middle), np.sin(middle)))
    rows = np.column_stack([x, y, heading, np.r_[0.0, np.cumsum(v) * step]])
    return np.vstack([rows, np.repeat(rows[-1:], _SPARE, axis=0)])


def _traffic(params: Records, builds: Records, reference: Floats, start: Point) -> Traffic:
    """One robot at rest, about to follow a reference."""
    movers = np.zeros(1, MOVER)
    mover = movers[0]
    mover["phase"], mover["count"], mover["held"] = WAITING, len(reference) - _SPARE, _HELD
    mover["x"], mover["y"] = start
    return Traffic(
        params, builds, movers, np.zeros(1, EFFORT), reference[None].copy(),
        np.zeros((1, 1, 2), np.float32), np.zeros((1, 4)), np.zeros(1, np.int64),
        np.zeros(1, MOVER), np.zeros((1, 4)), np.zeros((1, 4)), np.zeros((1, 2), np.int64),
    )  # fmt: skip
