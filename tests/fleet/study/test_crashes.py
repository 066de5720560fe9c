"""Whatever ends a study: nothing that was done is lost, nothing is counted twice."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fleet.study import StudyResult, run_jobs

COUNT = 60
SCRIPT = """\
import os, sys
sys.path.insert(0, {deeds!r})
from fleet.study import Job, run_jobs

open("main-ran", "a").write("x")
jobs = [
    Job.of(
        {{"n": n, "log": {log!r}}}, cell=f"n={{n}}", labels={{"label": n % 3}},
        function={function!r},
    )
    for n in range({count})
]
run_jobs(jobs, {out!r}, workers=2)
"""


@pytest.fixture
def study(tmp_path, log):
    """Start a study of slow jobs as a program of its own; its script has no main guard."""
    started = []

    def start(function="deeds:slow", count=COUNT, **options):
        script = tmp_path / "script.py"
        script.write_text(
            SCRIPT.format(
                deeds=str(Path(__file__).parent),
                log=str(log),
                out=str(tmp_path / "out"),
                function=function,
                count=count,
            )
        )
        process = subprocess.Popen(
            [sys.executable, script], cwd=tmp_path, stderr=subprocess.PIPE, text=True,
            start_new_session=True, **options,
        )  # fmt: skip
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.wait()
        process.stderr.close()


def wait_for_calls(calls, count, process):
    while len(calls()) < count:
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)


def assert_all_there(tmp_path, make_tasks, calls, most_twice=2):
    """Resume, and look: every row once, and no more repeated than was under way."""
    before = {row["key"] for row in StudyResult(tmp_path / "out").rows()}
    result = run_jobs(make_tasks(COUNT, "slow"), tmp_path / "out", workers=2)
    rows = list(result.rows())
    assert sorted(row["n"] for row in rows) == list(range(COUNT))
    assert before <= {row["key"] for row in rows}
    assert len(calls()) - len(set(calls())) <= most_twice


def gone(pid):
    try:
        return ") Z " in Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return True


def test_kill_9_of_the_study_keeps_what_is_done_and_leaves_nobody_behind(
    tmp_path, study, make_tasks, calls, log
):
    process = study()
    wait_for_calls(calls, 15, process)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    pids = {int(line.split()[1]) for line in log.read_text().splitlines()}
    deadline = time.monotonic() + 10.0
    while not all(map(gone, pids)):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert StudyResult(tmp_path / "out").counts().done >= 13
    assert_all_there(tmp_path, make_tasks, calls)


def test_a_ledger_whose_last_writes_were_torn_is_good_for_the_rest(
    tmp_path, study, make_tasks, calls
):
    """What a power cut may leave: the end of the write-ahead log missing, or half written."""
    process = study()
    wait_for_calls(calls, 20, process)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    log = tmp_path / "out" / "ledger.sqlite-wal"
    with log.open("r+b") as file:
        size = log.stat().st_size
        file.truncate(size - 5000)
        file.seek(size - 7000)
        file.write(b"\xa5" * 1000)
    assert_all_there(tmp_path, make_tasks, calls, most_twice=22)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_being_asked_to_stop_ends_soon_and_keeps_what_is_done(
    tmp_path, study, make_tasks, calls, number
):
    process = study()
    wait_for_calls(calls, 10, process)
    os.killpg(process.pid, number)  # as a terminal does: to everybody
    _, errors = process.communicate(timeout=20.0)
    assert "Interrupted: stopped;" in errors
    assert errors.count("Traceback") == 1  # of the script, which lets it pass; none of a worker
    assert StudyResult(tmp_path / "out").counts().done >= 8
    assert_all_there(tmp_path, make_tasks, calls)


def test_the_main_script_runs_once_though_it_has_no_guard(tmp_path, study):
    process = study(count=4)
    process.communicate()
    assert process.returncode == 0
    assert (tmp_path / "main-ran").read_text() == "x"


def test_a_full_disk_is_said_and_the_study_goes_on_when_there_is_room(
    tmp_path, study, make_tasks, calls
):
    def little_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (120_000, 120_000))

    process = study(preexec_fn=little_room)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode == 1
    assert "BrokenOff: the ledger cannot be written" in errors
    assert_all_there(tmp_path, make_tasks, calls, most_twice=4)


def test_a_full_disk_leaves_the_table_that_was_there(tmp_path, make_tasks, monkeypatch):
    result = run_jobs(make_tasks(3), tmp_path / "out", workers=1)
    table = tmp_path / "out" / "runs.parquet"
    table.write_bytes(b"of another ledger")  # so that it must be made again
    before = table.read_bytes()
    script = (
        "import resource, sys; from fleet.study import StudyResult\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        f"StudyResult({str(result.folder)!r}).write()"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=False
    )
    assert "BrokenOff: " in done.stderr
    assert "runs.parquet' cannot be written: File too large" in done.stderr
    assert (tmp_path / "out" / "runs.parquet").read_bytes() == before
    assert not list((tmp_path / "out").glob(".*"))
