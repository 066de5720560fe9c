"""Logs of real robots: how fast they are judged, and, of a folder of one's own, how well.

    python benchmarks/logs.py [FOLDER [k,R,bias [track]]]

An hour at 100 Hz is made, read and judged. A folder of grounds is judged ground by ground.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from fleet.logs.asking import LogSettings, motor_constants
from fleet.logs.gathering import gather
from fleet.logs.judging import judge
from fleet.logs.log_report import write

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from driven_logs import logged, table


def hour(folder: Path) -> None:
    columns = logged(0, seconds=3600.0, rate=100.0)
    rng = np.random.default_rng(0)
    for name, noise in (("v", 0.01), ("omega", 0.02), ("power", 1.0)):
        columns[name] = columns[name] + noise * rng.standard_normal(len(columns[name]))
    path = table(folder / "hour.csv", columns)
    begin = time.process_time()
    write(judge(gather([path])[0]), folder / "out")
    took = time.process_time() - begin
    print(f"an hour at 100 Hz, {path.stat().st_size / 1e6:.0f} MB: {took:.1f} s of CPU")


def grounds(folder: Path, motor: str | None, track: float | None) -> None:
    constants = motor_constants(motor) if motor else None
    for ground in gather([folder], LogSettings(motor=constants, track=track)):
        judged = judge(ground)
        for name, found in (("distance", judged.linear), ("fitted", judged.best.left_out),
                            ("forces", judged.preset.left_out)):  # fmt: skip
            print(
                f"{ground.name:10} {name:8} {len(found.energy)} trips, within 10 %:"
                f" {100 * found.within(0.1):.0f} %, half within {100 * found.median:.1f} %, total"
                f" {100 * found.total:+.1f} %"
            )


def main(folder: str = "", motor: str = "", track: str = "") -> None:
    with tempfile.TemporaryDirectory() as scratch:
        hour(Path(scratch))
    if folder:
        grounds(Path(folder), motor or None, float(track) if track else None)


if __name__ == "__main__":
    main(*sys.argv[1:])
