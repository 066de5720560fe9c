"""Routes: a published network, the delivery guarantee, and the theorem behind GFGF1."""

from __future__ import annotations

from math import dist

import numpy as np
import pytest
from hand_drawn import StillRobot, network, random_connected, random_points, routed
from hypothesis import given, settings
from hypothesis import strategies as st

from protocols.geometry import crossing
from protocols.messages import Event, Point
from protocols.routing import (
    WHOLE_FACE,
    Search,
    _enters_before,
    deliver,
    find,
    greedy,
    walk_face,
)

# Placement of INET's MANET-protocols GPSR showcase (ManetprotocolsShowcaseA); y points down there.
SHOWCASE = {
    "source": (394.0, 189.0),
    "destination": (1230.0, 492.0),
    1: (1064.24, 824.82465),
    2: (940.0, 718.0),
    3: (1304.0, 253.0),
    4: (1331.0, 391.0),
    5: (890.0, 430.0),
    6: (851.0, 573.0),
    7: (1046.0, 112.0),
    8: (901.0, 157.0),
    9: (862.0, 286.0),
    10: (1200.0, 156.0),
    11: (701.0, 373.0),
    12: (529.0, 286.0),
}


@pytest.mark.parametrize(
    ("hand", "route"),
    [
        ("right", [12, 11, 9, 5, 9, 8, 7, 10, 3, 4, "destination"]),
        (
            "left",
            [
                12,
                11,
                9,
                5,
                6,
                2,
                1,
                2,
                6,
                5,
                9,
                11,
                12,
                "source",
                12,
                11,
                9,
                8,
                7,
                10,
                3,
                4,
                "destination",
            ],
        ),
    ],
)
def test_published_network(hand, route):
    names = list(SHOWCASE)
    view = network([(x, -y) for x, y in SHOWCASE.values()], 195.0)
    talk = routed(deliver, view, 0, 1, view[1].position, Search(radius=0.0, hand=hand))
    assert [names[robot] for robot in talk.route] == route


def nearest(view: list[StillRobot], site: Point) -> float:
    return min(dist(robot.position, site) for robot in view)


def sparse_networks(count: int, seed: int):
    """Connected networks of 100 robots with a mean degree of 6 to 7."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        side = (100 * np.pi / rng.uniform(6.6, 7.6)) ** 0.5  # borders take some off
        yield network(random_connected(100, side, 1.0, rng), 1.0), side, rng


def check_delivery(count: int, seed: int) -> None:
    recovered, degree = 0, []
    for view, _, rng in sparse_networks(count, seed):
        source, destination = rng.choice(100, 2, replace=False).tolist()
        talk = routed(deliver, view, source, destination, view[destination].position)
        assert talk.award == destination
        recovered += bool(talk.said("route-face"))
        degree.append(np.mean([len(n) for n in udg_neighbours(view)]))
    assert 6.0 < np.mean(degree) < 7.0
    assert 0.3 < recovered / count < 0.55  # greedy alone would have lost these


def udg_neighbours(view):
    points = np.array([robot.position for robot in view])
    near = ((points[:, None] - points[None]) ** 2).sum(axis=2) <= 1.0
    return [np.flatnonzero(row) for row in near & ~np.eye(len(points), dtype=bool)]


def test_delivery_is_guaranteed():
    check_delivery(200, seed=1)


@pytest.mark.slow
def test_delivery_is_guaranteed_on_ten_thousand_networks():
    check_delivery(10_000, seed=2)


@pytest.mark.parametrize("hand", ["right", "left"])
@pytest.mark.parametrize("change", ["before", "after", "best-angle"])
def test_every_face_rule_delivers(hand, change):
    search = Search(radius=0.0, hand=hand, change=change)
    for view, _, rng in sparse_networks(40, seed=3):
        source, destination = rng.choice(100, 2, replace=False).tolist()
        talk = routed(deliver, view, source, destination, view[destination].position, search)
        assert talk.award == destination


@pytest.mark.parametrize("hand", ["right", "left"])
def test_gfgf1_finds_the_nearest_robot_wherever_the_event_is(hand):
    search = Search(radius=0.0, hand=hand)
    for view, side, rng in sparse_networks(60, seed=4):
        for site in random_points(5, 1.4 * side, rng):
            event = Event(0, (site[0] - 0.2 * side, site[1] - 0.2 * side))
            found = routed(find, view, 7, event, search).award
            assert dist(view[found].position, event.position) == nearest(view, event.position)


@pytest.mark.parametrize("hand", ["right", "left"])
def test_robots_in_one_place_are_passed_by(hand):
    """Several robots that have served one event stand in one place; the lowest id has the links."""
    rng = np.random.default_rng(5)
    search = Search(radius=0.0, hand=hand)
    for _ in range(40):
        points = random_connected(30, 6.0, 1.8, rng)
        crowds = [points[k] for k in rng.integers(0, 30, 12)]
        order = rng.permutation(42)
        everybody = [(points + crowds)[k] for k in order]
        view = network(everybody, 1.8)
        event = Event(0, random_points(1, 6.0, rng)[0])
        for source in range(0, 42, 5):
            found = routed(find, view, source, event, search).award
            assert dist(view[found].position, event.position) == nearest(view, event.position)
            destination = (source + 17) % 42
            if everybody.count(view[destination].position) > 1:
                continue
            talk = routed(deliver, view, source, destination, view[destination].position, search)
            assert talk.award == destination


def test_an_unreachable_destination_is_given_up():
    view = network([(0.0, 0.0), (1.0, 0.0), (1.5, 0.9), (9.0, 0.0)], 1.2)
    talk = routed(deliver, view, 0, 3, view[3].position)
    assert talk.award != 3
    assert len(talk.transcript) < 10


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_the_line_from_a_local_minimum_is_crossed_only_towards_it(seed):
    """In GG of a UDG: an edge that crosses the line from a local minimum u to D has an end
    strictly nearer to D than u. So no change of face is ever needed on a static network.
    """
    rng = np.random.default_rng(seed)
    view = network(random_connected(40, 6.0, 1.6, rng), 1.6)
    site = random_points(1, 6.0, rng)[0]
    for u in view:
        own = dist(u.position, site)
        if any(dist(p, site) < own for p in u.neighbours.values()):
            continue
        for v in view:
            for w, position in v.neighbours.items():
                if u.id in (v.id, w) or crossing(v.position, position, u.position, site) is None:
                    continue
                assert min(dist(v.position, site), dist(position, site)) < own


def test_greedy_stops_at_a_local_minimum_or_within_reach():
    line = network([(float(x), 0.0) for x in range(6)], 1.0)
    assert routed(greedy, line, 0, (9.0, 0.0)).award == 5
    assert routed(greedy, line, 0, (9.0, 0.0), 5.5).award == 4


# A hook; the event D lies beyond its tips. Robot 2 is nearest to it on the lower arm.
#
#   4 5 6 7 8
#   3
#   0 1 2     D
HOOK = [
    (0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (0.0, 2.0), (1.0, 2.0), (2.0, 2.0),
    (3.0, 2.0), (4.0, 2.0),
]  # fmt: skip
D = (5.0, 0.0)


@pytest.mark.parametrize(
    ("radius", "route"),
    [
        (3.0, [2]),  # looked at in the local minimum: robot 2 is 3 m away
        (2.9, [2, 1, 0, 3, 4, 5, 6, 7]),  # at each robot of the face: 7 is 2.83 m away
        (2.3, [2, 1, 0, 3, 4, 5, 6, 7, 8]),  # greedy again from 7, being nearer than 2
        (1.0, [2, 1, 0, 3, 4, 5, 6, 7, 8, 7, 6, 5, 4, 3, 0, 1, 2, 1, 0, 3, 4, 5, 6, 7, 8]),
    ],
)
def test_where_the_search_ends(radius, route):
    view = network(HOOK, 1.05)
    talk = routed(find, view, 1, Event(0, D), Search(radius=radius))
    assert talk.route == route
    assert talk.award == route[-1]


def test_node_rule_stops_before_it_visits_a_robot_twice():
    talk = routed(find, network(HOOK, 1.05), 1, Event(0, D), Search(radius=1.0, stop="node"))
    assert talk.route == [2, 1, 0, 3, 4, 5, 6, 7, 8, 7, 6, 5, 4, 3, 0, 1, 2]
    assert talk.award == 2


def test_check_at_every_hop_stops_sooner():
    line = network([(float(x), 0.0) for x in range(6)], 1.0)
    event = Event(0, (5.0, 0.0))
    assert routed(find, line, 0, event, Search(radius=2.0)).award == 5
    assert routed(find, line, 0, event, Search(radius=2.0, check="hop")).award == 3


def test_alone_in_the_world():
    view = network([(0.0, 0.0)], 1.0)
    assert routed(find, view, 0, Event(0, (3.0, 3.0)), WHOLE_FACE).award == 0


@pytest.mark.parametrize("radius", [-1.0, float("nan")])
def test_search_radius_must_not_be_negative(radius):
    with pytest.raises(ValueError, match="search radius"):
        Search(radius=radius)


@pytest.mark.parametrize("hand", ["right", "left"])
def test_no_packet_goes_round_a_circle_twice_where_links_are_one_way(hand):
    """0 hears 1, and 1, 2, 3 go round in a ring that never comes back to 0."""
    places = [(0.0, 0.0), (-1.0, 0.0), (-2.0, 1.0), (-2.0, -1.0)]
    ahead = {0: 1, 1: 2, 2: 3, 3: 1}
    view = [
        StillRobot(robot, place, 100.0, {ahead[robot]: places[ahead[robot]]})
        for robot, place in enumerate(places)
    ]
    talk = routed(walk_face, view, 0, (9.0, 0.0), Search(radius=0.0, hand=hand))
    edges = [(t.sender, t.receiver) for t, _ in talk.transcript]
    assert edges == [(0, 1), (1, 2), (2, 3), (3, 1)]


def test_a_walk_that_ran_into_its_middle_tries_the_other_hand():
    """By the right hand 1 is left for 2 and 3, which leads back to 1; by the left for 4, nearer."""
    places = [(0.0, 0.0), (-1.0, 0.0), (-1.0, 1.0), (-2.0, 0.5), (1.0, -1.0)]
    links = {0: (1,), 1: (2, 4), 2: (3,), 3: (1,), 4: (1,)}
    view = [
        StillRobot(robot, place, 100.0, {other: places[other] for other in links[robot]})
        for robot, place in enumerate(places)
    ]
    ends = {
        hand: routed(walk_face, view, 0, (9.0, 0.0), Search(radius=0.0, hand=hand)).award
        for hand in ("right", "left")
    }
    assert ends == {"right": 4, "left": 4}


@pytest.mark.parametrize(
    ("beside", "left", "before"),
    [
        ({2: (1.0, 0.2)}, True, True),  # closer to the site's direction than the edge ahead
        ({2: (1.0, -0.7)}, True, False),  # farther off it, on the other side
        ({2: (1.0, 0.2), 3: (-0.2, 1.0)}, True, True),  # clockwise from the edge comes 2,
        ({2: (1.0, 0.2), 3: (-0.2, 1.0)}, False, False),  # and counterclockwise 3
        ({}, True, False),  # nobody else
    ],
)
def test_best_angle_enters_the_face_whose_next_edge_points_closer_to_the_site(beside, left, before):
    """The edge ahead, to robot 1, is 31° off the direction of the site."""
    robot = StillRobot(0, (0.0, 0.0), 100.0, {1: (1.0, 0.6), **beside})
    search = Search(change="best-angle")
    assert _enters_before(search, robot, 1, (5.0, 0.0), left) == before
    assert _enters_before(Search(change="before"), robot, 1, (5.0, 0.0), left)
    assert not _enters_before(Search(change="after"), robot, 1, (5.0, 0.0), left)
