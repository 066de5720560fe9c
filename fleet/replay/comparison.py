"""Recordings arranged anew: several in one, so that one cursor moves them all."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from string import ascii_lowercase

import rerun as rr

from fleet.replay.blueprint import Stage, blueprint, side_by_side
from fleet.replay.readback import Recording
from fleet.replay.scheme import APPLICATION, COMPARISON, ROBOTS, ROUND, SIM_TIME

MOST = 6  # recordings side by side


def arrange(recordings: Sequence[Path], out: Path, timeline: str | None = None) -> None:
    """Write recordings into one, side by side; or a single one, to be scrubbed by ``timeline``.

    Raises:
        ValueError: there are none or too many, or one of them cannot be read.
    """
    if not 1 <= len(recordings) <= MOST:
        raise ValueError(f"{len(recordings)} recordings to compare; expected 1 to {MOST}")
    loaded = [Recording(path) for path in recordings]
    if len(loaded) == 1:
        stages = [_stage(loaded[0], "")]
        layout = blueprint(stages[0], timeline or SIM_TIME)
    else:
        stages = [_stage(r, f"{x}/") for r, x in zip(loaded, ascii_lowercase, strict=False)]
        layout = side_by_side(stages, timeline or ROUND)
    application = APPLICATION if len(loaded) == 1 else COMPARISON
    key = "+".join(recording.key for recording in loaded)
    sink = rr.RecordingStream(application, recording_id=key, send_properties=False)
    sink.save(out, default_blueprint=layout)
    sink.send_recording_name(" | ".join(stage.name for stage in stages))
    for recording, stage in zip(loaded, stages, strict=True):
        sink.send_chunks(
            [
                chunk.with_entity_path(stage(chunk.entity_path.removeprefix("/")))
                for chunk in recording.chunks
                if not chunk.entity_path.startswith("/__properties")
            ]
        )
    sink.flush()
    sink.disconnect()


def _stage(recording: Recording, root: str) -> Stage:
    scene = recording.properties["scene"]
    radii = recording.static(ROBOTS, "Points2D:radii")
    assert radii is not None
    return Stage(
        scene["width"], scene["height"], float(radii[0]), scene["capacity"],
        scene["title"], root,
    )  # fmt: skip
