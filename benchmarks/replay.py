"""What recording costs: ``python benchmarks/replay.py [--robots 100] [--repeat 7] [--rounds N]``.

Prints, for whole lifetimes under physics, the processor time of the run's own thread with and
without a recorder, that of the process which writes the file, the time of a whole cold command,
and the size of the file; then what a lifetime in straight motion and an hour of stream of 100
robots take to draw and to keep, and how much longer a viewer takes to show a recording than to
show nothing. Ratios count; milliseconds are those of this machine.

Aims, on an idle machine with two cores: --rrd adds 0.3 s to the command; 3 s of processor time to
draw the hour; 5 MB for 350 rounds in straight motion, 20 MB for the hour; 1.5 s for the viewer.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

from fleet.assembly import prepare
from fleet.observer import Observer
from fleet.replay import recorder
from fleet.scenario.loading import scenario_from


class Watches(Observer):
    """Sees everything, keeps nothing."""

    sample_interval = 0.05


def lifetime(scenario, observer):
    """The thread's and the wall time of one run [s], and what it came to."""
    simulation = prepare(scenario, [] if observer is None else [observer])
    thread, wall = time.thread_time(), time.perf_counter()
    summary = simulation.run()
    return time.thread_time() - thread, time.perf_counter() - wall, summary


def warm(scenario, path, repeat):
    """Median times by kind of observer, taken in turns so that all meet the same weather."""
    kinds = {
        "no observer": lambda: None,
        "an observer of 20 poses a second": Watches,
        "recorder": lambda: recorder(scenario, path),
    }
    times = {kind: [] for kind in kinds}
    children = []
    for _ in range(repeat + 1):
        for kind, make in kinds.items():
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            thread, wall, summary = lifetime(scenario, make())
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            times[kind].append((thread, wall))
            if kind == "recorder":
                spent = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
                children.append(spent)
    return {kind: [median(of) for of in zip(*t[1:], strict=True)] for kind, t in times.items()}, (
        median(children[1:]),
        summary,
    )


def cold(commands, repeat):
    """Median wall and processor time [s] of whole commands, taken in turns."""
    times = [[] for _ in commands]
    for _ in range(repeat + 1):
        for arguments, taken in zip(commands, times, strict=True):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            start = time.perf_counter()
            subprocess.run(
                [sys.executable, "-m", "fleet", "run", *arguments], check=True, capture_output=True
            )
            wall = time.perf_counter() - start
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            spent = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
            taken.append((wall, spent))
    return [[median(of) for of in zip(*taken[1:], strict=True)] for taken in times]


def drawn(settings, path):
    """Processor time of the process that draws [s], size of the file [MB], and the summary."""
    scenario = scenario_from(settings)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = prepare(scenario, [recorder(scenario, path)]).run()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
    return spent, path.stat().st_size / 1e6, summary


def first_picture(path):
    """Wall time [s] until a viewer is at rest: None for the one that shows nothing."""
    from fleet.replay.headless import HeadlessViewer

    start = time.perf_counter()
    with HeadlessViewer(1600, 900) as viewer:
        if path is not None:
            viewer.open(path)
        viewer.settle()
        return time.perf_counter() - start


def further(folder):
    """Streams, sizes, and the viewer."""
    from fleet.replay.headless import NoViewer

    straight, hour = folder / "straight.rrd", folder / "hour.rrd"
    spent, size, summary = drawn({"motion": "straight", "seed": 1}, straight)
    rounds = summary.lifetime
    print(
        f"\n(c) straight motion, {rounds} rounds: drawn in {spent:.2f} s of CPU, {size:.2f} MB,"
        f" {size / rounds * 350.0:.2f} MB for 350 rounds"
    )
    stream = {"name": "stream", "rate": 0.2, "duration": 3600.0}
    settings = {"motion": "path", "seed": 1, "time": stream, "robot": {"capacity": 1e6}}
    spent, size, summary = drawn(settings, hour)
    print(
        f"an hour of stream, {summary.events} events: drawn in {spent:.2f} s of CPU, {size:.2f} MB"
    )
    try:
        empty, full = first_picture(None), first_picture(straight)
    except NoViewer as reason:
        print(f"the viewer does not start here: {reason}")
        return
    print(f"(d) the viewer is at rest after {empty:.2f} s without a file, {full:.2f} s with one")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--repeat", type=int, default=15)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    side = (given.robots / 100.0) ** 0.5 * 10.0  # one robot to the square metre
    settings = {
        "motion": "physics", "robots": given.robots, "rounds": given.rounds, "seed": given.seed,
        "world": {"name": "random", "width": side, "height": side},
    }  # fmt: skip
    scenario = scenario_from({k: v for k, v in settings.items() if v is not None})
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.rrd"
        times, (writer, summary) = warm(scenario, path, given.repeat)
        size = path.stat().st_size
        command = ["--robots", str(given.robots), "--seed", str(given.seed), "--motion", "physics"]
        command += [f"--set=world.width={side}", f"--set=world.height={side}"]
        command += ["--rounds", str(given.rounds)] if given.rounds else []
        plain, recorded = cold([command, [*command, "--rrd", str(path)]], given.repeat)

    print(
        f"{given.robots} robots, {summary.lifetime} rounds, {summary.messages} messages,"
        f" {summary.simulated_time:.0f} s simulated\n"
    )
    print("(a) warm, in one process          thread        wall")
    base = times["no observer"][0]
    for kind, (thread, wall) in times.items():
        more = f"  {100.0 * (thread / base - 1.0):+5.1f} %" if thread != base else ""
        print(f"{kind:33} {1e3 * thread:7.1f} ms {1e3 * wall:8.1f} ms{more}")
    watched, kept = times["an observer of 20 poses a second"][0], times["recorder"][0]
    print(f"the recorder's own share          {1e3 * (kept - watched):7.1f} ms", end="")
    print(f"  {100.0 * (kept - watched) / base:+.1f} % of the run")
    print(f"the process that writes           {1e3 * writer:7.1f} ms, start and imports included")
    print("\n(b) the whole command, cold         wall   processor, all processes")
    for name, (wall, spent) in (("fleet run", plain), ("fleet run --rrd", recorded)):
        print(f"{name:33} {wall:7.2f} s {spent:7.2f} s")
    more, worked = (100.0 * (r / p - 1.0) for r, p in zip(recorded, plain, strict=True))
    print(f"{'recording adds':33} {more:+7.1f} % {worked:+7.1f} %")
    rounds = max(summary.lifetime, 1)
    print(f"\nfile {size / 1e6:.2f} MB, {size / 1e6 / rounds * 350.0:.2f} MB for 350 rounds")
    with tempfile.TemporaryDirectory() as folder:
        further(Path(folder))


if __name__ == "__main__":
    main()
