"""Network lifetimes per second and core, and what one moved robot costs the topology.

Aims: at least 25 RFTA2 lifetimes a second (straight, 100 robots, r = 2.5 m, warm); a moved robot
in under 50 µs whatever the size of the fleet.
"""

from __future__ import annotations

import time

import numpy as np

import fleet
from protocols.topology import Topology

REPEATS = 20


def lifetimes(**keys: object) -> tuple[float, float]:
    """Lifetimes a CPU second, and microseconds a round."""
    scenarios = [fleet.Scenario.of(seed=seed, **keys) for seed in range(REPEATS)]
    fleet.run(scenarios[0])
    started = time.process_time()
    rounds = sum(fleet.run(scenario).lifetime for scenario in scenarios)
    spent = time.process_time() - started
    return REPEATS / spent, 1e6 * spent / rounds


def main() -> None:
    import numba  # noqa: F401  # as in a campaign's worker, where the topology is compiled

    print("lifetimes per CPU second (100 robots, r = 2.5 m, warm)")
    base = 0.0
    for protocol in ("rfta2", "rfta2ge", "gfgf2a", "rfta3"):
        for motion in ("straight", "path", "physics"):
            rate, each = lifetimes(protocol=protocol, motion=motion)
            base = base or rate
            print(
                f"  {protocol:8} {motion:8} {rate:6.1f} lifetimes/s, {each:6.1f} µs a round,"
                f" {rate / base:.2f} × rfta2 straight"
            )
    print("a robot moved anywhere, its neighbourhood relinked (r = 2.5 m, 1 robot/m²)")
    first = 0.0
    for n in (100, 1_000, 10_000):
        rng = np.random.default_rng(n)
        side = float(n) ** 0.5
        start = [(x, y) for x, y in (side * rng.random((n, 2))).tolist()]
        live = Topology(start, 2.5, compiled=True)
        moves = [
            (int(robot), tuple(place))
            for robot, place in zip(
                rng.integers(0, n, 5000), (side * rng.random((5000, 2))).tolist(), strict=True
            )
        ]
        started = time.process_time()
        for robot, place in moves:
            live.move(robot, place)
        each = 1e6 * (time.process_time() - started) / len(moves)
        first = first or each
        print(f"  {n:6} robots: {each:5.1f} µs, {each / first:.2f} × that of 100")


if __name__ == "__main__":
    main()
