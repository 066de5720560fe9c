"""Under which conditions the runs of a study were made: every setting that is not the default."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from fleet.scenario.model import Scenario
from fleet.study.report.runs import Runs

MOST = 80  # letters of a value


def conditions(runs: Runs) -> list[tuple[str, str]]:
    """The settings that all runs have in common and that are not the default: key and value.

    Nothing is loaded or run: a file that a setting names is a name here.
    """
    if "scenario" not in runs.columns or "lifetime" not in runs.columns:
        return []
    of_cells = dict(zip(runs["cell"].tolist(), runs["scenario"].tolist(), strict=True))
    settings = [dict(_flat(json.loads(text))) for text in of_cells.values()]
    default = dict(_flat(Scenario().as_dict()))
    first = settings[0]
    return [
        (key, _text(value))
        for key, value in first.items()
        if key != "seed"
        and value != default.get(key)
        and all(key in other and other[key] == value for other in settings)
    ]


def _flat(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys; what a table is called stands for the table: ``radio`` and ``radio.loss``."""
    for key, value in table.items():
        dotted = f"{prefix}{key}"
        if isinstance(value, Mapping):
            if "name" in value:
                yield dotted, value["name"]
            rest = {name: item for name, item in value.items() if name != "name"}
            yield from _flat(rest, f"{dotted}.")
        else:
            yield dotted, value


def _text(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= MOST else f"{text[: MOST - 1]}…"
