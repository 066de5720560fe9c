"""``fleet sweep`` and ``fleet replay`` as a user meets them."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from fleet.cli import main
from fleet.study import StudyResult, kept

STUDY = """\
seeds = 2
[scenario]
motion = "straight"
rounds = 5
robots = 40
range = 3.0
[axes]
protocol = ["rfta2", "gfgf2a"]
"""
LONG = STUDY.replace("rounds = 5", "").replace("seeds = 2", "seeds = 400")


def fleet(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments], catch_exceptions=False)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


@pytest.fixture
def swept(tmp_path, file):
    out = tmp_path / "out"
    done = fleet("sweep", file, "--out", out, "--workers", 1)
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith(f"4 of 4 runs are done, in {out}. To read them:  ")
    assert done.stdout.endswith(f" report {out}\n")
    assert done.stderr == ""
    return out


def test_sweep_again_says_the_same_and_changes_nothing(swept, file):
    before = (swept / "runs.parquet").read_bytes()
    assert fleet("sweep", file, "--out", swept).stdout.startswith("4 of 4 runs are done")
    assert (swept / "runs.parquet").read_bytes() == before


def test_a_changed_study_is_noticed_and_said(swept, file):
    file.write_text(STUDY.replace("3.0", "3.5"))
    done = fleet("sweep", file, "--out", swept, "--workers", 1)
    assert done.exit_code == 0
    assert "the study has changed: 4 runs that are done are no part of it now" in done.stderr


def test_bad_axes_are_exit_2_with_their_line_before_anything_starts(tmp_path, file):
    file.write_text(STUDY + 'search_radius = [1.0, "wide"]\n')
    done = fleet("sweep", file, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert f"{file}:9: axes.search_radius: is 'wide'; expected a number" in done.stderr
    assert not (tmp_path / "out").exists()


def test_failed_runs_are_exit_1_and_named(tmp_path, file):
    file.write_text(STUDY.replace("range = 3.0", "") + "range = [0.2, 3.0]\n")
    done = fleet("sweep", file, "--out", tmp_path / "out", "--workers", 1)
    assert done.exit_code == 1
    assert done.stdout.startswith("4 of 8 runs are done")
    assert "raised: worlds.arena.ImpossibleWorld: range is 0.2 m" in done.stderr
    assert "4 of 8 runs failed" in done.stderr


def test_a_folder_at_work_is_exit_2(tmp_path, file):
    from fleet.study.open_ledger import writing

    with writing(tmp_path / "out"):
        done = fleet("sweep", file, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert "another study (process " in done.stderr


def test_a_cluster_without_dask_is_exit_2(tmp_path, file, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = fleet("sweep", file, "--out", tmp_path / "out", "--scheduler", "tcp://127.0.0.1:1")
    assert done.exit_code == 2
    assert "install talking-fleet[cluster]" in done.stderr


def test_no_scheduler_is_exit_3_and_says_how_to_go_on(tmp_path, file, monkeypatch):
    pytest.importorskip("distributed", reason="dask.distributed is not installed")
    monkeypatch.setattr("fleet.study.cluster.ANSWER", 0.5)
    done = fleet("sweep", file, "--out", tmp_path / "out", "--scheduler", "tcp://127.0.0.1:1")
    assert done.exit_code == 3
    assert "no Dask scheduler answers at 'tcp://127.0.0.1:1'" in done.stderr
    assert "run the same command to go on:" in done.stderr


def start(tmp_path, out, **streams):
    study = tmp_path / "long.toml"
    study.write_text(LONG)
    return subprocess.Popen(
        [sys.executable, "-m", "fleet", "sweep", str(study), "--out", str(out), "--workers", "2"],
        start_new_session=True,
        **streams,
    )


def wait_for_runs(out, count, process):
    while not (out / "ledger.sqlite").exists() or done_in(out) < count:
        assert process.poll() is None
        time.sleep(0.02)


def done_in(out):
    try:
        return StudyResult(out).counts().done
    except ValueError:  # its tables are being made
        return 0


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interrupted_sweep_says_what_is_kept_and_how_to_go_on(tmp_path, number, code):
    out = tmp_path / "out"
    process = start(tmp_path, out, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for_runs(out, 5, process)
    os.killpg(process.pid, number)
    stdout, stderr = process.communicate(timeout=20.0)
    assert process.returncode == code
    assert stdout == ""
    (line,) = stderr.splitlines()
    kept = done_in(out)
    assert f"fleet: stopped; {kept} of 800 runs are done and kept; to go on:" in line
    assert line.endswith(f"fleet sweep {tmp_path / 'long.toml'} --out {out} --workers 2")


def test_a_terminal_sees_a_bar_with_an_estimate(tmp_path):
    out = tmp_path / "out"
    ours, theirs = pty.openpty()
    process = start(tmp_path, out, stdout=subprocess.DEVNULL, stderr=theirs)
    os.close(theirs)
    wait_for_runs(out, 30, process)
    process.send_signal(signal.SIGINT)
    seen = b""
    try:
        while piece := os.read(ours, 4096):
            seen += piece
    except OSError:  # the other end is closed
        pass
    os.close(ours)
    assert process.wait() == 130
    assert b"/800" in seen
    assert b"0:0" in seen


def test_replay_runs_a_run_again_to_the_bit(swept):
    for row in StudyResult(swept).rows():
        done = fleet("replay", swept, row["key"][:10], "--json")
        assert done.exit_code == 0, done.output
        assert f"run {row['key'][:12]} is the same to the last bit" in done.stderr
        again = json.loads(done.stdout)
        assert {k: again[k] for k in again if k != "wall_time"} == {
            k: row[k] for k in again if k != "wall_time"
        }


def test_replay_notices_a_run_that_differs(swept, monkeypatch):
    key = next(iter(StudyResult(swept).rows()))["key"]
    found = kept.kept_run(swept, key)
    assert found.row is not None
    found.row["messages"] += 1
    monkeypatch.setattr(kept, "kept_run", lambda *_, **__: found)
    done = fleet("replay", swept, key)
    assert done.exit_code == 1
    assert f"messages was {found.row['messages']}, is {found.row['messages'] - 1}" in done.stderr
    assert f"run {key[:12]} is not the run that is kept" in done.stderr


def test_replay_of_an_unknown_key_names_the_near_ones(swept):
    key = next(iter(StudyResult(swept).rows()))["key"]
    done = fleet("replay", swept, key[:6] + "zzz")
    assert done.exit_code == 2
    assert f"did you mean '{key[:12]}'" in done.stderr
    assert "begins with ''" in fleet("replay", swept, "").stderr


def test_replay_finds_the_user_s_files_from_elsewhere(tmp_path, monkeypatch):
    home = tmp_path / "home"
    home.mkdir()
    (home / "mine.py").write_text(
        "from protocols.metrics import distance\n\n"
        "def nearest(robot, site):\n    return distance(robot, site)\n"
    )
    (home / "study.toml").write_text(
        STUDY.replace('["rfta2", "gfgf2a"]', '[{name = "rfta2", metric = "mine.py:nearest"}]')
    )
    monkeypatch.chdir(home)
    assert fleet("sweep", "study.toml", "--out", "out", "--workers", 1).exit_code == 0
    (row, _) = StudyResult("out").rows()
    monkeypatch.chdir(tmp_path)
    done = fleet("replay", "home/out", row["key"])
    assert done.exit_code == 0
    assert "the same to the last bit" in done.stderr
    assert Path.cwd() == tmp_path


@pytest.mark.slow
def test_replay_records_the_run(swept, tmp_path):
    pytest.importorskip("rerun", reason="rerun is not installed")
    key = next(iter(StudyResult(swept).rows()))["key"]
    done = fleet("replay", swept, key, "--rrd", tmp_path / "run.rrd")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "run.rrd").stat().st_size > 1000
    assert "the same to the last bit" in done.stderr
