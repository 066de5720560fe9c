"""What the kernels have to know of how robots drive: limits that wheels can keep, and gains."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from fleet.motion.builds import GRAVITY, Resistance, inertia_of, resistance_of
from fleet.motion.kernels.profile import FORCE_SHARE
from fleet.motion.kernels.records import PARAMS, TURN_SHARE
from fleet.motion.options import DriveOptions
from fleet.robot import RobotSpec

SINK = 8e-4  # [m] that bodies which drive into each other may sink in before they are stopped
TICK = 1.0 / 15.0  # [s] from knot to knot of a track, about
WINDOW = 1.0 / 15.0  # [s] that a change of curvature is spread over, at least
LONGEST_WINDOW = 0.25  # [s]
ALONG_SHARE = 0.6  # of traction for speeding up and braking, beside arcs
ACROSS_SHARE = 0.5  # of traction for arcs
RESPONSE = 0.04  # [s] in which the controller takes errors of speed away
ALONG_GAIN, HEADING_GAIN = 5.0, 8.0  # [1/s] by which errors are taken away
STRAYS = 0.0015  # [m] by which a robot may be off its reference that its controller knows
STRAYS_UNKNOWN = 0.021  # [m] more, times how far the robot is from what its controller believes


@dataclass(frozen=True, slots=True)
class Limits:
    """What a plan may ask of a robot.

    Raises:
        ValueError: (by :func:`limits_of`) it cannot drive at all.
    """

    acceleration: float  # [m/s²]
    turn_rate: float  # [rad/s]
    turn_acceleration: float  # [rad/s²]
    cornering: float  # acceleration across an arc [m/s²]
    window: float  # over which a change of curvature is spread [s]


def limits_of(spec: RobotSpec, resistance: Resistance) -> Limits:
    """What wheels can give, within what the robot is allowed.

    Raises:
        ValueError: they cannot overcome its resistance, or its scrub.
    """
    needed = 0.5 * (resistance.rolling + resistance.viscous * spec.cruise)  # by a wheel [N]
    grip, half = 0.5 * spec.traction * spec.mass * GRAVITY, 0.5 * spec.wheel_track
    if spec.motor <= needed:
        raise ValueError(
            f"robot motor is {spec.motor} N; at {spec.cruise} m/s its resistance takes"
            f" {needed:.3g} N of each wheel; expected more"
        )
    along = 2.0 * FORCE_SHARE * min(spec.motor - needed, ALONG_SHARE * grip) / spec.mass
    across = ACROSS_SHARE * spec.traction * GRAVITY
    if spec.drive == "holonomic":
        most = min(spec.acceleration, along)
        return Limits(most, inf, inf, min(across, along), 0.0)
    force = min(spec.motor - needed, grip)
    couple = 2.0 * force * half - spec.scrub
    if couple <= 0.0:
        key, value = ("motor", f"{spec.motor} N") if spec.motor - needed < grip else (
            "traction", f"{spec.traction}"
        )  # fmt: skip
        raise ValueError(
            f"robot {key} is {value}; wheels that push with {force:.3g} N and are"
            f" {spec.wheel_track:.3g} m apart cannot turn against a scrub of {spec.scrub} N·m;"
            f" expected enough for {0.5 * spec.scrub / half:.3g} N of each wheel"
        )
    turning = FORCE_SHARE * couple / inertia_of(spec)
    rate = min(spec.turn_rate, LONGEST_WINDOW * turning / TURN_SHARE)
    sharpest = min(TURN_SHARE * rate, spec.cruise / (2.0 * spec.radius))
    return Limits(
        min(spec.acceleration, along),
        rate,
        min(spec.turn_acceleration, turning),
        across,
        max(WINDOW, sharpest / turning),
    )


def params_of(
    spec: RobotSpec, options: DriveOptions, sample_interval: float | None
) -> NDArray[np.void]:
    """The record (1,) PARAMS that all kernels share.

    Raises:
        ValueError: the robot cannot drive at all.
    """
    resistance = resistance_of(spec)
    limits = limits_of(spec, resistance)
    stride = max(1, round(TICK / options.dt))
    params = np.zeros(1, PARAMS)
    for name in ("acceleration", "turn_rate", "turn_acceleration", "cornering", "window"):
        params[name] = getattr(limits, name)
    for name in (
        "radius", "cruise", "motor", "windings", "turning", "reverse"
    ):  # fmt: skip
        params[name] = getattr(spec, name)
    params["dt"], params["substeps"], params["stride"] = options.dt, 1, stride
    params["half_track"], params["onset"] = 0.5 * spec.wheel_track, spec.scrub_onset
    params["electronics"], params["idle"] = resistance.electronics, spec.extra.idle
    response = max(RESPONSE, options.dt)
    slower = RESPONSE / response
    params["servo"] = 1.0 / response
    params["cost"], params["back"] = 1.0 / spec.efficiency, spec.efficiency * spec.regeneration
    params["along_gain"], params["heading_gain"] = ALONG_GAIN * slower, HEADING_GAIN * slower
    params["across_gain"] = (0.5 * HEADING_GAIN * slower / spec.cruise) ** 2
    params["margin"] = margin = margin_of(spec)
    params["holonomic"] = spec.drive == "holonomic"
    params["reserved"] = options.traffic == "reserved"
    apart = max(options.headway, 2.0 * margin)
    params["gap"] = 2.0 * (spec.radius + _uneven(spec, limits, stride * options.dt)) + apart
    if sample_interval is not None:
        params["sample"] = max(1, round(sample_interval / options.dt))
    return params


def margin_of(spec: RobotSpec) -> float:
    """How far a robot may be from its reference when nothing is wrong [m]."""
    return STRAYS + STRAYS_UNKNOWN * max(spec.error, spec.payload / spec.mass)


def ladder_of(spec: RobotSpec, options: DriveOptions) -> tuple[float, ...]:
    """Clearances [m] to try in turn for a robot: those of the options, but none below its margin.

    One more comes first if it lets a differential drive go around others at cruise speed: the
    arc then has a radius of two robots' and the clearance.
    """
    margin = margin_of(spec)
    wide = [clearance for clearance in options.clearances if clearance > margin]
    rungs = tuple(wide) if len(wide) == len(options.clearances) else (*wide, margin)
    limits = limits_of(spec, resistance_of(spec))
    at_cruise = max(
        spec.cruise / (TURN_SHARE * limits.turn_rate), spec.cruise**2 / limits.cornering
    )
    widest = at_cruise - 2.0 * spec.radius
    if spec.drive == "holonomic" or widest <= rungs[0]:
        return rungs
    return (widest, *rungs)


def fine_substeps(spec: RobotSpec, options: DriveOptions) -> int:
    """Into how many steps of the engine a step must be divided where bodies may touch."""
    return ceil(2.0 * spec.cruise * options.dt / SINK)


def _uneven(spec: RobotSpec, limits: Limits, tick: float) -> float:
    """How far a robot may be from where even motion between two knots has it [m].

    At most an eighth of its acceleration times the time squared, along or across its path; and
    at most a quarter of what it drives at cruise speed, however sharply it speeds up.
    """
    across = min(limits.cornering, TURN_SHARE * limits.turn_rate * spec.cruise)
    acceleration = max(limits.acceleration, across)
    return min(acceleration * tick * tick / 8.0, spec.cruise * tick / 4.0)
