"""The work of a study's job: play one scenario, and give its summary as a row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fleet.study.job import Job


def play(job: Job) -> dict[str, Any]:
    """The summary of one run, and the tables that the job asks for."""
    from fleet.assembly import run
    from fleet.scenario.loading import scenario_from
    from fleet.study.side_tables import TABLES

    watchers = {name: TABLES[name]() for name in job.tables}
    row = run(scenario_from(job.scenario), list(watchers.values())).as_dict()
    return row | {"tables": {name: watcher.rows for name, watcher in watchers.items()}}
