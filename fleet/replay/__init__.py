"""Recordings of runs: written as Rerun files, watched live, opened, drawn, read back.

Only this package knows Rerun, and loads it when it is needed: a run itself never does, for
its recording is drawn by another process. Recordings are looked at with ``view.view``, drawn
with ``picture.picture`` and ``clip.clip``, and read with ``readback.Recording``.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fleet.replay.rerun_recorder import RerunRecorder
    from fleet.replay.writer_process import WriterProcess
    from fleet.scenario.model import Scenario

__all__ = ["RerunRecorder", "recorder"]


def recorder(
    scenario: Scenario,
    path: Path | None,
    *,
    live: bool | str = False,
    writer: WriterProcess | None = None,
) -> RerunRecorder:
    """An observer that records a run of ``scenario`` into a file, for a live viewer, or both.

    The file's folder is made if there is none. A ``writer`` started earlier is quicker ready.

    Raises:
        BadInput: there is nowhere to record to, the file cannot be written, or no viewer can
            be opened here.
    """
    import hashlib
    import json

    from fleet import __version__
    from fleet.replay.rerun_recorder import RerunRecorder
    from fleet.scenario.errors import bad

    described: dict[str, Any] = scenario.as_dict()
    named = json.dumps({"version": __version__, **described}, sort_keys=True, default=str)
    try:
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
        return RerunRecorder(
            path,
            key=hashlib.sha256(named.encode()).hexdigest()[:16],
            properties={"version": __version__, **described},
            live=live,
            writer=writer,
        )
    except OSError as error:
        raise bad("", f"cannot record to {path}: {error.strerror}") from error
    except ValueError as error:
        raise bad("", str(error)) from error


def __getattr__(name: str) -> Any:
    """Load the recorder when it is asked for."""
    if name != "RerunRecorder":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from fleet.replay.rerun_recorder import RerunRecorder

    return RerunRecorder
