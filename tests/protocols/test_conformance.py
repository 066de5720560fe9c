"""Every protocol of the catalogue passes the battery, and the battery sees what is wrong."""

from __future__ import annotations

from inspect import isclass

import pytest
from hand_drawn import converse, network

from protocols.auctions import award, call, keep, offer
from protocols.catalogue import PROTOCOLS
from protocols.conformance import CHECKS, GRAPHS, problem
from protocols.messages import Award, Bid, Transmission
from protocols.metrics import distance, energy_left
from protocols.rules import all_knowing


@pytest.fixture(params=sorted(PROTOCOLS))
def entry(request):
    return PROTOCOLS[request.param]


def made(entry):
    return entry.function() if isclass(entry.function) else entry.function


@pytest.mark.parametrize("check", CHECKS)
@pytest.mark.parametrize("graph", GRAPHS)
def test_every_protocol_passes(entry, check, graph):
    assert problem(check, made(entry), [graph]) == ""


def test_who_knows_all_says_so(entry):
    assert all_knowing(made(entry)) == (not entry.local)


def test_a_robot_alone_decides_alone(entry):
    view = network([(0.0, 0.0)], 1.0)
    assert converse(made(entry), view, (0.5, 0.0), 0).award.winner == 0


def forgets(view, event, source, *, _seen=[]):  # noqa: B006  # that is the fault
    """Acts on what happened before."""
    _seen.append(source)
    if len(_seen) % 2:
        yield Transmission("call", source, None)
    return Award(None, source)


def calls_one(view, event, source):
    for robot in (yield Transmission("call", source, None)):
        yield Transmission("assign", source, robot)
    return keep(view, source, event, distance)


def sends_anybody(view, event, source):
    yield from ()
    return Award(source, source)


def lowest_id(view, event, source):
    heard = yield Transmission("call", source, None)
    able = [robot for robot in heard if offer(view[robot], event, distance)]
    bids = [Bid(float(robot), robot) for robot in able]
    return (yield from award(source, dict.fromkeys(heard, source), bids))


def counts_who_was_reached(view, event, source):
    """Widens its call by how many heard it, which nobody has told it."""
    from protocols.auctions import AuctionRules

    reached = yield from call(view, source, AuctionRules(hops=3))
    if len(reached) % 2:
        yield Transmission("call", source, None)
    return keep(view, source, event, distance)


def reads_those_called(view, event, source):
    """Bids are compared that nobody has sent."""
    heard = yield Transmission("call", source, None)
    bids = [bid for robot in heard if (bid := offer(view[robot], event, energy_left))]
    return (yield from award(source, dict.fromkeys(heard, source), bids))


@pytest.mark.parametrize(
    ("protocol", "check"),
    [
        (forgets, "says the same again"),
        (calls_one, "speaks the language"),
        (sends_anybody, "sends who can afford the trip"),
        (lowest_id, "does not look at names"),
        (counts_who_was_reached, "decides by what was heard"),
        (reads_those_called, "decides by what was heard"),
    ],
)
def test_the_battery_sees_it(protocol, check):
    assert problem(check, protocol, ["gabriel"]) != ""
