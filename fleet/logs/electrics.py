"""Power from what was measured: watts, volts and amperes, motor currents, or energy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from fleet.logs.asking import LogSettings, MotorConstants
from fleet.logs.clocks import genuine
from fleet.logs.signals import SAYS_NO_POWER, Signals
from fleet.scenario.errors import bad

Floats = NDArray[np.float64]

GRAVITY = 9.81  # [m/s²]
STILL = 0.01  # [m/s] of a wheel's rim
MOST_PUSH = 1.2  # of a robot's own weight: wheels cannot pass on more than about 1
_ROLLING = 0.05  # [m/s] from which a push is worked out
_SIDES = ("left", "right")


def power_of(
    signals: Signals, settings: LogSettings, offsets: Mapping[str, float] | None = None
) -> tuple[Floats, Floats, list[str], bool]:
    """Times [s] and powers [W] of a log, what was done, and whether computers are left out.

    ``offsets`` [A] of the drives, as other logs read them, are taken where this one never stands.

    Raises:
        BadInput: the log tells no power, or what it tells cannot be the battery's.
    """
    logged = {role: values for role, values in signals.power.items() if np.isfinite(values).any()}
    empty = sorted(signals.power.keys() - logged.keys())
    pair = [f"i_{side}" for side in _SIDES]
    if settings.motor is not None and all(role in logged for role in pair):
        power, notes = _from_motors(logged, signals, settings.motor, offsets or {})
        return _finite(signals, power, notes, drive_only=True)
    if settings.motor is not None:
        raise bad(
            "--motor", f"{signals.name}: has no currents of two drives to use it on; name them:"
            " --log-column i_left=COLUMN --log-column i_right=COLUMN",
        )  # fmt: skip
    if "power" in logged:
        return _finite(signals, logged["power"], [], drive_only=False)
    if "current" in logged:
        power, notes = _from_battery(logged, signals, settings)
        return _finite(signals, power, notes, drive_only=False)
    if all(role in logged for role in pair):
        power, notes = _from_drives(logged, signals, settings)
        return _finite(signals, power, notes, drive_only=True)
    if "energy" in logged:
        return _from_energy(logged["time"], logged["energy"], signals.name)
    raise bad("--log", f"{signals.name}: {_missing(logged, empty, signals.notes)}")


def _missing(logged: Mapping[str, Floats], empty: list[str], notes: Sequence[str]) -> str:
    """What to do about a log without power."""
    if empty:
        names = " and ".join(repr(name) for name in empty)
        what = (
            "this driver does not measure current" if "current" in empty else "nothing was measured"
        )
        return f"{names} is NaN throughout: {what}; log the battery's current, or watts"
    if "voltage" in logged:
        return (
            "holds a voltage and no current, which makes no power; log the battery's current too"
            " (--log-column current=COLUMN), or watts"
        )
    hint = next((f" ({note})" for note in notes if SAYS_NO_POWER in note), "")
    return (
        f"holds no power{hint}; expected watts, or the battery's volts and amperes, or motor"
        " currents with --motor k,R,bias, or energy so far; name it: --log-column power=COLUMN"
    )


def _finite(
    signals: Signals, power: Floats, notes: list[str], *, drive_only: bool
) -> tuple[Floats, Floats, list[str], bool]:
    """The readings that are there; a reading that is held until the next counts once."""
    time = signals.power["time"]
    there = np.isfinite(power) & np.isfinite(time)
    lost = len(power) - np.count_nonzero(there)
    if lost and lost < 0.05 * len(power):
        notes.append(f"{lost} rows without a power left out")
    time, power = time[there], power[there]
    held = genuine(power, time, _motion_at(signals, time))
    if held is not None:
        notes.append(
            f"power is read {len(held)} times in {len(power)} rows, and held in between: each"
            " reading counts once"
        )
        time, power = time[held], power[held]
    return time, power, notes, drive_only


def _voltage(
    logged: Mapping[str, Floats], signals: Signals, settings: LogSettings, notes: list[str]
) -> Floats | float:
    volts: Floats | float
    if "voltage" in logged:
        volts = logged["voltage"]
        typical = float(np.nanmedian(volts))
        if typical > 1000.0:
            raise bad(
                "--log", f"{signals.name}: the voltage is {typical:.4g} V; is it in mV? Say so:"
                " --log-column voltage=COLUMN*0.001",
            )  # fmt: skip
        missing = ~np.isfinite(volts)
        if missing.any():  # voltage changes slowly: what is missing lies between its neighbours
            at = np.flatnonzero(~missing)
            volts = np.interp(np.arange(len(volts)), at, volts[at])
        return volts
    if settings.voltage is None:
        raise bad(
            "--log", f"{signals.name}: holds currents and no voltage; give the battery's:"
            " --voltage V, or --log-column voltage=COLUMN",
        )  # fmt: skip
    notes.append(
        f"energy in units of a nominal {settings.voltage:g} V: it scales all figures alike"
    )
    return settings.voltage


def _from_battery(
    logged: Mapping[str, Floats], signals: Signals, settings: LogSettings
) -> tuple[Floats, list[str]]:
    notes: list[str] = []
    volts = _voltage(logged, signals, settings, notes)
    amperes = logged["current"]
    if settings.offset is not None:
        amperes = amperes - settings.offset
        notes.append(f"current less an offset of {settings.offset:g} A, as told")
    speed = _speed_at(signals, logged["time"])
    driving = np.isfinite(amperes) & (np.abs(speed) > _ROLLING)
    if driving.any() and float(np.median(amperes[driving])) < 0.0:
        amperes = -amperes
        notes.append("the battery's current is negative when it discharges: turned round")
    _check_push(np.abs(amperes), volts, np.abs(speed), signals, settings, notes)
    return volts * amperes, notes


def _from_drives(
    logged: Mapping[str, Floats], signals: Signals, settings: LogSettings
) -> tuple[Floats, list[str]]:
    """Currents of two drives, taken for what the drives take from the battery."""
    if all(f"u_{side}" in logged for side in _SIDES):
        return sum(logged[f"u_{s}"] * logged[f"i_{s}"] for s in _SIDES), [
            "power is voltage times current of each drive"
        ]  # type: ignore[return-value]  # sum() of two arrays is an array
    if settings.mass is None:
        raise bad(
            "--log", f"{signals.name}: holds the currents of two drives; are they the motors', or"
            " drawn from the battery? Motors': --motor k,R,bias. The battery's: --voltage V, with"
            " --mass KG to check it",
        )  # fmt: skip
    notes: list[str] = []
    volts = _voltage(logged, signals, settings, notes)
    total = np.zeros_like(logged["time"])
    for side in _SIDES:
        amperes, note = _less_offset(logged[f"i_{side}"], signals, side, logged["time"], 0.0)
        notes += note
        total = total + np.abs(amperes)
    rim = 0.5 * sum(np.abs(_wheel(signals, side, logged["time"])) for side in _SIDES)
    _check_push(total, volts, np.asarray(rim), signals, settings, notes)
    notes.append("currents of the drives taken for what they draw from the battery")
    return volts * total, notes


def _check_push(
    amperes: Floats, volts: Floats | float, rim: Floats, signals: Signals, settings: LogSettings,
    notes: list[str],
) -> None:  # fmt: skip
    """Refuse currents that would push harder than wheels can: they are the motors'."""
    rolling = (rim > _ROLLING) & np.isfinite(amperes)
    if np.count_nonzero(rolling) < 20:
        return
    watts = (volts * amperes)[rolling]
    if settings.mass is not None:
        weight = settings.mass * GRAVITY
        push = float(np.quantile(watts / rim[rolling], 0.9)) / weight
        if push > MOST_PUSH:
            raise bad(
                "--log", f"{signals.name}: V·I would push with {push:.1f} times the robot's weight:"
                " these are the motors' currents, not the battery's; give --motor k,R,bias, or the"
                " battery's current",
            )  # fmt: skip
    slow, fast = np.quantile(rim[rolling], [0.1, 0.9])
    low, high = rim[rolling] <= slow, rim[rolling] >= fast
    if fast > 1.5 * slow and watts[high].mean() < 1.05 * watts[low].mean():
        notes.append(
            f"the current does not rise with speed ({slow:.2f} to {fast:.2f} m/s): is it a motor's,"
            " and not the battery's?"
        )


def _from_motors(
    logged: Mapping[str, Floats], signals: Signals, motor: MotorConstants,
    offsets: Mapping[str, float],
) -> tuple[Floats, list[str]]:  # fmt: skip
    """P = k·v·i + R·i² for each side."""
    notes = [
        (
            f"power is k·v·i + R·i² for each side, k = {motor.k:g} V·s/m, R ="
            f" {motor.resistance:g} Ω:"
            " these are the motors' currents"
        )
    ]
    total = np.zeros_like(logged["time"])
    signed = any((logged[f"i_{side}"] < -0.05).any() for side in _SIDES)
    for side in _SIDES:
        rim = _wheel(signals, side, logged["time"])
        amperes, note = _less_offset(
            logged[f"i_{side}"], signals, side, logged["time"], offsets.get(side, motor.bias)
        )
        notes += note
        if signed:
            if np.nansum(amperes * rim) < 0.0:
                amperes = -amperes
                notes.append(f"the current of the {side} drive turned round: it opposed its speed")
            work = motor.k * rim * amperes
        else:
            amperes = np.maximum(0.0, np.abs(amperes))
            work = motor.k * np.abs(rim) * amperes
        total = total + work + motor.resistance * amperes**2
    if not signed:
        notes.append("currents have no sign: braking counts as driving")
    return total, notes


def _less_offset(
    amperes: Floats, signals: Signals, side: str, time: Floats, bias: float
) -> tuple[Floats, list[str]]:
    """A channel less what it reads at standstill, or less the ``bias`` if it never stands."""
    signed = bool((amperes < -0.05).any())
    at_rest = _offset(amperes, signals, time)
    if at_rest is not None:
        offset = at_rest
        note = f"current of the {side} drive reads {offset:.2f} A at standstill: subtracted"
    else:
        offset = bias
        note = f"never stands: {bias:.2g} A taken off the {side} drive, as others read, or as told"
    less = amperes - offset if signed else np.maximum(0.0, np.abs(amperes) - offset)
    return less, [note] if note and offset else []


def _offset(amperes: Floats, signals: Signals, time: Floats) -> float | None:
    """What a channel reads while both sides stand [A]; None: they never do."""
    rest = np.isfinite(amperes)
    for side in _SIDES:
        rest &= np.abs(_wheel(signals, side, time)) < STILL
    return float(np.median(amperes[rest])) if np.count_nonzero(rest) > 5 else None


def standstill_offsets(logs: Sequence[Signals]) -> dict[str, float]:
    """What the drives' currents read at standstill, by side [A]: the median of logs that stand."""
    found: dict[str, list[float]] = {side: [] for side in _SIDES}
    for signals in logs:
        for side in _SIDES:
            if f"i_{side}" in signals.power and all(f"v_{s}" in signals.motion for s in _SIDES):
                offset = _offset(signals.power[f"i_{side}"], signals, signals.power["time"])
                if offset is not None:
                    found[side].append(offset)
    return {side: float(np.median(values)) for side, values in found.items() if values}


def _from_energy(
    time: Floats, energy: Floats, source: str
) -> tuple[Floats, Floats, list[str], bool]:
    """Power from energy so far, at the middle between its readings; what is left counts down."""
    there = np.isfinite(energy) & np.isfinite(time)
    time, energy = time[there], energy[there]
    keep = np.flatnonzero(np.r_[True, np.diff(energy) != 0.0])
    notes = ["power is the rise of energy from reading to reading"]
    if len(keep) > 2 and np.median(np.diff(keep)) >= 3:
        time, energy = time[keep], energy[keep]  # a counter that is read more often than it counts
    if len(energy) < 3:
        raise bad("--log", f"{source}: its energy never changes; expected energy used so far")
    if energy[-1] < energy[0]:
        energy = -energy
        notes.append("energy falls: taken for what is left in the battery")
    step = np.diff(time)
    good = step > 0.0
    middle = 0.5 * (time[1:] + time[:-1])
    return middle[good], np.diff(energy)[good] / step[good], notes, False


def _wheel(signals: Signals, side: str, time: Floats) -> Floats:
    """The speed of one side's wheels at other times [m/s]."""
    motion = signals.motion
    if f"v_{side}" in motion:
        return _at(time, motion["time"], motion[f"v_{side}"])
    raise bad(
        "--log", f"{signals.name}: motor currents need the speeds of the wheels; name them:"
        " --log-column v_left=COLUMN --log-column v_right=COLUMN",
    )  # fmt: skip


def _speed_at(signals: Signals, time: Floats) -> Floats:
    """How fast the robot goes at other times [m/s]; 0 where only places are logged."""
    motion = signals.motion
    if "v" in motion:
        return _at(time, motion["time"], motion["v"])
    if "v_left" in motion and "v_right" in motion:
        return _at(time, motion["time"], 0.5 * (motion["v_left"] + motion["v_right"]))
    if "x" in motion and "y" in motion:
        there = np.isfinite(motion["x"] + motion["y"] + motion["time"])
        at, x, y = (motion[role][there] for role in ("time", "x", "y"))
        if len(at) > 2:
            with np.errstate(divide="ignore", invalid="ignore"):
                step = np.hypot(np.diff(x), np.diff(y)) / np.diff(at)
            return _at(time, 0.5 * (at[1:] + at[:-1]), step)
    return np.zeros(len(time))


def _motion_at(signals: Signals, time: Floats) -> Floats:
    """A number that changes when any part of the motion does, at other times."""
    motion = signals.motion
    total = np.zeros(len(time))
    for role, weight in zip(
        sorted(motion.keys() - {"time"}), (1.0, 1.37, 1.71, 2.3, 2.9, 3.7, 4.1), strict=False
    ):
        total = total + weight * _at(time, motion["time"], motion[role])
    return total


def _at(time: Floats, known: Floats, values: Floats) -> Floats:
    if time is known:
        return values
    there = np.isfinite(values) & np.isfinite(known)
    if not there.any():
        return np.full(len(time), np.nan)
    order = np.argsort(known[there], kind="stable")
    return np.interp(time, known[there][order], values[there][order])
