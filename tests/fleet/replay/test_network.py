"""The links that change while robots drive, against computing all of them anew."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet.replay.layers.network import (
    MoverReach,
    any_spell,
    component_counts,
    disc_spell,
    encode,
    gabriel_spell,
    in_all,
    touching,
    whole,
    without,
)
from protocols.topology import edges

coarse = st.integers(0, 8).map(lambda k: 0.5 * k)  # a lattice: same places, right angles
fine = st.integers(0, 4_000_000).map(lambda k: 1e-6 * k)  # apart by what can be seen, or not
points = st.one_of(st.tuples(coarse, coarse), st.tuples(fine, fine))
fleets = st.lists(points, min_size=2, max_size=14)
paths = st.lists(points, min_size=1, max_size=5)


def told(spell):
    """All links of each moment."""
    return [np.sort(np.concatenate([spell.fixed, codes])) for codes in spell.varying]


@settings(max_examples=150)
@given(fleets, paths, st.data())
def test_one_mover_in_the_gabriel_graph(fleet, path, data):
    places, course = np.array(fleet), np.array(path)
    robot = data.draw(st.integers(0, len(fleet) - 1))
    silent = data.draw(st.lists(st.integers(0, len(fleet) - 1), max_size=2))
    places[[k for k in silent if k != robot]] = np.nan
    reach = MoverReach.of(places, robot, course, 1.5)
    disc = disc_spell(whole(places, 1.5, "udg"), robot, reach)
    gabriel = gabriel_spell(whole(places, 1.5, "gabriel"), disc.fixed, places, robot, reach)
    for spell, graph in ((disc, "udg"), (gabriel, "gabriel")):
        slow = any_spell(places, [robot], course[:, None], 1.5, graph)
        for quick, anew in zip(told(spell), told(slow), strict=True):
            assert quick.tolist() == anew.tolist()
        assert not touching(spell.fixed, len(places), robot).any()


@pytest.mark.parametrize("graph", ["gabriel", "udg", "rng", "emst"])
def test_several_movers(graph):
    rng = np.random.default_rng(3)
    places = rng.random((30, 2)) * 5.0
    movers, course = [4, 9, 17], rng.random((6, 3, 2)) * 5.0
    spell = any_spell(places, movers, course, 1.5, graph)
    for at, codes in zip(course, told(spell), strict=True):
        now = places.copy()
        now[movers] = at
        assert codes.tolist() == encode(edges(now, 1.5, graph), 30).tolist()
    for mover in movers:
        assert not touching(spell.fixed, 30, mover).any()


codes = st.lists(st.integers(0, 30), unique=True, max_size=12).map(
    lambda some: np.array(sorted(some), np.intp)
)


@given(st.lists(codes, min_size=1, max_size=5))
def test_in_all(several):
    assert set(in_all(several).tolist()) == set.intersection(*(set(c.tolist()) for c in several))


@given(codes, codes)
def test_without(some, others):
    assert without(some, others).tolist() == sorted(set(some.tolist()) - set(others.tolist()))


@given(st.lists(fleets, min_size=1, max_size=4), st.data())
def test_component_counts(several, data):
    import networkx as nx

    n = max(map(len, several))
    graphs, on_air, expected = [], [], []
    for fleet in several:
        places = np.full((n, 2), np.nan)
        places[: len(fleet)] = fleet
        links = edges(places, 1.0, "udg")
        graphs.append(encode(links, n))
        on_air.append(~np.isnan(places[:, 0]))
        graph = nx.Graph(links.tolist())
        graph.add_nodes_from(range(len(fleet)))
        expected.append(nx.number_connected_components(graph))
    assert component_counts(graphs, on_air, n).tolist() == expected
