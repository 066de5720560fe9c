"""Which axis of a study is drawn along x, which by colour, and which by figures of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fleet.scenario.errors import bad, unknown
from fleet.study.frame import is_numeric
from fleet.study.report.runs import Runs

MOST_COLOURS = 8


@dataclass(frozen=True, slots=True)
class Layout:
    """The parts that the axes of a study play in its report."""

    x: str | None  # along the abscissa; a column of numbers
    series: str | None  # by colour
    facets: tuple[str, ...]  # a figure for each combination
    baseline: Any  # of the series: what the others are compared with
    order: tuple[Any, ...]  # the values of the series


def layout(runs: Runs, asked: Mapping[str, Any]) -> Layout:
    """The parts that the study's ``[report]`` gives its axes, or that suit them.

    Raises:
        BadInput: a name that is asked for is no axis of the study, or no value of one.
    """
    x = _axis(runs, asked, "x")
    series = _axis(runs, asked, "series")
    if x is not None and not is_numeric(runs[x]):
        raise bad("report.x", f"is {x!r}, whose values are names; expected an axis of numbers")
    free = [axis for axis in runs.axes if axis not in {x, series}]
    if x is None:
        numbers = [a for a in free if is_numeric(runs[a]) and len(runs.values(a)) > 2]
        x = max(numbers, key=lambda a: len(runs.values(a)), default=None)
    if series is None:
        names = [a for a in free if a != x and len(runs.values(a)) <= MOST_COLOURS]
        series = next((a for a in names if not is_numeric(runs[a])), next(iter(names), None))
    facets = tuple(axis for axis in runs.axes if axis not in {x, series})
    order = tuple(runs.values(series)) if series is not None else (None,)
    return Layout(x, series, facets, _baseline(order, asked), order)


def _axis(runs: Runs, asked: Mapping[str, Any], part: str) -> str | None:
    name = asked.get(part)
    if name is None:
        return None
    column = str(name).replace(".", "_").replace("-", "_")
    if column not in runs.axes:
        raise bad(f"report.{part}", unknown("axis", str(name), runs.axes or ("protocol",)))
    return column


def _baseline(order: tuple[Any, ...], asked: Mapping[str, Any]) -> Any:
    baseline = asked.get("baseline", order[0])
    if baseline not in order:
        raise bad("report.baseline", unknown("value", str(baseline), map(str, order)))
    return baseline
