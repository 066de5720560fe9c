"""Links as numbers, and those of movers, against computing all of them anew."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet.replay.known_links import KnownLinks
from fleet.replay.layers.network import (
    component_counts,
    in_all,
    in_reach,
    of_movers,
    touching,
    without,
)
from protocols.topology import edges


@pytest.mark.parametrize("movers", [[], [4], [4, 9, 17]])
def test_movers_links_are_those_of_the_whole(movers):
    rng = np.random.default_rng(3)
    places = rng.random((30, 2)) * 5.0
    places[[2, 11]] = np.nan
    path = rng.random((6, len(movers), 2)) * 5.0
    before = in_reach(places, 1.5)
    fixed = before[~touching(before, 30, movers)]
    for at, codes in zip(path, of_movers(places, movers, path, 1.5), strict=True):
        now = places.copy()
        now[movers] = at
        pairs = edges(now, 1.5, "udg")
        expected = sorted((30 * pairs[:, 0] + pairs[:, 1]).tolist())
        assert np.sort(np.concatenate([fixed, codes])).tolist() == expected
        assert in_reach(now, 1.5).tolist() == expected


@settings(deadline=None)
@given(st.data())
def test_changes_of_an_adjacency_lead_to_it(data):
    adjacency, links = KnownLinks(6), set()
    for _ in range(4):
        told = {}
        for robot in data.draw(st.lists(st.integers(0, 5), unique=True)):
            told[robot] = data.draw(st.sets(st.integers(0, 5).filter(lambda o, r=robot: o != r)))
        new, gone = adjacency.update((robot, set(of)) for robot, of in told.items())
        links = (links - set(gone)) | set(new)
        for robot, of in told.items():  # the last one to speak of a link is right
            later = list(told)[list(told).index(robot) + 1 :]
            found = {o for o in range(6) if 6 * min(o, robot) + max(o, robot) in links}
            assert {o for o in found if o not in later} == {o for o in of if o not in later}


points = st.tuples(*[st.integers(0, 8).map(lambda k: 0.5 * k)] * 2)
fleets = st.lists(points, min_size=2, max_size=14)
codes = st.lists(st.integers(0, 30), unique=True, max_size=12).map(
    lambda some: np.array(sorted(some), np.intp)
)


@settings(deadline=None)
@given(st.lists(codes, min_size=1, max_size=5))
def test_in_all(several):
    assert set(in_all(several).tolist()) == set.intersection(*(set(c.tolist()) for c in several))


@settings(deadline=None)
@given(codes, codes)
def test_without(some, others):
    assert without(some, others).tolist() == sorted(set(some.tolist()) - set(others.tolist()))


@settings(deadline=None)
@given(st.lists(fleets, min_size=1, max_size=4), st.data())
def test_component_counts(several, data):
    import networkx as nx

    n = max(map(len, several))
    graphs, on_air, expected = [], [], []
    for fleet in several:
        places = np.full((n, 2), np.nan)
        places[: len(fleet)] = fleet
        links = edges(places, 1.0, "udg")
        graphs.append(np.sort(n * links[:, 0] + links[:, 1]))
        on_air.append(~np.isnan(places[:, 0]))
        graph = nx.Graph(links.tolist())
        graph.add_nodes_from(range(len(fleet)))
        expected.append(nx.number_connected_components(graph))
    assert component_counts(graphs, on_air, n).tolist() == expected
