"""From signals to runs: times, gaps, noise, turning. Every rule that is applied is told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fleet.logs.asking import LogSettings
from fleet.logs.clocks import ascending, seconds, unfolded
from fleet.logs.electrics import power_of
from fleet.logs.grounds import LoggedRun
from fleet.logs.signals import Signals
from fleet.scenario.errors import bad

Floats = NDArray[np.float64]

SHORTEST = 5.0  # [s] of a stretch that is kept
SPAN = 0.5  # [s] over which noisy speeds are averaged
_NOISE = {"v": 0.01, "omega": 0.02}  # [m/s], [rad/s] from which they are
_SURELY = 3.0  # times its noise: less turning is none, or noise alone would cost scrub
_STRAIGHT = 3e-3  # [rad/s] below which it does not matter
_HELD = 20  # samples of the same speed: a command rather than a measurement
_DENSER = 0.5  # steps of motion from one power to the next: it is averaged over these


class Cleaned(NamedTuple):
    """The runs of one log."""

    runs: list[LoggedRun]
    notes: list[str]  # what was done
    turns: bool  # whether it shows turning at all
    drive_only: bool  # the power is the drive's: computers are not in it


def runs_of(
    signals: Signals, settings: LogSettings, offsets: Mapping[str, float] | None = None
) -> Cleaned:
    """The runs of one log; ``offsets`` as for :func:`fleet.logs.electrics.power_of`.

    Raises:
        BadInput: motion, power or time is missing or unusable.
    """
    notes = list(signals.notes)
    for part in (signals.motion, signals.power, signals.gyro):
        if "time" in part:
            note = ""
            if not signals.in_seconds:
                part["time"], note = seconds(part["time"], signals.name)
            part["time"] = unfolded(part["time"])
            notes += [note] if note and note not in notes else []
    if not signals.motion:
        raise bad(
            "--log", f"{signals.name}: holds no motion; expected v and omega, or x, y and theta, or"
            " speeds of left and right wheels; name a column: --log-column v=COLUMN",
        )  # fmt: skip
    meter, power, told, drive_only = power_of(signals, settings, offsets)
    notes += told
    time, v, omega, told = motion_of(signals, settings)
    notes += told
    stretches, told = ascending(time, signals.name)
    notes += told
    metered, told = ascending(meter, signals.name)
    notes += [note for note in told if note not in notes]
    seen = np.zeros_like(v) if omega is None else omega
    runs = [
        run
        for rows in stretches
        for readings in metered
        if (
            run := _aligned(
                signals.name, (time[rows], v[rows], seen[rows]), meter[readings], power[readings]
            )
        )
    ]
    if not runs:
        length = float(np.ptp(time)) if len(time) else 0.0
        raise bad(
            "--log", f"{signals.name}: holds no stretch of {SHORTEST:g} s with motion and power"
                     f" at the"
            f" same time, in {len(time)} samples over {length:.3g} s; expected a drive of 20 s"
            f" or more",
        )  # fmt: skip
    notes += _smoothed(runs)
    if omega is None:
        notes.append("no heading: turning is not seen, nor what it costs")
    returned = sum(np.minimum(run.power, 0.0).sum() for run in runs)
    total = sum(run.power.sum() for run in runs)
    if returned < 0.0 < total:
        notes.append(
            f"{-100.0 * returned / (total - returned):.1f} % of the energy is returned: kept"
        )
    return Cleaned(runs, notes, omega is not None, drive_only)


def motion_of(
    signals: Signals, settings: LogSettings
) -> tuple[Floats, Floats, Floats | None, list[str]]:
    """Times [s], forward speeds [m/s], turning rates [rad/s] or None, and what was done."""
    motion, notes = signals.motion, []
    gyro = _gyro_at(signals)
    omega: Floats | None = None
    if "v" in motion:
        v = motion["v"]
        omega = motion.get("omega", gyro)
        if omega is None and "theta" in motion:
            omega = _rate(motion["time"], motion["theta"], angle=True)
            notes.append("turning rate from the heading")
        if gyro is not None and "omega" in motion:
            omega, told = _by_gyro(motion["omega"], gyro)
            notes += told
    elif "v_left" in motion and "v_right" in motion:
        v, omega, notes = _from_wheels(signals, gyro, settings)
    elif "x" in motion and "y" in motion:
        v, omega, notes = _from_places(motion, gyro)
    else:
        raise bad(
            "--log", f"{signals.name}: {', '.join(sorted(motion.keys() - {'time'}))} alone is no"
            " motion; expected v and omega, or x, y and theta, or speeds of left and right wheels",
        )  # fmt: skip
    there = np.isfinite(v) & np.isfinite(motion["time"])
    if omega is not None and np.isfinite(omega).any():
        there &= np.isfinite(omega)
    else:
        omega = None
    if not there.any():
        raise bad("--log", f"{signals.name}: its speeds are all missing; expected numbers")
    lost = len(there) - np.count_nonzero(there)
    if lost and lost < 0.2 * len(there):
        notes.append(f"{lost} rows without a speed left out")
    held = _longest_hold(v[there])
    if held > _HELD:
        notes.append("speeds stay the same for more than 20 samples: commands, not measurements?")
    return motion["time"][there], v[there], None if omega is None else omega[there], notes


def _from_wheels(
    signals: Signals, gyro: Floats | None, settings: LogSettings
) -> tuple[Floats, Floats, list[str]]:
    left, right = signals.motion["v_left"], signals.motion["v_right"]
    v, difference = 0.5 * (left + right), right - left
    if gyro is not None:
        there = np.isfinite(gyro) & np.isfinite(difference)
        square = float((gyro[there] ** 2).sum())
        track = float((difference[there] * gyro[there]).sum()) / square if square > 0.0 else 0.0
        if track > 0.0 and there.sum() > 2 and np.ptp(difference[there]) > 0.0:
            sure = float(np.corrcoef(difference[there], gyro[there])[0, 1])
            against = "" if settings.track is None else f", {settings.track:g} m were told"
            return (
                v,
                gyro,
                [
                    (
                        f"turning from the gyro: the effective track is {track:.2f} m (correlation"
                        f" {sure:.2f}{against})"
                    )
                ],
            )
    if settings.track is None:
        raise bad(
            "--log", f"{signals.name}: turning from wheel speeds needs --track, the distance"
                     f" between"
            " the wheels [m] (of a skid steer the effective one, often 1.5 to 2.5 times that), or a"
            " gyro: --log-column gyro=COLUMN",
        )  # fmt: skip
    return (
        v,
        difference / settings.track,
        [
            (
                f"turning from wheel speeds over a track of {settings.track:g} m; a skid steer"
                f" turns less"
                " than that: a gyro would tell"
            )
        ],
    )


def _from_places(
    motion: dict[str, Floats], gyro: Floats | None
) -> tuple[Floats, Floats | None, list[str]]:
    time = motion["time"]
    u, w = _rate(time, motion["x"]), _rate(time, motion["y"])
    if "theta" in motion:
        theta = motion["theta"]
        return (
            u * np.cos(theta) + w * np.sin(theta),
            gyro if gyro is not None else _rate(time, theta, angle=True),
            ["speed and turning rate from the places"],
        )
    return np.hypot(u, w), gyro, ["speed from the places"]


def _rate(time: Floats, values: Floats, *, angle: bool = False) -> Floats:
    """The rate of a signal, over its neighbours; NaN where it is not known."""
    rate = np.full(len(time), np.nan)
    there = np.flatnonzero(np.isfinite(time) & np.isfinite(values))
    if len(there) > 2:
        there = there[np.r_[True, np.diff(time[there]) != 0.0]]
    if len(there) > 2:
        known = np.unwrap(values[there]) if angle else values[there]
        rate[there] = np.gradient(known, time[there])
    return rate


def _gyro_at(signals: Signals) -> Floats | None:
    if "gyro" not in signals.gyro:
        return None
    if signals.gyro["time"] is signals.motion["time"] or np.array_equal(
        signals.gyro["time"], signals.motion["time"], equal_nan=True
    ):
        return signals.gyro["gyro"]
    there = np.isfinite(signals.gyro["gyro"])
    return np.interp(
        signals.motion["time"], signals.gyro["time"][there], signals.gyro["gyro"][there]
    )


def _by_gyro(omega: Floats, gyro: Floats) -> tuple[Floats, list[str]]:
    """The gyro's turning rate where the odometry's differs from it by a factor."""
    there = np.isfinite(omega) & np.isfinite(gyro)
    square = float((gyro[there] ** 2).sum())
    ratio = float((omega[there] * gyro[there]).sum()) / square if square > 0.0 else 1.0
    if not 0.9 <= ratio <= 1.1 and ratio > 0.2:
        return gyro, [f"odometry turns {ratio:.2f} times as much as the gyro: the gyro is taken"]
    return omega, []


def _longest_hold(v: Floats) -> int:
    """For how many samples on end a speed above 0 is the same."""
    edges = np.flatnonzero(np.r_[True, np.diff(v) != 0.0, True])
    moving = np.abs(v[edges[:-1]]) > 0.02
    return int(np.diff(edges)[moving].max()) if moving.any() else 0


def _aligned(
    file: str, motion: tuple[Floats, Floats, Floats], meter: Floats, power: Floats
) -> LoggedRun | None:
    """A run from the span that motion and power have in common; None: it is too short."""
    time, v, omega = motion
    if len(time) < 3 or len(meter) < 3:
        return None
    low, high = max(time[0], meter[0]), min(time[-1], meter[-1])
    if high - low < SHORTEST:
        return None
    rows = (time >= low) & (time <= high)
    begin = float(time[rows][0])
    if float(np.median(np.diff(meter))) < _DENSER * float(np.median(np.diff(time))):
        meter, power = time[rows], _averaged(time[rows], meter, power)
    else:
        readings = (meter >= low) & (meter <= high)
        meter, power = meter[readings], power[readings]
    if len(meter) < 10 or np.count_nonzero(rows) < 10:
        return None
    return LoggedRun(
        file, time[rows] - begin, v[rows], omega[rows], meter - begin, power
    )  # fmt: skip


def _averaged(time: Floats, meter: Floats, power: Floats) -> Floats:
    """Power at other times, by interpolating energy, not power: nothing is lost."""
    so_far = np.r_[0.0, np.cumsum(np.diff(meter) * 0.5 * (power[1:] + power[:-1]))]
    edges = np.r_[time[0], 0.5 * (time[1:] + time[:-1]), time[-1]]
    energy: Floats = np.diff(np.interp(edges, meter, so_far))
    averaged: Floats = energy / np.maximum(np.diff(edges), 1e-12)
    return averaged


def _smoothed(runs: list[LoggedRun]) -> list[str]:
    """Average noisy speeds over half a second, before anything squared is made of them."""
    notes = []
    for name, unit in (("v", "m/s"), ("omega", "rad/s")):
        noise = float(np.median([_noise(getattr(run, name)) for run in runs]))
        if noise <= _NOISE[name]:
            continue
        for number, run in enumerate(runs):
            values = {"v": run.v, "omega": run.omega}
            values[name] = _moving_average(values[name], run.time)
            runs[number] = LoggedRun(
                run.file, run.time, values["v"], values["omega"], run.meter, run.power
            )
        notes.append(f"{name} is noisy (± {noise:.2g} {unit}): averaged over {SPAN:g} s")
    noise = _SURELY * float(np.median([_noise(run.omega) for run in runs]))
    if noise > _STRAIGHT:
        runs[:] = [
            replace(run, omega=np.where(np.abs(run.omega) < noise, 0.0, run.omega)) for run in runs
        ]
        notes.append(f"turning of less than its noise, {noise:.2g} rad/s, is taken for none")
    return notes


def _noise(values: Floats) -> float:
    """The standard deviation of what differs from sample to sample: of second differences."""
    if len(values) < 5:
        return 0.0
    bends = np.diff(values, 2)
    return float(np.median(np.abs(bends - np.median(bends)))) / (0.6745 * sqrt(6.0))


def _moving_average(values: Floats, time: Floats) -> Floats:
    width = max(1, round(SPAN / float(np.median(np.diff(time)))))
    if width == 1:
        return values
    padded = np.pad(values, (width // 2, width - 1 - width // 2), "edge")
    sums = np.cumsum(np.r_[0.0, padded])
    averaged: Floats = (sums[width:] - sums[:-width]) / width
    return averaged
