"""Auctions on networks small enough to check by eye: expected transcripts, word by word."""

from __future__ import annotations

from functools import partial

import pytest
from hand_drawn import PER_METRE, StillRobot, converse, network

from protocols.auctions import AuctionRules, iterated_auction
from protocols.auctions import auction as hold
from protocols.messages import Award, Event
from protocols.metrics import distance, energy_left

# A star of robots around 0, with a second ring:   5 - 1 - 0 - 2 - 6 ,  3 above, 4 below 0.
STAR = [(0.0, 0.0), (-1.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-2.0, 0.0), (2.0, 0.0)]
EVENT = Event(0, (0.5, 0.0))


def auction(view, *, metric=energy_left, **options):
    def protocol(spied, event, source):
        return (yield from hold(spied, source, event, metric, AuctionRules(**options)))

    return converse(protocol, view, EVENT, 0)


def energies(*levels):
    return network(STAR, 1.1, energy=levels)


def test_one_hop_the_fullest_wins_and_is_told():
    view = energies(100, 60, 70, 90, 50, 100, 100)
    talk = auction(view)
    assert talk.said("call") == [(0, None)]
    assert talk.said("bid") == [(1, 0), (2, 0), (3, 0), (4, 0)]
    assert talk.said("assign") == [(0, 3)]
    assert talk.award.winner == 3
    assert talk.award.auctioneer == 0
    assert [bid.robot for bid in talk.award.bids] == [1, 2, 3, 4]


def test_who_cannot_afford_it_does_not_bid():
    assert auction(energies(100, 20, 20, 20, 20, 100, 100)).said("bid") == [(2, 0)]


def test_the_auctioneer_goes_if_nobody_bids():
    talk = auction(energies(100, 1, 1, 1, 1, 100, 100))
    assert talk.award.winner == 0
    assert [t.kind for t, _ in talk.transcript] == ["call"]


def test_the_auctioneer_stays_if_anybody_bids():
    assert auction(energies(100, 30, 1, 1, 1, 100, 100)).award.winner == 1


def test_the_auctioneer_bids_too_where_it_may():
    talk = auction(energies(100, 60, 70, 90, 50, 100, 100), auctioneer_bids=True)
    assert talk.award.winner == 0
    assert talk.said("assign") == []


def test_nobody_can_go():
    assert auction(energies(1, 1, 1, 1, 1, 1, 1)).award == Award(None, 0)


def test_a_robot_that_finds_no_way_does_not_bid():
    view = energies(100, 60, 70, 90, 50, 100, 100)
    walled = view[3]
    view[3] = StillRobot(3, walled.position, 90.0, walled.neighbours, unreachable=(EVENT.position,))
    assert auction(view).award.winner == 2


def test_two_hops_relay_every_bid():
    talk = auction(energies(100, 60, 70, 65, 50, 100, 99), hops=2)
    assert talk.said("call") == [(0, None), (1, None), (2, None), (3, None), (4, None)]
    assert talk.said("bid") == [(1, 0), (2, 0), (3, 0), (4, 0), (5, 1), (1, 0), (6, 2), (2, 0)]
    assert talk.award.winner == 6
    assert talk.said("assign") == [(0, 2), (2, 6)]


def test_two_hops_aggregated_pass_on_only_the_best():
    plain = auction(energies(100, 60, 70, 65, 50, 100, 99), hops=2)
    talk = auction(energies(100, 60, 70, 65, 50, 100, 99), hops=2, aggregate=True)
    assert talk.said("bid") == [(6, 2), (5, 1), (4, 0), (3, 0), (2, 0), (1, 0)]
    assert talk.award.winner == plain.award.winner == 6
    assert {bid.robot for bid in talk.award.bids} == {3, 4, 5, 6}


def test_distance_metric_sends_the_nearest():
    assert auction(energies(*[100] * 7), metric=distance).award.winner == 2


def test_ties_go_to_the_lower_id():
    view = network([(0.0, 0.0), (0.0, 1.0), (0.0, -1.0)], 1.1)
    talk = converse(lambda v, e, s: hold(v, s, e, distance), view, Event(0, (0.0, 0.0)), 0)
    assert talk.award.winner == 1


def test_a_lost_call_a_lost_bid_and_a_lost_assignment():
    view = energies(100, 60, 70, 90, 50, 100, 100)
    protocol = partial(alone, metric=energy_left)
    no_call = converse(protocol, view, EVENT, 0, deaf=lambda t: t.kind == "call")
    assert no_call.award.winner == 0
    no_best = converse(protocol, view, EVENT, 0, deaf=lambda t: t.kind == "bid" and t.sender == 3)
    assert no_best.award.winner == 2
    unheard = converse(protocol, view, EVENT, 0, deaf=lambda t: t.kind == "assign")
    assert unheard.award.winner is None


def alone(view, event, source, metric):
    return (yield from hold(view, source, event, metric))


@pytest.mark.parametrize("short", [0.0, 1e-9])
def test_exactly_enough_is_enough(short):
    near = PER_METRE * 0.5 - short
    view = network([(0.0, 0.0), (1.0, 0.0)], 1.1, energy=[0.0, near])
    assert (auction(view).award.winner == 1) == (short == 0.0)


def test_an_equal_bid_is_not_sent():
    """Both would spend the same; the call says what is to be bettered, and silence is agreement."""
    pair = network([(0.0, 0.0), (1.0, 0.0)], 1.5, energy=100.0)
    rules = AuctionRules(reserve=True, auctioneer_bids=True)

    def protocol(view, event, source):
        return (yield from hold(view, source, event, distance, rules))

    halfway = converse(protocol, pair, (0.5, 0.0), 0)
    assert halfway.said("bid") == []
    assert halfway.award.winner == 0
    assert converse(protocol, pair, (0.51, 0.0), 0).said("bid") == [(1, 0)]


def test_an_equal_bid_does_not_outbid():
    pair = network([(0.0, 0.0), (1.0, 0.0)], 1.5, energy=100.0)
    rules = AuctionRules(outbid=True, auctioneer_bids=True)

    def protocol(view, event, source):
        return (yield from hold(view, source, event, distance, rules))

    assert converse(protocol, pair, (0.5, 0.0), 0).said("bid") == []
    assert converse(protocol, pair, (0.51, 0.0), 0).said("bid") == [(1, 0)]


def test_bids_of_earlier_auctions_stay_in_the_award():
    """0 assigns to 1, which finds 2 to be better still."""
    line = network([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], 1.2, energy=[60.0, 80.0, 100.0])

    def protocol(view, event, source):
        return (yield from iterated_auction(view, source, event, energy_left))

    award = converse(protocol, line, (1.0, 0.1), 0).award
    assert award.winner == 2
    assert [bid.robot for bid in award.bids] == [1, 2]
