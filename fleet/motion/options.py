"""How driven motion works: the choices that are not the robot's."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Literal, get_args

Traffic = Literal["reserved", "free"]
Belief = Literal["straight", "path", "corrected", "driven"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveOptions:
    """Parameters of driven motion.

    Traffic is ``reserved``: a robot sets off when its way is free of all others, and they never
    touch; or ``free``: it sets off at once, and bodies may touch and push.

    A robot bids with what it believes a trip costs: Eq. (1) on the ``straight`` line, Eq. (1)
    on the planned ``path``, ``corrected``: ``per_launch`` and ``per_metre`` of that path, or what
    that path will take to be ``driven``, turns and ramps included.

    Raises:
        ValueError: a value is out of its range.
    """

    dt: float = 1.0 / 60.0  # [s] of a step
    traffic: Traffic = "reserved"
    belief: Belief = "straight"
    reachability: bool = True  # believing "straight": bid only if there is a path
    per_metre: float | None = None  # [J/m]; None: of Eq. (1)
    per_launch: float = 0.0  # [J]
    clearances: tuple[float, ...] = (0.03, 0.015, 0.005, 0.001)  # [m] tried in turn
    headway: float = 0.005  # [m] that reserved robots keep between them
    replans: int = 12  # after which a robot gives up
    bridge: bool = True  # let compiled loops call the engine directly

    def __post_init__(self) -> None:
        for name in ("dt", "headway"):
            value = getattr(self, name)
            if not 0.0 < value < inf:
                raise ValueError(f"motion {name} is {value}; expected more than 0, and finite")
        if not 1e-4 <= self.dt <= 0.1:
            raise ValueError(f"motion dt is {self.dt} s; expected 0.0001 to 0.1")
        for name, kinds in (("traffic", Traffic), ("belief", Belief)):
            if getattr(self, name) not in get_args(kinds):
                expected = " or ".join(map(repr, get_args(kinds)))
                raise ValueError(f"motion {name} is {getattr(self, name)!r}; expected {expected}")
        if not self.clearances or not all(0.0 < c < inf for c in self.clearances):
            raise ValueError(
                f"motion clearances are {self.clearances}; expected numbers above 0, one at least"
            )
        if self.per_metre is not None and not 0.0 < self.per_metre < inf:
            raise ValueError(f"motion per_metre is {self.per_metre} J; expected more than 0")
        if not 0.0 <= self.per_launch < inf:
            raise ValueError(f"motion per_launch is {self.per_launch} J; expected 0 or more")
        if self.replans < 0:
            raise ValueError(f"motion replans is {self.replans}; expected 0 or more")
        self._check_correction()

    def _check_correction(self) -> None:
        if self.belief == "corrected" and self.per_metre is None and not self.per_launch:
            raise ValueError(
                "motion belief is 'corrected'; expected per_launch or per_metre as well, without"
                " which it is 'path'"
            )
