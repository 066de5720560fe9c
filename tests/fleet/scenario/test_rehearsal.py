"""Protocols and metrics of the user's are tried out before a run, and what is wrong is said."""

from __future__ import annotations

import pytest

import fleet
from fleet.scenario.errors import BadInput
from fleet.scenario.rehearsal import rehearse
from protocols.catalogue import PROTOCOLS

MINE = '''
from protocols.messages import Award, Transmission

def one(view):
    yield

class NotCalled:
    """Its instances are no protocols."""

def returns(view, event, source):
    return 17

def yields(view, event, source):
    yield 5

def ends(view, event, source):
    yield Transmission("call", source, None)

def breaks(view, event, source):
    yield Transmission("call", source, None)
    return 1 / 0

def talks(view, event, source):
    while True:
        yield Transmission("call", source, None)

def metric(robot):
    return 1.0

def nothing(robot, site):
    return float("nan")

def words(robot, site):
    return "cheap"
'''


@pytest.fixture(scope="module")
def mine(tmp_path_factory):
    path = tmp_path_factory.mktemp("mine") / "mine.py"
    path.write_text(MINE)
    return path


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("one", "takes 1 positional argument but 3 were given"),
        ("NotCalled", "makes what cannot be called"),
        ("returns", "returns int 17; expected a generator of transmissions"),
        ("yields", "it yields 5; expected a Transmission"),
        ("ends", "it ends with None; expected an Award"),
        ("breaks", "fails in line 21 of mine.py: ZeroDivisionError: division by zero"),
        ("talks", "it still talks after 10000 transmissions between two robots"),
    ],
)
def test_what_is_no_protocol_is_refused_before_the_run(mine, name, said):
    with pytest.raises(BadInput, match=r"protocol: ") as refusal:
        fleet.run(fleet.Scenario.of(protocol=f"{mine}:{name}", motion="straight"))
    assert said in str(refusal.value)
    assert f"mine.py:{name}" in str(refusal.value)


def test_a_metric_is_tried_out_too(mine):
    with pytest.raises(BadInput, match=r"takes 1 positional argument but 2 were given"):
        fleet.run(fleet.Scenario.of(protocol={"name": "rfta2", "metric": f"{mine}:metric"}))


@pytest.mark.parametrize(("name", "said"), [("nothing", "nan"), ("words", "'cheap'")])
def test_bids_are_numbers(mine, name, said):
    chosen = {"name": "rfta2", "metric": f"{mine}:{name}"}
    with pytest.raises(BadInput, match=f"bids {said}; expected a number"):
        fleet.run(fleet.Scenario.of(protocol=chosen, motion="straight"))


def test_parameters_that_only_the_protocol_looks_at():
    with pytest.raises(BadInput, match=r"hops is -1; expected 1 or more"):
        fleet.run(fleet.Scenario.of(protocol={"name": "k-sap", "hops": -1}))


@pytest.mark.parametrize("name", sorted(PROTOCOLS))
def test_every_protocol_of_the_catalogue_passes(name):
    function = PROTOCOLS[name].function
    rehearse(function() if isinstance(function, type) else function, name)
