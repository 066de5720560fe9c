"""A log that no file format says: three wheels and three motor currents, judged from arrays.

A robot on omni-wheels drives a few minutes; its log holds wheel speeds and currents. Speed, turning
rate and power are worked out here, and the runs are judged as files are.
"""

import sys
from pathlib import Path

import numpy as np

from fleet.logs.asking import LogSettings
from fleet.logs.grounds import ground_from_runs, run_from_arrays
from fleet.logs.judging import judge
from fleet.logs.log_report import write
from fleet.logs.sentences import verdict_sentence

RESISTANCE, K, LEVER = 5.95, 20.6, 0.135  # ohm, V·s/m at the rim, m from the middle to a wheel
ANGLES = np.radians([60.0, 180.0, 300.0])


def recorded(seed: int, rate: float = 30.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stands in for your recorder: times (n,), wheel speeds (n, 3) [m/s], currents (n, 3) [A]."""
    rng = np.random.default_rng(seed)
    v, omega = np.zeros(round(120 * rate)), np.zeros(round(120 * rate))
    at = round(2 * rate)
    while at < len(v):
        until = at + round(rng.uniform(4.0, 9.0) * rate)
        v[at:until] = rng.uniform(0.1, 0.3)
        omega[at:until] = rng.choice([0.0, 0.6, -0.6])
        at = until + round(2 * rate)
    wheels = -np.sin(ANGLES) * v[:, None] + LEVER * omega[:, None]
    currents = np.sign(wheels) * 0.9 + 0.02 * rng.standard_normal(wheels.shape)
    return np.arange(len(v)) / rate, wheels, currents


def run_of(name: str, time: np.ndarray, wheels: np.ndarray, currents: np.ndarray):
    """Speed and turning rate by the wheels' geometry, power by the motors' constants."""
    geometry = np.column_stack([-np.sin(ANGLES), np.cos(ANGLES), np.full(3, LEVER)])
    ahead, aside, turning = np.linalg.solve(geometry, wheels.T)
    power = (K * wheels * currents + RESISTANCE * currents**2).sum(axis=1)
    return run_from_arrays(time, np.hypot(ahead, aside), turning, power, name)


def main(out: Path = Path("out/own-log")) -> None:
    runs = [run_of(f"run {seed}", *recorded(seed)) for seed in range(6)]
    judgement = judge(ground_from_runs("carpet", runs, LogSettings(mass=20.0)))
    print(verdict_sentence(judgement))
    for term, (value, low, high) in judgement.intervals.items():
        print(f"{term:9} {value:7.2f} [{low:.2f}, {high:.2f}]")
    print(f"Report: {write(judgement, out)}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
