"""What bids say, which are sent, how they come back, and what an award keeps of them."""

from __future__ import annotations

from functools import partial
from math import inf

import pytest
from hand_drawn import PER_METRE, StillRobot, converse, network

from protocols.adaptive import aap
from protocols.auctions import (
    AuctionRules,
    add_up,
    aggregate,
    auction,
    iterated_auction,
    keep,
    relay,
)
from protocols.central import Assignment, optimum
from protocols.flooding import bfs, k_saap, k_sap
from protocols.messages import Award, Bid, Event, Move
from protocols.metrics import (
    CompanyShare,
    EnergyLeftMinusCost,
    cost_over_left,
    cost_share,
    distance,
)
from protocols.rfta import rfta1, rfta2, rfta2ge
from protocols.rfta3 import rfta3
from protocols.routing import Search

# A tree of calls: 0 has called 1 and 2, and 1 has called 3 and 4.
TREE = {1: 0, 2: 0, 3: 1, 4: 1}
OFFERS = [Bid(5.0, 3), Bid(2.0, 4), Bid(3.0, 2)]
STREET = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)]


def played(part, deaf=()):
    """What a part of a conversation came to, and what was said; ``deaf``: nobody hears these."""
    said, heard = [], None
    try:
        while True:
            word = part.send(heard)
            said.append((word.sender, word.receiver, word.bid))
            heard = () if word.sender in deaf else (word.receiver,)
    except StopIteration as end:
        return end.value, said


def senders(talk, kind):
    return [word.sender for word, _ in talk.transcript if word.kind == kind]


def test_a_relayed_bid_is_the_same_on_every_hop():
    arrived, said = played(relay(0, TREE, OFFERS[:1]))
    assert said == [(3, 1, Bid(5.0, 3)), (1, 0, Bid(5.0, 3))]
    assert arrived == OFFERS[:1]


def test_a_bid_passed_on_is_the_best_that_was_heard():
    arrived, said = played(aggregate(0, TREE, OFFERS))
    assert said == [
        (4, 1, Bid(2.0, 4)),
        (3, 1, Bid(5.0, 3)),
        (2, 0, Bid(3.0, 2)),
        (1, 0, Bid(2.0, 4)),
    ]
    assert arrived == [Bid(3.0, 2), Bid(2.0, 4)]


def test_answers_are_added_up_on_their_way_back():
    (answers, arrived), said = played(add_up(0, TREE, OFFERS[:2]))
    assert said == [(4, 1, Bid(2.0, 4)), (3, 1, Bid(5.0, 3)), (2, 0, None), (1, 0, Bid(2.0, 4))]
    assert (answers, arrived) == (4, [Bid(2.0, 4)])


def test_an_answer_that_is_lost_counts_for_nothing_and_keeps_nobody_from_answering():
    (answers, arrived), said = played(add_up(0, TREE, OFFERS), deaf={4})
    assert said[-1] == (1, 0, Bid(5.0, 3))
    assert (answers, arrived) == (3, [Bid(3.0, 2), Bid(5.0, 3)])
    assert played(add_up(0, TREE, OFFERS), deaf={1, 2})[0] == (0, [])


def test_a_bid_as_good_as_the_one_in_the_call_is_not_sent():
    view = network(STREET[:2], 1.1)
    between = Event(0, (0.5, 0.0))
    rules = AuctionRules(reserve=True)
    talk = converse(lambda v, e, s: auction(v, s, e, distance, rules), view, between, 1)
    assert senders(talk, "bid") == []
    assert talk.award.winner == 1


def test_the_award_keeps_every_bid_that_was_made():
    view = network(STREET, 1.1, energy=[90, 100, 60, 60])
    event = Event(0, (3.0, 0.0))
    kept = converse(lambda v, e, s: iterated_auction(v, s, e, distance), view, event, 0)
    assert kept.award.winner == 3
    assert [bid.robot for bid in kept.award.bids] == [1, 2, 3]
    assert keep(view, 3, event, distance).bids == (Bid(0.0, 3),)


def test_rfta1_s_auctioneer_is_among_the_bidders():
    view = network(STREET[:2], 1.1)
    talk = converse(partial(rfta1, search=Search(radius=1.0, check="hop")), view, (0.9, 0.0), 0)
    assert [bid.robot for bid in talk.award.bids] == [1, 0]
    assert talk.award.winner == 1


def test_the_iterated_auction_begins_as_it_is_told():
    view = network(STREET, 1.1)
    rules = AuctionRules(hops=2)
    talk = converse(lambda v, e, s: iterated_auction(v, s, e, distance, rules), view, (3.0, 0.0), 0)
    assert [bid.robot for bid in talk.award.bids] == [1, 2, 3]
    assert talk.said("assign") == [(0, 1), (1, 2), (2, 3)]
    assert senders(talk, "call") == [0, 1, 2, 3]


@pytest.mark.parametrize("protocol", [k_sap, k_saap, bfs, aap])
def test_who_starts_an_auction_of_these_competes(protocol):
    view = network(STREET, 1.1, energy=[90, 50, 50, 50])
    assert converse(protocol, view, (0.1, 0.0), 0).award.winner == 0
    fuller = network(STREET, 1.1, energy=[50, 90, 50, 50])
    talk = converse(protocol, fuller, (0.1, 0.0), 0)
    assert talk.award.winner == 1
    assert 0 in [bid.robot for bid in talk.award.bids]


def test_the_optimum_knows_every_bid():
    view = network(STREET, 1.1, energy=[90, 1, 50, 70])
    event = Event(0, (2.0, 0.0))
    for protocol in (partial(optimum, metric=distance), Assignment(metric=distance)):
        award = converse(protocol, view, event, 0).award
        assert award.winner == 2
        assert [bid.robot for bid in award.bids] == [0, 2, 3]
    assert Assignment(metric=distance).together(view, [event]) == {0: 2}
    empty = network(STREET, 1.1, energy=0.1)
    assert converse(optimum, empty, (9.0, 0.0), 0).award == Award(None, 0)


@pytest.mark.parametrize("interval", [0.0, -1.0, inf])
def test_an_interval_between_assignments_is_a_time(interval):
    with pytest.raises(ValueError, match=f"interval is {interval}"):
        Assignment(interval=interval)
    assert Assignment(interval=0.5).interval == 0.5


@pytest.mark.parametrize("protocol", [rfta2, rfta2ge])
def test_the_auctioneer_may_be_let_compete(protocol):
    view = network(STREET, 1.1, energy=[50, 50, 50, 100])
    assert converse(protocol, view, (3.0, 0.0), 3).award.winner != 3
    competing = partial(protocol, auctioneer_bids=True)
    assert converse(competing, view, (3.0, 0.0), 3).award.winner == 3


def test_rfta2ge_relays_each_bid_by_itself_and_calls_without_one():
    view = network(STREET, 1.1, energy=[90, 80, 70, 60])
    talk = converse(rfta2ge, view, (3.0, 0.0), 3)
    assert senders(talk, "bid") == [2, 1, 2]
    assert all(word.bid is None for word, _ in talk.transcript if word.kind == "call")


# RFTA3


def test_who_bid_best_does_not_bid_again_when_more_are_asked():
    view = network([(0.0, 0.0), (0.5, 0.0), (1.4, 0.0)], 1.0, energy=[25, 60, 1])
    talk = converse(partial(rfta3, metric=cost_share, content=0.0), view, (-0.4, 0.0), 0)
    assert senders(talk, "call")[:2] == [0, 0]
    assert len(senders(talk, "bid")) == len(set(senders(talk, "bid")))


def test_a_bid_as_good_as_asked_for_is_not_asked_to_be_bettered():
    view = network(STREET, 1.1)
    cost = cost_share(view[3], (3.5, 0.0))
    for content, calls in ((cost, 1), (0.99 * cost, 3)):
        talk = converse(partial(rfta3, metric=cost_share, content=content), view, (3.5, 0.0), 3)
        assert len(senders(talk, "call")) == calls


def test_counting_begins_with_the_second_call_and_ends_when_it_finds_nobody_new():
    talk = converse(rfta3, network(STREET[:3], 1.1, energy=1.0), (-90.0, 0.0), 0)
    assert senders(talk, "call") == [0, 0, 1, 0, 1, 2, 0, 1, 2]  # the last: who carries it


@pytest.mark.parametrize(("carry", "counted"), [(4, True), (3, False)])
def test_answers_are_asked_for_while_the_robots_known_are_fewer_than_carry(carry, counted):
    view = network(STREET[:3], 1.1, energy=1.0)  # the one in the middle knows of two others
    talk = converse(partial(rfta3, carry=carry), view, (1.0, -90.0), 1)
    assert bool(senders(talk, "bid")) == counted


def test_one_robot_is_fewer_than_two():
    alone = network([(0.0, 0.0)], 1.0, energy=50.0)
    talk = converse(partial(rfta3, carry=2), alone, (0.0, 90.0), 0)
    assert talk.award.moves == (Move(0, (0.0, 1.0)),)


def test_an_event_is_carried_a_radio_range_on_the_way_to_it_by_whoever_can():
    """Robot 0 was found; it is empty, and 1 is told to go where 0's radio ends."""
    view = network([(1.0, 2.0), (1.0, 2.3)], 0.5, energy=[0.1, 60.0])
    talk = converse(rfta3, view, (1.0 + 0.6 * 9.0, 2.0 - 0.8 * 9.0), 0)
    (move,) = talk.award.moves
    assert move.robot == 1
    assert move.position == pytest.approx((1.3, 1.6))


def test_a_short_range_ends_before_an_event_close_by():
    view = network([(0.0, 0.0), (-0.1, 0.0)], 0.4, energy=0.5 * PER_METRE)
    (move,) = converse(rfta3, view, (0.9, 0.0), 0).award.moves
    assert move.position == pytest.approx((0.4, 0.0))


def test_an_event_in_radio_range_is_not_carried_past_its_place():
    view = network([(0.0, 0.0), (1.0, 0.0)], 1.1, energy=0.1)
    assert converse(rfta3, view, (0.5, 0.0), 0).award.moves == ()


# What bids are worth


def robot(energy, *, neighbours=None):
    return StillRobot(0, (0.0, 0.0), energy, neighbours or {})


def test_company_is_its_formula():
    """m·d/E^b·(1 + a/l), with a the distance to the nearest; 0 for whoever has no neighbours."""
    site = (2.0, 0.0)
    metric = CompanyShare(length=0.4, balance=0.5)
    lonely = 2.0 * PER_METRE / 64.0**0.5
    assert metric(robot(64.0), site) == pytest.approx(lonely)
    company = robot(64.0, neighbours={1: (0.0, 0.6), 2: (0.9, 0.0)})
    assert metric(company, site) == pytest.approx(lonely * (1.0 + 0.6 / 0.4))


def test_nearly_empty_is_not_empty():
    site = (1.0, 0.0)
    assert CompanyShare()(robot(0.25), site) == pytest.approx(PER_METRE / 0.5)
    assert cost_share(robot(0.25), site) == pytest.approx(PER_METRE / 0.25)
    assert CompanyShare()(robot(0.0), site) == inf
    assert cost_over_left(robot(PER_METRE), site) == inf


@pytest.mark.parametrize("weight", [0.0, 0.5])
def test_any_weight_that_is_not_negative_will_do(weight):
    metric = EnergyLeftMinusCost(weight=weight)
    assert metric(robot(80.0), (1.0, 0.0)) == pytest.approx(weight * PER_METRE - 80.0)
