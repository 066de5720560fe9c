"""Observers that keep a run's rounds, and its robots, as tables."""

from __future__ import annotations

from math import dist
from typing import Any, TypeAlias

from fleet.fleet import Fleet
from fleet.motion import Trip
from fleet.observer import Excerpt, Observer
from fleet.results import Summary
from protocols.messages import Award, Event, RobotId

Rows: TypeAlias = list[dict[str, Any]]


class RoundsTable(Observer):
    """A row for each time that an event was told to a robot; more than once if trips failed."""

    def __init__(self) -> None:
        self.rows: Rows = []
        self._of: dict[int, dict[str, Any]] = {}  # the last row of each event

    def run_started(self, fleet: Fleet) -> None:
        """Everybody is in place."""
        self._fleet = fleet

    def event_raised(self, event: Event, source: RobotId, time: float) -> None:
        """A row begins."""
        x, y = event.position
        self._of[event.id] = row = {
            "event": event.id,
            "time": time,  # [s]
            "x": x,  # [m]
            "y": y,  # [m]
            "source": source,
            "messages": 0,
            "frames": 0,  # those sent again counted again
            "hops": 0,  # of those, route-greedy and route-face
            "auctioneer": None,
            "winner": None,
            "outcome": "nobody",
            "arrived": None,  # [s] when the robot came to rest
            "path": 0.0,  # [m] driven
            "energy": 0.0,  # [J] drained
            "fleet_energy_left": 0.0,  # [J] of all robots together, after
        }
        self.rows.append(row)

    def transmitted(self, excerpt: Excerpt) -> None:
        """Count."""
        row, said = self._of[excerpt.event], excerpt.transmissions
        row["messages"] += len(said)
        row["frames"] += sum(excerpt.attempts)
        row["hops"] += sum(t.kind in {"route-greedy", "route-face"} for t in said)

    def awarded(self, event: Event, award: Award, time: float) -> None:
        """Who got it."""
        self._of[event.id] |= {
            "auctioneer": award.auctioneer,
            "winner": award.winner,
            "fleet_energy_left": self._left(),
        }

    def broken_off(self, event: Event, reason: str, time: float) -> None:
        """Nobody got it."""
        self._of[event.id] |= {"outcome": reason, "fleet_energy_left": self._left()}

    def trip_ended(self, event: Event, trip: Trip) -> None:
        """What it took."""
        self._of[event.id] |= {
            "outcome": trip.outcome,
            "arrived": trip.ended,
            "path": trip.path,
            "energy": trip.energy,
            "fleet_energy_left": self._left(),
        }

    def _left(self) -> float:
        return sum(robot.battery.charge for robot in self._fleet.robots)


class RobotsTable(Observer):
    """A row for each robot: where it began and ended, what it did, and what it has left."""

    def __init__(self) -> None:
        self.rows: Rows = []

    def run_started(self, fleet: Fleet) -> None:
        """Everybody is in place."""
        self._fleet = fleet
        for robot in fleet.robots:
            x, y = robot.position
            self.rows.append(
                {
                    "robot": robot.id,
                    "start_x": x,  # [m]
                    "start_y": y,  # [m]
                    "end_x": x,  # [m]
                    "end_y": y,  # [m]
                    "reactions": 0,  # trips that arrived at an event
                    "failed": 0,  # trips to an event that did not
                    "distance": 0.0,  # [m] straight lines from start to end, all trips
                    "path": 0.0,  # [m] driven
                    "energy_left": robot.battery.charge,  # [J] of this robot
                    "died": None,  # [s] when its battery was empty
                }
            )

    def trip_ended(self, event: Event, trip: Trip) -> None:
        """Add it up."""
        row = self.rows[trip.robot]
        row["reactions"] += trip.outcome == "arrived"
        row["failed"] += trip.outcome != "arrived"
        self._drove(trip)

    def relocated(self, event: Event, trip: Trip) -> None:
        """It drove, but to no event."""
        self._drove(trip)

    def exhausted(self, robot: RobotId, time: float) -> None:
        """That was all it had."""
        self.rows[robot]["died"] = time

    def run_ended(self, summary: Summary) -> None:
        """What is left, and where."""
        for row, robot in zip(self.rows, self._fleet.robots, strict=True):
            row["end_x"], row["end_y"] = robot.position
            row["energy_left"] = robot.battery.charge

    def _drove(self, trip: Trip) -> None:
        row = self.rows[trip.robot]
        row["distance"] += dist(trip.origin, trip.end)
        row["path"] += trip.path


TABLES: dict[str, type[RoundsTable] | type[RobotsTable]] = {
    "rounds": RoundsTable,
    "robots": RobotsTable,
}
"""Tables that a study may ask for, by name."""
