"""What the kernels have to know of the robot's build and of the options."""

from __future__ import annotations

from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from fleet.motion.kernels.records import GRIP, PARAMS
from fleet.motion.options import DriveOptions
from fleet.robot import RobotSpec

SINK = 5e-4  # [m] that bodies which drive into each other may sink in before they are stopped
TICK = 1.0 / 15.0  # [s] from knot to knot of a track, about


def params_of(
    spec: RobotSpec, options: DriveOptions, sample_interval: float | None
) -> NDArray[np.void]:
    """The record (1,) PARAMS that all kernels share."""
    stride = max(1, round(TICK / options.dt))
    params = np.zeros(1, PARAMS)
    params["dt"] = options.dt
    params["radius"], params["mass"], params["half_track"] = (
        spec.radius,
        spec.mass,
        0.5 * spec.wheel_track,
    )
    params["cruise"], params["acceleration"] = spec.cruise, spec.acceleration
    params["turn_rate"], params["turn_acceleration"] = spec.turn_rate, spec.turn_acceleration
    for coefficient in ("quadratic", "linear", "constant"):
        params[coefficient] = getattr(spec.power, coefficient)
    for extra in ("idle", "kinetic", "per_wheel"):
        params[extra] = getattr(spec.extra, extra)
    params["holonomic"], params["reverse"] = spec.drive == "holonomic", spec.reverse
    params["reserved"] = options.traffic == "reserved"
    params["stride"] = stride
    params["gap"] = 2.0 * spec.radius + options.headway + 2.0 * _strays(spec, stride * options.dt)
    params["substeps"] = 1
    if sample_interval is not None:
        params["sample"] = max(1, round(sample_interval / options.dt))
    return params


def fine_substeps(spec: RobotSpec, options: DriveOptions) -> int:
    """Into how many steps of the engine a step must be divided where bodies may touch."""
    return ceil(2.0 * spec.cruise * options.dt / SINK)


def _strays(spec: RobotSpec, tick: float) -> float:
    """How far a robot may be from where even motion between two knots has it [m].

    At most an eighth of its acceleration times the time squared, along or across its path; and
    at most a quarter of what it drives at cruise speed, however sharply it speeds up.
    """
    across = inf if spec.drive == "holonomic" else GRIP * spec.turn_rate * spec.cruise
    acceleration = max(spec.acceleration, across)
    return min(acceleration * tick * tick / 8.0, spec.cruise * tick / 4.0)
