"""Where a robot was sent, along the straight line that Eq. (1) charges, the way that it planned,
and where it drove.
"""

from __future__ import annotations

from math import dist

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from fleet.replay.columns import Moment, column, segments, strips
from fleet.replay.journal import TripEnd
from fleet.replay.scheme import DRIVEN, PLANNED, RELOCATION, STRAIGHT
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Point, RobotId

TRAIL_INTERVAL = 0.25  # [s] between two corners of a driven path
DASH = 0.12  # [m]

FloatArray = NDArray[np.float64]


class Drives(Layer):
    """The trips under way, and those ended since the latest event."""

    def __init__(self) -> None:
        self._dashes: dict[RobotId, FloatArray] = {}  # (d, 2, 2) [m]
        self._driven: dict[RobotId, list[Point]] = {}  # [m], by corner
        self._steps: dict[RobotId, int] = {}  # of the trail interval, where the last corner was
        self._planned: dict[RobotId, FloatArray] = {}  # (c, 2) [m] of those that bend
        self._ended: set[RobotId] = set()
        self._errands: set[RobotId] = set()  # those whose dashes lead to no event
        self._elsewhere = False  # whether any such are drawn
        self._straight_rows: list[tuple[Moment, list[FloatArray]]] = []
        self._errand_rows: list[tuple[Moment, list[FloatArray]]] = []
        self._driven_rows: list[tuple[Moment, list[tuple[list[Point], int]]]] = []
        self._planned_rows: list[tuple[Moment, list[FloatArray]]] = []

    def run_started(self, state: FleetState) -> None:
        """Nobody is under way."""
        self._state = state

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """Drives that have ended are history."""
        for robot in self._ended:
            del self._dashes[robot], self._driven[robot]
        if self._ended & self._planned.keys():
            self._planned = {r: way for r, way in self._planned.items() if r not in self._ended}
            self._draw_planned(at)
        if self._ended:
            self._draw_straight(at)
            self._errands -= self._ended
            self._ended.clear()
            self._draw_driven(at)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """The straight line is known."""
        trip = self._state.under_way[robot]
        self._ended.discard(robot)
        if self._planned.pop(robot, None) is not None:
            self._draw_planned(at)
        (self._errands.add if trip.errand else self._errands.discard)(robot)
        self._dashes[robot] = dashes(trip.origin, trip.site, DASH * self._state.mark / 0.1)
        self._driven[robot] = [trip.origin]
        self._steps[robot] = 0
        self._draw_straight(at)
        self._draw_driven(at)

    def planned(self, at: Moment, robot: RobotId, way: FloatArray) -> None:
        """The way is known."""
        self._planned[robot] = way
        self._draw_planned(at)

    def moved(self, at: Moment, samples: FloatArray) -> None:
        """The driven path grows by a corner every so often."""
        under_way = self._state.under_way
        for robot, time, x, y in samples[:, :4].tolist():
            step = int((time - under_way[robot].departed) / TRAIL_INTERVAL)
            if step != self._steps[robot]:
                self._steps[robot] = step
                self._driven[robot].append((x, y))
                self._draw_driven(at.later(time))

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """It stays in sight until the next event."""
        self._ended.add(trip.robot)
        if self._driven[trip.robot][-1] != trip.end:
            self._driven[trip.robot].append(trip.end)
            self._draw_driven(at)

    def send(self, sink: Sink) -> None:
        """Dashes and trails."""
        for path, dashed in ((STRAIGHT, self._straight_rows), (RELOCATION, self._errand_rows)):
            if not dashed:
                continue
            when, rows = zip(*dashed, strict=True)
            sink.rows(
                path,
                when,
                column(
                    rr.LineStrips2D.descriptor_strips(),
                    segments(
                        np.concatenate([np.empty((0, 2, 2)), *(d for row in rows for d in row)])
                    ),
                    [sum(map(len, row)) for row in rows],
                ),
            )
        for path, drawn in ((PLANNED, self._planned_rows), (DRIVEN, self._snapshots())):
            if not drawn:
                continue
            when, rows = zip(*drawn, strict=True)
            ways = [way for row in rows for way in row]
            points = np.concatenate([np.empty((0, 2)), *ways])
            sink.rows(
                path,
                when,
                column(
                    rr.LineStrips2D.descriptor_strips(),
                    strips(points, [len(way) for way in ways]),
                    [len(row) for row in rows],
                ),
            )
        self._straight_rows, self._errand_rows = [], []
        self._planned_rows, self._driven_rows = [], []

    def _draw_straight(self, at: Moment) -> None:
        to_events = [d for robot, d in self._dashes.items() if robot not in self._errands]
        elsewhere = [d for robot, d in self._dashes.items() if robot in self._errands]
        self._straight_rows.append((at, to_events))
        if elsewhere or self._elsewhere:
            self._errand_rows.append((at, elsewhere))
        self._elsewhere = bool(elsewhere)

    def _draw_planned(self, at: Moment) -> None:
        self._planned_rows.append((at, list(self._planned.values())))

    def _draw_driven(self, at: Moment) -> None:
        ways = [(way, len(way)) for way in self._driven.values()]
        self._driven_rows.append((at, ways))

    def _snapshots(self) -> list[tuple[Moment, list[FloatArray]]]:
        """The rows of driven paths: of each path the corners that it had by then."""
        whole = {id(way): way for _, row in self._driven_rows for way, _ in row}
        corners = {name: np.array(way) for name, way in whole.items()}
        return [(at, [corners[id(way)][:k] for way, k in row]) for at, row in self._driven_rows]


def dashes(origin: tuple[float, float], site: tuple[float, float], dash: float) -> FloatArray:
    """A broken line (d, 2, 2) [m] of dashes of about that length, with gaps between."""
    count = max(1, round(dist(origin, site) / (2.0 * dash)))
    ends = np.linspace(0.0, 1.0, 2 * count + 1)[: 2 * count].reshape(-1, 2, 1)
    start = np.array(origin)
    return np.asarray(start + ends * (np.array(site) - start))
