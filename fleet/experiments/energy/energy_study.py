"""The energy study from its tasks to its report."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path

from fleet.experiments.energy.energy_report import write_report
from fleet.experiments.energy.models import CORRECTED, fit
from fleet.experiments.energy.settings import (
    FULL,
    Size,
    Subject,
    headlines,
    lifetimes,
    papers,
    single_tasks,
    streams,
)
from fleet.experiments.energy.trip_table import TripTable
from fleet.study.result import StudyResult
from fleet.study.runner import Progress, Say, run_jobs, silent

Watch = Callable[[str], AbstractContextManager[Progress]]
"""Shows the progress of the part of that name."""


def energy_study(
    out: Path,
    watch: Watch,
    *,
    size: Size = FULL,
    seed: int = 0,
    workers: int | None = None,
    say: Say = silent,
    command: str = "fleet energy",
    subject: Subject | None = None,
) -> tuple[list[StudyResult], Path]:
    """Run what is left of the study into ``out``, and write its report.

    Single tasks and streams are in ``out/trips``; the corrected model is fitted on them.
    Lifetimes, in ``out/lifetimes``, are lived with it. Returns both, and the path of the page.
    ``subject`` is the paper's if it is not given.

    Raises what :func:`fleet.study.runner.run_jobs` raises.
    """
    meta, subject = {"command": command}, subject or papers()
    crowds = streams(size, seed) if subject.traffic else ()
    with watch("trips") as progress:
        driven = run_jobs(
            [*single_tasks(size, seed, subject), *crowds], out / "trips",
            workers=workers, progress=progress, say=say, meta=meta,
        )  # fmt: skip
    trips = TripTable.of(driven.table("trips"))
    single, streamed = trips.where(part="single"), trips.where(part="stream")
    with watch("lifetimes") as progress:
        lived = run_jobs(
            [
                *lifetimes(size, seed, launch_costs(single), subject),
                *headlines(size, seed, subject),
            ],
            out / "lifetimes",
            workers=workers, progress=progress, say=say, meta=meta,
        )  # fmt: skip
    page = write_report(
        out,
        single,
        streamed,
        TripTable.of(lived.table("trips")),
        list(lived.rows()),
        command,
        subject,
    )
    return [driven, lived], page


def launch_costs(single: TripTable) -> Mapping[str, float]:
    """What a launch costs in each setting [J], beyond Eq. (1) on the planned path."""
    there = [str(name) for name in dict.fromkeys(single["setting"].tolist())]
    return {
        name: fit(CORRECTED, single.where(setting=name).arrived()).coefficients[0].value
        for name in there
    }
