"""What is judged: the runs of one robot on one ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fleet.logs.asking import LogSettings
from fleet.scenario.errors import bad

Floats = NDArray[np.float64]


SLOWER = 2.5  # steps of motion from one power to the next: it is read less often


@dataclass(frozen=True, slots=True)
class LoggedRun:
    """A stretch of a log without gaps: how the robot moved, and the power that it took.

    Motion and power are each at their own times, which may be the same. A power stands for the time
    from halfway to the reading before to halfway to the one after.
    """

    file: str  # stretches of one file are one run when runs are held out
    time: Floats  # (n,) [s], ascending
    v: Floats  # (n,) forward speed [m/s]
    omega: Floats  # (n,) turning rate [rad/s]
    meter: Floats  # (k,) times of the power [s], ascending
    power: Floats  # (k,) [W], over all that was logged

    @property
    def duration(self) -> float:
        """From the first sample to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def slow(self) -> bool:
        """Whether the power was read less often than the motion."""
        steps = float(np.median(np.diff(self.time)))
        return float(np.median(np.diff(self.meter))) > SLOWER * steps


@dataclass(slots=True)
class LogGround:
    """Runs on one ground, what was told of them, and what was done to them."""

    name: str
    runs: list[LoggedRun]
    settings: LogSettings = LogSettings()
    turns: bool = True  # whether turning was seen at all
    drive_only: bool = False  # the power is the drive's: computers are not in it
    notes: list[str] = field(default_factory=list)  # of every rule that was applied

    @property
    def files(self) -> list[str]:
        """The files that the runs come from, in order."""
        return list(dict.fromkeys(run.file for run in self.runs))


def run_from_arrays(
    time: ArrayLike, v: ArrayLike, omega: ArrayLike, power: ArrayLike, name: str = "run"
) -> LoggedRun:
    """A run from arrays (n,): times [s], speeds [m/s], turning rates [rad/s], powers [W].

    For robots whose motion no file format says: with three wheels, say.

    Raises:
        BadInput: the arrays are not of one length, hold other than finite numbers, or the times do
            not ascend.
    """
    arrays = [np.array(values, float) for values in (time, v, omega, power)]
    if len({values.shape for values in arrays}) > 1 or arrays[0].ndim != 1 or len(arrays[0]) < 2:
        shapes = ", ".join(str(values.shape) for values in arrays)
        raise bad(name, f"arrays of shapes {shapes}; expected four of one length, 2 or more")
    if not all(np.isfinite(values).all() for values in arrays):
        raise bad(name, "holds values that are missing or infinite; expected finite numbers")
    if not (np.diff(arrays[0]) > 0.0).all():
        raise bad(name, "its times do not ascend; expected each later than the one before")
    return LoggedRun(name, arrays[0], arrays[1], arrays[2], arrays[0], arrays[3])


def ground_from_runs(
    name: str, runs: Sequence[LoggedRun], settings: LogSettings | None = None
) -> LogGround:
    """Runs that belong together, for :func:`fleet.logs.judging.judge`."""
    return LogGround(name, list(runs), settings or LogSettings())
