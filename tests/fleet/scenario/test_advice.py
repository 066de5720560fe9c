"""What is said to do nothing does nothing, and units that are mixed up are asked about."""

from __future__ import annotations

import pytest

import fleet
from fleet.observer import Observer
from fleet.scenario.errors import BadInput

SMALL = {"motion": "straight", "robots": 20, "range": 4.0, "rounds": 6, "seed": 2}


class Heard(Observer):
    """Keeps what is noticed."""

    def __init__(self):
        self.said = []

    def noticed(self, said):
        """A sentence."""
        self.said.append(said)


def played(**keys):
    """What a run comes to, and what was said before it."""
    ear = Heard()
    row = fleet.run(fleet.Scenario.of(**SMALL | keys), [ear]).as_dict()
    return {n: v for n, v in row.items() if n not in ("wall_time", "search_radius")}, ear.said


IDLE = [
    ({}, {"robot": {"mass": 3.0, "turn_rate": 2.0, "reverse": True, "radius": 0.2}}, "robot.mass"),
    ({}, {"robot": {"payload": 1.0, "scrub": 1.0}}, "robot.scrub"),
    (
        {"motion": "path"},
        {"motion": "path", "robot": {"payload": 3.0, "error": 0.2}},
        "robot.payload, robot.error do nothing",
    ),
    ({"protocol": "bfs"}, {"search_radius": 1.0}, "search_radius does nothing in 'bfs'"),
    ({}, {"time": {"name": "rounds", "offers": 2}}, "time.offers does nothing"),
    (
        {"motion": "path"},
        {"motion": {"name": "path", "per_launch": 4.0, "per_metre": 30.0}},
        "motion.per_metre, motion.per_launch do nothing",
    ),
    ({"motion": "path"}, {"motion": {"name": "path", "bridge": False}}, "motion.bridge"),
    (
        {"motion": {"name": "path", "belief": "path"}},
        {"motion": {"name": "path", "belief": "path", "reachability": False}},
        "motion.reachability",
    ),
    (
        {"radio": {"name": "lossy", "loss": 0.1}},
        {"radio": {"name": "lossy", "loss": 0.1, "falloff": 2.0, "path_loss": 2.0}},
        "radio.falloff",
    ),
    (
        {"world": {"name": "random-hole", "corners": [[1, 1], [4, 2], [2, 5]]}},
        {"world": {"name": "random-hole", "corners": [[1, 1], [4, 2], [2, 5]], "radius": 4.0}},
        "world.radius",
    ),
]


@pytest.mark.parametrize(("without", "with_it", "said"), IDLE, ids=[case[2] for case in IDLE])
def test_what_is_said_to_do_nothing_does_nothing(without, with_it, said):
    plain, silence = played(**without)
    same, sentences = played(**without | with_it)
    assert plain == same
    assert not [text for text in silence if "nothing" in text]
    assert any(said in text for text in sentences), sentences


def test_the_rate_of_a_trace_does_nothing(tmp_path):
    (tmp_path / "trace.csv").write_text("time,x,y\n1,2,3\n5,8,8\n")
    events = {"name": "trace", "occurrences": str(tmp_path / "trace.csv")}
    one, _ = played(events=events, time={"name": "stream", "duration": 30.0})
    two, said = played(events=events, time={"name": "stream", "duration": 30.0, "rate": 9.0})
    assert one == two
    assert "time.rate does nothing with the events of a trace" in said


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"range": 250.0}, "range is 250 m on a floor of 10 m × 10 m: in centimetres?"),
        ({"search_radius": 200.0}, "search_radius is 200 m on a floor"),
        ({"robot": {"turn_rate": 300.0}}, "robot.turn_rate is 300 rad/s: in degrees?"),
        ({"robot": {"cruise": 76.0}}, "robot.cruise is 76 m/s: in centimetres?"),
        ({"robot": {"radius": 10.0}}, "robot.radius is 10 m: in centimetres?"),
    ],
)
def test_units_that_are_mixed_up_are_asked_about(keys, said):
    assert any(text.startswith(said) for text in played(**keys)[1])


def test_nothing_is_said_of_what_has_an_effect():
    assert played()[1] == []
    assert played(robot={"cruise": 1.0, "capacity": 50.0, "extra": {"transmission": 0.1}})[1] == []
    assert played(motion={"name": "path", "belief": "corrected", "per_launch": 3.0})[1] == []


def test_a_corrected_belief_needs_its_correction():
    with pytest.raises(BadInput, match="belief is 'corrected'; expected per_launch or per_metre"):
        played(motion={"name": "path", "belief": "corrected"})
