"""Floors, shapes, starting places and sites."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from worlds.arena import Arena, ImpossibleWorld
from worlds.catalogue import EVENTS, WORLDS, placed, random_hole
from worlds.events import trace, uniform_sites
from worlds.ground import ground_of
from worlds.scattering import given as place_given
from worlds.scattering import scatter
from worlds.shapes import Disc, Polygon, square

L_SHAPE = Polygon(((0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)))
OPEN = ground_of(Arena(), 0.0)
FREE_OF_FILES = sorted(set(WORLDS) - {"map", "placed"})


@pytest.mark.parametrize("name", FREE_OF_FILES)
def test_every_world_starts_robots_where_they_have_room(name):
    world = WORLDS[name].function()
    places = world.place(world.arena, 60, 0.1, np.random.default_rng(1))
    assert places.shape == (60, 2)
    gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + 9.0 * np.eye(60)
    assert gaps.min() > 0.2
    size = np.array([world.arena.width, world.arena.height])
    assert ((places >= 0.1) & (places <= size - 0.1)).all()
    for shape in world.arena.shapes:
        assert (shape.distance(places) > 0.0).all()
    for obstacle in world.arena.obstacles:
        assert (obstacle.distance(places) >= 0.1).all()


@pytest.mark.parametrize("name", FREE_OF_FILES)
@pytest.mark.parametrize("process", sorted(set(EVENTS) - {"trace"}))
def test_events_fall_on_the_floor_in_order_and_not_into_obstacles(name, process):
    arena = WORLDS[name].function().arena
    happening = EVENTS[process].function(
        ground_of(arena, 0.0), 0.5, *map(np.random.default_rng, (2, 3))
    )
    drawn = [next(happening) for _ in range(600)]
    places = np.array([occurrence.position for occurrence in drawn])
    times = np.array([occurrence.time for occurrence in drawn])
    assert ((places >= 0.0) & (places <= [arena.width, arena.height])).all()
    for obstacle in arena.obstacles:
        assert (obstacle.distance(places) > 0.0).all()
    assert (np.diff(times) >= 0.0).all()
    assert 600 / times[-1] == pytest.approx(0.5, rel=0.35)


def test_a_poisson_process_forgets():
    """Gaps are exponential: as spread as long on average."""
    happening = EVENTS["uniform"].function(OPEN, 2.0, *map(np.random.default_rng, (4, 5)))
    gaps = np.diff([0.0, *(next(happening).time for _ in range(4000))])
    assert gaps.mean() == pytest.approx(0.5, rel=0.05)
    assert gaps.std() == pytest.approx(0.5, rel=0.08)


def test_bursts_and_hot_spots_cluster():
    def nearest(process):
        arena = Arena(40.0, 40.0)
        happening = EVENTS[process].function(
            ground_of(arena, 0.0), 0.5, *map(np.random.default_rng, (6, 7))
        )
        places = np.array([next(happening).position for _ in range(300)])
        gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + 99.0 * np.eye(300)
        return gaps.min(axis=1).mean()

    assert nearest("bursts") < 0.7 * nearest("uniform")
    assert nearest("hot-spots") < 0.7 * nearest("uniform")


def test_a_trace_says_when_where_and_for_how_long():
    rows = np.array([[5.0, 1.0, 2.0, np.nan, 9.0], [3.0, 4.0, 4.0, 2.0, np.nan]])
    drawn = list(trace(OPEN, 1.0, None, None, occurrences=rows))
    assert [(o.time, o.position) for o in drawn] == [(3.0, (4.0, 4.0)), (5.0, (1.0, 2.0))]
    assert [(o.service, o.deadline) for o in drawn] == [(2.0, None), (None, 9.0)]
    with pytest.raises(ValueError, match="outside the arena"):
        list(trace(OPEN, 1.0, None, None, occurrences=np.array([[1.0, 11.0, 2.0]])))
    with pytest.raises(ValueError, match="2 columns"):
        list(trace(OPEN, 1.0, None, None, occurrences=np.array([[1.0, 1.0]])))


def test_events_fall_into_the_hole_too():
    world = random_hole()
    sites = uniform_sites(ground_of(world.arena, 0.0), np.random.default_rng(3))
    drawn = np.array([next(sites) for _ in range(2000)])
    share = (world.arena.hole.distance(drawn) == 0.0).mean()
    assert share == pytest.approx(np.pi * 2.5**2 / 100.0, abs=0.03)


def test_without_bodies_the_placement_is_uniform():
    places = scatter(Arena(), 5000, 0.0, np.random.default_rng(4))
    assert places.mean(axis=0) == pytest.approx([5.0, 5.0], abs=0.15)
    assert places.std(axis=0) == pytest.approx([10 / 12**0.5] * 2, abs=0.1)


@pytest.mark.parametrize(
    ("arena", "count", "radius"),
    [
        (Arena(1.0, 1.0), 50, 0.2),
        (Arena(1.0, 1.0), 1, 0.6),
        (Arena(hole=square(5.0, 5.0, 20.0)), 3, 0.0),
    ],
    ids=["crowded", "too big", "all hole"],
)
def test_what_does_not_fit_is_said(arena, count, radius):
    with pytest.raises(ImpossibleWorld, match=r"do not fit|no room"):
        scatter(arena, count, radius, np.random.default_rng(5))


def test_obstacles_everywhere_leave_no_events():
    with pytest.raises(ImpossibleWorld, match="has no room anywhere"):
        ground_of(Arena(obstacles=(square(5.0, 5.0, 20.0),)), 0.0)
    speck = Arena(
        1000.0, 1000.0, obstacles=(Polygon(((0, 0), (1000, 0), (1000, 999.9), (0, 1000))),)
    )
    with pytest.raises(ImpossibleWorld, match="too small a part"):
        next(uniform_sites(ground_of(speck, 0.04), np.random.default_rng(6)))


def test_given_places_are_kept_or_refused():
    places = np.array([[1.0, 1.0], [1.1, 1.0], [5.0, 5.0]])
    rng = np.random.default_rng(7)
    assert place_given(places, Arena(), 2, 0.0, rng).tolist() == places[:2].tolist()
    with pytest.raises(ImpossibleWorld, match="robots is 4; expected 3 or fewer"):
        place_given(places, Arena(), 4, 0.0, rng)
    with pytest.raises(ImpossibleWorld, match="robot 1 of radius"):
        place_given(places, Arena(), 3, 0.1, rng)
    with pytest.raises(ValueError, match="robot 2 starts at"):
        placed(positions=places, width=3.0)


coordinate = st.floats(-2.0, 6.0)


@given(coordinate, coordinate)
def test_distance_to_a_polygon_is_that_to_its_nearest_point(x, y):
    outline = L_SHAPE.outline()
    dense = np.vstack(
        [a + t * (b - a) for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True)
         for t in np.linspace(0.0, 1.0, 60)]
    )  # fmt: skip
    inside = (0 < x < 4 and 0 < y < 1) or (0 < x < 1 and 0 < y < 3)
    distance = L_SHAPE.distance(np.array([[x, y]]))[0]
    expected = 0.0 if inside else np.hypot(*(dense - [x, y]).T).min()
    assert distance == pytest.approx(expected, abs=0.04)


def test_shapes_tell_their_outline_and_bounds():
    disc = Disc(1.0, 2.0, 0.5)
    assert np.hypot(*(disc.outline() - [1.0, 2.0]).T) == pytest.approx(0.5)
    assert disc.bounds() == ((0.5, 1.5), (1.5, 2.5))
    clockwise = Polygon(L_SHAPE.corners[::-1])
    assert Polygon(tuple(map(tuple, clockwise.outline().tolist()))).signed_area() == 6.0
    assert clockwise.bounds() == ((0.0, 0.0), (4.0, 3.0))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Disc(0, 0, 0.0), "disc radius"),
        (lambda: Polygon(((0.0, 0.0), (1.0, 1.0))), "2 corners"),
        (lambda: Polygon(((0.0, 0.0), (1.0, 1.0), (2.0, 2.0))), "no area"),
        (lambda: Arena(width=0.0), "arena width"),
        (lambda: Arena(hole=Disc(30.0, 30.0, 1.0)), "lies outside"),
    ],
    ids=["disc", "two corners", "flat", "arena", "outside"],
)
def test_impossible_shapes_are_refused(make, said):
    with pytest.raises(ValueError, match=said):
        make()
