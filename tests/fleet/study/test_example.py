"""The example runs as it stands, and says what it promises."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

EXAMPLE = Path(__file__).parents[3] / "examples" / "study_in_python.py"


def test_the_study_in_python_runs_and_goes_on(tmp_path):
    texts = [
        subprocess.run(
            [sys.executable, EXAMPLE, tmp_path / "out"],
            capture_output=True, text=True, check=True, env=os.environ,
        ).stdout
        for _ in range(2)
    ]  # fmt: skip
    assert texts[0] == texts[1]
    assert texts[0].count("95 % CI") == 6
    assert "at 3.0 m rfta2 lives +" in texts[0]
