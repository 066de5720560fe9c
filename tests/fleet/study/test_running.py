"""Jobs and their ledger: each is run once, whatever happens, and its row is kept."""

from __future__ import annotations

import os
import signal
import sqlite3
import threading
import time
from importlib.metadata import version
from pathlib import Path

import pytest

from fleet.scenario.errors import BadInput
from fleet.study import Job, StudyResult, run_jobs
from fleet.study.job import Outcome
from fleet.study.ledger import NAME, reading
from fleet.study.open_ledger import writing
from fleet.study.version import program_version


def numbers(result):
    return sorted(row["n"] for row in result.rows())


def test_every_task_has_its_row_and_is_run_once(tmp_path, make_tasks, calls):
    jobs = make_tasks(20)
    result = run_jobs(jobs, tmp_path / "out", workers=2)
    assert numbers(result) == sorted(calls()) == list(range(20))
    assert result.counts() == (20, 20, 0)
    again = run_jobs(jobs, tmp_path / "out", workers=2)
    assert len(calls()) == 20
    assert list(again.rows()) == list(result.rows())


def test_rows_come_in_the_order_of_the_tasks_with_labels_and_key(tmp_path, make_tasks):
    jobs = make_tasks(9)
    rows = list(run_jobs(jobs, tmp_path / "out", workers=2).rows())
    assert [row["key"] for row in rows] == [job.key for job in jobs]
    assert [row["label"] for row in rows] == [job.labels["label"] for job in jobs]
    assert [row["cell"] for row in rows] == [job.cell for job in jobs]


def test_more_tasks_are_added_and_others_put_aside(tmp_path, make_tasks, calls):
    said = []
    run_jobs(make_tasks(6), tmp_path / "out", workers=1, say=said.append)
    assert said == []
    result = run_jobs(make_tasks(9)[3:], tmp_path / "out", workers=1, say=said.append)
    assert numbers(result) == list(range(3, 9))
    assert sorted(calls()) == list(range(9))
    assert said == ["the study has changed: 3 runs that are done are no part of it now; kept aside"]
    assert numbers(run_jobs(make_tasks(9), tmp_path / "out")) == list(range(9))
    assert sorted(calls()) == list(range(9))


def test_another_version_of_the_program_runs_everything_again(tmp_path, make_tasks, monkeypatch):
    said = []
    with monkeypatch.context() as patched, writing(tmp_path / "out") as ledger:
        patched.setattr("fleet.study.inputs.program_version", lambda: "0.0+before")
        jobs = make_tasks(3)
        ledger.plan(jobs)
        ledger.record(Outcome(job.key, "done", '{"n": 1}', {}, "", 1, 0.1) for job in jobs)
        assert {row["version"] for row in ledger.rows()} == {"0.0+before"}
    result = run_jobs(make_tasks(3), tmp_path / "out", workers=1, say=said.append)
    assert {row["version"] for row in result.rows()} == {program_version()}
    assert numbers(result) == [0, 1, 2]
    assert said[0].startswith("the program has changed: 3 runs are of another version; kept aside")
    assert len(said) == 1


def test_a_row_says_which_libraries_it_was_made_with(tmp_path, make_tasks):
    (row,) = run_jobs(make_tasks(1), tmp_path / "out", workers=1).rows()
    for name in ("numpy", "numba", "scipy", "pymunk"):
        assert f"{name} {version(name)}" in row["libraries"].split(", ")


def test_one_run_may_stand_in_two_cells_and_is_run_once(tmp_path, calls, log):
    jobs = [
        Job.of({"n": 5, "log": str(log)}, cell=cell, labels={"figure": cell}, function="deeds:note")
        for cell in ("figure 1", "figure 2", "figure 2")
    ]
    result = run_jobs(jobs, tmp_path / "out", workers=1)
    assert [row["figure"] for row in result.rows()] == ["figure 1", "figure 2"]
    assert calls() == [5]
    assert result.counts().total == 1


@pytest.mark.parametrize(
    ("deed", "status", "said"),
    [
        ("raise", "raised", "ValueError: bad physics"),
        ("memory", "raised", "MemoryError"),
        ("exit", "killed", "exited with code 7"),
        ("segfault", "killed", "SIGSEGV"),
        ("kill", "killed", "SIGKILL (the system kills with it when memory runs out)"),
    ],
)
def test_a_task_that_fails_or_kills_is_named_and_the_others_go_on(
    tmp_path, make_tasks, calls, deed, status, said
):
    jobs = make_tasks(12, "deadly", victim=4, deed=deed)
    result = run_jobs(jobs, tmp_path / "out", workers=2)
    (failure,) = result.failures()
    assert (failure.key, failure.cell, failure.status) == (jobs[4].key, "n=4", status)
    assert said in failure.error
    assert numbers(result) == [n for n in range(12) if n != 4]
    assert result.counts() == (12, 11, 1)
    run_jobs(jobs, tmp_path / "out", workers=2)
    assert len(calls()) == len(set(calls())) == 11


def test_a_traceback_names_the_line_at_fault(tmp_path, make_tasks):
    result = run_jobs(make_tasks(1, "deadly", victim=0, deed="raise"), tmp_path / "out", workers=1)
    assert "deeds.py" in result.failures()[0].error
    assert "in raise_error" in result.failures()[0].error


def test_a_task_that_kills_its_worker_once_gets_another(tmp_path, make_tasks, calls):
    once = str(tmp_path / "marker")
    jobs = make_tasks(8, "deadly", victim=2, deed="kill", once=once)
    result = run_jobs(jobs, tmp_path / "out", workers=2)
    assert result.counts() == (8, 8, 0)
    assert sorted(calls()) == list(range(8))
    with reading(tmp_path / "out") as ledger:
        attempts = dict(ledger._database.execute("SELECT key, attempts FROM run"))
    assert attempts[jobs[2].key] == 2
    assert sum(attempts.values()) == 9


def test_failed_tasks_are_run_again_only_when_asked(tmp_path, make_tasks):
    once = tmp_path / "marker"
    jobs = make_tasks(3, "deadly", victim=1, deed="raise", once=str(once))
    assert run_jobs(jobs, tmp_path / "out", workers=1).counts().failed == 1
    assert once.exists()
    assert run_jobs(jobs, tmp_path / "out", workers=1).counts().failed == 1
    assert run_jobs(jobs, tmp_path / "out", workers=1, retry=True).counts() == (3, 3, 0)


def test_a_worker_killed_from_outside_costs_nothing(tmp_path, make_tasks, log, calls):
    jobs = make_tasks(30, "slow")
    killed = []

    def kill_one(counts):
        if counts.done >= 8 and not killed:
            killed.append(int(log.read_text().splitlines()[-1].split()[1]))
            os.kill(killed[0], signal.SIGKILL)

    result = run_jobs(jobs, tmp_path / "out", workers=2, progress=kill_one)
    assert killed
    assert result.counts() == (30, 30, 0)
    assert len(calls()) in (30, 31)  # it may have been killed after it had left its trace


@pytest.mark.parametrize("function", ["deeds:nothing", "no_module_of_this_name:f", "deeds"])
def test_a_work_function_that_is_not_there_is_said_by_each_task(tmp_path, function):
    if function.startswith("no_module"):
        with pytest.raises(ModuleNotFoundError, match="no_module_of_this_name"):
            Job.of({"n": 1}, function=function)
        return
    result = run_jobs([Job.of({"n": 1}, function=function)], tmp_path / "out", workers=1)
    assert "Error" in result.failures()[0].error


def test_a_row_that_cannot_be_written_down_is_the_task_s_error(tmp_path, make_tasks):
    result = run_jobs(make_tasks(1, "unspeakable"), tmp_path / "out", workers=1)
    assert "expected plain values" in result.failures()[0].error


def test_numpy_s_numbers_are_plain_in_rows(tmp_path, make_tasks):
    (row,) = run_jobs(make_tasks(1, "numbers"), tmp_path / "out", workers=1).rows()
    assert (row["n"], row["x"], row["list"]) == (0, 0.1, [0, 1, 2])


def test_progress_counts_up_to_the_end(tmp_path, make_tasks):
    seen = []
    run_jobs(make_tasks(7), tmp_path / "out", workers=2, progress=seen.append)
    assert [counts.done for counts in seen] == sorted(counts.done for counts in seen)
    assert (seen[0].done, seen[0].total, seen[-1].done) == (0, 7, 7)


def test_a_study_may_run_beside_the_main_thread(tmp_path, make_tasks):
    results = []
    thread = threading.Thread(
        target=lambda: results.append(run_jobs(make_tasks(4), tmp_path / "out", workers=2))
    )
    thread.start()
    thread.join()
    assert results[0].counts().done == 4


def test_two_studies_in_one_folder_are_refused(tmp_path, make_tasks):
    refused = []

    def try_too(counts):
        if not refused:
            with pytest.raises(BadInput, match=r"another study \(process \d+ on .*\) is at work"):
                run_jobs(make_tasks(1), tmp_path / "out")
            refused.append(True)

    run_jobs(make_tasks(2), tmp_path / "out", workers=1, progress=try_too)
    assert refused


def test_results_are_read_while_the_study_goes_on(tmp_path, make_tasks):
    seen = []

    def look(counts):
        result = StudyResult(tmp_path / "out")
        seen.append((counts.done, len(list(result.rows()))))

    run_jobs(make_tasks(10, "slow"), tmp_path / "out", workers=2, progress=look)
    assert all(rows == done for done, rows in seen)
    assert any(0 < done < 10 for done, _ in seen)


def test_a_folder_that_holds_no_study_says_so(tmp_path):
    with pytest.raises(BadInput, match="holds no study"):
        StudyResult(tmp_path).counts()
    (tmp_path / NAME).write_text("this is no database, and long enough to be seen as none" * 20)
    with pytest.raises(BadInput, match="cannot be read"):
        StudyResult(tmp_path).counts()
    with pytest.raises(BadInput, match="cannot be read"):
        run_jobs([], tmp_path)


def test_a_ledger_of_another_format_is_left_alone(tmp_path, make_tasks):
    run_jobs(make_tasks(1), tmp_path / "out", workers=1)
    database = sqlite3.connect(tmp_path / "out" / NAME)
    database.execute("PRAGMA user_version = 7")
    database.close()
    with pytest.raises(BadInput, match="is of format 7; expected 2"):
        run_jobs(make_tasks(1), tmp_path / "out")


def test_a_folder_that_cannot_be_made_is_bad_input(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot be used"):
        run_jobs([], tmp_path / "file" / "out")


def test_a_ledger_at_rest_is_one_file_that_may_be_read_only(tmp_path, make_tasks):
    run_jobs(make_tasks(2), tmp_path / "out", workers=1)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        NAME, "runs.parquet", "study.lock"
    }  # fmt: skip


def test_the_environment_is_left_as_it_was(tmp_path, make_tasks):
    before, folder = dict(os.environ), Path.cwd()
    run_jobs(make_tasks(2), tmp_path / "out", workers=2)
    assert dict(os.environ) == before
    assert Path.cwd() == folder


def test_handlers_of_signals_are_given_back(tmp_path, make_tasks):
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    run_jobs(make_tasks(2), tmp_path / "out", workers=2)
    assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before


def test_workers_are_gone_when_the_study_is_through(tmp_path, make_tasks, log):
    run_jobs(make_tasks(6, "slow"), tmp_path / "out", workers=2)
    pids = {int(line.split()[1]) for line in log.read_text().splitlines()}
    assert len(pids) == 2
    deadline = time.monotonic() + 10.0
    while any(Path(f"/proc/{pid}").exists() and _runs(pid) for pid in pids):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def _runs(pid):
    try:
        return ") Z " not in Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False
