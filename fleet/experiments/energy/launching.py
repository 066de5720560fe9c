"""What a launch costs by the drive law, in closed form: to set beside what is fitted."""

from __future__ import annotations

from math import nan, pi, sqrt

from fleet.robot import RobotSpec


def ramps_cost(spec: RobotSpec) -> float:
    """Speeding up to cruise and braking to rest, beyond Eq. (1) on the way they take [J].

    ∫P(v) dt over both ramps is 2·(c2·v³/3 + c1·v²/2 + c0·v)/a; Eq. (1) on the v²/a of their way
    is (c2·v + c1 + c0/v)·v²/a. What is left is (c0·v - c2·v³/3)/a, whatever the distance, if it
    is long enough to reach cruise speed.
    """
    v, power = spec.cruise, spec.power
    lost = 0.5 * spec.mass * v * v if spec.extra.kinetic else 0.0
    return (power.constant * v - power.quadratic * v**3 / 3.0) / spec.acceleration + lost


def pivot_cost(spec: RobotSpec) -> float:
    """Turning towards the site first, over headings of which all are alike [J].

    A turn by θ from rest to rest takes 2·√(θ/α) at the angular acceleration α, on P(0); the mean
    of √θ from 0 to Θ is 2/3·√Θ. NaN: the turn rate is reached on the way, or wheels pay.
    """
    if spec.drive == "holonomic":
        return 0.0
    most = 0.5 * pi if spec.reverse else pi
    if spec.extra.per_wheel or most > spec.turn_rate**2 / spec.turn_acceleration:
        return nan
    return spec.power.constant * 4.0 / 3.0 * sqrt(most / spec.turn_acceleration)


def launch_cost(spec: RobotSpec) -> float:
    """Both [J]."""
    return ramps_cost(spec) + pivot_cost(spec)
