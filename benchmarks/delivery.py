"""Routing on the air: delivery, stretch and overhead against loss of frames and speed of robots.

Packets go by greedy-face-greedy to the nearest able robot, over links that robots believe in by
beacons once a second, among 100 robots of which many drive. Delivered: the packet came to that
robot at the first attempt. Stretch: hops over those of the shortest way in the true graph when the
packet set out. Overhead: frames on the air, repeated ones too, over hops.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Mapping

import fleet
from fleet.assembly import prepare
from fleet.observer import Excerpt, Observer
from protocols.messages import Award, Event, RobotId

SEEDS = 5
LOSSES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.5)
SPEEDS = (0.0, 0.25, 0.76, 1.5, 3.0)  # [m/s]; 0: robots are there at once


class Routes(Observer):
    """What becomes of each packet."""

    def __init__(self) -> None:
        self.delivered = self.lost = self.hops = self.shortest = self.frames = self.trips = 0
        self.driven = 0.0  # [s]
        self._on_way: Counter[int] = Counter()
        self._source: dict[int, tuple[RobotId, Mapping[RobotId, int]]] = {}

    def run_started(self, fleet: object) -> None:
        self._fleet = fleet

    def event_raised(self, event: Event, source: RobotId, time: float) -> None:
        self._on_way[event.id] = 0
        self._source[event.id] = source, hops_from(source, self._fleet.topology.neighbours)

    def transmitted(self, excerpt: Excerpt) -> None:
        self._on_way[excerpt.event] += len(excerpt.attempts)
        self.frames += sum(excerpt.attempts)

    def awarded(self, event: Event, award: Award, time: float) -> None:
        if not award.bids:
            return  # nobody was free: there was nowhere to go
        delivered = award.winner is not None
        self.delivered += delivered
        self.lost += not delivered
        _, shortest = self._source[event.id]
        if delivered and award.winner in shortest:
            self.hops += self._on_way[event.id]
            self.shortest += shortest[award.winner]

    def broken_off(self, event: Event, reason: str, time: float) -> None:
        self.lost += 1

    def trip_ended(self, event: Event, trip: object) -> None:
        self.driven += trip.ended - trip.departed


def hops_from(source: RobotId, neighbours: object) -> dict[RobotId, int]:
    """The fewest hops to everybody within reach."""
    far, queue = {source: 0}, deque([source])
    while queue:
        robot = queue.popleft()
        for other in neighbours[robot]:
            if other not in far:
                far[other] = far[robot] + 1
                queue.append(other)
    return far


def measure(loss: float, speed: float) -> str:
    """One line: over several networks, a minute each."""
    total, driven = Counter(), 0.0
    for seed in range(SEEDS):
        routes = Routes()
        scenario = fleet.Scenario.of(
            protocol="gfg", motion="straight", range=2.0, seed=seed,
            robot={"capacity": 1e6, "cruise": speed or 1e3},
            time={"name": "stream", "rate": 20.0, "duration": 60.0, "deadline": 1.0},
            radio={"name": "lossy", "loss": loss},
        )  # fmt: skip
        prepare(scenario, [routes]).run()
        for name in ("delivered", "lost", "hops", "shortest", "frames"):
            total[name] += getattr(routes, name)
        driven += routes.driven
    share = total["delivered"] / (total["delivered"] + total["lost"])
    return (
        f"loss {loss:4.0%}, {speed:4.2f} m/s ({driven / (SEEDS * 6000):3.0%} under way):"
        f" {share:6.1%} delivered, stretch {total['hops'] / total['shortest']:.2f},"
        f" {total['frames'] / total['hops']:.2f} frames a hop"
    )


def main() -> None:
    print(__doc__)
    for loss in LOSSES:
        print(measure(loss, 0.76))
    for speed in SPEEDS:
        print(measure(0.1, speed))


if __name__ == "__main__":
    main()
