"""The robots: at rest, under way, and what has befallen them."""

from __future__ import annotations

from collections.abc import Mapping
from math import dist

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from fleet.replay.colormap import energy_colours
from fleet.replay.columns import Moment, colours, column, own, pairs, reals, segments, texts, whole
from fleet.replay.journal import TripEnd
from fleet.replay.layers.frames import Frames, Poses, frames, joined, still
from fleet.replay.scheme import (
    DEAD_COLOUR,
    MARK_COLOURS,
    MARKS,
    MOVERS,
    ROBOT_ENERGY,
    ROBOT_HEADING,
    ROBOT_ID,
    ROBOT_OFF_PLAN,
    ROBOTS,
)
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Point, RobotId

Floats = NDArray[np.float32]

SEEN = 1e-4  # [m] that can be told apart
NOSE = 1.9  # length of a mover's pointer, in its radii
POINTS = 256  # of the compass, that a pointer is drawn towards: few values make small files
ANGLES = np.arange(POINTS) * (2.0 * np.pi / POINTS)
DIRECTIONS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
CROSS = 0.9 * np.array([[[-1, -1], [1, 1]], [[-1, 1], [1, -1]]])
STROKES = {  # in radii of a robot: (lines, 2, 2)
    "exhausted": CROSS,
    "broken": CROSS,
    "motor": 1.5 * np.array([[[-1, 0], [1, 0]]]),
    "silenced": 0.9 * np.array([[[-1, -1], [1, 1]]]),
}


class Bodies(Layer):
    """Those at rest change only when somebody sets off or arrives; movers have their own rows."""

    def __init__(self) -> None:
        self._rest: list[tuple[Moment, Floats, Floats, NDArray[np.bool_]]] = []
        self._moving: list[Frames] = []
        self._names: list[tuple[Moment, list[str]]] = []
        self._marks: list[tuple[Moment, NDArray[np.float64], list[int]]] = []
        self._poses: Poses = {}

    def run_started(self, state: FleetState) -> None:
        """The first row."""
        self._state = state
        self._marked = False
        self._at_rest(Moment(0.0, 0, 0, 0.0))

    def air_changed(self, at: Moment) -> None:
        """Who is off the air is grey, or, under way, called silenced."""
        self._at_rest(at)
        if self._poses:
            self._stand(at)

    def exhausted(self, at: Moment, robot: RobotId) -> None:
        """It is marked."""
        self._mark(at)

    def broke_down(self, at: Moment, robot: RobotId, what: str) -> None:
        """It is marked."""
        self._mark(at)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """One leaves the others."""
        state = self._state
        (x, y), (to_x, to_y) = state.at(robot), state.under_way[robot].site
        heading = float(np.arctan2(to_y - y, to_x - x))
        self._poses[robot] = (robot, at.time, x, y, heading, float(state.energies[robot]), x, y)
        self._at_rest(at)
        self._stand(at)

    def moved(self, at: Moment, samples: NDArray[np.float64]) -> None:
        """Movers where they were at each time."""
        self._moving.append(frames(samples, self._poses, at))

    def linked_at(self, at: Moment, places: Mapping[RobotId, Point]) -> None:
        """Movers where they were linked, so that links end at them."""
        moved = {
            robot: (robot, at.time, *places[robot], *pose[4:])
            for robot, pose in self._poses.items()
            if robot in places and dist(places[robot], pose[2:4]) > SEEN
        }
        if moved:
            self._poses |= moved
            self._moving.append(still(self._poses, at))

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
        if self._marks:
            marked, lines, tints = zip(*self._marks, strict=True)
            counts = [len(row) for row in lines]
            colour = colours([one for row in tints for one in row])
            sink.rows(
                MARKS,
                marked,
                column(
                    rr.LineStrips2D.descriptor_strips(), segments(np.concatenate(lines)), counts
                ),
                column(rr.LineStrips2D.descriptor_colors(), colour, counts),
            )
        self._rest, self._moving, self._names, self._marks = [], [], [], []

    def _stand(self, at: Moment) -> None:
        """A frame of the movers when there is one more of them, or one less."""
        self._moving.append(still(self._poses, at))
        self._names.append((at, [self._name(robot) for robot in sorted(self._poses)]))

    def _name(self, robot: RobotId) -> str:
        errand = " relocates" * self._state.under_way[robot].errand
        return f"r{robot}{errand}{' silenced' * (not self._state.on_air[robot])}"

    def _at_rest(self, at: Moment) -> None:
        state = self._state
        positions = state.positions.astype(np.float32)
        positions[list(state.under_way)] = np.nan
        self._rest.append((at, positions, state.energies.astype(np.float32), state.on_air.copy()))
        self._mark(at)

    def _mark(self, at: Moment) -> None:
        """What has befallen whom: a cross, a bar, or one stroke, where the robot is at rest."""
        state = self._state
        silenced = dict.fromkeys(np.flatnonzero(~state.on_air).tolist(), "silenced")
        marked = {
            robot: why
            for robot, why in (silenced | state.failed).items()
            if robot not in state.under_way
        }
        lines = [state.positions[r] + state.mark * STROKES[why] for r, why in marked.items()]
        paint = [MARK_COLOURS[why] for why in marked.values() for _ in STROKES[why]]
        if paint or self._marked:
            self._marks.append((at, np.concatenate([np.empty((0, 2, 2)), *lines]), paint))
        self._marked = bool(paint)

    def _send_movers(self, sink: Sink, capacity: float) -> None:
        when, lengths, poses = joined(self._moving)
        heading, reach = poses[:, 4], NOSE * self._state.mark
        drawn = np.rint(heading * (POINTS / (2.0 * np.pi))).astype(int) % POINTS
        noses = (reach * DIRECTIONS)[drawn]
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
            column(own("Robot", ROBOT_ID), whole(poses[:, 0]), lengths),
            column(own("Robot", ROBOT_HEADING), reals(heading), lengths),
            column(own("Robot", ROBOT_ENERGY), reals(poses[:, 5]), lengths),
            column(own("Robot", ROBOT_OFF_PLAN), pairs(poses[:, 6:8] - poses[:, 2:4]), lengths),
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
