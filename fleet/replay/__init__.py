"""Recordings of runs: written as Rerun files, watched live, opened, drawn, read back.

Only this package knows Rerun, and loads it when it is needed: a run itself never does, for
its recording is drawn by another process. Recordings are looked at with ``view.view``, drawn
with ``picture.picture`` and ``picture.clip``, and read with ``readback.Recording``.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fleet.replay.recording import RerunRecorder
    from fleet.scenario.model import Scenario

__all__ = ["RerunRecorder", "recorder"]


def recorder(scenario: Scenario, path: Path | None, *, live: bool | str = False) -> RerunRecorder:
    """An observer that records a run of ``scenario`` into a file, for a live viewer, or both.

    Raises:
        ValueError: there is nowhere to record to, or the file cannot be written.
    """
    import hashlib
    import json

    from fleet import __version__
    from fleet.replay.recording import RerunRecorder

    described: dict[str, Any] = scenario.as_dict()
    named = json.dumps({"version": __version__, **described}, sort_keys=True, default=str)
    return RerunRecorder(
        path,
        key=hashlib.sha256(named.encode()).hexdigest()[:16],
        properties={"version": __version__, **described},
        live=live,
    )


def __getattr__(name: str) -> Any:
    """Load the recorder when it is asked for."""
    if name != "RerunRecorder":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from fleet.replay.recording import RerunRecorder

    return RerunRecorder
