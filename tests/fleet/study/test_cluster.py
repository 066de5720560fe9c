"""The same study on a Dask cluster: the same results, the same isolation."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fleet.study import BrokenOff, StudyResult, run_jobs
from fleet.study.sweeping import sweep

pytest.importorskip("distributed", reason="dask.distributed is not installed: the extra 'cluster'")


class Cluster:
    """A scheduler and its workers, each a process of its own on the loopback."""

    def __init__(self, folder):
        self.folder = folder
        self.file = folder / "scheduler.json"
        self.processes = []
        self.scheduler = self.start("scheduler", "--host", "127.0.0.1", "--port", "0")
        deadline = time.monotonic() + 30.0
        while not self.file.exists() or not self.file.read_text().endswith("}"):
            assert self.scheduler.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
        self.address = json.loads(self.file.read_text())["address"]

    def worker(self, *options):
        return self.start("worker", "--nthreads", "1", "--host", "127.0.0.1", *options)

    def start(self, kind, *options):
        path = os.pathsep.join([str(Path(__file__).parent), *filter(None, sys.path)])
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", kind, "--scheduler-file", str(self.file),
             "--no-dashboard", *options],
            cwd=self.folder, env={**os.environ, "PYTHONPATH": path}, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.processes.append(process)
        return process

    def close(self):
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    cluster.worker()
    cluster.worker("--no-nanny")
    yield cluster
    cluster.close()


@pytest.fixture
def own_cluster(tmp_path_factory):
    """A cluster that a test may break."""
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    yield cluster
    cluster.close()


pytestmark = pytest.mark.slow


def test_a_cluster_finds_what_one_machine_finds_to_the_bit(cluster, tmp_path):
    study = {
        "scenario": {"motion": "straight", "rounds": 30},
        "axes": {"protocol": ["rfta2", "gfgf2a"]},
        "seeds": 6,
        "tables": ["rounds"],
    }
    there = sweep(study, tmp_path / "there", scheduler=cluster.address)
    here = sweep(study, tmp_path / "here", workers=2)
    assert here.table("rounds").equals(there.table("rounds"))
    for a, b in zip(here.rows(), there.rows(), strict=True):
        assert a | {"wall_time": 0} == b | {"wall_time": 0}


def test_each_task_is_run_once_and_the_study_goes_on_here(cluster, tmp_path, make_tasks, calls):
    run_jobs(make_tasks(40), tmp_path / "out", scheduler=cluster.address)
    assert sorted(calls()) == list(range(40))
    run_jobs(make_tasks(60), tmp_path / "out", workers=2)
    assert sorted(calls()) == list(range(60))


@pytest.mark.parametrize(
    ("deed", "status", "said"),
    [
        ("raise", "raised", "bad physics"),
        ("exit", "killed", "code 7"),
        ("segfault", "killed", "SIGSEGV"),
        ("kill", "killed", "SIGKILL"),
    ],
)
def test_a_task_that_kills_is_blamed_alone(
    cluster, tmp_path, make_tasks, calls, deed, status, said
):
    jobs = make_tasks(25, "deadly", victim=4, deed=deed)
    result = run_jobs(jobs, tmp_path / "out", scheduler=cluster.address)
    (failure,) = result.failures()
    assert (failure.key, failure.status) == (jobs[4].key, status)
    assert said in failure.error
    assert result.counts() == (25, 24, 1)
    assert sorted(calls()) == [n for n in range(25) if n != 4]


def test_a_lost_worker_costs_nothing(own_cluster, tmp_path, make_tasks, log):
    own_cluster.worker("--no-nanny")
    doomed = own_cluster.worker("--no-nanny")
    killed = []

    def kill(counts):
        if counts.done >= 10 and not killed:
            killed.append(doomed.pid)
            os.killpg(doomed.pid, signal.SIGKILL)

    result = run_jobs(
        make_tasks(60, "slow"), tmp_path / "out", scheduler=own_cluster.address, progress=kill
    )
    assert killed
    assert result.counts() == (60, 60, 0)
    assert sorted(row["n"] for row in result.rows()) == list(range(60))


def test_a_lost_scheduler_is_said_and_nothing_done_is_lost(own_cluster, tmp_path, make_tasks):
    own_cluster.worker("--no-nanny")

    def kill(counts):
        if counts.done >= 10:
            own_cluster.scheduler.kill()

    with pytest.raises(BrokenOff, match="the Dask scheduler is lost"):
        run_jobs(
            make_tasks(200, "slow"), tmp_path / "out", scheduler=own_cluster.address, progress=kill
        )
    assert StudyResult(tmp_path / "out").counts().done >= 10
    assert run_jobs(make_tasks(30, "slow"), tmp_path / "out").counts() == (30, 30, 0)


def test_workers_of_another_version_are_refused(cluster, tmp_path, make_tasks, monkeypatch):
    for module in ("inputs", "runner", "cluster"):
        monkeypatch.setattr(f"fleet.study.{module}.program_version", lambda: "9.9+other")
    with pytest.raises(BrokenOff, match=r"a Dask worker runs .*, and the study 9\.9\+other"):
        run_jobs(make_tasks(3), tmp_path / "out", scheduler=cluster.address)


def test_a_cluster_without_workers_is_given_up(own_cluster, tmp_path, make_tasks, monkeypatch):
    monkeypatch.setattr("fleet.study.cluster.PATIENCE", 1.0)
    with pytest.raises(BrokenOff, match="has had no worker for 1 s"):
        run_jobs(make_tasks(3), tmp_path / "out", scheduler=own_cluster.address)


def test_an_address_that_is_none(tmp_path, make_tasks, monkeypatch):
    monkeypatch.setattr("fleet.study.cluster.ANSWER", 0.5)
    with pytest.raises(BrokenOff, match="no Dask scheduler answers at 'nonsense'"):
        run_jobs(make_tasks(1), tmp_path / "out", scheduler="nonsense")
