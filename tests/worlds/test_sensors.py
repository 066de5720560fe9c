"""The sensor field of Figure 1: who notices, and over how many sensors the word travels."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest

from worlds.arena import Arena, ImpossibleWorld
from worlds.sensors import SensorSpec, deploy


@pytest.fixture(scope="module")
def field():
    return deploy(Arena(), SensorSpec(count=300), np.random.default_rng(1))


def test_word_takes_the_fewest_hops_to_the_handler(field):
    graph = nx.Graph()
    graph.add_nodes_from(range(300))
    gaps = np.hypot(*(field.positions[:, None] - field.positions[None]).transpose(2, 0, 1))
    graph.add_edges_from(np.argwhere(np.triu(gaps <= field.spec.radio_range, 1)).tolist())
    gateway = int(np.argmin(np.hypot(*field.positions.T)))
    hops = nx.single_source_shortest_path_length(graph, gateway)
    assert field.hops.tolist() == [hops.get(k, -1) + 1 for k in range(300)]
    for sensor in range(300):
        if field.hops[sensor] > 1:
            assert field.hops[field.parent[sensor]] == field.hops[sensor] - 1


def test_those_in_reach_report_what_they_sense(field):
    site = (5.0, 5.0)
    reports = field.detect(site, np.random.default_rng(2))
    away = np.hypot(*(field.positions - site).T)
    assert [r.sensor for r in reports] == np.flatnonzero(away <= field.spec.reach).tolist()
    assert all(report.position == site for report in reports)


def test_misses_and_errors_are_as_often_and_as_large_as_asked():
    spec = SensorSpec(count=300, miss=0.25, error=0.3)
    field = deploy(Arena(), spec, np.random.default_rng(3))
    rng = np.random.default_rng(4)
    away = np.hypot(*(field.positions - (5.0, 5.0)).T)
    reports = [r for _ in range(300) for r in field.detect((5.0, 5.0), rng)]
    assert len(reports) / 300 == pytest.approx(0.75 * (away <= spec.reach).sum(), rel=0.05)
    off = np.array([report.position for report in reports]) - (5.0, 5.0)
    assert off.std(axis=0) == pytest.approx([0.3, 0.3], rel=0.05)


def test_a_field_that_cannot_talk_is_refused():
    with pytest.raises(ImpossibleWorld, match="reach the handler"):
        deploy(Arena(), SensorSpec(count=50, radio_range=0.5), np.random.default_rng(5))


@pytest.mark.parametrize(
    "wrong", [{"count": 0}, {"reach": 0.0}, {"miss": 1.5}, {"error": -1.0}, {"radio_range": -1.0}]
)
def test_bad_values_are_refused_with_a_sentence(wrong):
    with pytest.raises(ValueError, match="expected"):
        SensorSpec(**wrong)
