"""What motion costs, and the batteries that pay for it."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True, slots=True)
class PowerModel:
    """P(v) = c2·v² + c1·v + c0 [W], the power of a robot that drives at speed v.

    Eq. (1) of Stanulovic et al. (Sensors 21(18):6149, 2021) is the integral of this power
    over a straight drive at constant speed: E = P(v)·d/v. At 0.76 m/s that is 19.3558 J/m.

    Raises:
        ValueError: a coefficient is negative, or all are 0.
    """

    quadratic: float = 6.25  # c2 [W·s²/m²]
    linear: float = 9.79  # c1 [W·s/m]
    constant: float = 3.66  # c0 [W]

    def __post_init__(self) -> None:
        for name in ("quadratic", "linear", "constant"):
            value = getattr(self, name)
            if not value >= 0.0:
                raise ValueError(f"power coefficient {name} is {value}; expected 0 or more")
        if self.quadratic == self.linear == self.constant == 0.0:
            raise ValueError("all power coefficients are 0; expected at least one above 0")

    def power(self, speed: float) -> float:
        """P(v) [W] at ``speed`` [m/s]."""
        return (self.quadratic * speed + self.linear) * speed + self.constant

    def per_metre(self, speed: float) -> float:
        """The energy of one metre at a constant ``speed`` [m/s]: P(v)/v [J/m], Eq. (1)."""
        return self.quadratic * speed + self.linear + self.constant / speed


@dataclass(frozen=True, slots=True)
class ExtraPower:
    """What the paper leaves out; all off by default.

    Raises:
        ValueError: a value is negative.
    """

    idle: float = 0.0  # [W] of a robot that stands: parked, or waiting to set off
    transmission: float = 0.0  # [J] for each frame sent; charged by the simulation
    reception: float = 0.0  # [J] for each frame received; charged by the simulation
    listening: float = 0.0  # [W] of the radio of a robot on the air, standing or driving

    def __post_init__(self) -> None:
        for name in ("idle", "transmission", "reception", "listening"):
            value = getattr(self, name)
            if not 0.0 <= value < inf:
                raise ValueError(f"{name} power is {value}; expected 0 or more")


class Battery:
    """A store of energy that can only be emptied.

    Raises:
        ValueError: the capacity is not positive.
    """

    __slots__ = ("capacity", "charge")

    def __init__(self, capacity: float) -> None:
        if not capacity > 0.0:
            raise ValueError(f"battery capacity {capacity} J; expected more than 0")
        self.capacity = capacity  # [J]
        self.charge = capacity  # [J]

    def drain(self, energy: float) -> float:
        """Take ``energy`` [J] out; what is not there is not taken. Returns what was."""
        if not energy >= 0.0:
            raise ValueError(f"cannot drain {energy} J; expected 0 or more")
        before, self.charge = self.charge, max(0.0, self.charge - energy)
        return before - self.charge
