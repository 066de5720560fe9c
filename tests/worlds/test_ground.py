"""The floor of a body: it fits wherever it is put, and gets everywhere else from there."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt, label

from worlds.arena import Arena, ImpossibleWorld
from worlds.catalogue import occupancy_map
from worlds.events import hot_spots, trace, uniform
from worlds.ground import ROOM, ground_of
from worlds.occupancy import FREE, OCCUPIED, OccupancyGrid
from worlds.scattering import DENSEST, scatter
from worlds.scattering import given as place_given
from worlds.shapes import Polygon

FINE = 0.02  # [m] of the oracle's raster
CELL = 0.3  # [m] of the maps
unhurried = settings(deadline=None, max_examples=15)


def drawn_map(seed, share=0.35, side=8):
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((side, side)) < share, OCCUPIED, FREE).astype(np.int8)
    return occupancy_map(file=OccupancyGrid(cells, CELL), tolerance=0.0)


def clearance(arena, points):
    """How far points (k, 2) are from obstacles and walls, polygon by polygon [m]."""
    away = np.minimum(points, [arena.width, arena.height] - points).min(axis=1)
    for polygon in arena.obstacles:
        away = np.minimum(away, polygon.distance(points))
    return away


def rasterised(arena, room):
    """Where a centre keeps ``room`` from everything, on a fine raster, by areas; slow and plain."""
    x, y = (np.arange(0.5 * FINE, size, FINE) for size in (arena.width, arena.height))
    points = np.stack(np.meshgrid(x, y), axis=-1)
    away = clearance(arena, points.reshape(-1, 2)).reshape(points.shape[:2])
    return label(away >= room)[0]


def cells_of(points):
    return tuple((points // FINE).astype(int).T[::-1])


@unhurried
@given(st.integers(0, 2**31), st.sampled_from([0.08, 0.14, 0.2]))
def test_whoever_is_placed_fits_and_gets_to_all_the_others(seed, radius):
    world = drawn_map(seed)
    try:
        ground = ground_of(world.arena, radius)
        sites = [o.position for o in islice(uniform(ground, 1.0, *rngs(seed)), 40)]
        places = scatter(world.arena, 3, radius, np.random.default_rng(seed))
    except ImpossibleWorld:
        return
    points = np.vstack([sites, places])
    assert (clearance(world.arena, points) >= radius).all()
    # The raster misses at most its diagonal: what keeps less than this apart is one area.
    areas = rasterised(world.arena, radius - FINE)
    assert len(np.unique(areas[cells_of(points)])) == 1
    assert areas[cells_of(points)].all()


@unhurried
@given(st.integers(0, 2**31), st.sampled_from([0.08, 0.2]))
def test_no_place_of_the_largest_area_is_left_out(seed, radius):
    world = drawn_map(seed)
    areas = rasterised(world.arena, radius + ROOM + FINE)
    sizes = np.bincount(areas.ravel())[1:]
    if not len(sizes) or sizes.max() * FINE**2 < 0.05:
        return
    ground = ground_of(world.arena, radius)
    middles = (np.argwhere(areas == 1 + np.argmax(sizes))[:, ::-1] + 0.5) * FINE
    held = ground.holds(middles)
    assert held.all() or ground.area > sizes.max() * FINE**2  # another one is the largest


def rngs(seed):
    return map(np.random.default_rng, (seed, seed + 1))


def gap(width):
    """Two rooms of 4 m, joined by a gap in the wall between them."""
    walls = ((0.0, 2.0 - width / 2), (2.0 + width / 2, 4.0))
    standing = tuple(Polygon(((4.0, a), (4.2, a), (4.2, b), (4.0, b))) for a, b in walls)
    return Arena(9.0, 4.0, obstacles=standing)


@pytest.mark.parametrize(("radius", "joined"), [(0.07, True), (0.08, False), (0.3, False)])
def test_a_gap_joins_what_fits_through(radius, joined):
    ground = ground_of(gap(0.15), radius)
    held = ground.holds(np.array([[1.0, 1.0], [8.0, 1.0]]))
    assert held.tolist() == [joined, True]  # the room on the right is the larger one
    assert ground.area == pytest.approx(eroded_area(0.15, radius), rel=0.01)
    assert (ground.notice() is None) == joined


def eroded_area(width, radius):
    areas = rasterised_fast(gap(width), radius)
    return np.bincount(areas.ravel())[1:].max() * 1e-4


def rasterised_fast(arena, room):
    """The same by a distance transform of a raster of 1 cm."""
    x, y = (np.arange(0.005, size, 0.01) for size in (arena.width, arena.height))
    points = np.stack(np.meshgrid(x, y), axis=-1)
    free = np.ones(points.shape[:2], bool)
    for polygon in arena.obstacles:
        free &= ~polygon.contains(points.reshape(-1, 2)).reshape(free.shape)
    away = distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * 0.01
    return label(away >= room + 0.005)[0]


def test_a_place_picks_the_area_and_must_have_room():
    arena = gap(0.1)
    left = ground_of(arena, 0.1, (1.0, 1.0))
    assert left.holds(np.array([[1.0, 1.0], [8.0, 1.0]])).tolist() == [True, False]
    assert "two" not in (left.notice() or "")
    assert "world.start = [" in (left.notice() or "")
    with pytest.raises(ImpossibleWorld, match=r"world.start is \[4.1, 0.5\].*the nearest place is"):
        ground_of(arena, 0.04, (4.1, 0.5))


def test_a_body_too_large_for_the_floor_is_refused():
    with pytest.raises(ImpossibleWorld, match="such a body has no room anywhere"):
        ground_of(gap(0.5), 2.5)


def test_points_are_not_put_into_walls():
    arena = gap(0.15)
    sites = np.array(
        [o.position for o in islice(uniform(ground_of(arena, 0.0), 1.0, *rngs(1)), 500)]
    )
    assert (clearance(arena, sites) > 0.0).all()
    assert (sites[:, 0] < 4.0).any()
    assert (sites[:, 0] > 4.2).any()


def test_hot_spots_lie_on_the_ground():
    ground = ground_of(gap(0.15), 0.2)
    spots = islice(hot_spots(ground, 1.0, *rngs(3), spread=0.5), 200)
    assert ground.holds(np.array([o.position for o in spots])).all()


@pytest.mark.parametrize(
    ("event", "said"),
    [
        ((1.0, 4.1, 0.5), r"row 2: the event at \(4.1, 0.5\) lies in a wall"),
        (
            (1.0, 1.0, 1.0),
            r"row 2: the event at \(1, 1\) is where no robot of radius 0.1 m gets to",
        ),
        ((1.0, 9.5, 1.0), r"row 2: the event at \(9.5, 1\) lies outside"),
        ((1.0, np.nan, 1.0), r"row 2: the event at \(nan, 1\) is nowhere"),
        ((-1.0, 8.0, 1.0), r"row 2: .* happens at -1 s"),
        ((np.nan, 8.0, 1.0), r"row 2: .* has no time"),
    ],
)
def test_a_trace_is_refused_with_its_row(event, said):
    rows = np.array([(0.0, 8.0, 1.0), event])
    with pytest.raises(ValueError, match=said):
        list(trace(ground_of(gap(0.15), 0.1), 1.0, None, None, occurrences=rows))


def test_a_trace_may_name_what_a_body_covers_beside_a_wall():
    rows = np.array([(0.0, 8.0, 0.03)])
    (event,) = trace(ground_of(gap(0.15), 0.1), 1.0, None, None, occurrences=rows)
    assert event.position == (8.0, 0.03)


def test_a_trace_without_times_comes_evenly_and_in_the_map_s_frame():
    arena = Arena(5.0, 5.0, corner=(-2.0, 1.0))
    rows = np.array([(np.nan, 0.0, 2.0), (np.nan, 1.0, 2.0)])
    drawn = list(trace(ground_of(arena, 0.0), 0.5, None, None, occurrences=rows))
    assert [(o.time, o.position) for o in drawn] == [(0.0, (2.0, 1.0)), (2.0, (3.0, 1.0))]
    drawn = list(trace(ground_of(arena, 0.0), 0.5, None, None, occurrences=rows, scale=0.9))
    assert drawn[1].position == pytest.approx((2.9, 0.8))


def test_given_places_must_be_one_area():
    places = np.array([(8.0, 1.0), (1.0, 1.0)])
    rng = np.random.default_rng(0)
    assert len(place_given(places, gap(0.3), 2, 0.1, rng)) == 2
    with pytest.raises(ImpossibleWorld, match=r"robot 1 .* cannot get to where robot 0 starts"):
        place_given(places, gap(0.15), 2, 0.1, rng)


@pytest.mark.parametrize("radius", [0.05, 0.1])
def test_spacing_by_cells_is_as_by_all_distances(radius):
    """The points that one gets by asking everybody, in the order of drawing."""
    arena, count = Arena(6.0, 6.0), 250
    found = scatter(arena, count, radius, np.random.default_rng(2))
    rng, kept = np.random.default_rng(2), []
    while len(kept) < count:
        for point in arena.random_points(count, radius, rng):
            if len(kept) < count and all(((point - p) ** 2).sum() > 4 * radius**2 for p in kept):
                kept.append(point)
    assert np.array_equal(found, kept)


@pytest.mark.parametrize("side", [0.41, 0.9, 3.0])
def test_what_is_refused_at_once_cannot_be_placed(side):
    """Dropped at random until no more fit, bodies cover less than what is refused."""
    arena, radius = Arena(side, side), 0.2
    rng, kept = np.random.default_rng(3), np.empty((0, 2))
    for point in arena.random_points(20_000, radius, rng):
        if (((kept - point) ** 2).sum(axis=1) > 4 * radius**2).all():
            kept = np.vstack([kept, point])
    assert len(kept) * np.pi * radius**2 / side**2 < DENSEST * (1.0 + 4.0 / len(kept) ** 0.5)


def test_flags_that_geos_leaves_behind_are_nobodys_warning(monkeypatch):
    """Some processors leave a division by zero flagged where there was none."""
    import shapely

    ground, points = ground_of(gap(0.15), 0.07), np.array([[1.0, 1.0]])
    plain = shapely.points
    monkeypatch.setattr(shapely, "points", lambda *a: [1.0 / np.zeros(1), plain(*a)][1])
    assert ground.holds(points).all()
    assert ground.serves(points).all()
