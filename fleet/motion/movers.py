"""Everybody under way: the arrays that the kernels work on, and the calls that keep them.

Importing this module loads numba.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.motion import SAMPLE_FIELDS, Accounts
from fleet.motion.chipmunk import disconnected
from fleet.motion.kernels.loop import embark, launch, report, run, sample
from fleet.motion.kernels.records import ARRIVED, EFFORT, MOVER, SEGMENT, Floor, Records, Traffic
from fleet.motion.kernels.rollout import rollout
from fleet.motion.kernels.stopping import blocked, stand, stop_short
from protocols.compiled import direct
from protocols.messages import Point, RobotId

if TYPE_CHECKING:
    from fleet.motion.engine import Engine

Path = NDArray[Any]  # (k,) SEGMENT
SLOW = 0.1  # [m/s] below this a robot counts as stopped


class Driven(NamedTuple):
    """What has become of a robot under way: columns of :data:`kernels.records.MOVER`."""

    x: float  # [m]
    y: float
    heading: float  # [rad], not wrapped
    path: float  # [m]
    waited: int  # [steps]
    steps: int
    contacts: int
    spent: float  # [J]


class Movers:
    """Robots under way, each in a slot, which is used again; in order of departure."""

    def __init__(
        self, params: Records, builds: Records, floor: Floor, engine: Engine | None
    ) -> None:
        self.traffic = Traffic(
            params,
            builds,
            np.zeros(0, MOVER),
            np.zeros(0, EFFORT),
            np.zeros((0, 1024, 4)),
            np.zeros((0, 64, 2), np.float32),
            np.zeros((0, 4)),
            np.zeros(0, np.int64),
            np.zeros(1, MOVER),
            np.zeros((1024, 4)),
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
        self._segments = np.zeros(16, SEGMENT)  # work space
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
        room = self._embark(
            self._floor, self.traffic, self._active, self._segments, slot, robot, *position,
            heading, charge, path, step,
        )  # fmt: skip
        if self._make_room(*room):
            self.resume(slot, path, step)
        return slot

    def resume(self, slot: int, path: Path, step: int) -> None:
        """Send a robot that is under way along another ``path``."""
        self._more_segments(len(path) + 1)
        while self._make_room(
            *launch(self._floor, self.traffic, self._active, self._segments, slot, path, step)
        ):
            pass

    def rollout(self, position: Point, heading: float, path: Path) -> float:
        """What driving along ``path`` from ``position`` [m] and ``heading`` [rad] drains [J]."""
        self._more_segments(len(path) + 1)
        while True:
            energy: float
            energy, samples = self._rollout(self.traffic, self._segments, path, *position, heading)
            if not self._make_room(samples, 0):
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

    def driven(self, slot: int) -> Driven:
        """What has become of one robot since its departure."""
        return Driven._make(self._driven.item(slot))

    def accounts(self, slot: int) -> Accounts:
        """What its battery has paid for since."""
        return Accounts._make(self._accounts.item(slot))

    def samples(self) -> NDArray[np.float64]:
        """Poses (k, 8) kept since the last call, as :data:`fleet.motion.SAMPLE_FIELDS`, by time
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
        stop_short(self._floor, self.traffic, slot, step)

    def blocked_by(self, slot: int, step: int) -> list[int]:
        """The slots of those who will come too near to a robot that stands or stops."""
        count = blocked(self.traffic, self._active, slot, step, self._found)
        found: list[int] = self._found[:count].tolist()
        return found

    def stopped(self, slot: int) -> list[tuple[RobotId, Point]]:
        """Who has come to a stop on its way, but for the mover in ``slot``, and where [m]."""
        movers = self.traffic.movers[self._active[self._active != slot]]
        slow = np.hypot(movers["vx"], movers["vy"]) < SLOW
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
        traffic, active = self.traffic, self._active
        sampled = traffic.params[0]["sample"] > 0
        room = self._samples[self._kept :]
        kept = over = made = 0
        while made < steps and over == 0:
            if sampled and kept + self._count > len(room):
                break
            self._engine.step(self._floor, traffic, active, step + made)
            over = int((traffic.movers["phase"][active] >= ARRIVED).sum())
            made += 1
            if sampled:
                kept = sample(
                    traffic.movers, traffic.references, traffic.params[0], active, room, kept,
                    step + made,
                )  # fmt: skip
        report(traffic.movers, active, traffic.poses, traffic.over)
        return made, kept, over

    @property
    def _active(self) -> NDArray[np.int64]:
        """The slots in use, in order of departure."""
        return self._slots[: self._count]

    def _more_slots(self) -> None:
        have = len(self.traffic.movers)
        more = max(4, have)
        by_slot = (
            "movers", "efforts", "references", "reservations", "boxes", "near", "poses", "over"
        )  # fmt: skip
        self.traffic = self.traffic._replace(
            **{name: _longer(getattr(self.traffic, name), have + more) for name in by_slot}
        )
        self._driven = self.traffic.movers[list(Driven._fields)]  # views
        self._accounts = self.traffic.movers[list(Accounts._fields)]
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
        if needed > len(self._segments):
            self._segments = np.zeros(2 * needed, SEGMENT)

    def _make_room(self, samples: int, knots: int) -> bool:
        """Make room for references and tracks that long; whether there was too little."""
        traffic = self.traffic
        short = samples > len(traffic.draft)
        if short:
            self.traffic = traffic = traffic._replace(
                references=_wider(traffic.references, 2 * samples),
                draft=np.zeros((2 * samples, 4)),
            )
        if knots > traffic.reservations.shape[1]:
            self.traffic = traffic._replace(reservations=_wider(traffic.reservations, 2 * knots))
            return True
        return short


def _wider(array: NDArray[Any], length: int) -> NDArray[Any]:
    """The same with zeros after each row."""
    return _longer(array.swapaxes(0, 1), length).swapaxes(0, 1).copy()


def _longer(array: NDArray[Any], length: int) -> NDArray[Any]:
    """The same with zeros after it."""
    longer = np.zeros((length, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return longer
