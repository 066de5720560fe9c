"""Over a radio that takes time: packets that go in circles, robots that fall silent."""

from __future__ import annotations

import pytest

import fleet

TRIANGLE = [[1.0, 1.0], [3.0, 1.0], [2.0, 2.7]]

CIRCLES = '''
from protocols.auctions import keep
from protocols.messages import Award, Transmission
from protocols.metrics import distance

def circles(view, event, source):
    """A packet goes round and round; a search that starts at robot 1 ends there."""
    here = source
    while len(view) == 3 and source != 1:  # there are two robots in the rehearsal
        heard = yield Transmission("route-greedy", here, (here + 1) % 3)
        here = heard[0]
    return keep(view, here, event, distance)

def forever(view, event, source):
    """A packet goes round and round."""
    here = source
    while len(view) == 3:
        heard = yield Transmission("route-greedy", here, (here + 1) % 3)
        here = heard[0]
    return keep(view, here, event, distance)
'''


@pytest.fixture
def circles(tmp_path):
    path = tmp_path / "circles.py"
    path.write_text(CIRCLES)
    return path


def played(protocol, **keys):
    scenario = fleet.Scenario.of(
        motion="straight", protocol=protocol, range=2.5, handler="nearest-known", radio="lossy",
        world={"name": "placed", "positions": TRIANGLE},
        events={"name": "trace", "occurrences": [[5.0, 1.0, 1.0]]},
        **({"time": {"name": "stream", "duration": 60.0, "offers": 1}} | keys),
    )  # fmt: skip
    return fleet.run(scenario)


def test_a_packet_that_went_in_circles_starts_anew_from_where_it_stands(circles):
    """After the 31st hop of thirty that three robots are allowed it stands at robot 1."""
    summary = played(f"{circles}:circles")
    assert summary.restarts == 1
    assert summary.hops_greedy == 31
    assert (summary.served, summary.broken) == (1, 0)


def test_a_packet_that_goes_in_circles_whatever_is_done_is_given_up(circles):
    summary = played(f"{circles}:forever")
    assert summary.restarts == 3
    assert summary.hops_greedy == 4 * 31
    assert summary.lost_by_reason == {"its packet went round in circles": 1}


def test_a_packet_whose_robot_falls_silent_is_gone(circles):
    """Robot 1 is gone by the time that the packet is to go on from it."""
    gone = {"planned": [{"time": 5.001, "robot": 1}]}
    summary = played(f"{circles}:forever", faults=gone)
    assert summary.broken == 1
    assert summary.hops_greedy == 1
