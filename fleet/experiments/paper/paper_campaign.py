"""The campaign as tasks, run and reported."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from fleet.experiments.paper.campaign_runs import Results
from fleet.experiments.paper.cases import NETWORKS, cases, growth_cases
from fleet.experiments.paper.paper_report import write_report
from fleet.study.job import Job
from fleet.study.result import StudyResult
from fleet.study.runner import Progress, Say, run_jobs, silent

COLUMNS = (
    "series", "reading", "motion", "world", "robots", "radio_range", "search_radius", "seed",
    "lifetime", "events", "messages", "messages_per_robot", "hops_greedy", "hops_face",
    "energy_left_mean", "energy_left_min", "reactions_per_robot", "distance_per_robot",
    "closest_found",
)  # fmt: skip


def paper_campaign(
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
    :func:`fleet.study.runner.run_jobs` raises.
    """
    motions = ["straight", "physics"] if physics else ["straight"]
    result = run_jobs(
        tasks(networks, motions), out, workers=workers, scheduler=scheduler,
        progress=progress, say=say, meta={"command": command},
    )  # fmt: skip
    return result, write_report(out, results_of(result.rows()), command)


def tasks(networks: int, motions: Iterable[str]) -> list[Job]:
    """The campaign's runs, labelled by their series and their reading."""
    planned = [case for motion in motions for case in cases(networks, motion)]
    return [
        Job.of(
            scenario,
            cell=f"{name} ({reading}), {scenario['motion']}, {scenario['world']},"
            f" range {scenario['range']:.3g}, search radius {scenario['search_radius']:.3g}",
            labels={"series": name, "reading": reading},
        )
        for name, reading, scenario in [*planned, *growth_cases(networks)]
    ]


def results_of(rows: Iterable[Mapping[str, Any]]) -> Results:
    """The columns that the report needs, of all runs that are done."""
    return Results.of_rows({name: row[name] for name in COLUMNS} for row in rows)
