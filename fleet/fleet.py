"""The fleet of a run: its robots, in their world, with their links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fleet.radio import Radio
from fleet.robot import Robot, RobotSpec
from protocols.topology import Topology
from worlds.arena import Arena
from worlds.sensors import SensorField


@dataclass(frozen=True, slots=True)
class RunLabels:
    """What a run is called in its summary and in its recording."""

    protocol: str
    motion: str
    world: str
    seed: int
    search_radius: float  # [m]
    metric: str = ""  # what bids are worth, and in what unit
    unit: str = ""
    routed: bool = True  # whether the protocol searches for the robot that decides
    belief: str = "straight"  # what robots believe that a trip costs: see fleet.motion.options


@dataclass(frozen=True, slots=True)
class Fleet:
    """A fleet in its world, live: robots and topology change as the run goes on."""

    labels: RunLabels
    arena: Arena
    spec: RobotSpec
    robots: Sequence[Robot]
    topology: Topology  # the true one, whatever robots believe
    radio: Radio  # that they talk over
    field: SensorField | None = None  # of sensors that notice events
