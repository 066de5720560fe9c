"""A study from its description to its results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fleet.study.design import Study
from fleet.study.ledger import NAME, reading
from fleet.study.local import LIMIT
from fleet.study.remarks import study_remarks
from fleet.study.result import StudyResult
from fleet.study.runner import Progress, Say, run_jobs, silent
from fleet.study.study_file import load_study, study_from
from fleet.study.until import MOST, seeds_there, target, wanted, with_seeds


def sweep(
    study: Study | Mapping[str, Any] | str | Path,
    out: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
    say: Say = silent,
    retry: bool = False,
    limit: float | None = LIMIT,
    until: str = "",
    command: str = "",
) -> StudyResult:
    """Run every combination of a study with every seed; go on where the folder stands.

    ``until``, such as ``lifetime ±2%``, adds seeds until that measure's 95 % interval is that
    narrow in every combination: see :mod:`fleet.study.until`.

    ``study`` is a TOML file, tables as one would have, or a :class:`Study`. The other
    parameters are those of :func:`fleet.study.run_jobs`; ``command`` is what the report says
    was called.

    Raises:
        BadInput: the study cannot be used, or another process is at work in the folder.
        BrokenOff: the disk is full, or the Dask scheduler is lost. What is done is kept.
        Interrupted: Ctrl-C or SIGTERM; it is a KeyboardInterrupt. What is done is kept.
    """
    described, goal = described_by(study), target(until) if until else None
    source = _source(study)
    for said in study_remarks(described):
        say(said)
    if goal is not None and (Path(out) / NAME).is_file():
        with reading(Path(out)) as ledger:
            described = with_seeds(described, seeds_there(ledger.meta(), described))
    while True:
        result = run_jobs(
            described.jobs(),
            out,
            workers=workers,
            scheduler=scheduler,
            progress=progress,
            say=say,
            retry=retry,
            limit=limit,
            meta={
                "study": asdict(described) | {"seeds": list(described.seeds)},
                "source": source,
                "until": str(goal or ""),
                "command": command,
            },
        )
        if goal is None:
            return result
        count, half = wanted(result, goal)
        if count <= len(described.seeds):
            say(f"{goal.measure} is known to ±{half:.1%} with {len(described.seeds)} seeds")
            return result
        if count > MOST:
            say(f"{goal} takes more than {MOST} seeds; ±{half:.1%} is where it stands")
            return result
        say(f"{goal.measure} is known to ±{half:.1%}; {count - len(described.seeds)} seeds more")
        described = with_seeds(described, count)


def _source(study: Study | Mapping[str, Any] | str | Path) -> str:
    """The study file as it is written, if there is one."""
    return Path(study).read_text("utf-8") if isinstance(study, str | Path) else ""


def described_by(study: Study | Mapping[str, Any] | str | Path) -> Study:
    """The study that is meant.

    Raises:
        BadInput: it cannot be used.
    """
    if isinstance(study, Study):
        return study
    return study_from(study) if isinstance(study, Mapping) else load_study(Path(study))
