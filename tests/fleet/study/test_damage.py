"""A results folder is data: damage is said in one sentence, and nothing in it is run unasked."""

from __future__ import annotations

import json
import random
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import dying
import pytest
from click.testing import CliRunner

from fleet.cli import main
from fleet.scenario.errors import BadInput
from fleet.study import StudyResult, run_jobs
from fleet.study.audit import audit
from fleet.study.ledger import NAME
from fleet.study.open_ledger import writing
from fleet.study.sweeping import sweep


def fleet(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments], catch_exceptions=False)


@pytest.fixture
def folder(tmp_path):
    out = tmp_path / "out"
    dying.begin(out)
    dying.go_on(out)
    return out


def test_check_finds_nothing_wrong_with_what_a_study_wrote(folder):
    done = fleet("check", folder)
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout == f"{folder}: 6 runs and 3 tables are as they were written\n"


@pytest.mark.parametrize(
    ("statement", "said"),
    [
        ("UPDATE run SET row = replace(row, '16', '17')", "run {key} is not as it was written"),
        ("UPDATE run SET row = 'x'", "run {key} is not as it was written"),
        ("UPDATE side SET stream = x'00'", "the table 'parts' of run {key} is not as it was"),
        ("UPDATE job SET scenario = '{{\"n\":9}}'", "the job of run {key} is not as it was"),
        ("UPDATE plan SET labels = '{{\"n\":9}}'", "the plan of run {key} is not as it was"),
        ("UPDATE origin SET made_by = '{{}}'", "the job of run {key} is not as it was"),
    ],
)
def test_what_is_not_as_it_was_written_is_found_and_never_reported(folder, statement, said):
    key = "" if "{key}" not in said else "[0-9a-f]{12}"
    with writing(folder) as ledger:
        ledger._database.execute(statement.replace("{{", "{").replace("}}", "}"))
    done = fleet("check", folder)
    assert done.exit_code == 1
    assert re.search(re.escape(said).replace(re.escape("{key}"), key), done.stderr), done.stderr
    if "side" not in statement:
        reported = fleet("report", folder)
        assert reported.exit_code == 2
        assert "is damaged: " in reported.stderr
        assert reported.stderr.count("\n") == 1


def test_a_table_that_was_edited_is_found(folder):
    path = folder / "parts.parquet"
    data = bytearray(path.read_bytes())
    data[60] ^= 0x10
    path.write_bytes(data)
    done = fleet("check", folder)
    assert done.exit_code == 1
    assert done.stderr.startswith(f"fleet: {str(path)!r} is not as it was written; remove it")


def test_bits_that_flip_anywhere_are_one_sentence_and_never_other_numbers(folder, tmp_path):
    """200 flipped bytes: each is an error in a sentence, or changes nothing that is read."""
    rng = random.Random(3)
    good = list(StudyResult(folder).rows())
    whole = (folder / NAME).read_bytes()
    told: list[str] = []
    for number in range(200):
        place = tmp_path / str(number)
        place.mkdir()
        data = bytearray(whole)
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        (place / NAME).write_bytes(data)
        try:
            rows = list(StudyResult(place).rows())
            audit(place)
        except BadInput as error:
            told.append(str(error))
        else:
            assert {json.dumps(row) for row in rows} <= {json.dumps(row) for row in good}
        shutil.rmtree(place)
    assert len(told) > 5
    assert not any("\n" in sentence for sentence in told)


def test_a_truncated_ledger_is_one_sentence(folder):
    path = folder / NAME
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    for command in ("report", "check", "sweep"):
        arguments = [folder] if command != "sweep" else [_study(folder), "--out", folder]
        done = fleet(command, *arguments)
        assert done.exit_code in (1, 2)
        assert "Traceback" not in done.stderr
        assert "cannot be read" in done.stderr or "is damaged" in done.stderr


def _study(folder):
    path = folder.parent / "study.toml"
    path.write_text('seeds = 1\n[scenario]\nmotion = "straight"\nrounds = 1\n')
    return path


KILLED = """
import os, signal, sqlite3, sys
database = sqlite3.connect(sys.argv[1], isolation_level=None)
database.execute("PRAGMA journal_mode = " + sys.argv[2])
database.execute("PRAGMA cache_size = 1")
database.execute("BEGIN")
for n in range(400):
    database.execute("INSERT INTO meta VALUES (?, ?)", (f"x{n}", "0" * 500))
if sys.argv[2] == "WAL":
    database.execute("COMMIT")
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize("journal", ["DELETE", "WAL"])
def test_what_a_kill_left_half_done_is_read_without_a_write(folder, journal):
    """A hot journal, or a write-ahead log that nobody has put back, in a read-only folder too."""
    rows = list(StudyResult(folder).rows())
    subprocess.run([sys.executable, "-c", KILLED, folder / NAME, journal], check=False)
    left = {path.name for path in folder.iterdir()}
    assert any(name.endswith(("-journal", "-wal")) for name in left)
    before = {p.name: p.read_bytes() for p in folder.iterdir() if not p.name.endswith("-shm")}
    assert list(StudyResult(folder).rows()) == rows
    after = {p.name: p.read_bytes() for p in folder.iterdir() if not p.name.endswith("-shm")}
    assert after == before


def test_report_where_nothing_can_be_written_is_one_sentence(folder, tmp_path, monkeypatch):
    def refused(*_args, **_named):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(Path, "write_text", refused)
    done = fleet("report", folder)
    assert done.exit_code == 2
    assert "cannot be written: Read-only file system" in done.stderr
    assert done.stderr.count("\n") == 1


OWN = """\
from pathlib import Path
from protocols.metrics import distance

def nearest(robot, site):
    Path({ran!r}).touch()
    return distance(robot, site)
"""


def test_replay_runs_code_only_if_this_user_swept_with_it(tmp_path, monkeypatch):
    ran, mine = tmp_path / "ran", tmp_path / "mine.py"
    mine.write_text(OWN.format(ran=str(ran)))
    study = {
        "scenario": {
            "motion": "straight", "rounds": 1, "robots": 40, "range": 3.0,
            "protocol": {"name": "rfta2", "metric": f"{mine}:nearest"},
        }
    }  # fmt: skip
    out = tmp_path / "out"
    (row,) = sweep(study, out, workers=1).rows()
    assert fleet("replay", out, row["key"]).exit_code == 0

    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "another-user"))
    ran.unlink()
    done = fleet("replay", out, row["key"])
    assert done.exit_code == 2
    assert f"runs {mine}, which you have not swept with" in done.stderr
    assert not ran.exists()
    assert fleet("report", out).exit_code == 0
    assert fleet("check", out).exit_code == 0
    assert not ran.exists()
    assert fleet("replay", out, row["key"], "--trust").exit_code == 0
    assert ran.exists()


def test_a_run_that_never_ends_is_ended(tmp_path, make_tasks):
    jobs = make_tasks(1, "slow", seconds=60.0) + make_tasks(4)
    started = time.monotonic()
    result = run_jobs(jobs, tmp_path / "out", workers=2, limit=1.5)
    assert time.monotonic() - started < 20.0
    assert result.counts() == (5, 4, 1)
    (failure,) = result.failures()
    assert failure.status == "overdue"
    assert failure.error == "it took longer than 1.5 s, the limit of a run (--limit)"
