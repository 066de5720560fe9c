"""What is told of logs: by options, or by a ``log.toml`` beside the files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import inf, isfinite
from pathlib import Path
from typing import Any

from fleet.logs.signals import told_column
from fleet.scenario.errors import BadInput, bad, shown, unknown
from fleet.scenario.toml import read_toml

FILE = "log.toml"


@dataclass(frozen=True, slots=True)
class MotorConstants:
    """What makes power of a motor's current: P = k·v·i + R·i² for each side.

    k is the back EMF over the speed of the wheel's rim: Ke·gear/r, or Kt·gear/r.

    Raises:
        ValueError: a value is negative, or k is 0.
    """

    k: float  # [V·s/m]
    resistance: float  # R [Ω]
    bias: float = 0.0  # [A] that is read at standstill; what the log reads there goes first

    def __post_init__(self) -> None:
        if not 0.0 < self.k < 1e6 or not 0.0 <= self.resistance < 1e6 or not 0.0 <= self.bias < 1e6:
            raise ValueError(
                f"motor is {self.k:g},{self.resistance:g},{self.bias:g}; expected k [V·s/m]"
                f" above 0,"
                " R [Ω] and bias [A] of 0 or more"
            )


@dataclass(frozen=True, slots=True)
class LogSettings:
    """How logs are to be read and judged; whatever is None the log itself has to tell.

    Raises:
        ValueError: a value is out of its range.
    """

    columns: tuple[str, ...] = ()  # ROLE=COLUMN*FACTOR
    voltage: float | None = None  # of a battery that is not logged [V]
    motor: MotorConstants | None = None  # currents are the motors'
    track: float | None = None  # from wheel to wheel, of a skid steer the effective one [m]
    mass: float | None = None  # [kg]
    offset: float | None = None  # what the battery's current reads at no current [A]
    electronics: float = 0.0  # constant power that the log leaves out [W]
    inertia: float | None = None  # about the vertical axis [kg·m²]
    efficiency: float | None = None  # of motors and gears
    windings: float | None = None  # heat of a motor over its force squared [W/N²]
    scrub_onset: float | None = None  # turning per metre from which scrub is full [rad/m]
    regeneration: float | None = None  # share of the power of braking that is led back
    within: float = 10.0  # [%] of error that a trip may have

    def __post_init__(self) -> None:
        for name in ("voltage", "track", "mass", "within", "inertia", "scrub_onset", "efficiency"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < inf:
                raise ValueError(f"{name} is {value:g}; expected more than 0, and finite")
        for name in ("electronics", "windings", "regeneration"):
            value = getattr(self, name)
            if value is not None and not 0.0 <= value < inf:
                raise ValueError(f"{name} is {value:g}; expected 0 or more, and finite")
        for name in ("efficiency", "regeneration"):
            if (getattr(self, name) or 0.0) > 1.0:
                raise ValueError(f"{name} is {getattr(self, name):g}; expected at most 1")
        if self.offset is not None and not isfinite(self.offset):
            raise ValueError(f"offset is {self.offset:g} A; expected a finite number")
        for text in self.columns:
            told_column(text)


def motor_constants(text: str) -> MotorConstants:
    """The constants of ``k,R,bias`` or ``k,R``.

    Raises:
        BadInput: it is something else.
    """
    try:
        return MotorConstants(*map(float, text.split(",")))
    except (TypeError, ValueError) as error:
        reason = str(error) if isinstance(error, ValueError) and "motor is" in str(error) else ""
        raise bad(
            "--motor",
            reason or f"is {text!r}; expected k,R,bias [V·s/m, Ω, A], such as 27.2,0.46,0.59",
        ) from error


def beside(folder: Path) -> LogSettings:
    """The settings of the ``log.toml`` in a folder; the defaults if there is none.

    Raises:
        BadInput: it is no TOML, or has a key or value that is not understood.
    """
    path = folder / FILE
    if not path.is_file():
        return LogSettings()
    document = read_toml(path)
    try:
        return settings_from(document.data)
    except BadInput as error:
        raise document.located(error) from error


def settings_from(table: Mapping[str, Any]) -> LogSettings:
    """Settings from the keys of a ``log.toml``.

    Raises:
        BadInput: a key is unknown, or a value is of another type or out of its range.
    """
    names = [field.name for field in fields(LogSettings)]
    values: dict[str, Any] = {}
    for key, value in table.items():
        if key not in names:
            raise bad(key, unknown("key", key, names))
        values[key] = _value(key, value)
    try:
        return LogSettings(**values)
    except BadInput:
        raise
    except ValueError as error:
        raise bad("", str(error)) from error


def _value(key: str, value: Any) -> Any:
    if key == "columns":
        if isinstance(value, Mapping):
            return tuple(f"{role}={column}" for role, column in value.items())
        raise bad(key, f"is {shown(value)}; expected a table such as [columns] v = 'speed*0.001'")
    if key == "motor":
        if isinstance(value, Mapping) and {"k", "resistance"} <= value.keys() <= {
            "k",
            "resistance",
            "bias",
        }:
            value = [value["k"], value["resistance"], value.get("bias", 0.0)]
        if isinstance(value, list) and all(_number(item) for item in value):
            return motor_constants(",".join(map(str, value)))
        raise bad(key, f"is {shown(value)}; expected {{k = …, resistance = …, bias = …}}")
    if not _number(value):
        raise bad(key, f"is {shown(value)}; expected a number")
    return float(value)


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def over(first: LogSettings, second: LogSettings) -> LogSettings:
    """The ``first`` settings, and the ``second`` where the first say nothing.

    A column that both name is the first's.
    """
    default = LogSettings()
    mine = {told_column(text)[0] for text in first.columns}
    others = tuple(text for text in second.columns if told_column(text)[0] not in mine)
    said = {
        field.name: getattr(second, field.name)
        for field in fields(LogSettings)
        if getattr(first, field.name) == getattr(default, field.name)
    }
    return replace(first, **{**said, "columns": first.columns + others})
