"""Giving functions their parameters from tables: protocols, metrics, worlds and motions."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import is_dataclass
from datetime import date, time
from functools import cache, partial
from math import inf, isnan
from types import MappingProxyType, NoneType
from typing import Any, TypeVar, get_args, get_origin

from pydantic import PydanticUserError, TypeAdapter, ValidationError

from fleet.catalogue import look_up
from fleet.scenario.delimited import numbers
from fleet.scenario.errors import BadInput, bad, or_list, sentence, shown, unknown
from fleet.scenario.maps import occupancy_grid
from fleet.scenario.model import Scenario
from fleet.scenario.plugins import held, home_of, load_object, looks_like_file
from protocols.metrics import Metric
from protocols.routing import Search
from worlds.occupancy import OccupancyGrid
from worlds.shapes import EventTable, LinkTable, PlaceTable

T = TypeVar("T")
WELL_KNOWN = {"search": Search, "metric": Metric}  # the parameters that all protocols share
MOST = 1e12  # of any number: nothing of a fleet is larger, and its square is still a number


def bind(
    function: Callable[..., T],
    table: Mapping[str, Any],
    key: str,
    others: Mapping[str, Callable[..., Any]] = MappingProxyType({}),
) -> partial[T]:
    """``function`` with the keyword parameters of ``table``, checked against its annotations.

    ``others`` could stand in its place, by name: a key that is none here may be one of theirs.

    Raises:
        BadInput: an unknown parameter, or a value of another type; ``key`` is where the table
            stands in the scenario.
    """
    accepted = keywords(function)
    problems, values = [], {}
    for name, value in table.items():
        if name not in accepted:
            problems.append((f"{key}.{name}", _no_parameter(name, function, others)))
            continue
        try:
            values[name] = convert(accepted[name], value, f"{key}.{name}")
        except BadInput as error:
            problems.extend(error.problems)
    problems.extend(
        (f"{key}.{name}", "is missing; it is required") for name in required(function) - set(table)
    )
    if problems:
        raise BadInput(problems)
    return partial(function, **values)


@cache
def keywords(function: Callable[..., Any]) -> dict[str, Any]:
    """The parameters that a table may set, with their types.

    One whose type is not given takes what a file can hold; ``search`` and ``metric`` are ours.
    """
    parameters = inspect.signature(function, eval_str=True).parameters.values()
    return {
        p.name: WELL_KNOWN.get(p.name, Any) if p.annotation is p.empty else p.annotation
        for p in parameters
        if p.kind is p.KEYWORD_ONLY
    }


@cache
def required(function: Callable[..., Any]) -> set[str]:
    """The keyword parameters that have no default."""
    parameters = inspect.signature(function).parameters.values()
    return {p.name for p in parameters if p.kind is p.KEYWORD_ONLY and p.default is p.empty}


def convert(kind: Any, value: Any, key: str) -> Any:
    """``value``, as read from TOML, as a value of type ``kind``.

    Raises:
        BadInput: it is not one.
    """
    if kind == Metric:
        return metric(value, key)
    if (columns := columns_of(kind)) is not None:
        return numbers(value, columns, key)
    if kind is OccupancyGrid:
        return occupancy_grid(value, key)
    problems = [*unusable(value, key), *_unknown_keys(kind, value, key)]
    if not problems:
        try:
            return adapter(kind).validate_json(json.dumps(value), strict=True)
        except PydanticUserError as error:  # a type of the user's
            named = shown(getattr(kind, "__name__", kind))
            raise bad(key, f"is to be of type {named}, which no file can hold") from error
        except ValidationError as error:
            problems = [
                (
                    _dotted(key, e["loc"]),
                    sentence(e["type"], e["input"], e.get("ctx", {}), e["msg"]),
                )
                for e in error.errors(include_url=False)
            ]
    raise BadInput(problems)


@cache
def columns_of(kind: Any) -> tuple[str, ...] | None:
    """The columns of a table of numbers, or of one that may be left out; None: it is none."""
    for table in (PlaceTable, EventTable, LinkTable):
        if kind == table or kind == table | None:
            columns: tuple[str, ...] = get_args(table)[1]
            return columns
    return None


@cache
def adapter(kind: Any) -> TypeAdapter[Any]:
    """The checker of a type; making one takes a thousand times as long as using it."""
    return TypeAdapter(kind)


@cache
def field_types(kind: Callable[..., Any]) -> dict[str, Any]:
    """The parameters of a function, or the fields of a dataclass, with their types."""
    parameters = inspect.signature(kind, eval_str=True).parameters.values()
    return {p.name: p.annotation for p in parameters}


def metric(value: Any, key: str) -> Metric:
    """A bid metric from its name, ``file.py:name``, or a table of a name and parameters."""
    table = {"name": value} if isinstance(value, str) else value
    table = dict(table) if isinstance(table, Mapping) else {}
    name = table.pop("name", None)
    if not isinstance(name, str):
        raise bad(key, f"is {shown(value)}; expected the name of a metric, or a table with one")
    if looks_like_file(name):
        function: Any = load_object(name, key)
    else:
        function = look_up("metric", name, key).function
    if inspect.isclass(function):
        made: Metric = made_by(function, name, table, key)
        return made
    if table:
        raise bad(f"{key}.{next(iter(table))}", f"the metric {name!r} has no parameters")
    found: Metric = function
    return found


def build(
    function: Callable[..., T],
    table: Mapping[str, Any],
    key: str,
    others: Mapping[str, Callable[..., Any]] = MappingProxyType({}),
) -> T:
    """Call ``function`` with the table; what it refuses is bad input.

    Raises:
        BadInput: from binding, or in place of the ValueError that the function raised.
    """
    make = bind(function, table, key, others)
    try:
        return make()
    except ValueError as error:
        raise bad(key, str(error)) from error


def made_by(
    kind: type,
    called: str,
    table: Mapping[str, Any],
    key: str,
    others: Mapping[str, Callable[..., Any]] = MappingProxyType({}),
) -> Any:
    """What calling a class with the table makes: a protocol or a metric, the user's or ours.

    Raises:
        BadInput: from :func:`build`; or a class of the user's fails, or makes what nobody can call.
    """
    folder = home_of(called)
    with nullcontext() if folder is None else held(called, folder, key):
        made = build(kind, table, key, others)
    if not callable(made):
        said = f"{shown(called)} makes what cannot be called; expected a class with __call__"
        raise bad(key, said)
    return made


def unusable(value: Any, key: str) -> Iterator[tuple[str, str]]:
    """Values that no key takes, however deep in tables and lists: TOML has dates, and numbers of
    any size.
    """
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from unusable(item, f"{key}.{name}" if key else name)
    elif isinstance(value, list | tuple):
        for k, item in enumerate(value):
            yield from unusable(item, f"{key}[{k}]")
    elif isinstance(value, date | time):
        yield key, f"is {value}, a date or time; expected a number, text, a list or a table"
    elif isinstance(value, int | float):
        if isinstance(value, float) and isnan(value):
            yield key, "is nan; expected a number"
        elif MOST < abs(value) < inf and not (isinstance(value, int) and key == "seed"):
            yield key, f"is {shown(value)}; expected at most {MOST:g}"
    elif not isinstance(value, str | NoneType):
        yield key, f"is {shown(value)}; expected a number, text, a list or a table"


def _no_parameter(
    name: str, function: Callable[..., Any], others: Mapping[str, Callable[..., Any]]
) -> str:
    accepted = keywords(function)
    owners = [other for other, its in others.items() if name in keywords(its)]
    if owners:
        here = next((repr(other) for other, its in others.items() if its is function), "this")
        return f"does nothing in {here}; it belongs to name = {or_list(owners[:3])}"
    if name in Scenario.__dataclass_fields__:
        return f"is no key of this table, but of the scenario; set {name} above the first [table]"
    if not accepted:
        return f"unknown key {shown(name)}; there are no parameters here"
    return unknown("key", name, accepted)


def _unknown_keys(kind: Any, value: Any, key: str) -> list[tuple[str, str]]:
    """Keys of nested tables, and of tables in lists, that their dataclass does not have."""
    inner = [part for part in get_args(kind) if part is not type(None)]
    if get_origin(kind) is tuple and isinstance(value, list):
        listed = enumerate(value)
        return [p for k, item in listed for p in _unknown_keys(inner[0], item, f"{key}[{k}]")]
    if len(inner) == 1:  # something, or None
        return _unknown_keys(inner[0], value, key)
    if not (is_dataclass(kind) and isinstance(kind, type) and isinstance(value, Mapping)):
        return []
    fields = field_types(kind)
    problems = []
    for name, item in value.items():
        dotted = f"{key}.{name}" if key else name
        if name in fields:
            problems.extend(_unknown_keys(fields[name], item, dotted))
        else:
            problems.append((dotted, _no_key(name, key, fields)))
    return problems


def _no_key(name: str, table: str, fields: Mapping[str, Any]) -> str:
    if table and name in Scenario.__dataclass_fields__:
        return f"is no key of [{table}], but of the scenario; set {name} above the first [table]"
    return unknown("key", name, fields)


def _dotted(key: str, loc: tuple[int | str, ...]) -> str:
    parts = [key] if key else []
    for part in loc:
        if isinstance(part, int):
            parts[-1:] = [f"{parts[-1]}[{part}]" if parts else f"[{part}]"]
        else:
            parts.append(part)
    return ".".join(parts)
