"""The ways to go by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fleet.motion import Motion
from fleet.motion.straight import StraightMotion
from fleet.robot import RobotSpec
from worlds.arena import Arena


class Entry(NamedTuple):
    """A function that makes a motion, and whether its robots have bodies that need room."""

    function: Callable[..., Motion]  # spec, arena, sample interval [s]; parameters by keyword
    solid: bool
    source: str


def straight(spec: RobotSpec, _arena: Arena, sample_interval: float | None) -> Motion:
    """Straight to the event at cruise speed, through everything: Eq. (1) exactly."""
    return StraightMotion(spec, sample_interval)


MOTIONS: dict[str, Entry] = {
    "straight": Entry(straight, False, "Stanulovic et al., Sensors 21(18):6149, 2021, section 5"),
}
