"""Trips of a simulation, written as the logs of real robots are: to be read by the same commands.

Each robot's trips become one file, a run, with a few seconds of standing before and after each;
what a log cannot tell of its robot is in ``log.toml`` beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from fleet.logs.asking import FILE
from fleet.motion import SAMPLE_FIELDS
from fleet.observer import Observer
from fleet.robot import RobotSpec
from fleet.scenario.errors import bad

Floats = NDArray[np.float64]

COLUMNS = ("time", "x", "y", "theta", "v", "omega", "power")
"""Of a log: s, m, m, rad, m/s, rad/s, W. Rates and power are those of the step about the time."""

STANDING = 2.5  # [s] before and after each trip
_ROBOT, _TIME, _X, _Y, _HEADING, _ENERGY = (
    SAMPLE_FIELDS.index(name) for name in ("robot", "time", "x", "y", "heading", "energy")
)


class TripLog(Observer):
    """Writes the trips of a run into a folder when the run is over, a file for each robot.

    Raises:
        BadInput: the folder cannot be written to.
    """

    def __init__(self, folder: Path, spec: RobotSpec, interval: float = 1.0 / 60.0) -> None:
        self.sample_interval = interval
        self._folder, self._spec, self._interval = folder, spec, interval
        self._samples: list[Floats] = []

    @override
    def moved(self, samples: Floats) -> None:
        self._samples.append(samples.copy())

    @override
    def run_ended(self, summary: Any) -> None:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            for robot, log in logs_of(self._samples, self._spec, self._interval).items():
                lines = [",".join(COLUMNS), *(",".join(f"{x:.9g}" for x in row) for row in log)]
                path = self._folder / f"robot-{robot:03d}.csv"
                path.write_text("\n".join(lines) + "\n", "utf-8")
            (self._folder / FILE).write_text(settings_text(self._spec), "utf-8")
        except OSError as error:
            raise bad(
                "--log", f"{str(self._folder)!r} cannot be written to: {error.strerror}"
            ) from error


def logs_of(samples: Sequence[Floats], spec: RobotSpec, interval: float) -> dict[int, Floats]:
    """The log of each robot (n, 7), :data:`COLUMNS`, from the poses that a run told of."""
    if not samples:
        return {}
    rows = np.concatenate(samples)
    logs = {}
    for robot in np.unique(rows[:, _ROBOT]):
        mine = rows[rows[:, _ROBOT] == robot]
        mine = mine[np.argsort(mine[:, _TIME], kind="stable")]
        cuts = np.flatnonzero(np.diff(mine[:, _TIME]) > 1.5 * interval) + 1
        trips = [trip for trip in np.split(mine, cuts) if len(trip) > 2]
        if trips:
            logs[int(robot)] = _one_after_the_other(trips, spec, interval)
    return logs


def _one_after_the_other(trips: Sequence[Floats], spec: RobotSpec, interval: float) -> Floats:
    """A robot's trips with standing around them; its clock stops while it stands for longer."""
    rest = round(STANDING / interval)
    parts = []
    for trip in trips:
        steps = _steps(trip, spec)
        for end in (0, -1):
            stand = np.repeat(steps[[end]], rest, axis=0)
            stand[:, 4:] = 0.0, 0.0, spec.extra.idle
            parts.append(stand)
        parts.insert(-1, steps)
    log = np.concatenate(parts)
    log[:, 0] = interval * np.arange(len(log))
    return log


def _steps(trip: Floats, spec: RobotSpec) -> Floats:
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
    spent = -np.diff(trip[:, _ENERGY])
    return np.column_stack([
        middle[:, _TIME], middle[:, _X], middle[:, _Y], theta, ahead / step, turn / step,
        spent / step,
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
