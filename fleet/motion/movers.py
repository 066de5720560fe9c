"""Everybody under way: the arrays that the kernels work on, and the calls that keep them.

Importing this module loads numba.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion import SAMPLE_FIELDS
from fleet.motion.chipmunk import disconnected
from fleet.motion.kernels.loop import command, embark, launch, report, run, sample, settle
from fleet.motion.kernels.records import MOVER, SEGMENT, Floor, Traffic
from fleet.motion.kernels.rollout import rollout
from fleet.motion.kernels.stopping import blocked, stand, stop_short
from protocols.compiled import direct
from protocols.messages import Point, RobotId

if TYPE_CHECKING:
    from fleet.motion.engine import Engine

Path = NDArray[Any]  # (k,) SEGMENT
SLOW = 0.1  # [m/s] below this a robot counts as stopped


class Account(NamedTuple):
    """What has become of a robot under way: columns of :data:`kernels.records.MOVER`."""

    x: float  # [m]
    y: float
    heading: float  # [rad], not wrapped
    path: float  # [m]
    jostled: float  # [m] of it
    waited: int  # [steps]
    steps: int
    contacts: int
    spent: float  # [J], and by what for, each kept by itself:
    spent_turning: float
    spent_driving: float
    spent_waiting: float
    spent_off_path: float


class Movers:
    """Robots under way, each in a slot, which is used again; in order of departure."""

    def __init__(self, params: NDArray[Any], floor: Floor, engine: Engine | None) -> None:
        self.traffic = Traffic(
            params,
            np.zeros(0, MOVER),
            np.zeros((0, 16), SEGMENT),
            np.zeros((0, 61, 2), np.float32),
            np.zeros((0, 4)),
            np.zeros(0, np.int64),
            np.zeros(1, MOVER),
            np.zeros((0, 4)),
            np.zeros((0, 2), np.int64),
        )
        self._floor = floor
        self._engine = engine
        self._wires = disconnected() if engine is None else engine.wires
        self._embark, self._drive, self._rollout = direct(embark), direct(run), direct(rollout)
        self._free: list[int] = []
        self._slots = np.zeros(0, np.int64)  # in order of departure
        self._count = 0  # of them in use
        self._found = np.zeros(0, np.int64)
        self._ahead = np.zeros((1, 16), SEGMENT)
        self._samples = np.zeros((1024 if params[0]["sample"] else 0, len(SAMPLE_FIELDS)))
        self._kept = 0  # rows of it in use
        self._full: list[NDArray[np.float64]] = []  # what did not fit in
        self._mixed = False  # whether rows are of several robots
        self._more_slots()

    def depart(
        self, robot: RobotId, position: Point, heading: float, charge: float, path: Path, step: int
    ) -> int:
        """Send ``robot`` along ``path``; returns its slot."""
        if not self._free:
            self._more_slots()
        slot = self._free.pop()
        self._slots[self._count] = slot
        self._count += 1
        self._more_segments(len(path) + 1)
        needed = self._embark(
            self._floor, self.traffic, self._active, slot, robot, *position, heading, charge,
            path, step,
        )  # fmt: skip
        if needed > self.traffic.reservations.shape[1]:
            self._more_knots(needed)
            self.resume(slot, path, step)
        return slot

    def resume(self, slot: int, path: Path, step: int) -> None:
        """Send a robot that is under way along another ``path``."""
        self._more_segments(len(path) + 1)
        while True:
            needed = launch(self._floor, self.traffic, self._active, slot, path, step)
            if needed <= self.traffic.reservations.shape[1]:
                return
            self._more_knots(needed)

    def rollout(self, position: Point, heading: float, path: Path) -> float:
        """What driving along ``path`` from ``position`` [m] and ``heading`` [rad] drains [J]."""
        if len(path) + 1 > self._ahead.shape[1]:
            self._ahead = np.zeros((1, 2 * len(path) + 2), SEGMENT)
        traffic = self.traffic
        energy: float = self._rollout(
            traffic.ghost, self._ahead, traffic.params, path, *position, heading
        )
        return energy

    def leave(self, places: list[int]) -> None:
        """The trips at these places in the order are over: their slots are free again."""
        for place in sorted(places, reverse=True):
            self._free.append(int(self._slots[place]))
            self._count -= 1
            if place < self._count:
                self._slots[place : self._count] = self._slots[place + 1 : self._count + 1]

    def advance(self, step: int, steps: int) -> tuple[int, list[tuple[int, int]]]:
        """Drive on from ``step`` by ``steps`` at most.

        Returns the steps made, and who needs looking after: (place in the order of departure,
        phase of the trip).
        """
        if len(self._samples):
            self._mixed |= self._count > 1
            self._more_samples()
        drive = self._run_openly if self._wires is None else self._run
        made, kept, over = drive(step, steps)
        self._kept += kept
        found: list[tuple[int, int]] = self.traffic.over[:over].tolist()
        return made, found

    def poses(self) -> NDArray[np.float64]:
        """x, y, heading, charge (k, 4) [m, m, rad, J], in order of departure."""
        return self.traffic.poses[: self._count]

    def phase(self, slot: int) -> int:
        """Which phase of :mod:`fleet.motion.kernels.records` the trip is in."""
        return int(self.traffic.movers[slot]["phase"])

    def hold(self, slot: int, charge: float) -> None:
        """The robot's battery holds ``charge`` [J]: it may have paid for other things than driving.

        To the bit what it was, if it has not.
        """
        mover = self.traffic.movers[slot]
        other = float(mover["held"] - mover["spent"]) - charge
        if other != 0.0:
            mover["held"] -= other

    def account(self, slot: int) -> Account:
        """What has become of one robot since its departure."""
        return Account._make(self._accounts.item(slot))

    def samples(self) -> NDArray[np.float64]:
        """Poses (k, 6) kept since the last call, as :data:`fleet.motion.SAMPLE_FIELDS`, by time
        and robot.
        """
        rows = self._samples[: self._kept].copy()
        if self._full:
            rows = np.concatenate([*self._full, rows])
            self._full.clear()
        if self._mixed:
            rows = rows[np.lexsort((rows[:, 0], rows[:, 1]))]
        self._kept, self._mixed = 0, False
        return rows

    def stand(self, slot: int, step: int) -> None:
        """The robot stands where it is from ``step`` on."""
        stand(self._floor, self.traffic, slot, step)

    def stop_short(self, slot: int, step: int) -> None:
        """The robot brakes from ``step`` on."""
        while True:
            needed = stop_short(self._floor, self.traffic, slot, step)
            if needed <= self.traffic.reservations.shape[1]:
                return
            self._more_knots(needed)

    def blocked_by(self, slot: int, step: int) -> list[int]:
        """The slots of those who will come too near to a robot that stands or stops."""
        count = blocked(self.traffic, self._active, slot, step, self._found)
        found: list[int] = self._found[:count].tolist()
        return found

    def stopped(self, slot: int) -> list[tuple[RobotId, Point]]:
        """Who has come to a stop on its way, but for the mover in ``slot``, and where [m]."""
        movers = self.traffic.movers[self._active[self._active != slot]]
        slow = np.hypot(movers["ux"], movers["uy"]) < SLOW
        return [
            (int(mover["robot"]), (float(mover["x"]), float(mover["y"])))
            for mover in movers[slow & (movers["awake"] != 0)]
        ]

    def _run(self, step: int, steps: int) -> tuple[int, int, int]:
        assert self._wires is not None
        room = self._samples[self._kept :]
        return self._drive(self._floor, self.traffic, self._wires, self._active, step, steps, room)

    def _run_openly(self, step: int, steps: int) -> tuple[int, int, int]:
        """The same as the compiled loop, with the engine stepped over its public interface."""
        assert self._engine is not None
        movers, segments, params = (
            self.traffic.movers,
            self.traffic.segments,
            self.traffic.params[0],
        )
        room = self._samples[self._kept :]
        kept = over = made = 0
        while made < steps and over == 0:
            if params["sample"] and kept + self._count > len(room):
                break
            if command(movers, segments, params, self._active, step + made) > 0:
                self._engine.step(
                    movers, self._active, float(params["dt"]), int(params["substeps"])
                )
            over = settle(movers, params, self._active)
            self._engine.park_those_over(movers, self._active)
            made += 1
            if params["sample"]:
                kept = sample(movers, params, self._active, room, kept, step + made)
        report(movers, self._active, self.traffic.poses, self.traffic.over)
        return made, kept, over

    @property
    def _active(self) -> NDArray[np.int64]:
        """The slots in use, in order of departure."""
        return self._slots[: self._count]

    def _more_slots(self) -> None:
        have = len(self.traffic.movers)
        more = max(4, have)
        by_slot = ("movers", "segments", "reservations", "boxes", "near", "poses", "over")
        self.traffic = self.traffic._replace(
            **{name: _longer(getattr(self.traffic, name), have + more) for name in by_slot}
        )
        self._accounts = self.traffic.movers[list(Account._fields)]  # a view
        self._slots = _longer(self._slots, have + more)
        self._found = np.zeros(have + more, np.int64)
        self._free.extend(range(have + more - 1, have - 1, -1))

    def _more_samples(self) -> None:
        """Room for everybody at least once."""
        if self._kept + self._count > len(self._samples):
            self._full.append(self._samples[: self._kept].copy())
            self._kept = 0
        if self._count > len(self._samples):
            self._samples = np.zeros((2 * self._count, len(SAMPLE_FIELDS)))

    def _more_segments(self, needed: int) -> None:
        if needed > self.traffic.segments.shape[1]:
            self.traffic = self.traffic._replace(
                segments=_longer(self.traffic.segments.swapaxes(0, 1), 2 * needed)
                .swapaxes(0, 1)
                .copy()
            )

    def _more_knots(self, needed: int) -> None:
        self.traffic = self.traffic._replace(
            reservations=_longer(self.traffic.reservations.swapaxes(0, 1), 2 * needed)
            .swapaxes(0, 1)
            .copy()
        )


def _longer(array: NDArray[Any], length: int) -> NDArray[Any]:
    """The same with zeros after it."""
    longer = np.zeros((length, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return longer
