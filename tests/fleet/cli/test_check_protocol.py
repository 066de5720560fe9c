"""``fleet check FILE.py:NAME``: a protocol or a metric of the user's."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from fleet.cli import main

FILE = """
from protocols.auctions import keep
from protocols.messages import Award, Transmission
from protocols.metrics import distance
from protocols.rfta import rfta2 as good


def cheats(view, event, source):
    yield from ()
    return keep(view, min(range(len(view)), key=lambda k: distance(view[k], event.position)),
                event, distance)


def mute(view, event, source):
    while True:
        pass
    yield


def thrift(robot, site):
    return robot.cost_to(site)


def named(robot, site):
    return float(robot.id)


def writes(robot, site):
    robot.energy = 0.0
    return 1.0


def nothing(_one):
    return None
"""


@pytest.mark.parametrize(
    ("name", "code", "said"),
    [
        ("good", 0, "yes  decides by what was heard"),
        ("thrift", 0, "yes  bids numbers"),
        ("cheats", 2, "breaks a rule in line 10 of mine.py: robot 0 is asked, but nobody has told"),
        ("named", 2, "no   does not look at names: robot 0"),
        ("writes", 2, "in line 29 of mine.py"),
        ("nothing", 2, "takes 1 arguments; expected a protocol (view, event, source) or a metric"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, name, code, said):
    file = tmp_path / "mine.py"
    file.write_text(FILE)
    ended = CliRunner().invoke(main, ["check", f"{file}:{name}"])
    assert ended.exit_code == code
    assert said in ended.output
    assert ("no   " in ended.output) == (code == 2 and name != "nothing")


@pytest.mark.slow
def test_what_never_ends_is_broken_off(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(FILE)
    ended = CliRunner().invoke(main, ["check", f"{file}:mute"])
    assert ended.exit_code == 2
    assert "does not come to an end" in ended.output
