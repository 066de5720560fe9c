"""One look-up for all that has a name: whatever its case, and with near matches."""

from __future__ import annotations

import pytest

import fleet
from fleet.catalogue import CATALOGUES, known_name, look_up
from fleet.scenario.errors import BadInput
from fleet.scenario.model import Choice, Scenario

KINDS = sorted(CATALOGUES)
NAMED = [(kind, name) for kind in KINDS for name in CATALOGUES[kind]]


@pytest.mark.parametrize(("kind", "name"), NAMED)
def test_everything_is_found_in_upper_and_in_lower_case(kind, name):
    assert known_name(kind, name.upper()) == known_name(kind, name.title()) == name
    assert look_up(kind, name.upper(), kind) is CATALOGUES[kind][name]


@pytest.mark.parametrize("kind", KINDS)
def test_a_near_match_is_suggested_whatever_its_case(kind):
    name = max(CATALOGUES[kind], key=len)
    with pytest.raises(BadInput, match=f"unknown {kind} .*did you mean .*{name}") as found:
        look_up(kind, name.upper() + "X", "that.key")
    assert found.value.problems[0][0] == "that.key"


def test_a_scenario_is_the_same_however_its_names_are_spelt():
    spelt = {
        "protocol": {"name": "RFTA2", "metric": "Energy-Left"}, "world": "Random-Hole",
        "motion": "STRAIGHT", "time": "Stream", "events": "UNIFORM", "radio": "Lossy",
        "robot": "Pioneer",
    }  # fmt: skip
    plain = {key: value.lower() for key, value in spelt.items() if key != "protocol"}
    one = Scenario.of(**spelt)
    other = Scenario.of(**plain, protocol={"name": "rfta2", "metric": "Energy-Left"})
    assert one == other
    assert one.protocol.name == "rfta2"


def test_a_scenario_made_by_hand_may_spell_them_so_too():
    def figures(protocol):
        made = Scenario(protocol=Choice(protocol), motion=Choice("Straight"), rounds=3)
        found = fleet.run(made).as_dict()
        return {key: found[key] for key in found if key not in ("protocol", "wall_time")}

    assert figures("RFTA2") == figures("rfta2")
