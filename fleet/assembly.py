"""From the parts that a scenario names to a simulation that is ready to run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf, pi

import numpy as np

from fleet.energy import Battery
from fleet.motion.straight import StraightMotion
from fleet.observer import Observer
from fleet.radio import IdealRadio
from fleet.robot import Robot, RobotSpec
from fleet.simulation import Fleet, Labels, Simulation
from protocols.links import unit_disc
from protocols.topology import Topology
from worlds.arena import FloatArray, ImpossibleWorld
from worlds.catalogue import World

STREAMS = ("placement", "sites", "collector", "heading")
"""Independent random streams of a run. Append only: the order decides every run."""


def streams(seed: int) -> dict[str, np.random.Generator]:
    """One generator for each purpose, all spawned from the run's one seed."""
    children = np.random.SeedSequence(seed).spawn(len(STREAMS))
    return dict(zip(STREAMS, map(np.random.default_rng, children), strict=True))
