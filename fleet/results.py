"""What a run comes to: one frozen record, and how its figures are counted."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass, field
from math import fsum, sqrt
from typing import Any

from fleet.fleet import Fleet
from fleet.service import StreamFigures
from protocols.messages import KINDS


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
    lifetime: int  # events served before the first that never was
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

    stream: StreamFigures | None = None  # of a stream; there are none in rounds

    def as_dict(self) -> dict[str, Any]:
        """The record as plain Python values, keys in the order above; ``stream`` if there is."""
        described = asdict(self)
        if self.stream is None:
            del described["stream"]
        return described


@dataclass(slots=True)
class Tally:
    """What is counted as a run goes on."""

    served: int = 0
    failed: int = 0  # trips
    conversations: int = 0
    closest: int = 0  # conversations that found the nearest robot
    predicted: float = 0.0  # [J]
    distance: float = 0.0  # [m]
    path: float = 0.0  # [m]
    engaged: float = 0.0  # time that robots were promised, under way or at work, summed [s]
    repeated: int = 0  # frames sent again because nobody acknowledged them
    unheard: int = 0  # transmissions that nobody heard
    restarts: int = 0  # searches begun anew because the packet went round in circles
    broken: int = 0  # conversations that came to no end
    conflicts: int = 0  # auctions won by a robot that another had taken meanwhile
    breakdowns: int = 0
    relocations: int = 0  # trips to places that are no events
    kinds: Counter[str] = field(default_factory=Counter)  # transmissions


def summarise(
    fleet: Fleet,
    tally: Tally,
    events: int,
    simulated_time: float,
    wall_time: float,
    figures: StreamFigures | None,
) -> Summary:
    """The record of a run that is over."""
    labels = fleet.labels
    n = len(fleet.robots)
    left = [robot.battery.charge for robot in fleet.robots]
    initial = fsum(robot.battery.capacity for robot in fleet.robots)
    mean = fsum(left) / n
    by_kind: dict[str, int] = {kind: tally.kinds[kind] for kind in KINDS}
    messages = sum(by_kind.values())
    return Summary(
        protocol=labels.protocol,
        motion=labels.motion,
        world=labels.world,
        seed=labels.seed,
        robots=n,
        radio_range=fleet.topology.radio_range,
        search_radius=labels.search_radius,
        lifetime=tally.served if figures is None else figures.served_before_first_loss,
        events=events,
        served=tally.served,
        failed=tally.failed,
        messages=messages,
        messages_per_robot=messages / n,
        messages_by_kind=by_kind,
        hops_greedy=by_kind["route-greedy"],
        hops_face=by_kind["route-face"],
        energy_initial=initial,
        energy_predicted=tally.predicted,
        energy_drained=initial - fsum(left),
        energy_left_mean=mean,
        energy_left_min=min(left),
        energy_left_sd=sqrt(fsum((charge - mean) ** 2 for charge in left) / n),
        reactions_per_robot=tally.served / n,
        distance_per_robot=tally.distance / n,
        path_per_robot=tally.path / n,
        closest_found=tally.closest / max(tally.conversations, 1),
        simulated_time=simulated_time,
        wall_time=wall_time,
        stream=figures,
    )
