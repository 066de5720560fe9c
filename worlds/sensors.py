"""The static sensor field: who detects an event, and how word of it reaches the handler.

Figure 1 of Stanulovic et al., Sensors 21(18):6149, 2021 (doi:10.3390/s21186149): sensors that
sense an event forward its position, sensor by sensor, to the event handler.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from worlds.arena import Arena, FloatArray, ImpossibleWorld
from worlds.ground import ground_of
from worlds.shapes import Corner


class Report(NamedTuple):
    """What one sensor tells the handler of an event."""

    sensor: int
    position: Corner  # where it says that the event is [m]
    hops: int  # over how many sensors the word travels, itself included


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorSpec:
    """How many sensors of what kind, and what they get wrong.

    The handler stands in the lower left corner, at the sensor nearest to it. It takes reports
    for the same event if they are about one place and one time; with probability
    ``duplicates`` it does not notice, and the event is raised a second time.

    Raises:
        ValueError: a value is out of its range.
    """

    count: int = 200
    reach: float = 1.2  # how far a sensor senses [m]
    radio_range: float = 1.6  # of the sensors' own network [m]
    miss: float = 0.0  # probability that a sensor in reach does not sense the event
    duplicates: float = 0.0  # probability that a second report is taken for a second event
    error: float = 0.0  # standard deviation of a reported coordinate [m]
    hop_time: float = 0.01  # [s]

    def __post_init__(self) -> None:
        if self.count < 1:
            raise ValueError(f"sensors count is {self.count}; expected 1 or more")
        for name in ("reach", "radio_range"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"sensors {name} is {getattr(self, name)}; expected more than 0")
        for name in ("miss", "duplicates"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"sensors {name} is {getattr(self, name)}; expected 0 to 1")
        for name in ("error", "hop_time"):
            if not getattr(self, name) >= 0.0:
                raise ValueError(f"sensors {name} is {getattr(self, name)}; expected 0 or more")


@dataclass(frozen=True, slots=True, eq=False)
class SensorField:
    """Sensors in their places, and the tree over which their reports travel."""

    arena: Arena
    spec: SensorSpec
    positions: FloatArray  # (count, 2) [m]
    hops: NDArray[np.int64]  # (count,) to the handler, itself included; 0: no way there
    parent: NDArray[np.int64]  # (count,) the next sensor on the way; -1: the handler, or no way

    def detect(self, site: Corner, rng: np.random.Generator) -> list[Report]:
        """The reports of an event at ``site`` [m] that reach the handler, by sensor.

        Each sensor in reach draws whether it misses the event, and errs by itself; none reports
        a place that is not on the floor.
        """
        width, height = self.arena.width, self.arena.height
        away = np.hypot(*(self.positions - np.array(site)).T)
        near = np.flatnonzero(away <= self.spec.reach)
        sensed = near[rng.random(len(near)) >= self.spec.miss]
        errors = rng.normal(0.0, 1.0, (len(near), 2))[: len(sensed)] * self.spec.error
        return [
            Report(
                int(sensor),
                (min(max(site[0] + dx, 0.0), width), min(max(site[1] + dy, 0.0), height)),
                int(self.hops[sensor]),
            )
            for sensor, (dx, dy) in zip(sensed.tolist(), errors.tolist(), strict=True)
            if self.hops[sensor] > 0
        ]


def deploy(arena: Arena, spec: SensorSpec, rng: np.random.Generator) -> SensorField:
    """Scatter sensors uniformly over the free floor and join them to the handler.

    Raises:
        ImpossibleWorld: fewer than half of them have a way to the handler.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order
    from scipy.spatial import cKDTree

    positions, ground = np.empty((0, 2)), ground_of(arena, 0.0)
    while len(positions) < spec.count:
        drawn = arena.random_points(spec.count, 0.0, rng)
        positions = np.vstack([positions, drawn[ground.holds(drawn)]])[: spec.count]
    pairs = cKDTree(positions).query_pairs(spec.radio_range, output_type="ndarray")
    links = coo_array(
        (np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(spec.count, spec.count)
    ).tocsr()
    gateway = int(np.argmin(np.hypot(*positions.T)))
    order, before = breadth_first_order(links, gateway, directed=False)
    hops = np.zeros(spec.count, np.int64)
    hops[gateway] = 1
    for sensor in order[1:]:
        hops[sensor] = hops[before[sensor]] + 1
    if (hops > 0).mean() < 0.5:
        raise ImpossibleWorld(
            f"sensors radio_range is {spec.radio_range} m; only {(hops > 0).sum()} of"
            f" {spec.count} sensors reach the handler; expected a longer range or more sensors"
        )
    return SensorField(
        arena, spec, positions, hops, np.where(before < 0, -1, before).astype(np.int64)
    )
