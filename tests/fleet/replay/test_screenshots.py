"""Ten kinds of runs in the native viewer, to be looked at.

``SCREENSHOTS=DIR pytest -m slow tests/fleet/replay/test_screenshots.py`` keeps the pictures.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from fleet.replay import scheme
from fleet.replay.headless import HeadlessViewer, NoViewer
from fleet.replay.readback import Recording

from .conftest import record

STREAM = {"name": "stream", "rate": 0.5, "duration": 30.0}
KINDS = {
    "hole": {"world": "random-hole", "rounds": 8, "robots": 60},
    "physics": {"motion": "physics", "rounds": 8, "robots": 60},
    "warehouse": {"motion": "path", "world": "warehouse", "rounds": 8},
    "rfta3": {"protocol": "rfta3", "rounds": 8},
    "bfs": {"protocol": "bfs", "rounds": 8},
    "assignment": {"protocol": "assignment", "time": STREAM, "robots": 60},
    "lossy stream": {"radio": {"name": "lossy", "loss": 0.3}, "time": STREAM},
    "busy stream": {"time": {**STREAM, "rate": 3.0}, "robots": 100, "range": 2.5},
    "faults": {
        "time": STREAM,
        "faults": {
            "planned": [{"time": 5.0, "robot": 2, "what": "all"}],
            "blackouts": [{"start": 8.0, "duration": 20.0, "x": 4.0, "y": 4.0, "radius": 3.0}],
        },
    },
    "many": {
        "robots": 1000, "range": 2.5, "rounds": 4,
        "world": {"name": "random", "width": 32.0, "height": 32.0},
    },
}  # fmt: skip

pytestmark = pytest.mark.slow


@pytest.fixture
def viewer():
    """One for each: a viewer keeps the layout of the first recording that it shows."""
    try:
        viewer = HeadlessViewer(1600, 900)
    except NoViewer as reason:
        pytest.skip(f"the viewer does not start here: {reason}")
    with viewer:
        yield viewer


def kept(folder, name):
    """Where a picture goes: to be looked at, or to be thrown away."""
    chosen = os.environ.get("SCREENSHOTS")
    where = folder if chosen is None else Path(chosen)
    where.mkdir(parents=True, exist_ok=True)
    return where / f"{name.replace(' ', '-')}.png"


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_of_run_in_the_native_viewer(viewer, kind, tmp_path):
    run = record(tmp_path / f"{kind}.rrd", key=kind, **KINDS[kind])
    viewer.open(run.path)
    awards = run.recording.rows(scheme.LOG, "TextLog:text")
    moments = [
        moment / 1e9
        for text, moment in zip(awards.values, awards.moments[scheme.STORY].tolist(), strict=True)
        if "wins" in str(text[0]) or " to r" in str(text[0])
    ] or [Recording(run.path).span(scheme.STORY)[1] / 2]
    viewer.go("story", duration=moments[len(moments) // 2] + 0.3)
    picture = viewer.picture()
    picture.save(kept(tmp_path, kind))
    assert len(np.unique(np.array(picture).reshape(-1, 3), axis=0)) > 200
    slow = "The requested Wait timed out"  # a machine that has other things to do
    assert [problem for problem in viewer.problems() if slow not in problem] == []
