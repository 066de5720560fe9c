"""Studies from files and from Python. What is wrong is said with its file, line and key."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import prod
from pathlib import Path
from typing import Any

from fleet.scenario.errors import BadInput, bad, or_list, shown, unknown
from fleet.scenario.loading import CHOICES, merged
from fleet.scenario.model import Scenario
from fleet.scenario.paths import anchored
from fleet.scenario.toml import read_toml
from fleet.study.design import MOST_PROBLEMS, Study
from fleet.study.side_tables import TABLES

KEYS = ("title", "scenario", "axes", "paired", "cases", "seeds", "tables", "report")
REPORT_KEYS = ("x", "series", "baseline", "measures")
MOST_RUNS = 10_000_000
MOST_CELLS = 20_000  # combinations, each of which is checked before the first run
MOST_SEED = 2**63 - 1

Problems = list[tuple[str, str]]


def load_study(path: Path) -> Study:
    """The study of a TOML file, every combination of it checked.

    Raises:
        BadInput: a file, key or value that cannot be used; all that is wrong is said.
    """
    document = read_toml(path)
    try:
        return study_from(_anchored(document.data, path.parent))
    except BadInput as error:
        raise document.located(error) from error


def _anchored(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """A study's tables; the paths in them are relative to its file, and now to where we are."""
    placed = {key: anchored(value, folder) for key, value in data.items()}
    base = placed.get("scenario")
    if isinstance(base, str):
        placed["scenario"] = str(folder / base)
    elif isinstance(base, Mapping) and isinstance(base.get("file"), str):
        placed["scenario"] = {**base, "file": str(folder / base["file"])}
    return placed


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
        title=_title(data.get("title", ""), problems),
        report=report,
    )
    _no_key_twice(study, problems)
    _report(study, problems)
    if not problems:
        _not_too_many(study, problems)
    if problems:
        raise BadInput(problems[:MOST_PROBLEMS])
    _hold_report(study)
    return study


def _hold_report(study: Study) -> None:
    """See that the report will find what it is asked for, before anything runs.

    Raises:
        BadInput: it would not; or something is wrong with a cell.
    """
    cells = study.resolved
    if not study.report:
        return
    from fleet.study.report.derived import is_measurable, measurable
    from fleet.study.report.layout import layout
    from fleet.study.report.runs import runs_of_rows

    layout(runs_of_rows([cell.labels for cell in cells]), study.report)
    for name in study.report.get("measures", ()):
        if not is_measurable(name):
            raise bad("report.measures", unknown("measure", name, measurable()))


def _title(value: Any, problems: Problems) -> str:
    if isinstance(value, str):
        return value
    problems.append(("title", f"is {shown(value)}; expected text in quotes"))
    return ""


def _not_too_many(study: Study, problems: Problems) -> None:
    """More combinations than these, or more runs, are a slip of the pen."""
    blocks = [next(iter(block.values())) for block in study.paired]
    lengths = [len(values) for values in (*study.axes.values(), *blocks)]
    cells = prod(lengths) * max(1, len(study.cases))
    if cells > MOST_CELLS:
        problems.append(("", f"the study has {cells:.4g} cells; expected {MOST_CELLS} at most"))
    elif cells * len(study.seeds) > MOST_RUNS:
        runs = cells * len(study.seeds)
        problems.append(("seeds", f"make {runs:.4g} runs; expected {MOST_RUNS} at most"))


def _base(value: Any, problems: Problems) -> Mapping[str, Any]:
    """The scenario that is varied: a table, or the path of a scenario file."""
    if isinstance(value, str):
        try:
            document = read_toml(Path(value))
        except BadInput as error:
            problems += [("scenario", text) for _, text in error.problems]
            return {}
        base: Mapping[str, Any] = anchored(document.data, document.path.parent)
        return base
    if isinstance(value, Scenario):
        return value.as_dict()
    if not isinstance(value, Mapping):
        problems.append(
            ("scenario", f"is {shown(value)}; expected a table, or the path of a scenario file")
        )
        return {}
    if "seed" in value:
        problems.append(("scenario.seed", "the study has its own; set seeds instead"))
    file = value.get("file")
    if isinstance(file, str):
        rest = {key: item for key, item in value.items() if key != "file"}
        return merged(_base(file, problems), rest)
    return value


def _axes(value: Any, key: str, problems: Problems) -> dict[str, Sequence[Any]]:
    """Lists of values by dotted key; tables within are further dots."""
    if not isinstance(value, Mapping):
        problems.append((key, f"is {shown(value)}; expected a table of lists"))
        return {}
    axes: dict[str, Sequence[Any]] = {}
    for name, values in value.items():
        dotted = f"{key}.{name}"
        if isinstance(values, Mapping):
            axes |= {f"{name}.{inner}": v for inner, v in _axes(values, dotted, problems).items()}
        elif not isinstance(values, list | tuple):
            problems.append((dotted, f"is {shown(values)}; expected a list of values"))
        elif not values:
            problems.append((dotted, "has no values; expected one or more"))
        else:
            counts = Counter(map(repr, values))
            twice = next((v for v in values if counts[repr(v)] > 1), None)
            if twice is not None and not key.startswith("paired"):
                problems.append((dotted, f"holds {shown(twice)} twice"))
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
        problems.append((key, f"is {shown(value)}; expected a table of scenario keys"))
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
        if key is not None and key not in [*study.varied, "case"]:
            problems.append((f"report.{part}", unknown("axis", str(key), [*study.varied, "case"])))
    asked = study.report.get("measures", [])
    if not isinstance(asked, list | tuple) or not all(isinstance(name, str) for name in asked):
        problems.append(("report.measures", f"is {shown(asked)}; expected a list of names"))


def _seeds(value: Any, problems: Problems) -> Sequence[int]:
    """A number of seeds, a list of them, or a table of ``first`` and ``count``."""
    if isinstance(value, Mapping) and value.keys() <= {"first", "count"}:
        first, count = value.get("first", 0), value.get("count", 1)
    else:
        first, count = 0, value
    if _whole(first) and _whole(count) and count > 0:
        if count <= MOST_RUNS:
            return range(first, first + count)
        problems.append(("seeds", f"is {shown(value)}; expected {MOST_RUNS} at most"))
        return (0,)
    if isinstance(value, list | tuple | range) and value and all(map(_whole, value)):
        if len(set(value)) == len(value):
            return value
        problems.append(("seeds", f"is {shown(value)}; expected each seed once"))
    else:
        problems.append(
            (
                "seeds",
                f"is {shown(value)}; expected how many, a list, or a table of first and count",
            )
        )
    return (0,)


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < MOST_SEED


def _names(value: Any, problems: Problems) -> tuple[str, ...]:
    if isinstance(value, list | tuple) and all(
        isinstance(name, str) and name in TABLES for name in value
    ):
        return tuple(dict.fromkeys(value))
    problems.append(("tables", f"is {shown(value)}; expected a list of {or_list(TABLES)}"))
    return ()


def _table(data: Mapping[str, Any], key: str, problems: Problems) -> Mapping[str, Any]:
    value = data.get(key, {})
    if isinstance(value, Mapping):
        return value
    problems.append((key, f"is {shown(value)}; expected a table"))
    return {}


def _tables(data: Mapping[str, Any], key: str, problems: Problems) -> Sequence[Any]:
    value = data.get(key, [])
    if isinstance(value, list | tuple):
        return value
    problems.append((key, f"is {shown(value)}; expected a list of tables, each written [[{key}]]"))
    return []
