"""The JSON Schema of scenario files, made from the models and the catalogues.

Editors that know TOML complete and check a file with it. What a schema cannot say (that a file is
there, that robots fit on the floor) is said when the scenario is read.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from inspect import signature
from math import isfinite
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

from fleet.catalogue import takers
from fleet.robot import PRESETS, RobotSpec
from fleet.scenario.binding import adapter, columns_of, field_types, keywords, required
from fleet.scenario.model import Choice, Scenario
from fleet.scenario.resolving import written
from protocols.metrics import Metric
from worlds.occupancy import OccupancyGrid

Schema = dict[str, Any]

DIALECT = "https://json-schema.org/draft/2020-12/schema"
OWN = {"type": "string", "pattern": r"\.py:\w+$", "description": "file.py:name, of your own"}


def scenario_schema() -> Schema:
    """The schema of a scenario file."""
    keys = {
        name: choice_schema(takers(name), own=name == "protocol")
        if kind is Choice
        else {**type_schema(kind), **_default(written(getattr(Scenario(), name)))}
        for name, kind in field_types(Scenario).items()
    }
    robot = type_schema(RobotSpec)
    robot["properties"]["preset"] = {"enum": sorted(PRESETS)}
    keys["robot"] = {"anyOf": [{"enum": sorted(PRESETS)}, robot]}
    return {"$schema": DIALECT, "title": "A scenario of talking-fleet", **table_schema(keys)}


def choice_schema(functions: Mapping[str, Callable[..., Any]], *, own: bool = False) -> Schema:
    """A name alone, or a table of a name and its parameters; which these are depends on it."""
    tables = [
        table_schema(
            {"name": {"const": name}, **parameters(function)}, ["name", *sorted(required(function))]
        )
        for name, function in sorted(functions.items())
    ]
    nameless = table_schema({n: s for f in functions.values() for n, s in parameters(f).items()})
    kinds: list[Schema] = [{"enum": sorted(functions)}, *tables, nameless]
    if own:
        kinds += [OWN, {"type": "object", "properties": {"name": OWN}, "required": ["name"]}]
    return {"anyOf": kinds}


def type_schema(kind: Any) -> Schema:
    """The schema of a value of that type, as a file has it."""
    if kind == Metric:
        return choice_schema(takers("metric"), own=True)
    if kind is OccupancyGrid:
        return {"type": "string", "description": "the file of a map"}
    if (columns := columns_of(kind)) is not None:
        said = f"a CSV file of {', '.join(columns)}, or rows of numbers"
        return {"type": ["string", "array"], "description": said}
    inner = [part for part in get_args(kind) if part is not NoneType]
    if get_origin(kind) in (Union, UnionType) and len(inner) == 1:
        return type_schema(inner[0])
    return _plain_schema(kind, inner)


def _plain_schema(kind: Any, inner: list[Any]) -> Schema:
    if get_origin(kind) is tuple and inner[1:] == [...]:
        return {"type": "array", "items": type_schema(inner[0])}
    if is_dataclass(kind) and isinstance(kind, type):
        needed = [f.name for f in fields(kind) if f.default is f.default_factory is MISSING]
        return table_schema({n: type_schema(k) for n, k in field_types(kind).items()}, needed)
    found: Schema = adapter(kind).json_schema()
    return found


def table_schema(keys: Mapping[str, Schema], required: list[str] | None = None) -> Schema:
    """A table of these keys and no others."""
    needed = {"required": required} if required else {}
    return {"type": "object", "properties": dict(keys), **needed, "additionalProperties": False}


def parameters(function: Callable[..., Any]) -> dict[str, Schema]:
    """The parameters that a table may set; the search radius is the scenario's."""
    defaults = signature(function).parameters
    found = {
        name: {**type_schema(kind), **_default(written(defaults[name].default))}
        for name, kind in keywords(function).items()
        if name != "search_radius"
    }
    if "search" in found:
        found["search"]["properties"].pop("radius", None)
        found["search"].pop("default", None)
    return found


def _default(value: Any) -> Schema:
    """The default, if a file could hold it, and JSON as well."""
    plain = isinstance(value, str | bool | int) or (isinstance(value, float) and isfinite(value))
    return {"default": value} if plain else {}
