"""Why a run ends, what it says of it, and that it does end."""

from __future__ import annotations

import pytest

import fleet
from fleet.modes import MOST_OFFERS, Stream
from fleet.observer import Observer
from fleet.scenario.errors import BadInput
from fleet.simulation import UNNOTICED
from fleet.tasks import Task
from protocols.messages import Event


class Heard(Observer):
    """When events were told to robots, and how they ended."""

    def __init__(self):
        self.told, self.closed_as = [], []

    def event_raised(self, event, source, time):
        self.told.append((event.id, time))

    def event_closed(self, event, outcome, time):
        self.closed_as.append((event.id, outcome))


def played(**keys):
    heard = Heard()
    summary = fleet.run(fleet.Scenario.of(**{"motion": "straight", **keys}), [heard])
    return summary, heard


def trace(*occurrences):
    return {"name": "trace", "occurrences": [list(row) for row in occurrences]}


def placed(*positions):
    return {"name": "placed", "positions": [list(place) for place in positions]}


def stream(**keys):
    return {"name": "stream", **keys}


PAIR = placed((1.0, 1.0), (2.0, 1.0))
ALL_BROKEN = {"planned": [{"time": 0.0, "robot": k, "what": "motor"} for k in (0, 1)]}
ALL_GONE = {"planned": [{"time": 0.0, "robot": k} for k in (0, 1)]}


@pytest.mark.parametrize(
    ("ended", "censored", "keys"),
    [
        ("rounds played", True, {"rounds": 3}),
        ("no more events", True, {"world": PAIR, "events": trace((0.0, 1.5, 1.0))}),
        ("time over", True, {"time": stream(duration=20.0)}),
        ("nobody has the energy", False, {"world": PAIR, "robot": {"capacity": 20.0}}),
        ("nobody can drive", False, {"world": PAIR, "faults": ALL_BROKEN}),
        ("nobody on the air", False, {"world": PAIR, "faults": ALL_GONE}),
        ("nobody was found", False, {"world": placed((1.0, 1.0), (9.0, 9.0)), "connected": False,
                                     "handler": "nearest-known", "protocol": "gfgf1",
                                     "events": trace((0.0, 1.0, 2.5), (0.0, 4.9, 4.9)),
                                     "robot": {"capacity": 113.0}}),
        ("no sensor notices events", False, {"sensors": {"miss": 1.0}}),
    ],
)  # fmt: skip
def test_a_run_says_why_it_ended(ended, censored, keys):
    summary, _ = played(**keys)
    assert summary.ended == ended
    assert summary.censored == censored


def test_a_place_that_nobody_can_get_to():
    """The event falls into a corner, behind three robots that can no longer move."""
    corner = [(0.12, 0.4), (0.4, 0.12), (0.35, 0.35)]
    summary, _ = played(
        motion="path", world=placed(*corner, (2.0, 2.0)), events=trace((0.0, 0.12, 0.12)),
        robot={"capacity": 1e4},
        faults={"planned": [{"time": 0.0, "robot": k, "what": "motor"} for k in (0, 1, 2)]},
    )  # fmt: skip
    assert summary.ended == "nobody can reach the event"


def test_a_lifetime_in_rounds_ends_with_the_first_event_that_no_sensor_noticed():
    summary, heard = played(rounds=200, seed=9, sensors={"count": 60, "radio_range": 2.5,
                                                         "miss": 0.4})  # fmt: skip
    outcomes = [outcome for _, outcome in sorted(heard.closed_as)]
    assert summary.ended == "rounds played"
    assert summary.served == 200
    assert summary.lifetime == outcomes.index("lost") < 200
    assert not summary.censored


def test_sensors_that_notice_nothing_end_rounds():
    summary, _ = played(rounds=20, sensors={"miss": 1.0})
    assert summary.events == summary.lost == UNNOTICED
    assert summary.lifetime == 0


CARRIERS = '''
from protocols.messages import Award, Move

def stays(view, event, source):
    """The robot that is told carries the event to where it stands."""
    yield from ()
    return Award(None, source, (), (Move(source, view[source].position),))

def trembles(view, event, source):
    """It carries the event a millionth of a metre further."""
    yield from ()
    x, y = view[source].position
    return Award(None, source, (), (Move(source, (x + 1e-6, y)),))
'''


@pytest.fixture
def carriers(tmp_path):
    path = tmp_path / "carriers.py"
    path.write_text(CARRIERS)
    return path


@pytest.mark.parametrize("radio", ["ideal", {"name": "lossy", "latency": 0.0}])
def test_an_event_that_is_carried_nowhere_waits(carriers, radio):
    summary, heard = played(
        world=PAIR, protocol=f"{carriers}:stays", radio=radio,
        events=trace((1.0, 5.0, 1.0)), time=stream(duration=60.0, backoff=2.0, backoff_most=8.0),
    )  # fmt: skip
    times = [time for _, time in heard.told]
    assert times == pytest.approx([1.0, 3.0, 7.0, 15.0, 23.0, 31.0, 39.0, 47.0, 55.0])
    assert summary.waiting == 1


@pytest.mark.parametrize("protocol", ["stays", "trembles"])
def test_rounds_end_however_often_an_event_is_carried_on(carriers, protocol):
    summary, _ = played(world=PAIR, protocol=f"{carriers}:{protocol}", rounds=5)
    assert summary.served == 0
    assert summary.relocations <= MOST_OFFERS
    assert summary.ended == "nobody was found"


def test_a_stream_gives_up_what_is_carried_on_for_ever(carriers):
    summary, _ = played(
        world=PAIR, protocol=f"{carriers}:trembles", events=trace((1.0, 5.0, 1.0)),
        time=stream(duration=60.0, offers=50),
    )  # fmt: skip
    assert summary.lost_by_reason == {"offered 50 times: it was carried on in vain": 1}
    assert summary.conversations == 50


@pytest.mark.parametrize("radio", ["ideal", {"name": "lossy", "latency": 0.0, "timeout": 0.0}])
def test_a_protocol_that_talks_for_ever_is_stopped(tmp_path, radio):
    path = tmp_path / "talker.py"
    path.write_text(
        "from protocols.messages import Award, Transmission\n"
        "def talks(view, event, source):\n"
        "    while len(view) > 2:\n"  # two of them are those of the rehearsal
        "        yield Transmission('call', source, None)\n"
        "    yield from ()\n"
        "    return Award(source, source)\n"
    )
    scenario = fleet.Scenario.of(
        motion="straight", world=placed((1.0, 1.0), (2.0, 1.0), (2.0, 2.0)),
        protocol=f"{path}:talks", radio=radio, rounds=1,
    )  # fmt: skip
    with pytest.raises((BadInput, RuntimeError), match="does not end"):
        fleet.run(scenario)


def test_the_back_off_doubles_from_the_first_wait():
    mode = Stream(backoff=2.0, backoff_most=60.0, patience=5.0, offers=9).mode(None, lossy=False)
    task = Task(Event(0, (0.0, 0.0)), (0.0, 0.0), 0.0)
    waits = []
    for task.offers in range(1, 10):
        waits.append(mode.next_offer(task, silent=False, anybody=True))
    assert waits == [2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0, 60.0, None]
    task.offers = 1
    assert mode.next_offer(task, silent=True, anybody=True) == 5.0


def test_offers_are_that_far_apart():
    """Nobody can drive: the event is offered again and again, until it is given up."""
    summary, heard = played(
        world=PAIR, faults=ALL_BROKEN, events=trace((1.0, 5.0, 1.0)),
        time=stream(duration=100.0, backoff=1.5, offers=5),
    )  # fmt: skip
    assert [time for _, time in heard.told] == pytest.approx([1.0, 2.5, 5.5, 11.5, 23.5])
    assert summary.lost_by_reason == {"offered 5 times: nobody could take it": 1}


def test_utilisation_counts_who_is_still_under_way_at_the_end():
    """A robot sets off at 1 s, and would drive for longer than the run lasts."""
    summary, _ = played(
        world=PAIR, events=trace((1.0, 9.0, 9.0)), time=stream(duration=5.0),
        robot={"capacity": 1e4},
    )  # fmt: skip
    assert summary.waiting == 1
    assert summary.stream.utilisation == pytest.approx((5.0 - 1.0) / (2 * 5.0))


def test_eq_1_is_charged_to_the_event_however_far_the_robot_got():
    class Trips(Observer):
        def trip_ended(self, event, trip):
            self.trip = trip

    trips = Trips()
    scenario = fleet.Scenario.of(
        motion="straight", world=placed((1.0, 1.0)), connected=False,
        events=trace((0.0, 5.0, 4.0)), time=stream(duration=30.0),
        robot={"capacity": 1e4}, faults={"planned": [{"time": 2.0, "robot": 0, "what": "motor"}]},
    )  # fmt: skip
    summary = fleet.run(scenario, [trips])
    assert trips.trip.outcome == "broken down"
    assert summary.energy_predicted == pytest.approx(19.355789473684212 * 5.0)  # 3, 4, 5
    assert summary.distance_per_robot == pytest.approx(2.0 * 0.76)


def test_a_late_bid_is_not_counted():
    """The robot that calls cannot drive; a bid takes a tenth of a second, a call another."""

    def winner(listening):
        summary, _ = played(
            world=placed((1.0, 1.0), (3.0, 1.0), (5.0, 1.0)), protocol="rfta2",
            range=2.5, search_radius=0.5, handler="nearest-known",
            radio={"name": "lossy", "latency": 0.1}, events=trace((5.0, 3.0, 1.0)),
            time=stream(duration=60.0, listening=listening, offers=1),
            faults={"planned": [{"time": 1.0, "robot": 1, "what": "motor"}]},
        )  # fmt: skip
        return summary.served

    assert winner(listening=0.25) == 1
    assert winner(listening=0.05) == 0
