"""Which column of a log is what: by its name, or as it is told."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fleet.logs.sniffing import Sheet
from fleet.logs.units import factor_of, split_name, split_suffix
from fleet.scenario.errors import bad, unknown

Floats = NDArray[np.float64]

_SIDE = {"left": r"l(eft)?", "right": r"r(ight)?"}
_SPEED, _CURRENT = r"(v|vel(ocity)?|speed)", r"(i|cur(rent)?|amps?|motor_current)"
_MEASURED = r"(meas(ured)?_|actual_|est(imated)?_)?"


def _of_side(side: str, what: str) -> str:
    wheel = r"(wheel_|motor_|drive_|track_)?"
    words = rf"({wheel}{what}_?{_SIDE[side]}|{wheel}{_SIDE[side]}_{wheel}{what})(_wheel|_motor)?"
    return _MEASURED + words


@dataclass(frozen=True, slots=True)
class Role:
    """What a column can be: its unit, and the names that it goes by."""

    unit: str  # of the values, after their factor
    names: str  # a regular expression over the whole name, as `split_name` gives it
    what: str  # for people


ROLES: dict[str, Role] = {
    "time": Role("s", r"(ros_?|unix_?|log_|sim_|elapsed_|header_|epoch_)?(t|time|timestamp"
                      r"|time_stamp"
                 r"|stamp|sec|secs|seconds)|epoch|elapsed|date(_?time)?|utc"
                 r"|.*header_stamp", "time"),
    "x": Role("m", r"(pos(ition)?_?|pose_|odom_|p|.*position_)?x(_pos(ition)?"
                   r"|_estimate)?", "place"),
    "y": Role("m", r"(pos(ition)?_?|pose_|odom_|p|.*position_)?y(_pos(ition)?"
                   r"|_estimate)?", "place"),
    "theta": Role("rad", r"(pose_|odom_)?(theta|yaw|heading|psi|th|orientation|θ|ψ|φ)", "heading"),
    "v": Role("m/s", _MEASURED + r"(v|vx|v_x|speed|vel|velocity|linear|lin(ear)?_(vel(ocity)?"
                                 r"|speed|x)"
              r"|v_lin(ear)?|vel(ocity)?_x|(forward|ground|robot|body|longitudinal)_(speed|vel(ocity)?)"
              r"|.*twist_linear_x)(_meas(ured)?)?", "speed"),
    "omega": Role("rad/s", _MEASURED + r"(w|wz|w_z|omega|omega_z|(yaw|turn|turning"
                                       r"|heading)_?rate|angular"
                  r"|(ang(ular)?|rot(ation(al)?)?|yaw)_(vel(ocity)?|speed|rate|z)|v_?th(eta)?|v_ang|ω"
                  r"|vel_theta|.*twist_angular_z)(_meas(ured)?)?", "turning rate"),
    "gyro": Role("rad/s", r"gyro(scope)?(_?z)?|imu_?(w|wz|gyro|gyro_?z|yaw_?rate)|g_?z|wz?_imu"
                 r"|(.*_)?angular_velocity_z|yaw_?rate_imu", "turning rate of a gyro"),
    "v_left": Role("m/s", _of_side("left", _SPEED), "speed of the left wheels"),
    "v_right": Role("m/s", _of_side("right", _SPEED), "speed of the right wheels"),
    "power": Role("W", r"(bat(t(ery)?)?_|total_|electric(al)?_|consumed_|p_)?(p|power|watts?)"
                  r"(_bat(t(ery)?)?|_total|_draw|_consumption)?", "power"),
    "voltage": Role("V", r"(u|voltage|volts?|[uv]_?bat(t(ery)?)?|measured_battery"
                    r"|(bat(t(ery)?)?|supply|bus|pack)_?(voltage|volts?|[uv])"
                    r"|voltage_(bat(t(ery)?)?|v)|.*battery_?(state)?_voltage)", "voltage of the"
                                                                                " battery"),
    "current": Role("A", r"(i|current|amps?|amperes?|i_?bat(t(ery)?)?|(total|supply|bus"
                         r"|pack)_current"
                    r"|bat(t(ery)?)?_?(current|cur|amps?|i)|current_(bat(t(ery)?)?|draw|total)"
                    r"|.*battery_?(state)?_current)", "current of the battery"),
    "u_left": Role("V", _of_side("left", r"(u|volt(age)?)"), "voltage of the left drive"),
    "u_right": Role("V", _of_side("right", r"(u|volt(age)?)"), "voltage of the right drive"),
    "i_left": Role("A", _of_side("left", _CURRENT), "current of the left drive"),
    "i_right": Role("A", _of_side("right", _CURRENT), "current of the right drive"),
    "energy": Role("J", r"(e|energy|wh|(total|consumed|cumulative|used|bat(t(ery)?)?)_energy"
                   r"|energy_(used|consumed|total|drawn)|total_power_consumed)", "energy so far"),
}  # fmt: skip
"""Everything that a column can be. ``time``, a motion and a power are what a log must have."""

_ALONE = {"V": "voltage", "W": "power", "E": "energy", "U": "voltage", "I": "current", "P": "power"}
_COMMAND = re.compile(
    r"(^|_)(cmd|command(ed)?|set(point)?|target|desired|des|ref(erence)?|goal)(_|$)"
)
_CHARGE = re.compile(r"(.*_)?(soc|percent(age)?|battery_?level|charge)(_|$)")
_MOTOR = re.compile(r"(.*_)?motor_?cur(rent)?s?(_|$)")
SAYS_NO_POWER = "is a state of charge, too coarse for power"
_FASTEST_WHEEL = 3.0  # [m/s] beyond it a wheel's column is more likely in rad/s


@dataclass(slots=True)
class Signals:
    """What was measured, by role, in SI units; motion, power and gyro each at their own times."""

    name: str
    motion: dict[str, Floats] = field(default_factory=dict)  # with "time" [s], all (n,)
    power: dict[str, Floats] = field(default_factory=dict)  # with "time" [s], all (k,)
    gyro: dict[str, Floats] = field(default_factory=dict)  # with "time" [s], or empty
    in_seconds: bool = False  # the unit of time is known, not to be told by its steps
    notes: list[str] = field(default_factory=list)


MOTION = ("x", "y", "theta", "v", "omega", "v_left", "v_right")
POWER = ("power", "voltage", "current", "u_left", "u_right", "i_left", "i_right", "energy")


def told_column(text: str) -> tuple[str, str, float]:
    """What ``role=COLUMN*factor`` says; the factor is 1 if it is left out.

    Raises:
        BadInput: it has another form, or there is no such role.
    """
    role, equals, rest = (part.strip() for part in text.partition("="))
    if not equals or not rest:
        raise bad("--log-column", f"is {text!r}; expected ROLE=COLUMN or ROLE=COLUMN*FACTOR")
    if role not in ROLES:
        raise bad("--log-column", unknown("role", role, ROLES))
    column, star, factor = rest.rpartition("*")
    if not star:
        return role, rest, 1.0
    try:
        value = float(factor)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value) or value == 0.0:
        raise bad(
            "--log-column", f"{text!r} has the factor {factor!r}; expected a number such as 0.001"
        )
    return role, column.strip(), value


def signals_of(sheet: Sheet, told: Sequence[str] = ()) -> Signals:
    """The signals of a table: columns by name, ``told`` ones as ``role=COLUMN*factor`` first.

    Raises:
        BadInput: a column that is told is not there, two could be the same thing, a unit is not
            understood, or there is no column of times.
    """
    found: dict[str, Floats] = {}
    signals = Signals(sheet.source, notes=list(sheet.notes))
    taken = set()
    for text in told:
        role, column, factor = told_column(text)
        if column not in sheet.columns:
            raise bad("--log-column", f"{sheet.source}: {unknown('column', column, sheet.columns)}")
        found[role] = sheet.columns[column] * factor
        taken.add(column)
        signals.in_seconds |= role == "time" and "*" in text
        signals.notes.append(f"{role} [{ROLES[role].unit}] is {column!r} × {factor:g}, as told")
    nanoseconds = _split_stamp(sheet, taken)
    for role in ROLES:
        if role not in found:
            _by_name(role, sheet, taken, found, signals.notes)
    if "time" not in found:
        raise bad(
            "--log", f"{sheet.source}: no column of times among {_listed(sheet.columns)}; name it:"
            " --log-column time=COLUMN (in seconds; append *0.001 for milliseconds)",
        )  # fmt: skip
    if nanoseconds is not None:
        found["time"] = found["time"] + 1e-9 * nanoseconds
        signals.in_seconds = True
    signals.in_seconds |= any(
        note.startswith("time [s] is") and " in " in note for note in signals.notes
    )
    _check_wheels(sheet, told, found)
    time = found["time"]
    for roles, part in (
        (MOTION, signals.motion),
        (POWER, signals.power),
        (("gyro",), signals.gyro),
    ):
        here = {role: found[role] for role in roles if role in found}
        if here:
            part.update(here, time=time)
    signals.notes += _unused(sheet, signals)
    return signals


def _by_name(
    role: str, sheet: Sheet, taken: set[str], found: dict[str, Floats], notes: list[str]
) -> None:
    candidates = {}
    for column in sheet.columns:
        if column not in taken:
            unit = _fits(role, column, sheet.units)
            if unit is not None:
                candidates[column] = unit
    if len(candidates) > 1:
        first, second, *_ = (repr(name) for name in candidates)
        raise bad(
            "--log", f"{sheet.source}: {first} and {second} could both be the {ROLES[role].what};"
            f" choose one: --log-column {role}=COLUMN",
        )  # fmt: skip
    for column, unit in candidates.items():
        factor = factor_of(unit, ROLES[role].unit) if unit else 1.0
        if factor is None:
            raise bad(
                "--log", f"{sheet.source}: {column!r} is in {unit!r}; {_by_factor(role, column)}"
            )
        values = sheet.columns[column] * factor
        if not np.isfinite(values).any() and role not in POWER:
            continue  # a column that was never filled
        found[role] = values
        taken.add(column)
        given = f" in {unit}, × {factor:g}" if factor != 1.0 else ""
        notes.append(f"{role} [{ROLES[role].unit}] is {column!r}{given}")


def _fits(role: str, column: str, units: Mapping[str, str]) -> str | None:
    """The unit of a column that can be ``role``, "" where none is written; None: it cannot be."""
    words, bracketed = split_name(column)
    words = _ALONE.get(column.strip(), words)
    unit = bracketed or units.get(column, "")
    if _COMMAND.search(words):
        return None
    pattern = ROLES[role].names
    stem, suffix = split_suffix(words, ROLES[role].unit)
    if re.fullmatch(pattern, words):
        return unit if _is_unit(unit) else ""
    if suffix and re.fullmatch(pattern, stem):
        return unit or suffix
    return None


def _is_unit(text: str) -> bool:
    """Whether it looks like a unit, rather than a short name below the header."""
    return bool(text) and (
        any(
            factor_of(text, unit) is not None
            for unit in ("s", "m", "rad", "m/s", "rad/s", "W", "V", "A", "J")
        )
        or bool(re.fullmatch(r"[%a-zA-Zµ°]{1,8}(/[a-z0-9]{1,4})?", text) and "/" in text)
        or text in {"%", "px", "pixel", "ticks", "counts"}
    )


def _by_factor(role: str, column: str) -> str:
    unit = ROLES[role].unit
    what = "the wheel's radius [m]" if role in {"v_left", "v_right"} else f"what makes it {unit}"
    return f"expected {unit}: --log-column '{role}={column}*FACTOR' with {what} as the factor"


def _split_stamp(sheet: Sheet, taken: set[str]) -> Floats | None:
    """The nanoseconds of a stamp that is written as seconds and nanoseconds, in two columns."""
    words = {split_name(column)[0]: column for column in sheet.columns}
    for name, column in words.items():
        whole = re.sub(r"(nanosec|nsec)(s|onds)?$", r"sec\2", name)
        if whole != name and whole in words and words[whole] not in taken:
            taken.add(column)
            return sheet.columns[column]
    return None


def _check_wheels(sheet: Sheet, told: Sequence[str], found: Mapping[str, Floats]) -> None:
    named = {told_column(text)[0] for text in told}
    for role in {"v_left", "v_right"} & found.keys() - named:
        fastest = float(np.nanquantile(np.abs(found[role]), 0.95)) if len(found[role]) else 0.0
        if fastest > _FASTEST_WHEEL:
            raise bad(
                "--log", f"{sheet.source}: the {ROLES[role].what} reaches {fastest:.3g} m/s; is"
                         f" it in"
                f" rad/s? Say so with the wheel's radius as the factor: --log-column"
                f" '{role}=COLUMN*RADIUS' (*1 if it is right)",
            )  # fmt: skip


def _unused(sheet: Sheet, signals: Signals) -> list[str]:
    """What is there and is not taken, where that may surprise."""
    notes = []
    commands = [name for name in sheet.columns if _COMMAND.search(split_name(name)[0])]
    if commands:
        notes.append(f"{_listed(commands)} not taken: commands, no measurements")
    if not signals.power:
        charge = [name for name in sheet.columns if _CHARGE.match(split_name(name)[0])]
        motor = [name for name in sheet.columns if _MOTOR.match(split_name(name)[0])]
        if charge:
            notes.append(f"{_listed(charge)} {SAYS_NO_POWER}")
        if motor:
            notes.append(
                f"{_listed(motor)}: which side? --log-column i_left=COLUMN, i_right=COLUMN"
            )
    return notes


def _listed(names: Sequence[str] | Mapping[str, object]) -> str:
    shown = [repr(name) for name in list(names)[:12]]
    return ", ".join(shown) + (" …" if len(names) > 12 else "")
