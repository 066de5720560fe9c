"""Studies from files and from Python. What is wrong is said with its file, line and key."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from fleet.scenario.errors import BadInput, or_list, unknown
from fleet.scenario.loading import CHOICES, ENTRY, HEADER, merged, read_toml
from fleet.scenario.model import Scenario
from fleet.study.design import MOST_PROBLEMS, Study
from fleet.study.recording import TABLES

KEYS = ("title", "scenario", "axes", "paired", "cases", "seeds", "tables", "report")
REPORT_KEYS = ("x", "series", "baseline", "measures")
MOST_RUNS = 10_000_000

Problems = list[tuple[str, str]]


def load_study(path: Path) -> Study:
    """The study of a TOML file, every combination of it checked.

    Raises:
        BadInput: a file, key or value that cannot be used; all that is wrong is said.
    """
    data, _ = read_toml(path)
    lines = dict(_lines(path.read_text("utf-8")))
    try:
        return study_from(data)
    except BadInput as error:
        raise BadInput(
            (": ".join(filter(None, (_place(path, key, lines), key))), text)
            for key, text in error.problems
        ) from error


def study_from(data: Mapping[str, Any]) -> Study:
    """A study from tables as a file would have them, every combination of it checked.

    Raises:
        BadInput: a key or value that cannot be used; all that is wrong is said.
    """
    problems: Problems = [(key, unknown("key", key, KEYS)) for key in data if key not in KEYS]
    axes = _axes(data.get("axes", {}), "axes", problems)
    paired = [
        _block(block, f"paired[{n}]", problems)
        for n, block in enumerate(_tables(data, "paired", problems))
    ]
    cases = [
        dict(_settings(case, f"cases[{n}]", problems))
        for n, case in enumerate(_tables(data, "cases", problems))
    ]
    report = _table(data, "report", problems)
    problems += [
        (f"report.{key}", unknown("key", key, REPORT_KEYS))
        for key in report
        if key not in REPORT_KEYS
    ]
    study = Study(
        scenario=_base(data.get("scenario", {}), problems),
        axes=axes,
        paired=paired,
        cases=cases,
        seeds=_seeds(data.get("seeds", 1), problems),
        tables=_names(data.get("tables", []), problems),
        title=str(data.get("title", "")),
        report=report,
    )
    _no_key_twice(study, problems)
    _report(study, problems)
    if not problems and len(study) > MOST_RUNS:
        problems.append(("", f"the study has {len(study)} runs; expected {MOST_RUNS} at most"))
    if problems:
        raise BadInput(problems[:MOST_PROBLEMS])
    assert study.resolved  # or what is wrong with a cell has been raised
    return study


def _base(value: Any, problems: Problems) -> Mapping[str, Any]:
    """The scenario that is varied: a table, or the path of a scenario file."""
    if isinstance(value, str):
        try:
            return read_toml(Path(value))[0]
        except BadInput as error:
            problems += [("scenario", text) for _, text in error.problems]
            return {}
    if isinstance(value, Scenario):
        return value.as_dict()
    if not isinstance(value, Mapping):
        problems.append(
            ("scenario", f"is {value!r}; expected a table, or the path of a scenario file")
        )
        return {}
    if "seed" in value:
        problems.append(("scenario.seed", "the study has its own; set seeds instead"))
    base = value.get("file")
    if isinstance(base, str):
        rest = {key: item for key, item in value.items() if key != "file"}
        return merged(_base(base, problems), rest)
    return value


def _axes(value: Any, key: str, problems: Problems) -> dict[str, Sequence[Any]]:
    """Lists of values by dotted key; tables within are further dots."""
    if not isinstance(value, Mapping):
        problems.append((key, f"is {value!r}; expected a table of lists"))
        return {}
    axes: dict[str, Sequence[Any]] = {}
    for name, values in value.items():
        dotted = f"{key}.{name}"
        if isinstance(values, Mapping):
            axes |= {f"{name}.{inner}": v for inner, v in _axes(values, dotted, problems).items()}
        elif not isinstance(values, list | tuple):
            problems.append((dotted, f"is {values!r}; expected a list of values"))
        elif not values:
            problems.append((dotted, "has no values; expected one or more"))
        else:
            twice = next((v for n, v in enumerate(values) if v in values[:n]), None)
            if twice is not None and not key.startswith("paired"):
                problems.append((dotted, f"holds {twice!r} twice"))
            axes[name] = values
    return axes


def _block(value: Any, key: str, problems: Problems) -> dict[str, Sequence[Any]]:
    block = _axes(value, key, problems)
    lengths = {name: len(values) for name, values in block.items()}
    if len(set(lengths.values())) > 1:
        said = ", ".join(f"{name} has {count}" for name, count in lengths.items())
        problems.append((key, f"{said} values; expected the same number of each"))
        return {}
    if not block:
        problems.append((key, "has no keys; expected lists of values that go together"))
    return block


def _settings(value: Any, key: str, problems: Problems) -> Iterator[tuple[str, Any]]:
    """The dotted keys of a case; what is picked by name, and its parameters, stay together."""
    if not isinstance(value, Mapping) or not value:
        problems.append((key, f"is {value!r}; expected a table of scenario keys"))
        return
    for name, item in value.items():
        nameless = name in CHOICES and isinstance(item, Mapping) and "name" not in item
        if isinstance(item, Mapping) and item and (name not in CHOICES or nameless):
            for inner, leaf in _settings(item, f"{key}.{name}", problems):
                yield f"{name}.{inner}", leaf
        else:
            yield name, item


def _no_key_twice(study: Study, problems: Problems) -> None:
    """A key that stands in two places has no value that anybody could tell."""
    seen: dict[str, str] = {}
    places = [(key, f"axes.{key}") for key in study.axes]
    places += [(k, f"paired[{n}].{k}") for n, block in enumerate(study.paired) for k in block]
    places += [
        (key, f"cases[{n}].{key}")
        for n, case in enumerate(study.cases)
        for key in case
        if not any(key in other for other in study.cases[:n])
    ]
    for key, place in places:
        if key == "seed":
            problems.append((place, "seeds are not an axis; set seeds instead"))
        elif key in seen:
            problems.append((place, f"stands in {seen[key]} too; expected it in one of them"))
        seen[key] = place


def _report(study: Study, problems: Problems) -> None:
    """What the report is to show must be something that varies, or a list of measures."""
    for part in ("x", "series"):
        key = study.report.get(part)
        if key is not None and key not in {*study.varied, "case"}:
            problems.append((f"report.{part}", unknown("axis", str(key), [*study.varied, "case"])))
    asked = study.report.get("measures", [])
    if not isinstance(asked, list | tuple) or not all(isinstance(name, str) for name in asked):
        problems.append(("report.measures", f"is {asked!r}; expected a list of names"))


def _seeds(value: Any, problems: Problems) -> Sequence[int]:
    """A number of seeds, a list of them, or a table of ``first`` and ``count``."""
    if isinstance(value, Mapping) and value.keys() <= {"first", "count"}:
        first, count = value.get("first", 0), value.get("count", 1)
    else:
        first, count = 0, value
    if _whole(first) and _whole(count) and count > 0:
        return range(first, first + count)
    if isinstance(value, list | tuple | range) and value and all(map(_whole, value)):
        if len(set(value)) == len(value):
            return value
        problems.append(("seeds", f"is {value!r}; expected each seed once"))
    else:
        problems.append(
            ("seeds", f"is {value!r}; expected how many, a list, or a table of first and count")
        )
    return (0,)


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _names(value: Any, problems: Problems) -> tuple[str, ...]:
    if isinstance(value, list | tuple) and all(name in TABLES for name in value):
        return tuple(dict.fromkeys(value))
    problems.append(("tables", f"is {value!r}; expected a list of {or_list(TABLES)}"))
    return ()


def _table(data: Mapping[str, Any], key: str, problems: Problems) -> Mapping[str, Any]:
    value = data.get(key, {})
    if isinstance(value, Mapping):
        return value
    problems.append((key, f"is {value!r}; expected a table"))
    return {}


def _tables(data: Mapping[str, Any], key: str, problems: Problems) -> Sequence[Any]:
    value = data.get(key, [])
    if isinstance(value, list | tuple):
        return value
    problems.append((key, f"is {value!r}; expected a list of tables, each written [[{key}]]"))
    return []


def _lines(text: str) -> Iterator[tuple[str, int]]:
    """The line of each dotted key; the n-th table of a list as ``name[n]``. First ones last."""
    found: list[tuple[str, int]] = []
    counts: dict[str, int] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), 1):
        if header := HEADER.match(line):
            table = re.sub(r"[\"'\s]", "", header[1])
            if line.lstrip().startswith("[["):
                n = counts[table] = counts.get(table, -1) + 1
                table = f"{table}[{n}]"
            else:  # a table within the last one of a list
                head, _, rest = table.partition(".")
                table = f"{head}[{counts[head]}].{rest}" if head in counts else table
            found.append((table, number))
        elif entry := ENTRY.match(line):
            key = re.sub(r"[\"'\s]", "", entry[1])
            found.append((f"{table}.{key}" if table else key, number))
    yield from reversed(found)


def _place(path: Path, key: str, lines: Mapping[str, int]) -> str:
    """The file, and the line that sets the key, or the nearest table around it."""
    within = key
    while within and within not in lines:
        unnumbered = re.sub(r"\[\d+\]$", "", within)
        within = unnumbered if unnumbered != within else within.rpartition(".")[0]
    if not within and key:
        within = next((k for k in lines if k.startswith(f"{key}.")), "")
    return f"{path}:{lines[within]}" if within else f"{path}"
