"""The ways to go by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from numpy.random import Generator

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

    function: Callable[..., Motion]  # spec, arena, options, sample interval [s], rng
    options: type[Any]
    solid: bool
    source: str


def straight(
    spec: RobotSpec,
    _arena: Arena,
    _options: NoOptions,
    sample_interval: float | None,
    _rng: Generator | None,
) -> Motion:
    """Straight to the event at cruise speed, through everything: Eq. (1) exactly."""
    return StraightMotion(spec, sample_interval)


def path(
    spec: RobotSpec,
    arena: Arena,
    options: DriveOptions,
    sample_interval: float | None,
    rng: Generator | None,
) -> Motion:
    """The prediction: shortest paths around others, driven exactly as planned; nothing touches."""
    from fleet.motion.driven import DrivenMotion

    return DrivenMotion(
        spec, arena, options, engine=False, sample_interval=sample_interval, rng=rng
    )


def physics(
    spec: RobotSpec,
    arena: Arena,
    options: DriveOptions,
    sample_interval: float | None,
    rng: Generator | None,
) -> Motion:
    """The same paths, driven by wheels that push pymunk bodies: they can slip, touch and push."""
    from fleet.motion.driven import DrivenMotion

    return DrivenMotion(spec, arena, options, engine=True, sample_interval=sample_interval, rng=rng)


PAPER = "Stanulovic et al., Sensors 21(18):6149, 2021, section 5"

MOTIONS: dict[str, MotionKind] = {
    "path": MotionKind(path, DriveOptions, True, "tangent graph: exact; drive: inverse dynamics"),
    "physics": MotionKind(
        physics, DriveOptions, True, "Munk2D through pymunk; wheels: docs/motion.md"
    ),
    "straight": MotionKind(straight, NoOptions, False, PAPER),
}
