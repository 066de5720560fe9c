"""Several observers as one: who is told what, and that nobody is forgotten at the end."""

from __future__ import annotations

import pytest

import fleet
from fleet.observer import Audience, Excerpt, Observer, TranscriptLine
from fleet.radio import BrokenProtocol
from protocols.messages import Transmission

LINES = (Transmission("route-greedy", 0, 1), Transmission("call", 1, None))
EXCERPT = Excerpt(7, 2.5, 3, LINES, ((1,), (0, 2)), (1, 4))


class Hears(Observer):
    def __init__(self):
        self.lines = []

    def transmitted(self, excerpt):
        self.lines.extend(excerpt.lines())


class Reads(Observer):
    sample_interval = 0.1

    def __init__(self):
        self.excerpts = []

    def transmitted(self, excerpt):
        self.excerpts.append(excerpt)


class Stumbles(Observer):
    def __init__(self):
        self.over = False

    def closed(self):
        self.over = True
        raise OSError("no space left on device")


def test_an_excerpt_is_told_whole_or_line_by_line():
    hears, reads = Hears(), Reads()
    Audience([hears, reads]).transmitted(EXCERPT)
    assert reads.excerpts == [EXCERPT]
    assert hears.lines == [
        TranscriptLine(7, 2.5, 3, LINES[0], (1,), 1),
        TranscriptLine(8, 2.5, 3, LINES[1], (0, 2), 4),
    ]


def test_what_nobody_overrides_is_told_to_nobody(monkeypatch):
    def fail(*_):
        raise AssertionError("told of what it does not care for")

    audience = Audience([Reads()])
    for hook in ("awarded", "relinked"):
        monkeypatch.setattr(Observer, hook, fail)
    audience.awarded(None, None, 0.0)
    audience.relinked(0.0)


def test_hooks_may_be_set_on_an_observer_or_be_those_of_another():
    class Wrapper:
        def __init__(self, inner):
            self._inner = inner

        def __getattr__(self, name):
            return getattr(self._inner, name)

    plain, seen = Observer(), []
    plain.transmitted = lambda excerpt: seen.extend(excerpt.lines())
    hears = Hears()
    Audience([plain, Wrapper(hears)]).transmitted(EXCERPT)
    assert seen == hears.lines == EXCERPT.lines()
    assert Audience([Wrapper(hears)]).listens
    assert not Audience([Wrapper(Stumbles())]).listens


def test_intervals_are_the_shortest_asked_for():
    slow = Reads()
    slow.sample_interval = 2.0
    audience = Audience([slow, Hears(), Reads()])
    assert (audience.sample_interval, audience.link_interval) == (0.1, None)
    assert Audience().sample_interval is None


def test_only_those_who_listen_are_read_to():
    assert Audience([Hears()]).listens
    assert Audience([Reads()]).listens
    assert not Audience([Stumbles()]).listens


def test_all_are_closed_whatever_one_of_them_raises():
    first, second = Stumbles(), Stumbles()
    with pytest.raises(OSError, match="no space left"):
        Audience([first, second]).closed()
    assert first.over
    assert second.over


def test_what_was_said_is_read_out_even_if_the_protocol_breaks(monkeypatch):
    def broken(view, event, source):
        neighbour = next(iter(view[source].neighbours))
        yield Transmission("route-greedy", source, neighbour)
        raise ArithmeticError("as planned")

    def far(view, event, source):
        stranger = next(r for r in range(len(view)) if r not in view[source].neighbours)
        yield Transmission("call", source, None)
        yield Transmission("route-greedy", source, stranger)

    for protocol, error, kinds in (
        (broken, ArithmeticError, ["route-greedy"]), (far, BrokenProtocol, ["call"])
    ):  # fmt: skip
        hears = Hears()
        monkeypatch.setattr("fleet.assembly.bind_protocol", lambda _, told=protocol: told)
        with pytest.raises(error):
            fleet.run(fleet.Scenario.of(motion="straight", rounds=3), [hears])
        assert [line.transmission.kind for line in hears.lines] == kinds


@pytest.mark.parametrize(
    ("name", "meant"),
    [("award", "awarded"), ("trip_end", "trip_ended"), ("sent", "transmitted"), ("Moved", "moved")],
)
def test_a_misspelt_hook_is_told_with_the_one_that_was_meant(name, meant):
    observer = type("Mine", (Observer,), {name: lambda *_: None})()
    with pytest.raises(TypeError, match=rf"Mine\.{name} is no hook .* did you mean '{meant}'\?"):
        Audience([observer])


def test_a_hook_that_is_hidden_by_what_an_observer_keeps_is_told():
    observer = Observer()
    observer.awarded = {}
    with pytest.raises(TypeError, match=r"Observer.awarded is a dict; .* hook"):
        Audience([observer])


def test_methods_of_an_observers_own_and_what_it_keeps_are_left_alone():
    observer = type("Mine", (Observer,), {"totals": lambda *_: None, "_award": lambda *_: None})()
    observer.awards = []
    Audience([observer])


class Sees(Observer):
    """Keeps what goes wrong, and what robots believed."""

    def __init__(self):
        self.faults, self.air, self.occurred, self.beliefs = [], [], [], {}

    def broke_down(self, fault):
        self.faults.append((fault.time, fault.what, fault.robot))

    def exhausted(self, robot, time):
        self.faults.append((time, "exhausted", robot))

    def blacked_out(self, blackout):
        self.faults.append((blackout.start, "blacked out", None))

    def lifted(self, blackout):
        self.faults.append((blackout.end, "lifted", None))

    def air_changed(self, on_air, time):
        self.air.append((time, list(on_air)))

    def event_occurred(self, task):
        self.occurred.append(task)

    def appraised(self, event, appraisals, time):
        self.beliefs.setdefault(event.id, []).extend(appraisals)


FAULTY = {
    "motion": "straight", "robots": 20, "range": 4.0, "seed": 3,
    "time": {"name": "stream", "rate": 0.2, "duration": 60.0},
    "faults": {
        "planned": [
            {"time": 10.0, "robot": 2, "what": "motor"}, {"time": 20.0, "robot": 3, "what": "all"}
        ],
        "blackouts": [{"start": 30.0, "duration": 5.0, "x": 5.0, "y": 5.0, "radius": 20.0}],
    },
}  # fmt: skip


def test_faults_are_told_when_they_happen():
    sees = Sees()
    fleet.run(fleet.Scenario.of(**FAULTY), [sees])
    planned = [
        (10.0, "motor", 2), (20.0, "all", 3), (30.0, "blacked out", None), (35.0, "lifted", None)
    ]  # fmt: skip
    assert [fault for fault in sees.faults if fault[1] != "exhausted"] == planned
    spent = {(time, robot) for time, what, robot in sees.faults if what == "exhausted"}
    on_air = set(range(20))
    for time, now in sees.air:
        gone, back = on_air - set(now), set(now) - on_air
        if time == 20.0:
            assert gone == {3}
        elif time == 30.0:
            assert not now
        elif time == 35.0:
            assert not gone
        else:
            assert gone == {robot for at, robot in spent if at == time}
        assert bool(back) == (time == 35.0)
        on_air = set(now)


@pytest.mark.parametrize("protocol", ["rfta2", "rfta2ge", "bfs", "optimum", "rfta3"])
def test_what_robots_believed_is_what_decided(protocol):
    class Checks(Sees):
        def awarded(self, event, award, time):
            believed = {a.robot: a for a in self.beliefs[event.id]}
            for bid in award.bids:
                assert believed[bid.robot].cost <= believed[bid.robot].energy
                assert not believed[bid.robot].refusal
            if protocol == "rfta2":
                for bid in award.bids:
                    mine = believed[bid.robot]
                    assert bid.cost == mine.cost - mine.energy

    checks = Checks()
    scenario = fleet.Scenario.of(motion="straight", protocol=protocol, rounds=8, seed=5)
    fleet.run(scenario, [checks])
    assert len(checks.beliefs) >= 8
    assert [task.event.id for task in checks.occurred] == [*range(len(checks.occurred))]


def test_nothing_is_kept_of_what_robots_believe_if_nobody_asks():
    class Peeks(Observer):
        def awarded(self, event, award, time):
            assert all(robot.appraisals is None for robot in self.fleet.robots)

        def run_started(self, fleet):
            self.fleet = fleet

    fleet.run(fleet.Scenario.of(motion="straight", rounds=2), [Peeks()])


@pytest.mark.parametrize("radio", ["ideal", "lossy"])
def test_asking_for_links_on_the_way_changes_nothing(radio):
    class Looking(Observer):
        link_interval = 0.03
        sample_interval = 0.05

        def relinked(self, time):
            """Look."""

    scenario = fleet.Scenario.of(
        motion="straight", seed=5, radio=radio,
        time={"name": "stream", "rate": 4.0, "duration": 20.0},
    )  # fmt: skip
    alone, watched = fleet.run(scenario).as_dict(), fleet.run(scenario, [Looking()]).as_dict()
    del alone["wall_time"], watched["wall_time"]
    assert alone == watched
