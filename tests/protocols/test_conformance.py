"""What every protocol of the catalogue keeps to, whatever it does.

``converse`` also asserts that nobody speaks before being told, that every transmission uses
a link that exists, and that only robots that know of the event are asked anything.
"""

from __future__ import annotations

from inspect import isclass

import numpy as np
import pytest
from hand_drawn import converse as play
from hand_drawn import network, random_connected, random_points

from protocols.catalogue import PROTOCOLS
from protocols.messages import KINDS, Event


@pytest.fixture(params=sorted(PROTOCOLS))
def protocol(request):
    return PROTOCOLS[request.param]


def converse(protocol, *arguments):
    made = protocol.function() if isclass(protocol.function) else protocol.function
    return play(made, *arguments, local=protocol.local)


@pytest.fixture(params=["gabriel", "udg", "rng", "emst"])
def graph(request):
    return request.param


def cases(graph, count=12):
    """Networks with uneven batteries, an event and a collecting robot each."""
    rng = np.random.default_rng(list(graph.encode()))
    for k in range(count):
        points = random_connected(40, 10.0, 2.7, rng)
        energy = rng.uniform(0.0, 60.0 if k % 3 else 5.0, 40).tolist()
        yield points, energy, Event(k, random_points(1, 10.0, rng)[0]), int(rng.integers(40)), rng


def test_says_the_same_again(protocol, graph):
    for points, energy, event, source, _ in cases(graph):
        view = network(points, 2.7, graph, energy)
        first, second = (converse(protocol, view, event, source) for _ in range(2))
        assert first == second


def test_speaks_the_language(protocol, graph):
    for points, energy, event, source, _ in cases(graph):
        talk = converse(protocol, network(points, 2.7, graph, energy), event, source)
        for sent, _ in talk.transcript:
            assert sent.kind in KINDS
            assert sent.receiver is not None or sent.kind == "call"
            assert sent.bid is not None or sent.kind not in ("bid", "assign")


def test_the_winner_can_afford_it_and_has_been_told(protocol, graph):
    for points, energy, event, source, _ in cases(graph):
        view = network(points, 2.7, graph, energy)
        talk = converse(protocol, view, event, source)
        winner = talk.award.winner
        if winner is None:
            continue
        assert view[winner].energy >= view[winner].cost_to(event.position)
        told = {source} | {robot for _, heard in talk.transcript for robot in heard}
        assert winner in told or not protocol.local


def test_names_do_not_matter(protocol, graph):
    """Relabelling the robots relabels the winner."""
    for points, energy, event, source, rng in cases(graph):
        order = rng.permutation(len(points)).tolist()
        shuffled = network([points[k] for k in order], 2.7, graph, [energy[k] for k in order])
        plain = converse(protocol, network(points, 2.7, graph, energy), event, source)
        other = converse(protocol, shuffled, event, order.index(source))
        winner = other.award.winner
        assert (None if winner is None else order[winner]) == plain.award.winner
        assert order[other.award.auctioneer] == plain.award.auctioneer


def test_a_robot_alone_decides_alone(protocol):
    view = network([(0.0, 0.0)], 1.0)
    assert converse(protocol, view, (0.5, 0.0), 0).award.winner == 0
