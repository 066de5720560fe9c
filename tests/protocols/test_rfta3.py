"""RFTA3, word by word, and what it promises."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from math import cos, dist, sin

import numpy as np
import pytest
from hand_drawn import converse, network, random_connected, random_points

from protocols.messages import Move
from protocols.metrics import CompanyShare, cost_share
from protocols.rfta3 import rfta3
from protocols.routing import Search

# A ladder, so that no single robot's departure cuts anybody off, and an event past its end.
#
#   1 3 5 7
#   0 2 4 6   *
LADDER = [(float(x), 0.9 * y) for x in range(4) for y in range(2)]
SITE = (4.2, 0.2)
THRIFT = partial(rfta3, metric=cost_share, search=Search(radius=1.5))


def ladder(*energy):
    return network(LADDER, 1.4, energy=list(energy))


def test_the_auctioneer_goes_itself_if_nobody_offers_more():
    talk = converse(THRIFT, ladder(*[100] * 8), SITE, 0)
    assert talk.award.winner == talk.award.auctioneer == 6
    assert [t.kind for t, _ in talk.transcript][-1] == "call"
    assert talk.said("bid") == []


def test_only_better_bids_are_sent():
    talk = converse(THRIFT, ladder(100, 100, 100, 100, 100, 100, 60, 100), SITE, 0)
    (call,) = [t for t, _ in talk.transcript if t.kind == "call"]
    assert call.bid.robot == 6
    assert [sender for sender, _ in talk.said("bid")] == [7]
    assert talk.award.winner == 7


def test_a_poor_bid_is_asked_to_be_bettered_once_by_neighbours_of_neighbours():
    """Robot 6 is at the event's side but nearly empty; 5, two hops away, is full."""
    energies = (1, 1, 1, 1, 1, 100, 25, 1)
    for content, winner, calls in ((1.0, 6, [6]), (0.9, 5, [6, 6, 4, 7])):
        talk = converse(partial(THRIFT, content=content), ladder(*energies), SITE, 6)
        assert talk.award.winner == winner
        said = [t for t, _ in talk.transcript if t.kind == "call"]
        assert sorted(t.sender for t in said) == sorted(calls)
        assert all(t.bid is not None and t.bid.robot == 6 for t in said)
    assert [sender for sender, _ in talk.said("bid")] == [5, 4]


def test_the_ring_widens_while_nobody_can_go():
    talk = converse(THRIFT, ladder(100, 1, 1, 1, 1, 1, 1, 1), SITE, 0)
    calls = [t.sender for t, _ in talk.transcript if t.kind == "call"]
    assert calls[0] == calls[1] == 6  # one hop deep, then two, then four
    assert talk.award.winner == 0
    assert talk.said("assign")[-1][1] == 0


def rings(talk):
    """How many robots called each time that the auctioneer did."""
    calls = [t.sender for t, _ in talk.transcript if t.kind == "call"]
    starts = [k for k, sender in enumerate(calls) if sender == calls[0]] + [len(calls)]
    return [end - start for start, end in pairwise(starts)]


def test_the_ring_doubles_twice_and_then_takes_in_everybody():
    line = [(float(x), 0.0) for x in range(20)]
    view = network(line, 1.1, energy=[*[1.0] * 19, 1e4])
    talk = converse(rfta3, view, (-0.5, 0.0), 0)
    assert talk.award.winner == 19
    assert rings(talk) == [1, 2, 4, 20]


@pytest.mark.parametrize(("robots", "carried"), [(2, True), (9, True), (10, False), (30, False)])
def test_a_component_of_fewer_than_carry_carries_on(robots, carried):
    line = [(0.9 * x, 0.0) for x in range(robots)]
    talk = converse(rfta3, network(line, 1.0, energy=30.0), (-90.0, 0.0), 0)
    assert talk.award.winner is None
    assert bool(talk.award.moves) == carried
    assert not converse(partial(rfta3, carry=robots), network(line, 1.0, energy=30.0),
                        (-90.0, 0.0), 0).award.moves  # fmt: skip


def test_a_small_component_answers_and_a_large_one_is_not_asked_to():
    """Who knows of nine others by its own table need not have anybody counted."""
    line = [(0.9 * x, 0.0) for x in range(3)]
    talk = converse(rfta3, network(line, 1.0, energy=1.0), (-90.0, 0.0), 0)
    answers = [t for t, _ in talk.transcript if t.kind == "bid"]
    assert [t.sender for t in answers] == [2, 1, 2, 1]  # two more, and then nobody new
    assert all(t.bid is None for t in answers)
    star = [(0.0, 0.0), *((cos(k), sin(k)) for k in range(1, 11))]
    talk = converse(rfta3, network(star, 1.0, "udg", 1.0), (0.0, 0.2), 0)
    assert talk.award.winner is None
    assert talk.said("bid") == []


def test_who_knows_of_nobody_calls_once():
    talk = converse(rfta3, network([(0.0, 0.0)], 1.0, energy=1.0), (-90.0, 0.0), 0)
    assert talk.said("call") == [(0, None)] * 2  # for the event, and for who would carry it


def test_a_splinter_carries_the_event_towards_it():
    pair = network([(0.0, 0.0), (0.5, 0.0)], 1.0, energy=[50, 90])
    talk = converse(rfta3, pair, (9.0, 0.0), 0)
    assert talk.award.winner is None
    assert talk.award.moves == (Move(1, (1.5, 0.0)),)


def test_a_splinter_that_can_go_goes():
    pair = network([(0.0, 0.0), (0.5, 0.0)], 1.0, energy=[50, 90])
    assert converse(rfta3, pair, (2.0, 0.0), 0).award.winner is not None


@pytest.mark.parametrize("graph", ["gabriel", "rng", "udg"])
def test_an_event_is_served_whenever_any_robot_of_the_component_can(graph):
    rng = np.random.default_rng(3)
    served = refused = 0
    for _ in range(150):
        energy = np.where(rng.random(30) < 0.12, rng.uniform(20.0, 100.0, 30), 0.5)
        points = random_connected(30, 8.0, 2.6, rng)
        view = network(points, 2.6, graph, energy)
        site = random_points(1, 8.0, rng)[0]
        able = [robot for robot in view if robot.energy >= robot.cost_to(site)]
        winner = converse(rfta3, view, site, int(rng.integers(30))).award.winner
        assert (winner is not None) == bool(able)
        served += winner is not None
        refused += winner is None
    assert min(served, refused) > 10


def test_company_makes_dispensable():
    metric = CompanyShare(length=0.3)
    crowd = network([(0.0, 0.0), (0.1, 0.0), (2.0, 0.0)], 2.5)
    beside, apart = crowd[1], crowd[2]
    site = (1.05, 0.0)
    assert dist(beside.position, site) == pytest.approx(dist(apart.position, site))
    assert metric(beside, site) < metric(apart, site)
    with pytest.raises(ValueError, match="length is 0"):
        CompanyShare(length=0.0)


def test_balance_weighs_the_battery_against_the_trip():
    pair = network([(0.0, 0.0), (3.0, 0.0)], 4.0, energy=[40, 90])
    site = (1.2, 0.0)  # 1.2 m from the one that holds less, 1.8 m from the other
    near, full = pair
    assert CompanyShare(balance=0.0)(near, site) < CompanyShare(balance=0.0)(full, site)
    assert CompanyShare(balance=1.0)(near, site) > CompanyShare(balance=1.0)(full, site)
    ratio = CompanyShare(balance=0.5)(near, site) / CompanyShare(balance=0.5)(full, site)
    assert ratio == pytest.approx(1.2 / 1.8 * (90 / 40) ** 0.5)
    with pytest.raises(ValueError, match="balance is -1"):
        CompanyShare(balance=-1.0)
