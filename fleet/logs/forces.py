"""What a robot's wheels have to push for a recorded motion, and what that costs.

The law by forces has the parameters of a simulated robot: rolling resistance F, viscous resistance
k, scrub Q when turning, electronics, and power while turning. Wheels push against them and against
the robot's inertia; its battery pays work over efficiency, and heat in the windings:

    f = (m·a + F·sgn(w) + k·w)/2 ∓ (I·α + Q·s)/(2h),  P = c + τ·|s| + Σ [f·w]₊/η + κ·f²

for wheels at speeds w = v ∓ h·ω. Scrub is full once the robot turns sharply: s is ω/(onset·|v|)
within ± 1. Mass, track, efficiency and windings are not fitted: they are told, or a robot's
defaults. Of two onsets, that of tyres that drag on every bend and that of wheels that drag on the
spot only, the one that fits better is taken, unless one is told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fleet.logs.asking import LogSettings
from fleet.robot import RobotSpec

Floats = NDArray[np.float64]

ONSETS = (0.4, 100.0)  # [rad/m] of a skid steer, and of round wheels with a caster
_SOFT, _SOFTER = 1e-4, 0.02  # [rad/s] over which scrub, and power of turning, set in on the spot
_ROLLS = 1e-3  # [m/s] below which a wheel's resistance fades


@dataclass(frozen=True, slots=True)
class Chassis:
    """What of a robot decides its wheels' forces and is not fitted."""

    mass: float  # [kg]
    inertia: float  # [kg·m²]
    half_track: float  # [m]
    efficiency: float = 1.0
    windings: float = 0.0  # [W/N²]
    scrub_onset: float = ONSETS[-1]  # [rad/m]
    regeneration: float = 0.0


def chassis_of(settings: LogSettings) -> Chassis:
    """The chassis of a robot that is logged; what is not told is a scenario's default."""
    spec = RobotSpec()
    mass = settings.mass if settings.mass is not None else spec.mass
    track = settings.track if settings.track is not None else spec.wheel_track
    motor, told = settings.motor, settings
    return Chassis(
        mass=mass,
        inertia=_or(told.inertia, 0.5 * mass * (0.5 * track) ** 2),
        half_track=0.5 * track,
        efficiency=_or(told.efficiency, spec.efficiency if motor is None else 1.0),
        windings=_or(
            told.windings, spec.windings if motor is None else motor.resistance / motor.k**2
        ),
        scrub_onset=_or(told.scrub_onset, ONSETS[-1]),
        regeneration=_or(told.regeneration, 0.0),
    )


def _or(told: float | None, usual: float) -> float:
    return usual if told is None else told


@dataclass(frozen=True, slots=True)
class _Side:
    """One side's wheels along a motion: their speed, and what pushes against them."""

    speed: Floats  # (n,) [m/s]
    inert: Floats  # (n,) [N]
    rolls: Floats  # (n,) of rolling resistance
    drags: Floats  # (n,) of viscous resistance [m/s]
    turns: Floats  # (n,) of scrub [1/m]

    def force(self, parameters: Floats) -> Floats:
        """What the wheels push with (n,) [N]."""
        rolling, _, scrub, _, viscous = parameters
        force: Floats = (
            self.inert + rolling * self.rolls + viscous * self.drags + scrub * self.turns
        )
        return force


def scrub_share(chassis: Chassis, v: Floats, omega: Floats, soft: float = _SOFT) -> Floats:
    """How much of the scrub there is (n,), -1 to 1: tyres that roll yield before they slide."""
    share: Floats = np.clip(omega / (soft + chassis.scrub_onset * np.abs(v)), -1.0, 1.0)
    return share


def _sides(chassis: Chassis, time: Floats, v: Floats, omega: Floats) -> tuple[_Side, _Side]:
    """Both sides, from each sample to the next: n is one less than there are samples."""
    half, step = chassis.half_track, np.diff(time)
    push = 0.5 * chassis.mass * np.diff(v) / step
    twist = 0.5 * chassis.inertia / half * np.diff(omega) / step
    v, omega = _means(v, omega)
    soft = scrub_share(chassis, v, omega)

    def side(sign: float) -> _Side:
        wheel = v + sign * half * omega
        rolls = 0.5 * np.clip(wheel / _ROLLS, -1.0, 1.0)
        return _Side(wheel, push + sign * twist, rolls, 0.5 * wheel, 0.5 * sign / half * soft)

    return side(-1.0), side(1.0)


def _means(v: Floats, omega: Floats) -> tuple[Floats, Floats]:
    """Speeds and turning rates from each sample to the next."""
    return 0.5 * (v[1:] + v[:-1]), 0.5 * (omega[1:] + omega[:-1])


def wheel_forces(
    chassis: Chassis, time: Floats, v: Floats, omega: Floats, parameters: Floats
) -> tuple[Floats, Floats]:
    """What the left and right wheels push with, from each of n + 1 samples to the next (n,) [N]."""
    left, right = _sides(chassis, time, v, omega)
    return left.force(parameters), right.force(parameters)


def linearised(
    chassis: Chassis, time: Floats, v: Floats, omega: Floats, parameters: Floats
) -> tuple[Floats, Floats]:
    """Power near ``parameters`` (5,): its derivatives (n, 5) [W per unit], and the rest (n,) [W].

    From each of n + 1 samples to the next: work is force times the mean of the velocities.

    Parameters in the order of :data:`fleet.logs.sampling.TERMS`: rolling F [N], constant [W], scrub
    Q [N·m], turning [W], viscous k [N·s/m].
    """
    terms = np.zeros((len(v) - 1, 5))
    rest = np.zeros(len(v) - 1)
    terms[:, 1] = 1.0
    terms[:, 3] = np.abs(scrub_share(chassis, *_means(v, omega), _SOFTER))
    for side in _sides(chassis, time, v, omega):
        force = side.force(parameters)
        gain = np.where(
            force * side.speed > 0.0,
            1.0 / chassis.efficiency,
            chassis.regeneration * chassis.efficiency,
        )
        slope = gain * side.speed + 2.0 * chassis.windings * force
        for column, share in ((0, side.rolls), (2, side.turns), (4, side.drags)):
            terms[:, column] += slope * share
        power = gain * side.speed * force + chassis.windings * force**2
        rest += power - slope * (force - side.inert)
    return terms, rest
