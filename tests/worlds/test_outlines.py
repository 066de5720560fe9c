"""From cells to polygons: all that is occupied is covered, and no way opens or is lost."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import label

from worlds.outlines import polygons

BRIDGE = 0.1  # [cells] half of what joins occupied cells that touch at a corner
SLIT = 0.006  # [cells] half of what cuts open a ring
FINE = 10  # samples along a cell

grids = arrays(np.bool_, st.tuples(st.integers(1, 7), st.integers(1, 7)))
tolerances = st.sampled_from([0.0, 0.5, 1.0, 2.5])
unhurried = settings(deadline=None)  # grids differ much in size


def outlined(occupied, tolerance=0.0):
    rows, columns = occupied.shape
    return polygons(occupied, np.arange(columns + 1.0), np.arange(rows + 1.0), tolerance)


def samples(occupied):
    """Points (rows·FINE, columns·FINE, 2) all over the grid."""
    rows, columns = occupied.shape
    y, x = ((np.arange(count * FINE) + 0.37) / FINE for count in (rows, columns))
    return np.stack(np.meshgrid(x, y), axis=-1)


def depth_of_cover(found, points):
    """How far outside of all polygons points (..., 2) are; 0: covered."""
    flat = points.reshape(-1, 2)
    away = np.full(len(flat), np.inf)
    for polygon in found:
        away = np.minimum(away, polygon.distance(flat))
    return away.reshape(points.shape[:-1])


def distance_to_cells(occupied, points):
    """Slow and plain: to the nearest occupied cell [cells]."""
    away = np.full(points.shape[:-1], np.inf)
    for row, column in np.argwhere(occupied):
        beside = np.abs(points - [column + 0.5, row + 0.5]) - 0.5
        away = np.minimum(away, np.hypot(*np.maximum(beside, 0.0).transpose(2, 0, 1)))
    return away


@unhurried
@given(grids, tolerances)
def test_what_is_occupied_is_covered(occupied, tolerance):
    away = depth_of_cover(outlined(occupied, tolerance), samples(occupied))
    inside = distance_to_cells(occupied, samples(occupied)) == 0.0
    assert (away[inside] <= SLIT).all()


@unhurried
@given(grids, tolerances)
def test_what_is_free_and_far_enough_stays_free(occupied, tolerance):
    points = samples(occupied)
    away = depth_of_cover(outlined(occupied, tolerance), points)
    far = distance_to_cells(occupied, points) > max(tolerance, BRIDGE) + 1e-9
    assert (away[far] > 0.0).all()


@unhurried
@given(grids, tolerances)
def test_no_way_opens(occupied, tolerance):
    """Free samples that hang together lie in free cells that do."""
    open_floor = depth_of_cover(outlined(occupied, tolerance), samples(occupied)) > SLIT
    areas, count = label(open_floor)
    cells = np.kron(label(~occupied)[0], np.ones((FINE, FINE), int))
    for area in range(1, count + 1):
        assert len(np.unique(cells[areas == area])) == 1


@unhurried
@given(grids)
def test_exact_outlines_close_no_way(occupied):
    open_floor = depth_of_cover(outlined(occupied), samples(occupied)) > SLIT
    assert label(open_floor)[1] == label(~occupied)[1]


@unhurried
@given(grids, tolerances)
def test_polygons_are_simple_and_apart(occupied, tolerance):
    found = outlined(occupied, tolerance)
    sides = []
    for number, polygon in enumerate(found):
        corners = polygon.corners
        ring = [
            (a, b, number, k)
            for k, (a, b) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True))
        ]
        sides += ring
        assert len(set(corners)) == len(corners)
        assert polygon.signed_area() > 0.0
    for (a, b, p, i), (c, d, q, j) in combinations(sides, 2):
        apart = (j - i) % len(found[p].corners) if p == q else 0
        if p == q and apart in {1, len(found[p].corners) - 1}:
            continue
        assert not crosses(a, b, c, d)


def crosses(a, b, c, d):
    def side(p, q, r):
        turn = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        return np.sign(turn) if abs(turn) > 1e-12 else 0.0

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def test_a_slanting_wall_has_few_corners():
    stairs = np.tri(40, dtype=bool)
    (exact,), (slanting,) = outlined(stairs), outlined(stairs, 1.0)
    assert len(exact.corners) == 82
    assert len(slanting.corners) == 5


def test_a_ring_is_one_polygon_around_free_floor():
    ring = np.ones((5, 5), bool)
    ring[1:4, 1:4] = False
    (found,) = outlined(ring)
    assert found.signed_area() == pytest.approx(16.0, abs=0.02)
    assert found.distance(np.array([[2.5, 2.5]]))[0] == pytest.approx(1.5)
