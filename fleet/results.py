"""What a run comes to: one frozen record, and how its figures are counted."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Summary:
    """The outcome of one run. Energies in J, distances in m, times in s.

    ``wall_time`` is the only figure that differs between two runs of one scenario.
    """

    protocol: str
    motion: str
    world: str
    seed: int
    robots: int
    radio_range: float  # r [m]
    search_radius: float  # SR [m]
    lifetime: int  # rounds served before the first event that nobody took
    events: int  # events that happened
    served: int  # events that a robot reached
    failed: int  # trips that ended short of their event
    messages: int  # transmissions; a broadcast is one
    messages_per_robot: float
    messages_by_kind: dict[str, int]
    hops_greedy: int
    hops_face: int
    energy_initial: float  # of the whole fleet
    energy_predicted: float  # Eq. (1) on the straight line from start to event, all trips
    energy_drained: float  # what the batteries lost
    energy_left_mean: float  # a robot
    energy_left_min: float
    energy_left_sd: float  # over the robots (population)
    reactions_per_robot: float  # trips that arrived
    distance_per_robot: float  # straight lines from start to end, all trips
    path_per_robot: float  # driven
    closest_found: float  # share of events whose nearest robot ended the search or won
    simulated_time: float
    wall_time: float

    def as_dict(self) -> dict[str, Any]:
        """The record as plain Python values, keys in the order above."""
        return asdict(self)


@dataclass(slots=True)
class Tally:
    """What is counted as a run goes on."""

    events: int = 0
    served: int = 0
    failed: int = 0
    conversations: int = 0
    closest: int = 0
    predicted: float = 0.0  # [J]
    distance: float = 0.0  # [m]
    path: float = 0.0  # [m]
    kinds: Counter[str] = field(default_factory=Counter)  # transmissions
