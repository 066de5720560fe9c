"""What a study costs beyond its runs: ratios within one run, on whatever machine this is.

python benchmarks/study.py [overhead] [workers] [plan] [cluster]
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from fleet.motion.motions import MOTIONS
from fleet.study import Job, run_jobs
from fleet.study.job import Outcome
from fleet.study.ledger import reading
from fleet.study.open_ledger import writing
from fleet.study.study_file import study_from
from fleet.study.sweeping import sweep

TURNS = 3  # of which the fastest counts: others may be at work on the machine
FOLDER = Path(__file__).resolve().parent


def nothing(job):
    """A work function that does none."""
    return {"seed": job.scenario["seed"]}


def busy(job):
    """A work function that takes 25 ms of a core, as a short run does."""
    end = time.process_time() + 0.025
    while time.process_time() < end:
        pass
    return {"seed": job.scenario["seed"]}


def idle_tasks(count, function):
    return [Job.of({"seed": seed}, function=f"study:{function}") for seed in range(count)]


def timed(run):
    started = time.perf_counter()
    result = run()
    return time.perf_counter() - started, result


class Rate:
    """Runs a second, once the workers are warm."""

    def __init__(self, warm):
        self.warm, self.marks = warm, []

    def __call__(self, counts):
        self.marks += [time.perf_counter()] * (counts.done - len(self.marks))

    def value(self):
        return (len(self.marks) - 1 - self.warm) / (self.marks[-1] - self.marks[self.warm])


def overhead():
    """Time a job beyond what its worker spends in it, from the first job to the last."""
    for function, count, named in (
        ("nothing", 3000, "that do nothing"), ("busy", 300, "of 25 ms of a core")
    ):  # fmt: skip
        with tempfile.TemporaryDirectory() as out:
            rate = Rate(warm=10)
            result = run_jobs(idle_tasks(count, function), out, workers=1, progress=rate)
            assert result.counts().done == count
            with reading(Path(out)) as ledger:
                inside = ledger.seconds() / count
        print(f"jobs {named}: {1e3 * (1.0 / rate.value() - inside):.2f} ms a job beyond them")


def workers():
    """How much faster two processes are than one, on runs as they are."""
    for motion, seeds, rounds in (("straight", 100, None), ("physics", 100, None)):
        if motion not in MOTIONS:
            print(f"{motion}: there is none")
            continue
        scenario = {"motion": motion} | ({"rounds": rounds} if rounds else {})
        rates = {1: 0.0, 2: 0.0}
        with tempfile.TemporaryDirectory() as out:
            for turn, number in enumerate((1, 2) * TURNS):
                rate = Rate(warm=2 * number)
                study = {"scenario": scenario, "seeds": seeds}
                sweep(study, f"{out}/{turn}", workers=number, progress=rate)
                rates[number] = max(rates[number], rate.value())
        print(
            f"{motion}: {rates[1]:.1f} runs/s in one process, {rates[2]:.1f} in two:"
            f" {rates[2] / rates[1]:.2f} times"
        )


def plan():
    """100 000 jobs: planned, and gone on with when all but ten are done."""
    study = study_from(
        {
            "scenario": {"motion": "straight"},
            "axes": {"range": [1.5 + 0.01 * k for k in range(100)]},
            "seeds": 1000,
        }
    )
    with tempfile.TemporaryDirectory() as out:
        folder = Path(out)
        with writing(folder) as ledger:
            first, _ = timed(lambda: ledger.plan(study.jobs()))
            row = json.dumps({f"figure_{n}": n / 7 for n in range(36)})
            ledger.record(Outcome(key, "done", row, {}, "", 1, 0.02) for key in ledger.todo()[:-10])

        def resume():
            with writing(folder) as ledger:
                ledger.plan(study.jobs())
                return len(ledger.todo()), ledger.counts()

        again, (left, counts) = timed(resume)
        assert (left, counts.done) == (10, 99_990)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"100 000 jobs: planned in {first:.1f} s, gone on with in {again:.1f} s, {memory:.0f} MiB"
    )


def cluster():
    """Throughput on a Dask cluster of two workers on the loopback, against two local ones."""
    with tempfile.TemporaryDirectory() as out:
        file = Path(out) / "scheduler.json"
        path = os.pathsep.join([str(FOLDER), *filter(None, sys.path)])

        def start(*arguments):
            return subprocess.Popen(
                [sys.executable, "-m", "dask", *arguments, "--scheduler-file", str(file),
                 "--no-dashboard", "--host", "127.0.0.1"],
                env={**os.environ, "PYTHONPATH": path}, cwd=out,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            )  # fmt: skip

        processes = [start("scheduler", "--port", "0")]
        while not file.exists():
            time.sleep(0.1)
        processes += [start("worker", "--nthreads", "1") for _ in range(2)]
        time.sleep(5.0)
        try:
            address = json.loads(file.read_text())["address"]
            rates = {None: 0.0, address: 0.0}
            study = {"scenario": {"motion": "straight"}, "seeds": 300}
            for turn, where in enumerate((None, address) * TURNS):
                rate = Rate(warm=40)
                sweep(study, f"{out}/{turn}", workers=2, scheduler=where, progress=rate)
                rates[where] = max(rates[where], rate.value())
        finally:
            for process in reversed(processes):
                process.terminate()
                process.wait()
    here, there = rates[None], rates[address]
    print(f"straight: {here:.1f} runs/s here, {there:.1f} on Dask: {there / here:.2f} times")


if __name__ == "__main__":
    sys.path.insert(0, str(FOLDER))
    chosen = sys.argv[1:] or ["overhead", "workers", "plan", "cluster"]
    for name in chosen:
        {"overhead": overhead, "workers": workers, "plan": plan, "cluster": cluster}[name]()
