"""The RFTA family, word by word."""

from __future__ import annotations

from functools import partial

import pytest
from hand_drawn import converse, network

from protocols.messages import Award
from protocols.metrics import distance
from protocols.rfta import rfta1, rfta2, rfta2_iterated, rfta2ge
from protocols.routing import Search

# A street towards the event, and two robots in side streets of robot 3.
#
#            5
#   0  1  2  3  4      * event at (4.5, 0)
#            6
STREET = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0), (3.0, 1.0), (3.0, -1.0)]
SITE = (4.5, 0.0)
AT_3 = Search(radius=1.6, check="hop")  # ends the search at robot 3


def test_rfta1_lets_only_those_nearer_than_the_robot_found_bid():
    talk = converse(partial(rfta1, search=AT_3), network(STREET, 1.1), SITE, 0)
    assert talk.route == [1, 2, 3]
    assert talk.said("call") == [(3, None)]
    assert talk.said("bid") == [(4, 3)]
    assert talk.said("assign") == [(3, 4)]
    assert talk.award.winner == 4


def test_rfta1_call_carries_the_bid_to_better():
    talk = converse(partial(rfta1, search=AT_3), network(STREET, 1.1), SITE, 0)
    (call,) = [t for t, _ in talk.transcript if t.kind == "call"]
    assert call.bid.cost == 1.5
    assert call.bid.robot == 3


def test_rfta1_keeps_the_event_where_nobody_is_nearer():
    talk = converse(rfta1, network(STREET, 1.1), SITE, 0)
    assert talk.route == [1, 2, 3, 4]
    assert talk.said("bid") == []
    assert talk.award.winner == talk.award.auctioneer == 4


def test_rfta2_lets_the_neighbours_of_the_robot_found_bid():
    view = network(STREET, 1.1, energy=[100, 100, 80, 100, 50, 90, 95])
    talk = converse(partial(rfta2, search=AT_3), view, SITE, 0)
    assert talk.route == [1, 2, 3]
    assert talk.said("call") == [(3, None)]
    assert talk.said("bid") == [(2, 3), (4, 3), (5, 3), (6, 3)]
    assert talk.said("assign") == [(3, 6)]
    assert talk.award.winner == 6


def test_rfta2_with_another_metric():
    talk = converse(partial(rfta2, search=AT_3, metric=distance), network(STREET, 1.1), SITE, 0)
    assert talk.award.winner == 4


def test_rfta2_where_the_collecting_robot_is_the_auctioneer():
    talk = converse(rfta2, network(STREET, 1.1), SITE, 4)
    assert talk.route == []
    assert talk.award.winner == 3


def test_rfta2_ends_the_network_s_life_where_neither_neighbours_nor_auctioneer_can():
    view = network(STREET, 1.1, energy=[100, 100, 100, 5, 5, 100, 100])
    assert converse(rfta2, view, SITE, 0).award == Award(None, 4)


@pytest.mark.parametrize("aggregate", [False, True])
def test_rfta2ge_reaches_two_hops(aggregate):
    view = network(STREET, 1.1, energy=[100, 99, 60, 50, 30, 60, 55])
    protocol = partial(rfta2ge, search=AT_3, aggregate=aggregate)
    talk = converse(protocol, view, SITE, 0)
    assert talk.said("call") == [(3, None), (2, None), (4, None), (5, None), (6, None)]
    assert talk.award.winner == 1  # two hops from robot 3
    assert talk.said("assign") == [(3, 2), (2, 1)]
    up = [pair for pair in talk.said("bid") if pair[0] == 2]
    assert up == ([(2, 3)] if aggregate else [(2, 3), (2, 3)])


def test_rfta2ge_two_hops_away_only_those_bid_that_outbid_their_caller():
    view = network(STREET, 1.1, energy=[100, 99, 60, 50, 30, 60, 55])
    protocol = partial(rfta2ge, search=AT_3, aggregate=True, outbid=True)
    talk = converse(protocol, view, SITE, 0)
    calls = {t.sender: t.bid for t, _ in talk.transcript if t.kind == "call"}
    assert calls[3] is None
    assert calls[2].robot == 2
    assert (1, 2) in talk.said("bid")
    weak = network(STREET, 1.1, energy=[100, 70, 60, 50, 30, 60, 55])
    talk = converse(protocol, weak, SITE, 0)
    assert (1, 2) not in talk.said("bid")
    assert talk.award.winner == 5


def test_iterated_extension_walks_uphill_until_nobody_is_fuller():
    view = network(STREET, 1.1, energy=[97, 100, 80, 60, 60, 40, 40])
    talk = converse(partial(rfta2_iterated, search=AT_3), view, (2.0, 0.5), 3)
    assert talk.said("assign") == [(3, 2), (2, 1)]
    assert talk.said("call") == [(3, None), (2, None), (1, None)]
    assert talk.award.winner == 1
    assert talk.award.auctioneer == 3


def test_iterated_extension_stays_if_the_next_winner_cannot_be_told():
    view = network(STREET, 1.1, energy=[97, 100, 80, 60, 60, 40, 40])
    protocol = partial(rfta2_iterated, search=AT_3)
    talk = converse(
        protocol, view, (2.0, 0.5), 3, deaf=lambda t: t.kind == "assign" and t.sender == 2
    )
    assert talk.award.winner == 2
