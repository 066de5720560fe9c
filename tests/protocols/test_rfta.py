"""RFTA2 and GFGF2A, word by word."""

from __future__ import annotations

from functools import partial

from hand_drawn import converse, network

from protocols.gfgf import gfgf2a
from protocols.metrics import distance
from protocols.rfta import rfta2
from protocols.routing import Search

# A street towards the event, and two robots in side streets of robot 3.
#
#            5
#   0  1  2  3  4      * event at (4.5, 0)
#            6
STREET = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0), (3.0, 1.0), (3.0, -1.0)]
SITE = (4.5, 0.0)


def test_gfgf2a_sends_whoever_is_found():
    talk = converse(gfgf2a, network(STREET, 1.1), SITE, 0)
    assert [t.kind for t, _ in talk.transcript] == ["route-greedy"] * 4
    assert talk.route == [1, 2, 3, 4]
    assert talk.award.winner == talk.award.auctioneer == 4


def test_gfgf2a_ends_when_the_found_robot_cannot_afford_it():
    view = network(STREET, 1.1, energy=[100, 100, 100, 100, 5, 100, 100])
    assert converse(gfgf2a, view, SITE, 0).award.winner is None


def test_rfta2_lets_the_neighbours_of_the_found_robot_bid():
    search = Search(radius=1.6, check="hop")
    view = network(STREET, 1.1, energy=[100, 100, 80, 100, 50, 90, 95])
    talk = converse(partial(rfta2, search=search), view, SITE, 0)
    assert talk.route == [1, 2, 3]
    assert talk.said("call") == [(3, None)]
    assert talk.said("bid") == [(2, 3), (4, 3), (5, 3), (6, 3)]
    assert talk.said("assign") == [(3, 6)]
    assert talk.award.winner == 6


def test_rfta2_with_another_metric():
    search = Search(radius=1.6, check="hop")
    talk = converse(partial(rfta2, search=search, metric=distance), network(STREET, 1.1), SITE, 0)
    assert talk.award.winner == 4


def test_the_collecting_robot_may_be_the_auctioneer():
    talk = converse(rfta2, network(STREET, 1.1), SITE, 4)
    assert talk.route == []
    assert talk.award.winner == 3
