"""How fast a recording is scrubbed through: ``python benchmarks/scrubbing.py [--repeat 20]``.

The native viewer, without a window, is sent from moment to moment of two recordings, one of 100
robots and one of 1000, and draws each: by simulated time while a robot drives, and message by
message. What is compared is the time of a picture. Here it is drawn by the processor unless there
is a graphics card; that share is the same for both.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path
from statistics import median

from fleet.assembly import run
from fleet.replay import recorder
from fleet.replay.headless import HeadlessViewer, NoViewer
from fleet.scenario.loading import scenario_from

ROBOTS = (100, 1000)


def recorded(robots, path):
    """40 rounds of RFTA2 in physics, at one robot a square metre."""
    side = robots**0.5
    settings = {
        "motion": "physics", "robots": robots, "rounds": 40, "seed": 1,
        "world": {"name": "random", "width": side, "height": side},
    }  # fmt: skip
    scenario = scenario_from(settings)
    return run(scenario, [recorder(scenario, path)])


def pictures(viewer, timeline, moments):
    """Seconds for each picture."""
    took = []
    for moment in moments:
        began = time.perf_counter()
        viewer.scrub(timeline, **moment)
        took.append(time.perf_counter() - began)
    return took


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--repeat", type=int, default=20, help="pictures on each timeline")
    count = parser.parse_args().repeat
    times = {}
    with tempfile.TemporaryDirectory() as folder:
        for robots in ROBOTS:
            path = Path(folder) / f"{robots}.rrd"
            summary = recorded(robots, path)
            try:
                viewer = HeadlessViewer(1600, 900)
            except NoViewer as reason:
                print(f"the viewer does not start here: {reason}")
                return
            with viewer:
                viewer.open(path)
                halfway = summary.simulated_time / 2.0
                viewer.go("sim_time", duration=halfway)
                by_time = [{"duration": halfway + 0.1 * k} for k in range(count)]
                by_msg = [{"sequence": summary.messages // 2 + k} for k in range(count)]
                times[robots] = [
                    median(pictures(viewer, timeline, moments))
                    for timeline, moments in (("sim_time", by_time), ("msg", by_msg))
                ]
            size = path.stat().st_size / 1e6
            print(
                f"{robots:5} robots, {size:.1f} MB: a picture by sim_time"
                f" {1e3 * times[robots][0]:4.0f} ms, by msg {1e3 * times[robots][1]:4.0f} ms"
            )
    few, many = (times[robots] for robots in ROBOTS)
    ratios = ", ".join(f"{b / a:.2f}" for a, b in zip(few, many, strict=True))
    print(f"ten times the robots take {ratios} times as long")


if __name__ == "__main__":
    main()
