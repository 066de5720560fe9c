"""The cache of compiled kernels survives what happens to files."""

from __future__ import annotations

import os
import subprocess
import sys

SCRIPT = """
from protocols.topology import Topology
live = Topology([(0.0, 0.0), (1.0, 0.0)], 2.0, compiled=True)
live.move(1, (1.5, 0.0))
print(dict(live.neighbours[0]))
"""


def run(cache):
    return subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def test_a_truncated_cache_is_compiled_anew(tmp_path):
    expected = run(tmp_path)
    files = [f for f in tmp_path.rglob("*") if f.suffix in (".nbi", ".nbc")]
    assert files
    for file in files:
        file.write_bytes(file.read_bytes()[:10])
    assert run(tmp_path) == expected
    assert run(tmp_path) == expected


def test_a_cache_that_cannot_be_written_does_not_matter(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    assert run(blocked / "cache") == run(tmp_path / "free")
