"""Scenarios from files and options. What is wrong is said with its file, line and key."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from fleet.robot import PRESETS, RobotSpec
from fleet.scenario.binding import convert
from fleet.scenario.choices import check
from fleet.scenario.errors import BadInput, bad, unknown
from fleet.scenario.model import Choice, Scenario, plain

CHOICES = ("protocol", "world", "motion", "time", "events", "radio")
NAMED_BY = dict.fromkeys(CHOICES, "name") | {"robot": "preset"}


def load_scenario(
    path: Path | None, options: Mapping[str, Any] | None = None, settings: Sequence[str] = ()
) -> Scenario:
    """The scenario of a TOML file, with ``options`` and then ``key=value`` settings over it.

    Raises:
        BadInput: a file, key or value that cannot be used.
    """
    data, lines = ({}, {}) if path is None else read_toml(path)
    origins = {key: f"{path}:{line}" for key, line in lines.items()}
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
        raise BadInput(_located(error, origins)) from error
    return scenario


def scenario_from(data: Mapping[str, Any]) -> Scenario:
    """A scenario from tables as a file would have them.

    Raises:
        BadInput: an unknown key, a value of another type or out of its range.
    """
    tables = dict(data)
    for key in CHOICES:
        if key in tables:
            tables[key] = _choice(tables[key], key)
    if "robot" in tables:
        tables["robot"] = _robot(tables["robot"])
    scenario: Scenario = convert(Scenario, tables, "")
    return scenario


def read_toml(path: Path) -> tuple[dict[str, Any], dict[str, int]]:
    """The tables of a TOML file, and the line that each dotted key stands in.

    Raises:
        BadInput: no such file, or not TOML.
    """
    try:
        text = path.read_text("utf-8")
        return tomllib.loads(text), _key_lines(text)
    except FileNotFoundError:
        near = get_close_matches(path.name, [p.name for p in path.parent.glob("*.toml")], 1, 0.6)
        hint = f"; did you mean {str(path.parent / near[0])!r}?" if near else ""
        raise bad("", f"{path}: no such file{hint}") from None
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise bad("", f"{path}: cannot be read: {reason}") from error
    except tomllib.TOMLDecodeError as error:
        raise bad("", _not_toml(path, str(error))) from error


def parse_setting(setting: str) -> tuple[str, Any]:
    """``key=value``: the value as in TOML, or, if it is none, as plain text.

    Raises:
        BadInput: there is no ``=``, or no key.
    """
    key, equals, text = setting.partition("=")
    key = key.strip()
    if not equals or not re.fullmatch(r"[A-Za-z0-9_]+(\.[A-Za-z0-9_]+)*", key):
        raise bad("--set", f"is {setting!r}; expected key=value, such as robot.radius=0.2")
    try:
        return key, tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return key, text.strip()


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
        return {"name": value, "parameters": {}}
    if isinstance(value, Choice):
        return {"name": value.name, "parameters": value.parameters}
    if not isinstance(value, Mapping):
        raise bad(key, f"is {value!r}; expected a name, or a table with one")
    parameters = dict(value)
    name = parameters.pop("name", None) or getattr(Scenario(), key).name
    return {"name": name, "parameters": parameters}


def _robot(value: Any) -> dict[str, Any]:
    """A preset, or a table of what differs from one, as the fields of a RobotSpec."""
    if not isinstance(value, str | Mapping | RobotSpec):
        raise bad("robot", f"is {value!r}; expected the name of a preset, or a table")
    table = {"preset": value} if isinstance(value, str) else plain(value)
    preset = table.pop("preset", "small")
    if preset not in PRESETS:
        raise bad("robot.preset", unknown("preset", str(preset), PRESETS))
    return merged(plain(PRESETS[preset]), table)


def _located(error: BadInput, origins: Mapping[str, str]) -> list[tuple[str, str]]:
    """The problems with where their key was set: a line of the file, or an option."""
    located = []
    for key, text in error.problems:
        set_by = key
        while set_by and set_by not in origins:
            set_by = set_by.rpartition(".")[0]
        if not set_by and key:  # something in a table that was set from below
            set_by = next((k for k in origins if k.startswith(f"{key}.")), "")
        if not set_by:  # a range is checked for the whole table; its sentence names the key
            named = re.match(r"(?:\w+ )?(\w+) is ", text)
            inner = ".".join(filter(None, (key, named[1] if named else "")))
            set_by = inner if inner in origins else ""
        located.append((": ".join(filter(None, (origins.get(set_by, ""), key))), text))
    return located


HEADER = re.compile(r"^\s*\[\[?\s*([^\]]+?)\s*\]\]?")
ENTRY = re.compile(r"^\s*([\w.\"'-]+?)\s*=")


def _key_lines(text: str) -> dict[str, int]:
    """The first line that each dotted key of a TOML text stands in; inline tables as one."""
    lines: dict[str, int] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), 1):
        if header := HEADER.match(line):
            table = re.sub(r"[\"'\s]", "", header[1])
            lines.setdefault(table, number)
        elif entry := ENTRY.match(line):
            key = re.sub(r"[\"'\s]", "", entry[1])
            lines.setdefault(f"{table}.{key}" if table else key, number)
    return lines


def _not_toml(path: Path, message: str) -> str:
    where = re.search(r"\(at line (\d+), column (\d+)\)", message)
    what = message[: where.start()].strip() if where else message
    place = f"{path}:{where[1]}:{where[2]}" if where else f"{path}"
    return f"{place}: not TOML: {what[0].lower()}{what[1:]}"
