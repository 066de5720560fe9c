"""Trips of a simulation, written as the logs of real robots are: to be read by the same commands.

Each robot's trips become one file, a run, with a few seconds of standing before and after each;
what a log cannot tell of its robot is in ``log.toml`` beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from fleet.logs.asking import FILE
from fleet.motion import SAMPLE_FIELDS, Trip
from fleet.observer import Observer
from fleet.robot import RobotSpec
from fleet.scenario.errors import bad

if TYPE_CHECKING:
    from fleet.fleet import Fleet
    from protocols.messages import Event, Move, RobotId

Floats = NDArray[np.float64]

COLUMNS = ("time", "x", "y", "theta", "v", "omega", "energy")
"""Of a log: s, m, m, rad, m/s, rad/s, J drawn so far; all at the same instants.

Energy, and not power, because a simulation settles up for whole steps: from one row to the next is
one of them, and velocities are those before and after it.
"""

STANDING = 2.5  # [s] before and after each trip
_KEPT = ("robot", "time", "x", "y", "heading", "energy")
_ROBOT, _TIME, _X, _Y, _HEADING, _ENERGY, _RESTS = range(len(_KEPT) + 1)


class TripExport(Observer):
    """Writes the trips of a run into a folder when the run is over, a file for each robot.

    Raises:
        BadInput: the folder cannot be written to.
    """

    def __init__(
        self,
        folder: Path,
        spec: RobotSpec,
        interval: float = 1.0 / 60.0,
        run: int = 0,
    ) -> None:
        self.sample_interval = interval
        self._folder, self._spec, self._interval = folder, spec, interval
        self._run = run
        self._samples: list[Floats] = []

    @override
    def moved(self, samples: Floats) -> None:
        kept = samples[:, [SAMPLE_FIELDS.index(name) for name in _KEPT]]
        self._samples.append(np.column_stack([kept, np.zeros(len(kept))]))

    @override
    def run_started(self, fleet: Fleet) -> None:
        self._fleet = fleet

    @override
    def departed(self, event: Event, robot: RobotId, time: float) -> None:
        self._keep(robot, time)

    @override
    def relocating(self, event: Event, move: Move, time: float) -> None:
        self._keep(move.robot, time)

    @override
    def trip_ended(self, event: Event, trip: Trip) -> None:
        self._keep(trip.robot, trip.ended)

    @override
    def relocated(self, event: Event, trip: Trip) -> None:
        self._keep(trip.robot, trip.ended)

    def _keep(self, number: RobotId, time: float) -> None:
        """A robot as it is at the begin or the end of a trip, between samples."""
        robot = self._fleet.robots[number]
        self._samples.append(
            np.array([[number, time, *robot.position, robot.heading, robot.energy, 1.0]])
        )

    @override
    def run_ended(self, summary: Any) -> None:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            for robot, log in logs_of(self._samples, self._spec, self._interval).items():
                lines = [",".join(COLUMNS), *(",".join(f"{x:.9g}" for x in row) for row in log)]
                path = self._folder / f"run-{self._run}-robot-{robot:03d}.csv"
                path.write_text("\n".join(lines) + "\n", "utf-8")
            (self._folder / FILE).write_text(settings_text(self._spec), "utf-8")
        except OSError as error:
            raise bad(
                "--log", f"{str(self._folder)!r} cannot be written to: {error.strerror}"
            ) from error


def logs_of(samples: Sequence[Floats], spec: RobotSpec, interval: float) -> dict[int, Floats]:
    """The log of each robot (n, 7), :data:`COLUMNS`, from the poses that a run told of.

    Motion first moves bodies and then changes their velocity: a step's displacement is that of the
    velocity before it.
    """
    if not samples:
        return {}
    rows = np.concatenate(samples)
    logs = {}
    for robot in np.unique(rows[:, _ROBOT]):
        mine = rows[rows[:, _ROBOT] == robot]
        mine = mine[np.unique(mine[:, _TIME].round(6), return_index=True)[1]]
        cuts = np.flatnonzero(np.diff(mine[:, _TIME]) > 1.5 * interval) + 1
        drives = _from_rest(np.split(mine, cuts), spec.extra.idle, interval)
        if drives:
            logs[int(robot)] = _one_after_the_other(drives, spec, interval)
    return logs


def _from_rest(parts: Sequence[Floats], idle: float, interval: float) -> list[Floats]:
    """Stretches of driving; one that begins under way gets the instant before, when it stood.

    Who waits for others is told of from its first step on.
    """
    drives = []
    before: Floats | None = None
    for part in parts:
        if before is not None and not part[0, _RESTS]:
            rest = before.copy()
            rest[_TIME] = part[0, _TIME] - interval
            rest[_ENERGY] -= idle * (rest[_TIME] - before[_TIME])
            drives.append(np.vstack([rest, part]))
        elif len(part) > 2:
            drives.append(part)
        before = part[-1]
    return drives


def _one_after_the_other(drives: Sequence[Floats], spec: RobotSpec, interval: float) -> Floats:
    """A robot's drives with standing around them; its clock stops while it stands for longer."""
    parts = []
    for drive in drives:
        rows = _instants(drive, spec)
        for end in (0, -1):
            stand = np.repeat(rows[[end]], round(STANDING / interval), axis=0)
            stand[:, 4:] = 0.0, 0.0, spec.extra.idle * interval
            parts.append(stand)
        parts.insert(-1, rows)
    log = np.concatenate(parts)
    log[:, 0] = interval * np.arange(len(log))
    log[:, 6] = np.cumsum(log[:, 6])
    return log


def _instants(drive: Floats, spec: RobotSpec) -> Floats:
    """Place, velocity and what was drawn since the row before, (n, 7)."""
    step = np.diff(drive[:, _TIME])
    dx, dy = np.diff(drive[:, _X]), np.diff(drive[:, _Y])
    heading = np.unwrap(drive[:, _HEADING])
    turn = np.diff(heading)
    if spec.drive == "holonomic":
        ahead, turn = np.hypot(dx, dy), np.zeros(len(dx))
    else:
        theta = heading[:-1] + 0.5 * turn
        ahead = dx * np.cos(theta) + dy * np.sin(theta)
    rates = np.column_stack([ahead, turn]) / step[:, None]
    rates = np.vstack([rates, np.zeros((1, 2))])
    spent = np.r_[spec.extra.idle * step[0], -np.diff(drive[:, _ENERGY])]
    return np.column_stack([
        drive[:, _TIME], drive[:, _X], drive[:, _Y], heading, rates, spent,
    ])  # fmt: skip


def settings_text(spec: RobotSpec) -> str:
    """What of a robot its log does not tell, as ``log.toml``."""
    inertia = spec.inertia if spec.inertia is not None else 0.5 * spec.mass * spec.radius**2
    values = {
        "mass": (spec.mass, "kg"),
        "track": (spec.wheel_track, "m"),
        "inertia": (inertia, "kg·m²"),
        "efficiency": (spec.efficiency, ""),
        "windings": (spec.windings, "W/N²"),
        "scrub_onset": (spec.scrub_onset, "rad/m"),
        "regeneration": (spec.regeneration, ""),
        "offset": (0.0, "A"),
    }
    lines = ["# Of the simulated robot that these logs are of."]
    lines += [
        f"{key} = {float(value)!r}  # {unit}".rstrip(" #") for key, (value, unit) in values.items()
    ]
    return "\n".join(lines) + "\n"
