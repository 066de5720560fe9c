"""The campaign as tasks, run and reported."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fleet.study.paper.campaign import NETWORKS, cases
from fleet.study.paper.report import write_report
from fleet.study.paper.results import Results
from fleet.study.result import StudyResult
from fleet.study.running import Progress, Say, run_tasks, silent
from fleet.study.task import Task

COLUMNS = (
    "series", "motion", "world", "radio_range", "search_radius", "seed", "lifetime", "events",
    "messages", "messages_per_robot", "energy_left_mean", "energy_left_min",
    "reactions_per_robot", "distance_per_robot", "closest_found",
)  # fmt: skip


def reproduce(
    out: Path,
    *,
    networks: int = NETWORKS,
    physics: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
    say: Say = silent,
    command: str = "fleet paper",
) -> tuple[StudyResult, Path]:
    """Run what is left of the campaign into ``out``, and write its report.

    ``networks`` are drawn for each range and topology; ``physics`` runs all of it on pymunk as
    well.
    Returns the runs, and the path of the page. Raises what
    :func:`fleet.study.running.run_tasks` raises.
    """
    motions = ["straight", "physics"] if physics else ["straight"]
    result = run_tasks(
        tasks(networks, motions), out, workers=workers, scheduler=scheduler,
        progress=progress, say=say, meta={"command": command},
    )  # fmt: skip
    return result, write_report(out, results_of(result.rows()), command)


def tasks(networks: int, motions: Iterable[str]) -> list[Task]:
    """The campaign's runs, labelled by the series that they belong to."""
    return [
        Task.of(
            scenario,
            cell=f"{name}, {motion}, {scenario['world']}, range {scenario['range']},"
            f" search radius {scenario['search_radius']}",
            labels={"series": name},
        )
        for motion in motions
        for name, scenario in cases(networks, motion)
    ]


def results_of(rows: Iterable[Mapping[str, Any]]) -> Results:
    """The columns that the report needs, of all runs that are done."""
    return Results.of({name: row[name] for name in COLUMNS} for row in rows)
