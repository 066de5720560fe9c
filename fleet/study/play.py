"""The work of a study's task: play one scenario, and give its summary as a row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fleet.study.task import Task


def play(task: Task) -> dict[str, Any]:
    """The summary of one run, and the tables that the task asks for."""
    from fleet.assembly import run
    from fleet.scenario.loading import scenario_from
    from fleet.study.recording import TABLES

    watchers = {name: TABLES[name]() for name in task.tables}
    row = run(scenario_from(task.scenario), list(watchers.values())).as_dict()
    return row | {"tables": {name: watcher.rows for name, watcher in watchers.items()}}
