"""A study from its description to its results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fleet.study.design import Study
from fleet.study.local import LIMIT
from fleet.study.result import StudyResult
from fleet.study.runner import Progress, Say, run_jobs, silent
from fleet.study.study_file import load_study, study_from


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
    command: str = "",
) -> StudyResult:
    """Run every combination of a study with every seed; go on where the folder stands.

    ``study`` is a TOML file, tables as one would have, or a :class:`Study`. The other
    parameters are those of :func:`fleet.study.run_jobs`; ``command`` is what the report says
    was called.

    Raises:
        BadInput: the study cannot be used, or another process is at work in the folder.
        BrokenOff: the disk is full, or the Dask scheduler is lost. What is done is kept.
        Interrupted: Ctrl-C or SIGTERM; it is a KeyboardInterrupt. What is done is kept.
    """
    described = described_by(study)
    return run_jobs(
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
            "source": _source(study),
            "command": command,
        },
    )


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
