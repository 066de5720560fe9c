"""The other families, word by word: routing alone, flooding, AAP, MIA-TA, and who knows all."""

from __future__ import annotations

from functools import partial
from itertools import permutations
from math import dist, inf

import numpy as np
import pytest
from hand_drawn import PER_METRE, converse, network, random_connected, random_points

from protocols.adaptive import aap
from protocols.central import assign_all, gfg, optimum
from protocols.connectivity import can_be_spared, mia_ta
from protocols.flooding import bfs, k_saap, k_sap
from protocols.gfgf import face, gfgf1, gfgf2a, greedy_only
from protocols.messages import Event
from protocols.metrics import energy_left
from protocols.routing import Search

# A hook; the event lies beyond its tips. Robot 2 is nearest to it on the lower arm.
#
#   4 5 6 7 8
#   3
#   0 1 2     *
HOOK = [
    (0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (0.0, 2.0), (1.0, 2.0), (2.0, 2.0),
    (3.0, 2.0), (4.0, 2.0),
]  # fmt: skip
SITE = (5.0, 0.0)


def test_greedy_gets_stuck_at_the_tip():
    talk = converse(greedy_only, network(HOOK, 1.05), SITE, 0)
    assert talk.route == [1, 2]
    assert talk.award.winner == 2


def test_gfgf1_walks_on_to_the_nearest():
    talk = converse(gfgf1, network(HOOK, 1.05), SITE, 1)
    assert talk.award.winner == 8
    assert len(talk.said("route-greedy")) == 2  # to 2, and from 7
    assert len(talk.said("route-face")) == 7 + 16  # to 7, and all the way round


def test_gfgf2a_is_content_with_the_search_radius():
    talk = converse(gfgf2a, network(HOOK, 1.05), SITE, 1)
    assert talk.award.winner == 8  # 2.24 m away, the first within 2 m is nobody
    wide = partial(gfgf2a, search=Search(radius=3.0))
    assert converse(wide, network(HOOK, 1.05), SITE, 1).award.winner == 2


def test_gfgf2a_does_not_send_who_cannot_afford_it():
    view = network(HOOK, 1.05, energy=[100] * 8 + [5])
    assert converse(gfgf2a, view, SITE, 1).award.winner is None


def test_face_walks_faces_only():
    talk = converse(partial(face, search=Search(radius=2.3)), network(HOOK, 1.05), SITE, 1)
    assert talk.said("route-greedy") == []
    assert talk.route == [2, 1, 0, 3, 4, 5, 6, 7, 8]
    assert talk.award.winner == 8


def test_face_changes_faces_along_the_line():
    """A ladder, the event to its right: the rungs are passed by, the last leads outside."""
    ladder = [(float(x), y) for x in range(5) for y in (0.0, 1.0)]
    search = Search(radius=0.75)
    talk = converse(partial(face, search=search), network(ladder, 1.05), (4.6, 0.4), 0)
    assert talk.award.winner == 8
    assert talk.route == [1, 3, 5, 7, 9, 7, 5, 3, 1, 0, 2, 4, 6, 8]
    across = partial(face, search=Search(radius=0.75, change="after"))
    assert len(converse(across, network(ladder, 1.05), (4.6, 0.4), 0).route) <= 9


def test_gfg_goes_straight_to_the_nearest_that_can():
    view = network(HOOK, 1.05, energy=[100] * 8 + [5])
    talk = converse(gfg, view, SITE, 1)
    assert talk.award.winner == 7
    assert talk.route == [2, 1, 0, 3, 4, 5, 6, 7]


# A line of robots; the call starts at its end.
LINE = [(float(x), 0.0) for x in range(6)]


def test_k_sap_asks_k_hops_deep_and_hears_everybody():
    view = network(LINE, 1.05, energy=[60, 61, 62, 50, 64, 100])
    talk = converse(partial(k_sap, hops=3), view, (0.0, 0.5), 0)
    assert talk.said("call") == [(0, None), (1, None), (2, None)]
    assert talk.said("bid") == [(1, 0), (2, 1), (1, 0)]  # robot 3 cannot afford it
    assert talk.award.winner == 0


def test_k_saap_passes_on_the_best():
    view = network(LINE, 1.05, energy=[60, 61, 100, 63, 64, 100])
    talk = converse(partial(k_saap, hops=3), view, (2.0, 0.5), 0)
    assert talk.said("bid") == [(3, 2), (2, 1), (1, 0)]
    assert talk.said("assign") == [(0, 1), (1, 2)]
    assert talk.award.winner == 2


def test_k_saap_and_k_sap_choose_alike_and_aggregation_saves():
    rng = np.random.default_rng(1)
    for _ in range(10):
        view = network(random_connected(40, 8.0, 2.5, rng), 2.5, energy=rng.uniform(5, 100, 40))
        site = random_points(1, 8.0, rng)[0]
        sap, saap = (converse(p, view, site, 0) for p in (k_sap, k_saap))
        assert sap.award.winner == saap.award.winner
        assert len(saap.transcript) <= len(sap.transcript)
        assert len(saap.said("bid")) <= 39


def test_greedy_extension_goes_on_beyond_k_hops():
    view = network(LINE, 1.05, energy=[60, 61, 70, 80, 64, 100])
    plain = converse(partial(k_sap, hops=2), view, (2.5, 0.5), 0)
    extended = converse(partial(k_sap, hops=2, greedy_extension=True), view, (2.5, 0.5), 0)
    assert plain.award.winner == 2
    assert extended.award.winner == 3


def test_bfs_calls_each_neighbour_by_itself():
    view = network(LINE, 1.05, energy=[60, 61, 62, 63, 64, 100])
    talk = converse(partial(bfs, hopmax=3), view, (0.0, 0.5), 1)
    assert talk.said("call") == [(1, 0), (1, 2), (2, 3), (3, 4)]


def test_aap_is_content_with_one_ring_where_many_can():
    star = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (2.0, 0.0)]
    view = network(star, 1.05)
    near = converse(partial(aap, wanted=4), view, (0.1, 0.0), 0)
    assert near.said("call") == [(0, None)]
    far = converse(partial(aap, wanted=9), view, (0.1, 0.0), 0)
    assert len(far.said("call")) > 1


def test_mia_ta_keeps_the_bridge_in_its_place():
    """Robot 1 joins 0 and 2; the fullest, it may not go all the same."""
    view = network(LINE[:3], 1.05, energy=[50, 100, 60])
    assert [can_be_spared(robot) for robot in view] == [True, False, True]
    talk = converse(mia_ta, view, (1.0, 0.5), 1)
    assert talk.award.winner == 2
    alone = network(LINE[:3], 1.05, energy=[1, 100, 1])
    assert converse(mia_ta, alone, (1.0, 0.5), 1).award.winner is None


def test_sparing_a_robot_never_cuts_the_network():
    from protocols.topology import connected, unit_disc

    rng = np.random.default_rng(2)
    spared = 0
    for _ in range(10):
        points = random_connected(40, 8.0, 2.0, rng)
        for robot in network(points, 2.0):
            if can_be_spared(robot):
                spared += 1
                rest = np.array([p for k, p in enumerate(points) if k != robot.id])
                assert connected(39, unit_disc(rest, 2.0))
    assert spared > 100


def test_optimum_is_the_best_of_all():
    rng = np.random.default_rng(3)
    view = network(random_points(30, 9.0, rng), 2.0, energy=rng.uniform(0, 80, 30))
    site = (4.0, 4.0)
    able = [robot for robot in view if robot.energy >= robot.cost_to(site)]
    talk = converse(optimum, view, site, 3)
    assert talk.award.winner == min(able, key=lambda r: dist(r.position, site)).id
    assert talk.transcript == []


@pytest.mark.parametrize("seed", range(8))
def test_assigning_several_events_at_once_costs_least(seed):
    rng = np.random.default_rng(seed)
    view = network(random_points(5, 6.0, rng), 9.0, energy=rng.uniform(20, 90, 5))
    events = [Event(10 + k, place) for k, place in enumerate(random_points(3, 6.0, rng))]
    chosen = assign_all(view, events)
    assert len(set(chosen.values())) == len(chosen)
    served, cost = best_by_trying(view, events)
    assert len(chosen) == served
    by_id = {event.id: event for event in events}
    total = sum(dist(view[r].position, by_id[e].position) for e, r in chosen.items())
    assert total == pytest.approx(cost)


def best_by_trying(view, events):
    """The most events served, and the least total distance of doing so."""
    best = (0, inf)
    for robots in permutations([*range(len(view)), None, None, None], len(events)):
        pairs = [(view[r], e) for r, e in zip(robots, events, strict=True) if r is not None]
        if all(r.energy >= r.cost_to(e.position) for r, e in pairs):
            cost = sum(dist(r.position, e.position) for r, e in pairs)
            best = max(best, (len(pairs), cost), key=lambda b: (b[0], -b[1]))
    return best


def test_nobody_can_serve_any():
    assert assign_all(network([(0.0, 0.0)], 1.0, energy=0.0), [Event(0, (5.0, 5.0))]) == {}


def test_assignment_also_minimises_metrics_that_are_negative():
    view = network([(0.0, 0.0), (1.0, 0.0)], 2.0, energy=[100, 30])
    assert assign_all(view, [Event(0, (0.5, 0.0))], energy_left) == {0: 0}
    assert view[0].cost_to((0.5, 0.0)) == pytest.approx(0.5 * PER_METRE)


@pytest.mark.parametrize(
    ("able", "wanted", "depth"),
    [(1, 8, 3), (2, 8, 2), (4, 8, 2), (4, 4, 1), (1, 17, 4), (1, 16, 4), (1, 100, 4), (0, 4, 2)],
)
def test_after_aap_the_depth_follows_from_the_first_bids(able, wanted, depth):
    """k = √(wanted/b) for b bids at one hop, rounded up, at most 4: a star of four arms."""
    arms = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    points = [(0.0, 0.0), *((k * x, k * y) for k in range(1, 7) for x, y in arms)]
    energy = [100.0] + [100.0 if k < able else 0.1 for k in range(4)] + [0.1] * 20
    view = network([(float(x), float(y)) for x, y in points], 1.1, energy=energy)
    talk = converse(partial(aap, wanted=wanted), view, (0.0, 0.0), 0)
    calls = [t.sender for t, _ in talk.transcript if t.kind == "call"]
    second = calls[1:]  # the first ring's call is the auctioneer's alone
    assert len(second) == (0 if depth == 1 else 1 + 4 * (depth - 1))
