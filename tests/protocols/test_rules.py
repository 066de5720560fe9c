"""Protocols that cheat or err: each is one sentence with the rule, the robot and the line."""

from __future__ import annotations

import pytest

from fleet import Scenario, run
from fleet.scenario.errors import BadInput

PRELUDE = """
from protocols.auctions import keep
from protocols.messages import Award, Bid, Move, Transmission
from protocols.metrics import distance


def mine(view, event, source):
    me = view[source]
    near = next(iter(me.neighbours), None)
    if event.id < 3 or near is None:  # it behaves at first
        yield Transmission("call", source, None)
        return keep(view, source, event, distance)
"""
LINE = PRELUDE.count("\n") + 1  # of the first line of a case


def play(tmp_path, body, ending="    return Award(None, source)\n", after="", **more):
    file = tmp_path / "cheat.py"
    file.write_text(PRELUDE + "".join(f"    {line}\n" for line in body) + ending + after)
    settings = {"motion": "straight", "robots": 60, "rounds": 8, "robot": {"capacity": 1e4}}
    return run(Scenario.of(protocol=f"{file}:mine", **settings, **more))


CASES = {
    "asks another": (["view[near].energy"], r"robot \d+ is asked, but nobody has told it"),
    "asks everybody": (["[robot.energy for robot in view]"], "all robots are asked"),
    "drains": (["me.battery.drain(-1e9)"], r"robot \d+ is asked for 'battery'"),
    "writes": (["me.position = event.position"], r"robot \d+ is written to \(position\)"),
    "deletes": (["del me.position"], r"robot \d+ is written to \(position\)"),
    "speaks for another": (
        ['yield Transmission("call", near, None)'],
        r"robot \d+ speaks, but nobody has told it",
    ),
    "says another thing": (["yield 3"], "it yields 3; expected a Transmission"),
    "misspells": (
        ['yield Transmission("asign", source, near)'],
        "kind is 'asign'; did you mean 'assign'",
    ),
    "says nothing": (['yield Transmission("", source, None)'], "kind is ''; expected a word"),
    "nobody sends": (['yield Transmission("call", -1, None)'], "robot -1 speaks; expected one of"),
    "half a robot": (
        ['yield Transmission("call", float(source), None)'],
        r"robot \d+.0 speaks; expected one of 0 to 59",
    ),
    "to nobody": (
        ['yield Transmission("assign", source, 99)'],
        r"assign from robot \d+ to robot 99, which is not among its neighbours",
    ),
    "no link": (
        [
            "far = next(k for k in range(60) if k != source and k not in me.neighbours)",
            'yield Transmission("assign", source, far)',
        ],
        r"assign from robot \d+ to robot \d+, which is not among its neighbours",
    ),
    "no number": (
        ['yield Transmission("bid", source, near, Bid(float("nan"), source))'],
        r"robot \d+ bids nan; expected a number",
    ),
    "for another": (
        ['yield Transmission("bid", source, near, Bid(1.0, near))'],
        r"robot \d+ bids, but nobody has told it",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_broken_rule_is_said_with_its_line(tmp_path, case):
    body, sentence = CASES[case]
    line = LINE + len(body) - 1
    with pytest.raises(BadInput, match=rf"breaks a rule in line {line} of cheat.py: .*{sentence}"):
        play(tmp_path, body)


@pytest.mark.parametrize(
    ("ending", "sentence"),
    [
        ("Award(-1, source)", "robot -1 wins; expected one of 0 to 59"),
        ("Award(99, source)", "robot 99 wins; expected one of 0 to 59"),
        ("Award(True, source)", "robot True wins; expected one of"),
        ("Award(near, source)", r"robot \d+ wins, but nobody has told it"),
        ("Award(None, near)", r"robot \d+ is named as the auctioneer, but nobody has told it"),
        ("Award(source, source, (Bid('cheap', source),))", r"robot \d+ bids 'cheap'; expected a n"),
        ("Award(None, source, (), (Move(near, (1.0, 1.0)),))", r"robot \d+ is moved, but nobody"),
        ("Award(None, source, (), (Move(source, (1.0, float('inf'))),))", "expected x, y"),
        ("source", r"it ends with \d+; expected an Award"),
        ("None", "it ends with None; expected an Award"),
    ],
)
def test_an_award_that_cannot_be_is_said(tmp_path, ending, sentence):
    with pytest.raises(BadInput, match=f"breaks a rule at the end of mine, in line 7 .*{sentence}"):
        play(tmp_path, [], f"    return {ending}\n")


def test_who_catches_everything_does_not_get_away(tmp_path):
    body = ["try:", "    view[near].energy", "except BaseException:", "    pass"]
    caught = ["try:", '    yield Transmission("call", near, None)', "except BaseException:"]
    with pytest.raises(BadInput, match=r"robot \d+ speaks, but nobody has told it"):
        play(tmp_path, [*body, *caught, "    pass"])


def test_neighbours_are_read_only(tmp_path):
    with pytest.raises(BadInput, match=f"fails in line {LINE} of cheat.py: AttributeError"):
        play(tmp_path, ["me.neighbours.clear()"])


def test_who_has_heard_may_be_asked_speak_and_win(tmp_path):
    body = [
        'heard = yield Transmission("call", source, None)',
        "far = heard[0]",
        "bid = Bid(view[far].energy, far)",
        'yield Transmission("bid", far, source, bid)',
        'yield Transmission("assign", source, far, bid)',
    ]
    able = (
        "    return Award(far if view[far].energy >= view[far].cost_to(event.position) else None,"
    )
    summary = play(tmp_path, body, able + " source, (bid,))\n")
    assert summary.messages_by_kind["assign"] >= 1


def test_a_kind_of_its_own_is_counted(tmp_path):
    ending = '    yield Transmission("gossip", source, None)\n    return keep(view, source, event,'
    summary = play(tmp_path, [], ending + " distance)\n")
    assert summary.messages_by_kind["gossip"] == 5
    assert summary.messages == sum(summary.messages_by_kind.values()) == summary.events == 8


def test_a_baseline_that_says_so_may_know_everybody(tmp_path):
    ending = (
        "    return Award(None, source, tuple(Bid(robot.energy, robot.id) for robot in view))\n"
    )
    with pytest.raises(BadInput, match="all robots are asked"):
        play(tmp_path, [], ending)
    assert play(tmp_path, [], ending, "mine.all_knowing = True\n").events == 4


def test_a_link_that_is_lost_on_the_air_is_no_fault_of_the_protocol_s(tmp_path):
    body = ['heard = yield Transmission("call", source, None)']
    summary = play(tmp_path, body, radio={"name": "lossy", "loss": 0.5})
    assert summary.events >= 4
