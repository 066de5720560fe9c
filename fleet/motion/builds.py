"""What robots are like as bodies: in truth, and as their controllers believe.

Eq. (1) is read as physics. Driving steadily and straight at speed v, a robot whose wheels meet the
resistance F = rolling + viscous·v takes F·v/efficiency + windings·F²/2 + electronics, each of two
motors giving half of F. This is P(v) = c2·v² + c1·v + c0 for every v if

    viscous = (√(1/efficiency² + 2·windings·c2) - 1/efficiency)/windings    (c2·efficiency without)
    rolling = c1/(1/efficiency + windings·viscous)
    electronics = c0 - windings·rolling²/2
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fleet.motion.kernels.records import BUILD, Records
from fleet.robot import RobotSpec

GRAVITY = 9.81  # [m/s²]


class Resistance(NamedTuple):
    """P(v) read as physics."""

    rolling: float  # [N]
    viscous: float  # [N·s/m]
    electronics: float  # [W]


def resistance_of(spec: RobotSpec) -> Resistance:
    """What makes steady straight driving cost ``spec.power``.

    Raises:
        ValueError: the windings would take more than the power at standstill.
    """
    cost, heat, power = 1.0 / spec.efficiency, spec.windings, spec.power
    viscous = power.quadratic / cost
    if heat > 0.0:
        viscous = 2.0 * power.quadratic / (sqrt(cost * cost + 2.0 * heat * power.quadratic) + cost)
    rolling = power.linear / (cost + heat * viscous)
    warm = 0.5 * heat * rolling * rolling
    if warm > power.constant:
        raise ValueError(
            f"robot windings is {heat} W/N²; at standstill that alone takes {warm:.3g} W of"
            f" power.constant, {power.constant} W; expected less"
        )
    return Resistance(rolling, viscous, power.constant - warm)


def inertia_of(spec: RobotSpec) -> float:
    """About the vertical axis [kg·m²]: as given, or a solid disc's."""
    return 0.5 * spec.mass * spec.radius**2 if spec.inertia is None else spec.inertia


def builds_of(spec: RobotSpec, robots: int, rng: np.random.Generator) -> Records:
    """(robots + 1,) BUILD: every robot in truth, and last what all controllers believe.

    Mass, resistances, scrub and traction of each robot differ from what is believed by up to
    ``spec.error`` of it, evenly spread and each by itself. A payload presses on the wheels, too.
    """
    resistance = resistance_of(spec)
    off = 1.0 + spec.error * np.vstack([rng.uniform(-1.0, 1.0, (robots, 5)), np.zeros(5)])
    mass = spec.mass * off[:, 0]
    mass[:-1] += spec.payload
    load = mass / spec.mass
    builds = np.zeros(robots + 1, BUILD)
    builds["mass"], builds["inertia"] = mass, inertia_of(spec) * load
    builds["per_mass"], builds["per_inertia"] = 1.0 / mass, 1.0 / builds["inertia"]
    builds["rolling"] = resistance.rolling * off[:, 1] * load
    builds["viscous"] = resistance.viscous * off[:, 2]
    builds["scrub"] = spec.scrub * off[:, 3] * load
    builds["grip"] = 0.5 * spec.traction * off[:, 4] * mass * GRAVITY
    if spec.drive == "holonomic":
        builds["scrub"] = 0.0
    return builds
