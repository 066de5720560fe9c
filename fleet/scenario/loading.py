"""Scenarios from files and options. What is wrong is said with its file, line and key."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fleet.catalogue import known_name, look_up
from fleet.robot import RobotSpec
from fleet.scenario.binding import convert, unusable
from fleet.scenario.choices import check, homes
from fleet.scenario.errors import BadInput, bad, or_list, shortened, shown, unknown
from fleet.scenario.model import Scenario, plain
from fleet.scenario.paths import anchored
from fleet.scenario.toml import Document, parse_value, read_toml

CHOICES = ("protocol", "world", "motion", "time", "events", "radio")
NAMED_BY = dict.fromkeys(CHOICES, "name") | {"robot": "preset"}


def load_scenario(
    path: Path | None, options: Mapping[str, Any] | None = None, settings: Sequence[str] = ()
) -> Scenario:
    """The scenario of a TOML file, with ``options`` and then ``key=value`` settings over it.

    Raises:
        BadInput: a file, key or value that cannot be used.
    """
    file = None if path is None else read_toml(path)
    data: dict[str, Any] = anchored(file.data, file.path.parent) if file else {}
    origins: dict[str, str] = {}
    for key, value in (options or {}).items():
        data = merged(data, {key: value})
        origins[key] = "--" + key.replace("_", "-")
    for setting in settings:
        key, value = parse_setting(setting)
        data = merged(data, nested(key, value))
        origins[key] = "--set"
    try:
        scenario = scenario_from(data)
        check(scenario)
    except BadInput as error:
        raise BadInput(_located(error, origins, file)) from error
    return scenario


def scenario_from(data: Mapping[str, Any]) -> Scenario:
    """A scenario from tables as a file would have them.

    Raises:
        BadInput: an unknown key, a value of another type or out of its range.
    """
    tables = plain(data)
    problems = list(unusable(tables, ""))
    problems += [(key, _stray(key)) for key in tables if key not in Scenario.__dataclass_fields__]
    if problems:
        raise BadInput(problems)
    for key in CHOICES:
        if key in tables:
            tables[key] = _choice(tables[key], key)
    if "robot" in tables:
        tables["robot"] = _robot(tables["robot"])
    scenario: Scenario = convert(Scenario, tables, "")
    return scenario


def _stray(key: str) -> str:
    """There is no such key, at least not outside of all tables."""
    within = list(homes(key))
    if within:
        return f"unknown key {key!r}; did you mean {or_list(within[:3])}?"
    return unknown("key", key, Scenario.__dataclass_fields__)


def parse_setting(setting: str) -> tuple[str, Any]:
    """``key=value``: the value as in TOML, or, if it is none, as plain text.

    Raises:
        BadInput: there is no ``=``, no key, or more than one value.
    """
    key, equals, text = setting.partition("=")
    key = key.strip()
    if not equals or not re.fullmatch(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+){0,9}", key):
        raise bad("--set", f"is {shown(setting)}; expected key=value, such as robot.radius=0.2")
    try:
        return key, parse_value(text)
    except ValueError as error:
        raise bad(f"--set: {shortened(key, 60)}", str(error)) from error


def nested(key: str, value: Any) -> dict[str, Any]:
    """``a.b = value`` as tables."""
    head, _, rest = key.partition(".")
    return {head: nested(rest, value) if rest else value}


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """``base`` with the values of ``over`` laid over it, table by table.

    A table laid over a name alone adds to what that name stands for.
    """
    result = dict(base)
    for key, value in over.items():
        under = result.get(key)
        if isinstance(value, Mapping) and isinstance(under, str) and key in NAMED_BY:
            under = {NAMED_BY[key]: under}
        if isinstance(value, Mapping) and isinstance(under, Mapping):
            result[key] = merged(under, value)
        else:
            result[key] = value
    return result


def _choice(value: Any, key: str) -> dict[str, Any]:
    """A name, or a table, as the fields of a :class:`Choice`."""
    if isinstance(value, str):
        value = {"name": value}
    if not isinstance(value, Mapping):
        raise bad(key, f"is {shown(value)}; expected a name, or a table with one")
    parameters = dict(value)
    name = parameters.pop("name", getattr(Scenario(), key).name)
    if not isinstance(name, str) or not name:
        raise bad(f"{key}.name", f"is {shown(name)}; expected a name from `fleet list`")
    name = known_name(key, name) or name  # one that is not known may be a file of the user's
    return {"name": name, "parameters": parameters}


def _robot(value: Any) -> dict[str, Any]:
    """A preset, or a table of what differs from one, as the fields of a RobotSpec.

    A preset may also be a file with such a table, as ``fleet energy --log`` writes them.
    """
    if not isinstance(value, str | Mapping):
        raise bad("robot", f"is {shown(value)}; expected the name of a preset, or a table")
    table = {"preset": value} if isinstance(value, str) else dict(value)
    preset = table.pop("preset", "small")
    if not isinstance(preset, str):
        raise bad("robot.preset", f"is {shown(preset)}; expected the name of a preset, or a file")
    if preset.endswith(".toml"):
        return merged(_robot_from(Path(preset)), table)
    return merged(plain(look_up("preset", preset, "robot.preset")), table)


def _robot_from(path: Path) -> dict[str, Any]:
    """The robot of a file of its own, as the fields of a RobotSpec."""
    file = read_toml(path)
    if str(file.data.get("preset", "")).endswith(".toml"):
        raise bad("robot.preset", f"{path}: names another file; expected the name of a preset")
    try:
        robot = _robot(file.data)
        convert(RobotSpec, robot, "")
    except BadInput as error:
        raise file.located(error) from error
    return robot


def _located(
    error: BadInput, origins: Mapping[str, str], file: Document | None
) -> list[tuple[str, str]]:
    """The problems with where their key was set: a line of the file, or an option."""
    located = []
    for key, text in error.problems:
        named = re.match(r"(?:\w+ )?(\w+) (?=is )", text)  # a range is checked for a whole table
        inner = ".".join(filter(None, (key, named[1]))) if named else key
        by_option = _set_by(inner, origins)
        if not by_option and (file is None or inner not in file.lines):
            by_option = _set_by(key, origins)
        if by_option:
            option, exact = origins[by_option], by_option == inner
            said = text[named.end() :] if named and exact else text
            located.append((option if exact and option != "--set" else f"{option}: {inner}", said))
        elif file is None:
            located.append((key, text))
        else:
            place = file.place(inner if inner in file.lines else key)
            located.append((": ".join(filter(None, (place, key))), text))
    return located


def _set_by(key: str, origins: Mapping[str, str]) -> str:
    """The option that set the key, or the nearest table around it, or something in it."""
    within = key
    while within and within not in origins:
        within = within.rpartition(".")[0]
    if not within and key:
        within = next((k for k in origins if k.startswith(f"{key}.")), "")
    return within
