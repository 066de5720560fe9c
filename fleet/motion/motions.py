"""The ways to go by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from fleet.motion import Motion
from fleet.motion.options import DriveOptions
from fleet.motion.straight import StraightMotion
from fleet.robot import RobotSpec
from worlds.arena import Arena


@dataclass(frozen=True, slots=True, kw_only=True)
class NoOptions:
    """Nothing to choose."""


class MotionKind(NamedTuple):
    """A way to go: how it is made, what can be chosen, and whether robots need room."""

    function: Callable[..., Motion]  # spec, arena, options, sample interval [s]
    options: type[Any]
    solid: bool
    source: str


def straight(
    spec: RobotSpec, _arena: Arena, _options: NoOptions, sample_interval: float | None
) -> Motion:
    """Straight to the event at cruise speed, through everything: Eq. (1) exactly."""
    return StraightMotion(spec, sample_interval)


def path(
    spec: RobotSpec, arena: Arena, options: DriveOptions, sample_interval: float | None
) -> Motion:
    """Shortest paths around others, turning, accelerating and braking; nothing ever touches."""
    from fleet.motion.driven import DrivenMotion

    return DrivenMotion(spec, arena, options, engine=False, sample_interval=sample_interval)


def physics(
    spec: RobotSpec, arena: Arena, options: DriveOptions, sample_interval: float | None
) -> Motion:
    """As path, but pymunk steps the bodies, so that they can touch and push."""
    from fleet.motion.driven import DrivenMotion

    return DrivenMotion(spec, arena, options, engine=True, sample_interval=sample_interval)


PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021, section 5"

MOTIONS: dict[str, MotionKind] = {
    "path": MotionKind(
        path, DriveOptions, True, "tangent graph: exact; drive: trapezoidal profile"
    ),
    "physics": MotionKind(physics, DriveOptions, True, "Munk2D through pymunk"),
    "straight": MotionKind(straight, NoOptions, False, PAPER),
}
