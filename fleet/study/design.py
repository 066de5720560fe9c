"""What a study is made of: a scenario, what varies in it, and seeds."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

from fleet.scenario.choices import check
from fleet.scenario.errors import BadInput
from fleet.scenario.loading import merged, nested, scenario_from
from fleet.scenario.model import Scenario
from fleet.study.job import Job

MOST_PROBLEMS = 20  # said at once


class Setting(NamedTuple):
    """One scenario key with the value that a cell gives it, and where the study says so."""

    key: str  # dotted
    value: Any
    origin: str  # such as axes.range, or cases[2].range


class Cell(NamedTuple):
    """What runs of all seeds have in common."""

    name: str
    labels: dict[str, Any]  # a value for each key that the study varies
    scenario: dict[str, Any]  # in full, but for the seed


@dataclass(frozen=True)
class Study:
    """Every combination of the values of the axes, of the paired axes and of the cases.

    Each is run once with every seed, and one seed gives the same network and the same events
    to all of them: runs of one seed are pairs. Use :func:`fleet.study.study_file.load_study` or
    :func:`fleet.study.study_file.study_from`, which check all of it.
    """

    scenario: Mapping[str, Any] = field(default_factory=dict)  # keys as in a scenario file
    axes: Mapping[str, Sequence[Any]] = field(default_factory=dict)  # values by dotted key
    paired: Sequence[Mapping[str, Sequence[Any]]] = ()  # the i-th values go together
    cases: Sequence[Mapping[str, Any]] = ()  # dotted keys and values; "label" names a case
    seeds: Sequence[int] = (0,)
    tables: tuple[str, ...] = ()  # names in fleet.study.side_tables.TABLES
    title: str = ""
    report: Mapping[str, Any] = field(default_factory=dict)  # see fleet.study.report

    @property
    def varied(self) -> list[str]:
        """The scenario keys that the study varies, in order."""
        keys = [*self.axes, *(key for block in self.paired for key in block)]
        keys += [key for case in self.cases for key in case if key != "label"]
        return list(dict.fromkeys(keys))

    def cells(self) -> Iterator[list[Setting]]:
        """The combinations. Keys of a few dots come first: a name, then what it is given."""
        axes = [
            [[Setting(key, value, f"axes.{key}")] for value in values]
            for key, values in self.axes.items()
        ]
        blocks = [
            [
                [
                    Setting(key, value, f"paired[{n}].{key}")
                    for key, value in zip(block, row, strict=True)
                ]
                for row in zip(*block.values(), strict=True)
            ]
            for n, block in enumerate(self.paired)
        ]
        cases = [
            [Setting(key, value, f"cases[{n}].{key}") for key, value in case.items()]
            for n, case in enumerate(self.cases)
        ]
        for combination in product(*axes, *blocks, cases or [[]]):
            settings = [setting for group in combination for setting in group]
            yield sorted(settings, key=lambda setting: setting.key.count("."))

    def scenario_of(self, cell: Sequence[Setting]) -> Scenario:
        """The scenario of a cell, with the first of the seeds.

        Raises:
            BadInput: the cell's scenario cannot be used; its keys are those of the study.
        """
        tables: dict[str, Any] = dict(self.scenario)
        for setting in cell:
            if setting.key != "label":
                tables = merged(tables, nested(setting.key, setting.value))
        try:
            scenario = scenario_from(tables | {"seed": self.seeds[0]})
            check(scenario)
        except BadInput as error:
            raise BadInput(
                [(_origin(key, text, cell), text) for key, text in error.problems]
            ) from error
        return scenario

    def jobs(self) -> Iterator[Job]:
        """All runs: seed by seed, so that a study that is stopped has something of every cell.

        Raises:
            BadInput: a cell's scenario cannot be used. All that is wrong is said.
        """
        origins: dict[int, str] = {}  # of each cell: looked up on the disk once
        for seed in self.seeds:
            for number, cell in enumerate(self.resolved):
                job = Job.of(
                    cell.scenario | {"seed": seed},
                    cell=cell.name,
                    labels=cell.labels | {"seed": seed},
                    tables=self.tables,
                    origin=origins.get(number),
                )
                origins[number] = job.origin
                yield job

    @cached_property
    def resolved(self) -> list[Cell]:
        """The cells with their scenarios in full, every one of them checked.

        Raises:
            BadInput: a cell's scenario cannot be used. All that is wrong is said.
        """
        found = []
        problems: dict[tuple[str, str], None] = {}
        varied = self.varied
        columns = {key: column(key) for key in varied}
        for cell in self.cells():
            try:
                scenario = self.scenario_of(cell).as_dict()
            except BadInput as error:
                problems |= dict.fromkeys(error.problems)
                if len(problems) >= MOST_PROBLEMS:
                    break
                continue
            given = {setting.key: setting.value for setting in cell}
            labels = {
                columns[key]: label(given[key] if key in given else look_up(scenario, key))
                for key in varied
            }
            if "label" in given:
                labels = {"case": given["label"], **labels}
            found.append((labels, scenario))
        if problems:
            raise BadInput(problems)
        return [Cell(describe(labels), labels, scenario) for labels, scenario in _uniform(found)]

    def __len__(self) -> int:
        """How many runs there are to be."""
        count = len(self.seeds) * max(1, len(self.cases))
        for values in self.axes.values():
            count *= len(values)
        for block in self.paired:
            count *= len(next(iter(block.values())))
        return count


def _uniform(
    cells: list[tuple[dict[str, Any], dict[str, Any]]],
) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Labels of one kind a column: where numbers and text meet, all of it is text."""
    kinds: dict[str, set[type]] = {}
    for labels, _ in cells:
        for name, value in labels.items():
            kinds.setdefault(name, set()).add(float if type(value) is int else type(value))
    mixed = {name for name, found in kinds.items() if len(found - {type(None)}) > 1}
    return [
        ({n: str(v) if n in mixed else v for n, v in labels.items()}, scenario)
        for labels, scenario in cells
    ]


def column(key: str) -> str:
    """The name of a scenario key's column in the tables; there ``events`` counts them."""
    if key == "events":
        return "event_process"
    return key.replace(".", "_").replace("-", "_")


def label(value: Any) -> Any:
    """A value of an axis as a cell of a table: numbers and text as they are, others as text."""
    if isinstance(value, Mapping):
        named = [str(value["name"])] if "name" in value else []
        return " ".join(named + [f"{k}={label(v)}" for k, v in value.items() if k != "name"])
    if isinstance(value, list | tuple):
        return json.dumps(value)
    return value


def describe(labels: Mapping[str, Any]) -> str:
    """A cell in words: ``protocol=rfta2 range=2.5``."""
    return " ".join(f"{key}={value}" for key, value in labels.items() if value is not None)


def look_up(scenario: Mapping[str, Any], key: str) -> Any:
    """The value of a dotted key in a scenario; None: it has none."""
    head, _, rest = key.partition(".")
    value = scenario.get(head)
    if not rest:
        return value
    return look_up(value, rest) if isinstance(value, Mapping) else None


def _origin(key: str, text: str, cell: Sequence[Setting]) -> str:
    """Where the study gives a scenario key its value."""
    if not key:  # a range is checked for the whole table; its sentence names the key
        key = text.split(" ", 1)[0]
    for setting in cell[::-1]:
        if key == setting.key or key.startswith((f"{setting.key}.", f"{setting.key}[")):
            return setting.origin + key[len(setting.key) :]
        if setting.key.startswith(f"{key}."):
            return setting.origin
    return f"scenario.{key}"
