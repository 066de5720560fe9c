"""Plans on ragged floors, measured: python benchmarks/planning.py [ROWS COLUMNS ROOMS].

Rooms with doors and crates whose outlines are as a noisy laser draws them, at 5 cm a cell, and
100 robots of radius 0.1 m that rest. 1,000 plans to sites all over the floor, each forgotten at
once; CPU time. Aims in brackets.
"""

from __future__ import annotations

import sys
from itertools import islice
from time import process_time

import numpy as np

from fleet.motion.options import DriveOptions
from fleet.motion.planning import Planner
from worlds.catalogue import occupancy_map
from worlds.events import uniform_sites
from worlds.ground import ground_of
from worlds.occupancy import FREE, OCCUPIED, OccupancyGrid
from worlds.scattering import scatter

RADIUS, ROBOTS, PLANS = 0.1, 100, 1000


def floor(rows, columns, rooms, seed=1):
    """The map as a world."""
    rng = np.random.default_rng(seed)
    occupied = np.zeros((rows, columns), bool)
    occupied[:2] = occupied[-2:] = occupied[:, :2] = occupied[:, -2:] = True
    for x in np.linspace(0, columns, rooms + 1)[1:-1].astype(int):
        occupied[:, x : x + 2] = True
        door = rng.integers(10, rows - 35)
        occupied[door : door + 20, x : x + 2] = False
    for _ in range(rows * columns // 2500):
        y, x = rng.integers(0, rows - 8), rng.integers(0, columns - 8)
        occupied[y : y + rng.integers(2, 8), x : x + rng.integers(2, 8)] = True
    around = np.pad(occupied, 1)
    beside = around[:-2, 1:-1] | around[2:, 1:-1] | around[1:-1, :-2] | around[1:-1, 2:]
    occupied |= beside & (rng.random(occupied.shape) < 0.4)
    cells = np.where(occupied, OCCUPIED, FREE).astype(np.int8)
    return occupancy_map(file=OccupancyGrid(cells, 0.05), tolerance=0.0)


def main(rows=480, columns=820, rooms=6):
    world, rng = floor(rows, columns, rooms), np.random.default_rng(2)
    places = [(x, y) for x, y in scatter(world.arena, ROBOTS, RADIUS, rng).tolist()]
    sites = list(islice(uniform_sites(ground_of(world.arena, RADIUS), rng), PLANS + 1))
    planner = Planner(world.arena, RADIUS, places, DriveOptions().clearances)
    print(f"corners {sum(len(p.corners) for p in world.arena.obstacles)}")
    began = process_time()
    planner.plan(0, places[0], sites[0])
    print(f"first plan {process_time() - began:.2f} s")
    took, none = [], 0
    for k, site in enumerate(sites[1:]):
        planner.changed()
        began = process_time()
        none += planner.plan(k % ROBOTS, places[k % ROBOTS], site).segments is None
        took.append(1e3 * (process_time() - began))
    print(f"{PLANS} plans {sum(took) / 1e3:.2f} s [1], {none} without a way")
    median, most = np.quantile(took, [0.5, 0.99])
    print(f"a plan: median {median:.2f} ms, 99 % {most:.1f} ms, worst {max(took):.1f} ms [50]")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
