"""The robots: at rest, under way, and out of energy."""

from __future__ import annotations

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from fleet.replay.colormap import energy_colours
from fleet.replay.columns import Moment, colours, column, own, pairs, reals, segments, texts
from fleet.replay.journal import TripEnd
from fleet.replay.layers.frames import Frames, Poses, frames, joined, still
from fleet.replay.scheme import (
    DEAD,
    DEAD_COLOUR,
    MOVERS,
    ROBOT_ENERGY,
    ROBOTS,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import RobotId

Floats = NDArray[np.float32]

NOSE = 1.9  # length of a mover's pointer, in its radii


class Bodies(Layer):
    """Those at rest change only when somebody sets off or arrives; movers have their own rows."""

    def __init__(self) -> None:
        self._rest: list[tuple[Moment, Floats, Floats, NDArray[np.bool_]]] = []
        self._moving: list[Frames] = []
        self._names: list[tuple[Moment, list[str]]] = []
        self._dead: list[tuple[Moment, NDArray[np.float64]]] = []
        self._poses: Poses = {}

    def run_started(self, state: FleetState) -> None:
        """The first row."""
        self._state = state
        self._on_air = np.ones(state.n, bool)
        self._at_rest(Moment(0.0, 0, 0))

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """A moment to see who has fallen silent, or is heard again."""
        if (self._on_air != self._state.on_air).any():
            self._at_rest(at)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """One leaves the others."""
        state = self._state
        (x, y), (to_x, to_y) = state.at(robot), state.under_way[robot].site
        heading = float(np.arctan2(to_y - y, to_x - x))
        self._poses[robot] = (robot, at.time, x, y, heading, float(state.energies[robot]))
        self._at_rest(at)
        self._stand(at)

    def moved(self, at: Moment, samples: NDArray[np.float64]) -> None:
        """Movers where they were at each time."""
        self._moving.append(frames(samples, self._poses, at))

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """One is back among the others."""
        del self._poses[trip.robot]
        self._at_rest(at)
        self._stand(at)

    def send(self, sink: Sink) -> None:
        """Those at rest, those under way, the dead."""
        capacity = self._state.capacity
        if self._rest:
            when, positions, energies, on_air = zip(*self._rest, strict=True)
            energy = np.concatenate(energies)
            heard = np.concatenate(on_air)
            paint = np.where(heard, energy_colours(energy, capacity), np.uint32(DEAD_COLOUR))
            count = np.full(len(when), self._state.n)
            sink.rows(
                ROBOTS,
                when,
                column(rr.Points2D.descriptor_positions(), pairs(np.concatenate(positions)), count),
                column(rr.Points2D.descriptor_colors(), colours(paint), count),
                column(own("Robot", ROBOT_ENERGY), reals(energy), count),
            )
        if self._moving:
            self._send_movers(sink, capacity)
        if self._dead:
            when, crosses = zip(*self._dead, strict=True)
            sink.rows(
                DEAD,
                when,
                column(
                    rr.LineStrips2D.descriptor_strips(),
                    segments(np.concatenate(crosses)),
                    [len(cross) for cross in crosses],
                ),
            )
        self._rest, self._moving, self._names, self._dead = [], [], [], []

    def _stand(self, at: Moment) -> None:
        """A frame of the movers when there is one more of them, or one less."""
        self._moving.append(still(self._poses, at))
        ways = self._state.under_way
        names = [f"r{robot}{' relocates' * ways[robot].errand}" for robot in sorted(self._poses)]
        self._names.append((at, names))

    def _at_rest(self, at: Moment) -> None:
        state = self._state
        positions = state.positions.astype(np.float32)
        positions[list(state.under_way)] = np.nan
        on_air = state.on_air.copy()
        self._rest.append((at, positions, state.energies.astype(np.float32), on_air))
        if (on_air != self._on_air).any():
            self._on_air = on_air
            dead = np.flatnonzero(~on_air)
            arm = 0.9 * state.mark * np.array([[[-1, -1], [1, 1]], [[-1, 1], [1, -1]]])
            crosses = state.positions[dead, None, None] + arm
            self._dead.append((at, crosses.reshape(-1, 2, 2)))

    def _send_movers(self, sink: Sink, capacity: float) -> None:
        when, lengths, poses = joined(self._moving)
        heading, reach = poses[:, 4], NOSE * self._state.mark
        noses = reach * np.column_stack([np.cos(heading), np.sin(heading)])
        sink.rows(
            MOVERS,
            when,
            column(rr.Points2D.descriptor_positions(), pairs(poses[:, 2:4]), lengths),
            column(
                rr.Points2D.descriptor_colors(),
                colours(energy_colours(poses[:, 5], capacity)),
                lengths,
            ),
            column(rr.Arrows2D.descriptor_vectors(), pairs(noses), lengths),
        )
        if not self._names:
            return
        changes, names = zip(*self._names, strict=True)
        sink.rows(
            MOVERS,
            changes,
            column(
                rr.Points2D.descriptor_labels(),
                texts([name for row in names for name in row]),
                [len(row) for row in names],
            ),
        )
