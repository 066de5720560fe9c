"""Occupancy maps: which cells count as free, and what stands on the floor."""

from __future__ import annotations

import numpy as np
import pytest

from worlds.arena import ImpossibleWorld
from worlds.catalogue import occupancy_map
from worlds.ground import ground_of
from worlds.occupancy import FREE, OCCUPIED, UNKNOWN, OccupancyGrid, large_areas


def grid(text, resolution=0.5):
    """A map drawn in text, upper row first: # occupied, ? unknown."""
    cells = {"#": OCCUPIED, "?": UNKNOWN, ".": FREE}
    rows = [[cells[c] for c in line] for line in text.split()]
    return OccupancyGrid(np.array(rows[::-1], np.int8), resolution)


def free_at(world, *points):
    return ground_of(world.arena, 0.0, world.start).holds(np.array(points)).tolist()


def test_the_floor_has_the_map_s_size_and_its_lower_row_first():
    world = occupancy_map(file=grid("#... .... ...."))
    assert (world.arena.width, world.arena.height) == (2.0, 1.5)
    assert free_at(world, (0.25, 1.25), (0.25, 0.25), (1.75, 1.25)) == [False, True, True]


def test_unknown_cells_count_as_asked_for():
    drawn = grid("??... ..... .....")
    assert free_at(occupancy_map(file=drawn), (0.25, 1.25)) == [False]
    assert free_at(occupancy_map(file=drawn, unknown="free"), (0.25, 1.25)) == [True]


def test_a_room_without_a_door_counts_as_occupied():
    world = occupancy_map(file=grid(".#... .#... .#..."))
    assert free_at(world, (0.25, 0.75), (1.75, 0.75)) == [False, True]


def test_small_areas_are_filled_and_touching_at_a_corner_does_not_join():
    blocks = np.kron(np.array([[1, 1, 0], [1, 0, 0], [0, 0, 1]]), np.ones((9, 9), int)) > 0
    blocks[13, 13] = True
    kept = large_areas(blocks)
    assert kept.sum() == 4 * 81
    assert not kept[13, 13]
    assert large_areas(blocks, (13, 13))[13, 13]
    assert not large_areas(np.zeros((2, 2), bool)).any()


def test_a_place_picks_the_area():
    drawn = grid(".#... .#... .#...")
    assert free_at(occupancy_map(file=drawn, start=(0.2, 0.7)), (0.25, 0.75), (1.75, 0.75)) == [
        True,
        False,
    ]


def test_positions_are_in_the_frame_of_the_map():
    drawn = OccupancyGrid(np.zeros((20, 20), np.int8), 0.5, corner=(-5.0, -3.0))
    world = occupancy_map(file=drawn, positions=np.array([[-4.0, -2.0], [4.0, 6.0]]))
    rng = np.random.default_rng(0)
    assert world.place(world.arena, 2, 0.1, rng).tolist() == [[1.0, 1.0], [9.0, 9.0]]
    assert (world.fixed, world.robots, world.arena.corner) == (True, 2, (-5.0, -3.0))
    with pytest.raises(ValueError, match=r"robot 1 starts at \(6, 0\); expected a place"):
        occupancy_map(file=drawn, positions=np.array([[-4.0, -2.0], [6.0, 0.0]]))
    with pytest.raises(ValueError, match="robot 0 starts at"):
        occupancy_map(file=drawn, positions=np.array([[np.nan, -2.0]]))


def test_a_tolerance_makes_fewer_corners_and_only_grows_what_stands():
    stairs = OccupancyGrid(np.where(np.tri(30, dtype=bool), OCCUPIED, FREE).astype(np.int8), 0.1)
    (exact,) = occupancy_map(file=stairs, tolerance=0.0).arena.obstacles
    (coarse,) = occupancy_map(file=stairs).arena.obstacles
    assert len(coarse.corners) < 8 < len(exact.corners)
    assert coarse.signed_area() > exact.signed_area()


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: OccupancyGrid(np.zeros((0, 3), np.int8), 0.1), "a map of shape"),
        (lambda: OccupancyGrid(np.zeros((2, 3), np.int8), 0.0), "resolution is 0.0 m"),
        (lambda: occupancy_map(file=grid(".."), tolerance=-1.0), "tolerance is -1.0 m"),
    ],
)
def test_impossible_maps_are_said(make, said):
    with pytest.raises(ValueError, match=said):
        make()


def test_a_map_without_free_floor_is_no_world():
    with pytest.raises(ImpossibleWorld, match="no cell of the map is free"):
        occupancy_map(file=grid("?# ##"))
