"""Pits, rooms and warehouses: sizes as asked for, ways wide enough."""

from __future__ import annotations

import numpy as np
import pytest

from worlds.arena import ImpossibleWorld
from worlds.catalogue import pit, rooms, warehouse
from worlds.obstacles import round_pit


def free_spans(world, at, *, across):
    """Lengths [m] of what is free along a line over the floor: at that y, or at that x."""
    length = world.arena.width if across else world.arena.height
    along = np.arange(0.0, length, 1e-3) + 5e-4
    line = np.full_like(along, at)
    points = np.column_stack([along, line] if across else [line, along])
    changes = np.flatnonzero(np.diff(np.r_[0, world.arena.is_free(points), 0]))
    return np.diff(changes.reshape(-1, 2), axis=1).ravel() * 1e-3


@pytest.mark.parametrize("door", [0.3, 0.9, 1.7])
@pytest.mark.parametrize("columns", [2, 4])
def test_doors_are_as_wide_as_asked_for(door, columns):
    world = rooms(columns=columns, rows=3, wall=0.2, door=door)
    room = (10.0 - 0.2 * (columns - 1)) / columns
    for wall in range(1, columns):
        x = wall * (room + 0.2) - 0.1
        assert free_spans(world, x, across=False) == pytest.approx([door] * 3, abs=2e-3)
    assert free_spans(world, 0.3, across=True) == pytest.approx([room] * columns, abs=2e-3)


def test_one_room_has_no_walls():
    assert rooms(columns=1, rows=1).arena.obstacles == ()


def test_shelves_and_aisles_are_as_asked_for():
    world = warehouse(columns=2, rows=3, length=1.5, depth=0.5, aisle=0.8)
    assert (world.arena.width, world.arena.height) == pytest.approx((5.4, 4.7))
    assert len(world.arena.obstacles) == 6
    assert all(s.signed_area() == pytest.approx(0.75) for s in world.arena.obstacles)
    assert free_spans(world, 1.0, across=True) == pytest.approx([0.8] * 3, abs=2e-3)
    assert free_spans(world, 1.5, across=False) == pytest.approx([0.8] * 4, abs=2e-3)


@pytest.mark.parametrize("sides", [3, 8, 64])
def test_a_pit_is_around_its_disc(sides):
    hole = round_pit(5.0, 4.0, 2.0, sides)
    turn = np.linspace(0.0, 2.0 * np.pi, 400)
    on_disc = np.column_stack([5.0 + 1.999 * np.cos(turn), 4.0 + 1.999 * np.sin(turn)])
    assert (hole.distance(on_disc) == 0.0).all()
    middles = 0.5 * (hole.outline() + np.roll(hole.outline(), 1, axis=0))
    assert np.hypot(*(middles - [5.0, 4.0]).T) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("world", "said"),
    [
        (rooms(door=0.3), "a door is 0.3 m, too narrow for robots of radius 0.2 m"),
        (warehouse(aisle=0.4), "an aisle is 0.4 m, too narrow"),
        (pit(radius=4.8), "the way past the pit is 0.2 m, too narrow"),
    ],
)
def test_robots_that_do_not_fit_through_are_refused(world, said):
    with pytest.raises(ImpossibleWorld, match=said):
        world.place(world.arena, 2, 0.2, np.random.default_rng(0))
    assert len(world.place(world.arena, 2, 0.0, np.random.default_rng(0))) == 2


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: rooms(columns=0), "columns is 0; expected 1 or more"),
        (lambda: rooms(door=3.5), "door is 3.5 m in rooms of 3.23 m"),
        (lambda: rooms(wall=0.0), "wall is 0.0 m; expected more than 0"),
        (lambda: warehouse(rows=0), "rows is 0; expected 1 or more"),
        (lambda: warehouse(aisle=-1.0), "aisle is -1.0 m; expected more than 0"),
        (lambda: pit(radius=5.0), "radius is 5.0 m; expected more than 0, and less than half"),
        (lambda: pit(sides=2), "sides is 2; expected 3 or more"),
    ],
)
def test_impossible_sizes_are_said(make, said):
    with pytest.raises(ValueError, match=said):
        make()
