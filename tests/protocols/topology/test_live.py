"""The live graphs against their definitions, in places that are not general at all."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest
from hand_drawn import random_connected, random_points
from hypothesis import given, settings
from hypothesis import strategies as st

from protocols.geometry import crossing
from protocols.topology import NOWHERE, Topology, edges, graphs

LOCAL = ("udg", "gabriel", "rng")
COS = 1e-9  # of an angle that counts as right,
BESIDE = 1e-16  # but not right beside an end (squared)


def by_definition(points, radio_range, graph):
    """Word by word, O(n³)."""
    linked = set()
    present = [k for k, p in enumerate(points) if p[0] == p[0]]
    for u, v in combinations(present, 2):
        (ux, uy), (vx, vy) = points[u], points[v]
        uv = (ux - vx) ** 2 + (uy - vy) ** 2
        if uv <= radio_range**2 and not any(
            graph != "udg" and stands_between(points, graph, u, v, w, uv)
            for w in present
            if w not in (u, v)
        ):
            linked.add((u, v))
    return linked


def stands_between(points, graph, u, v, w, uv):
    (ux, uy), (vx, vy), (wx, wy) = points[u], points[v], points[w]
    if points[w] in (points[u], points[v]):  # of robots in one place, the lowest id is linked
        if points[u] == points[v]:
            return w < min(u, v)
        return w < (u if points[w] == points[u] else v)
    uw, vw = (ux - wx) ** 2 + (uy - wy) ** 2, (vx - wx) ** 2 + (vy - wy) ** 2
    dot = (ux - wx) * (vx - wx) + (uy - wy) * (vy - wy)
    beside = uw <= BESIDE * vw or vw <= BESIDE * uw
    in_disc = dot <= 0.0 or (dot * dot <= COS * COS * uw * vw and not beside)
    return in_disc or (graph == "rng" and max(uw, vw) < uv)


def listed(topology):
    """The edges that the neighbour tables say, checked to be said by both ends."""
    tables = topology.neighbours
    for u, near in enumerate(tables):
        assert list(near) == sorted(near)
        assert all(u in tables[v] for v in near)
        assert all(near[v] == topology.positions[v] for v in near)
    return {(u, v) for u, near in enumerate(tables) for v in near if u < v}


coordinate = {
    "anywhere": st.floats(0.0, 10.0).map(lambda v: round(v, 9)),  # a nanometre is a place
    "beside": st.integers(0, 3).map(lambda k: 1e-9 * k),
    "lattice": st.integers(0, 6).map(lambda k: 0.3 * k),
    "three places": st.sampled_from([0.0, 1.0, 2.5]),
}
place = st.sampled_from(sorted(coordinate)).flatmap(
    lambda kind: st.tuples(coordinate[kind], coordinate[kind])
)
line = st.tuples(st.integers(0, 20).map(lambda k: 0.1 * k), st.just(0.0))


@given(
    st.one_of(st.lists(place, min_size=1, max_size=24), st.lists(line, min_size=1, max_size=24)),
    st.lists(st.tuples(st.integers(0, 23), st.one_of(place, line, st.just(NOWHERE))), max_size=12),
    st.sampled_from(LOCAL),
    st.sampled_from([0.3, 1.0, 2.5, 20.0]),
)
@settings(max_examples=150, deadline=None)
def test_moving_robots_one_by_one_gives_the_graph_by_definition(start, moves, graph, radio_range):
    compiled = Topology(start, radio_range, graph, compiled=True)
    whole = Topology(start, radio_range, graph, compiled=False)
    for robot, where in [(0, start[0]), *moves]:
        compiled.move(robot % len(start), where)
        whole.move(robot % len(start), where)
        expected = by_definition(whole.positions, radio_range, graph)
        assert listed(whole) == expected
        assert listed(compiled) == expected
        assert {tuple(e) for e in compiled.edges().tolist()} == expected


@given(st.lists(place, min_size=2, max_size=24), st.sampled_from([0.3, 1.0, 3.0]))
@settings(max_examples=100, deadline=None)
def test_each_graph_is_a_part_of_the_next_and_keeps_what_is_connected(points, radio_range):
    array = np.array(points)
    graphs = {
        name: {tuple(e) for e in edges(array, radio_range, name).tolist()}
        for name in ("emst", "rng", "gabriel", "udg")
    }
    distinct = len(set(points)) == len(points)
    assert graphs["rng"] <= graphs["gabriel"] <= graphs["udg"]
    if distinct:  # with robots in one place the spanning tree is one of several
        weights = {length_squared(array, e) for e in graphs["emst"]}
        if len(weights) == len(graphs["emst"]):
            assert graphs["emst"] <= graphs["udg"]
    parts = {name: components(len(points), pairs) for name, pairs in graphs.items()}
    assert parts["emst"] == parts["rng"] == parts["gabriel"] == parts["udg"]
    assert len(graphs["emst"]) == len(points) - len(parts["udg"])


def length_squared(array, edge):
    return float(((array[edge[0]] - array[edge[1]]) ** 2).sum())


def components(count, pairs):
    graph = nx.Graph(list(pairs))
    graph.add_nodes_from(range(count))
    return sorted(sorted(part) for part in nx.connected_components(graph))


@given(st.integers(1, 60), st.data())
@settings(max_examples=100, deadline=None)
def test_a_component_is_named_after_its_lowest_robot(count, data):
    robot = st.integers(0, count - 1)
    pairs = data.draw(st.lists(st.tuples(robot, robot), max_size=80))
    found = graphs.components(count, np.array(pairs, np.intp).reshape(-1, 2))
    parts = components(count, pairs)
    assert [found[part].tolist() for part in parts] == [[part[0]] * len(part) for part in parts]
    assert graphs.component_count(count, np.array(pairs, np.intp).reshape(-1, 2)) == len(parts)


def test_a_long_chain_is_one_component():
    rng = np.random.default_rng(2)
    order = rng.permutation(5000)
    chain = np.stack([order[1:], order[:-1]], axis=1)
    assert graphs.connected(5000, chain)
    assert graphs.component_count(5000, np.delete(chain, 2500, axis=0)) == 2


def test_spanning_tree_is_minimal_and_inside_the_others():
    rng = np.random.default_rng(5)
    for _ in range(20):
        points = np.array(random_points(60, 8.0, rng))
        graph = nx.Graph()
        for u, v in edges(points, 3.0, "udg").tolist():
            graph.add_edge(u, v, weight=float(np.hypot(*(points[u] - points[v]))))
        tree = {tuple(e) for e in edges(points, 3.0, "emst").tolist()}
        assert tree == {tuple(sorted(e)) for e in nx.minimum_spanning_edges(graph, data=False)}
        assert tree <= {tuple(e) for e in edges(points, 3.0, "rng").tolist()}


@pytest.mark.parametrize("spacing", [1.0, 0.3, 0.7])
def test_lattice_stays_planar_with_its_sides_and_no_diagonals(spacing):
    """The open disc would leave 25 crossing pairs on a 6 × 6 lattice."""
    points = [(spacing * x, spacing * y) for x in range(6) for y in range(6)]
    pairs = edges(np.array(points), 1.5 * spacing, "gabriel").tolist()
    assert len(pairs) == 60
    assert crossings(points, pairs) == 0


def test_random_gabriel_graphs_are_planar():
    rng = np.random.default_rng(6)
    for _ in range(10):
        points = random_connected(80, 9.0, 2.0, rng)
        assert crossings(points, edges(np.array(points), 2.0, "gabriel").tolist()) == 0


def crossings(points, pairs):
    return sum(
        crossing(points[a], points[b], points[c], points[d]) is not None
        for (a, b), (c, d) in combinations(pairs, 2)
        if len({a, b, c, d}) == 4
    )


def test_mean_degrees_are_ordered_as_the_paper_says():
    """d(UDG) > d(GG) > d(RNG), section 3."""
    rng = np.random.default_rng(7)
    points = np.array(random_points(100, 10.0, rng))
    degree = {name: len(edges(points, 2.5, name)) for name in ("udg", "gabriel", "rng", "emst")}
    assert degree["udg"] > degree["gabriel"] > degree["rng"] > degree["emst"]


def test_large_fleets_agree_with_the_definition_too():
    """Above a thousand robots pairs come from a tree, and links from the grid of cells."""
    rng = np.random.default_rng(8)
    points = random_points(1500, 38.7, rng)
    live = Topology(points, 2.5, compiled=True)
    for robot in range(200):
        live.move(robot, random_points(1, 38.7, rng)[0])
    whole = edges(np.array(live.positions), 2.5, "gabriel").tolist()
    assert listed(live) == {tuple(e) for e in whole}


@pytest.mark.parametrize("graph", ["gabriel", "udg", "emst"])
@pytest.mark.parametrize("compiled", [True, False])
def test_moving_all_at_once_is_moving_one_by_one(graph, compiled):
    rng = np.random.default_rng(9)
    start = random_points(60, 6.0, rng)
    one, all_ = (Topology(start, 2.0, graph, compiled=compiled) for _ in range(2))
    for _ in range(10):
        robots = rng.choice(60, 20, replace=False).tolist()
        places = random_points(20, 3.0, rng)  # closer, so that there must be more room for links
        for robot, place in zip(robots, places, strict=True):
            one.move(robot, place)
        all_.move_all(robots, places)
        assert [dict(t) for t in all_.neighbours] == [dict(t) for t in one.neighbours]


def test_a_robot_that_leaves_the_air_is_forgotten():
    live = Topology([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], 2.0, compiled=True)
    live.remove(1)
    assert live.neighbours[1] == {}
    assert live.neighbours[0] == {2: (2.0, 0.0)}


def test_tables_that_were_read_stay_as_they_were():
    live = Topology([(0.0, 0.0), (1.0, 0.0)], 2.0, compiled=True)
    before = live.neighbours[0]
    live.move(1, (1.5, 0.0))
    assert before == {1: (1.0, 0.0)}
    assert live.neighbours[0] == {1: (1.5, 0.0)}


@pytest.mark.parametrize(("radio_range", "graph"), [(0.0, "udg"), (float("nan"), "udg"), (1, "gg")])
def test_bad_input_is_named(radio_range, graph):
    with pytest.raises(ValueError, match="expected"):
        Topology([(0.0, 0.0)], radio_range, graph)


def test_ties_of_the_spanning_tree_go_to_lower_ids():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    assert edges(square, 1.2, "emst").tolist() == [[0, 1], [0, 3], [1, 2]]
    assert edges(square[[2, 3, 0, 1]], 1.2, "emst").tolist() == [[0, 1], [0, 3], [1, 2]]
