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

COLUMNS = ("time", "x", "y", "theta", "v", "omega", "power")
"""Of a log: s, m, m, rad, m/s, rad/s, W. Rates and power are those of the step about the time."""

STANDING = 2.5  # [s] before and after each trip
_KEPT = ("robot", "time", "x", "y", "heading", "energy")
_ROBOT, _TIME, _X, _Y, _HEADING, _ENERGY = range(len(_KEPT))


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
        *,
        engine: bool = True,
        run: int = 0,
    ) -> None:
        self.sample_interval = interval
        self._folder, self._spec, self._interval = folder, spec, interval
        self._engine, self._run = engine, run
        self._samples: list[Floats] = []

    @override
    def moved(self, samples: Floats) -> None:
        self._samples.append(samples[:, [SAMPLE_FIELDS.index(name) for name in _KEPT]])

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
            np.array([[number, time, *robot.position, robot.heading, robot.energy]])
        )

    @override
    def run_ended(self, summary: Any) -> None:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            for robot, log in logs_of(
                self._samples, self._spec, self._interval, engine=self._engine
            ).items():
                lines = [",".join(COLUMNS), *(",".join(f"{x:.9g}" for x in row) for row in log)]
                path = self._folder / f"run-{self._run}-robot-{robot:03d}.csv"
                path.write_text("\n".join(lines) + "\n", "utf-8")
            (self._folder / FILE).write_text(settings_text(self._spec), "utf-8")
        except OSError as error:
            raise bad(
                "--log", f"{str(self._folder)!r} cannot be written to: {error.strerror}"
            ) from error


def logs_of(
    samples: Sequence[Floats], spec: RobotSpec, interval: float, *, engine: bool
) -> dict[int, Floats]:
    """The log of each robot (n, 7), :data:`COLUMNS`, from the poses that a run told of.

    What a step takes goes with the mean of the velocities before and after it. With an ``engine``,
    which moves bodies first and then changes their velocity, a step's own displacement is that of
    the velocity before it, otherwise of the one after.
    """
    if not samples:
        return {}
    rows = np.concatenate(samples)
    logs = {}
    for robot in np.unique(rows[:, _ROBOT]):
        mine = rows[rows[:, _ROBOT] == robot]
        mine = mine[np.unique(mine[:, _TIME].round(6), return_index=True)[1]]
        cuts = np.flatnonzero(np.diff(mine[:, _TIME]) > 1.5 * interval) + 1
        trips = [trip for trip in np.split(mine, cuts) if len(trip) > 2]
        if trips:
            logs[int(robot)] = _one_after_the_other(trips, spec, interval, engine=engine)
    return logs


def _one_after_the_other(
    trips: Sequence[Floats], spec: RobotSpec, interval: float, *, engine: bool
) -> Floats:
    """A robot's trips with standing around them; its clock stops while it stands for longer."""
    rest = round(STANDING / interval)
    parts = []
    for trip in trips:
        steps = _steps(trip, spec, engine=engine)
        for end in (0, -1):
            stand = np.repeat(steps[[end]], rest, axis=0)
            stand[:, 4:] = 0.0, 0.0, spec.extra.idle
            parts.append(stand)
        parts.insert(-1, steps)
    log = np.concatenate(parts)
    log[:, 0] = interval * np.arange(len(log))
    return log


def _steps(trip: Floats, spec: RobotSpec, *, engine: bool) -> Floats:
    """Place, rates and power of each step of a trip: at its middle."""
    step = np.diff(trip[:, _TIME])
    dx, dy = np.diff(trip[:, _X]), np.diff(trip[:, _Y])
    heading = np.unwrap(trip[:, _HEADING])
    theta, turn = 0.5 * (heading[1:] + heading[:-1]), np.diff(heading)
    middle = 0.5 * (trip[1:] + trip[:-1])
    if spec.drive == "holonomic":
        ahead, turn = np.hypot(dx, dy), np.zeros(len(dx))
    else:
        ahead = dx * np.cos(theta) + dy * np.sin(theta)
    rates = np.column_stack([ahead, turn]) / step[:, None]
    nothing = np.zeros((1, 2))
    other = np.vstack([rates[1:], nothing] if engine else [nothing, rates[:-1]])
    rates = 0.5 * (rates + other)
    spent = -np.diff(trip[:, _ENERGY])
    return np.column_stack([
        middle[:, _TIME], middle[:, _X], middle[:, _Y], theta, rates, spent / step,
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
