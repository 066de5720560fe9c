"""Whatever ends a study while its tables are written: after the next command they are right."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import dying
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from fleet.study import BrokenOff, StudyResult, run_jobs
from fleet.study.audit import audit
from fleet.study.parquet import made_from


@pytest.mark.parametrize("how", ["before", "half", "after"])
def test_tables_are_the_ledger_s_wherever_the_last_call_ended(tmp_path, how):
    """Dead at the first write, the ninth ... until it comes through; all of them are below."""
    for number in range(0, 500, 8):
        folder = tmp_path / str(number)
        dying.begin(folder)
        death = dying.Death(number, how, raise_killed)
        try:
            with dying.dying(death):
                dying.go_on(folder)
        except dying.Killed:
            dying.go_on(folder)
            dying.check(folder)
            continue
        break
    assert number > 50
    dying.check(folder)


def raise_killed():
    raise dying.Killed


@pytest.mark.slow
def test_250_kills_while_tables_are_written(tmp_path):
    done = subprocess.run(
        [sys.executable, dying.__file__, tmp_path, "150", "100"],
        capture_output=True, text=True, timeout=600.0, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    signals = [line.split()[1] for line in done.stdout.splitlines()]
    assert len(signals) == 250
    assert signals.count("9") > 60  # of those at writes; there may be fewer writes than points
    assert signals.count("14") > 40


@pytest.mark.parametrize("room", [200, 1500, 3000])
def test_a_full_disk_while_tables_are_written_is_said_and_mended(tmp_path, room):
    dying.begin(tmp_path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    try:
        with pytest.raises(BrokenOff, match="cannot be written: File too large"):
            StudyResult(tmp_path).write()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    dying.go_on(tmp_path)
    dying.check(tmp_path)


def test_a_table_that_is_missing_or_no_more_is_put_right(tmp_path):
    dying.begin(tmp_path)
    dying.go_on(tmp_path)
    (tmp_path / "parts.parquet").unlink()
    kept = (tmp_path / "wholes.parquet").stat().st_mtime_ns
    assert "'parts" in audit(tmp_path).problems[0].replace(str(tmp_path) + "/", "")
    dying.go_on(tmp_path)
    dying.check(tmp_path)
    assert (tmp_path / "wholes.parquet").stat().st_mtime_ns == kept  # it was right
    pq.write_table(pa.table({"x": [1]}), tmp_path / "mine.parquet")
    run_jobs([], tmp_path)
    assert {path.name for path in tmp_path.glob("*.parquet")} == {"runs.parquet", "mine.parquet"}


def test_a_table_says_what_it_was_made_from(tmp_path):
    dying.begin(tmp_path)
    old = made_from(tmp_path / "runs.parquet")
    assert StudyResult(tmp_path).table().num_rows == 6
    assert len(audit(tmp_path).problems) == 3
    dying.go_on(tmp_path)
    new = made_from(tmp_path / "runs.parquet")
    assert old.partition(":")[0] == new.partition(":")[0] != ""
    assert old != new
    assert made_from(Path(__file__)) == ""
