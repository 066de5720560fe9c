"""Runs without compiled code: for debuggers, and for the proof that kernels are Python."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

COMMAND = "import sys; from fleet.cli import main; main(sys.argv[1:])"


def summary(uncompiled, *options):
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", COMMAND, "run", "--json", *options],
        env={**os.environ, "NUMBA_DISABLE_JIT": uncompiled},
        capture_output=True,
        text=True,
        check=True,
    )
    return {**json.loads(run.stdout), "wall_time": 0.0}


@pytest.mark.slow
@pytest.mark.parametrize("motion", ["straight", "path", "physics"])
@pytest.mark.parametrize("radio", ["ideal", "lossy"])
def test_uncompiled_runs_come_to_the_same(motion, radio):
    options = [
        "--motion", motion, "--rounds", "3", "--robots", "60", "--set", f"radio.name={radio}",
        "--set", "world.width=8", "--set", "world.height=8",
    ]  # fmt: skip
    assert summary("1", *options) == summary("0", *options)
