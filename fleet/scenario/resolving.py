"""A scenario with all that it leaves out, as a file that gives the same run."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from fleet.scenario.choices import functions_of
from fleet.scenario.model import Choice, Scenario, plain
from fleet.scenario.paths import anchored
from protocols.catalogue import METRICS


def resolved(scenario: Scenario) -> dict[str, Any]:
    """The scenario's tables with every default written out, and all paths absolute.

    Keys that have no value (no sensors, as many robots as the world has) are left out.
    """
    tables: dict[str, Any] = plain(scenario)
    for key, function in functions_of(scenario).items():
        choice: Choice = getattr(scenario, key)
        tables[key] = {"name": choice.name, **_filled(function, choice.parameters)}
    search = tables["protocol"].get("search")
    if isinstance(search, dict):
        search.pop("radius", None)  # it is the scenario's
    tables["protocol"].pop("search_radius", None)
    whole: dict[str, Any] = _without_nothing(anchored(tables, Path.cwd()))
    return whole


def as_toml(scenario: Scenario) -> str:
    """The resolved scenario as the text of a file."""
    import tomli_w

    return tomli_w.dumps(resolved(scenario))


def _filled(function: Callable[..., Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters of ``function``: those given, tables completed, and the defaults of others."""
    found: dict[str, Any] = {}
    for parameter in inspect.signature(function, eval_str=True).parameters.values():
        if parameter.kind is not parameter.KEYWORD_ONLY:
            continue
        default = written(parameter.default)
        value = given.get(parameter.name, default)
        if isinstance(value, Mapping) and isinstance(default, Mapping):
            value = {**default, **value}
        if value is not parameter.empty:
            found[parameter.name] = value
    return found


def written(default: Any) -> Any:
    """A default as a file has it: a metric by its name, values as tables."""
    for name, entry in METRICS.items():
        if default is entry.function:
            return name
        if inspect.isclass(entry.function) and isinstance(default, entry.function):
            return {"name": name, **plain(default)}
    return plain(default)


def _without_nothing(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_nothing(item) for key, item in value.items() if item is not None}
    if isinstance(value, list):
        return [_without_nothing(item) for item in value]
    return value
