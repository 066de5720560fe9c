"""The reference pages name every key there is, with its default, and none that there is not."""

from __future__ import annotations

import inspect
import re
import tomllib
from dataclasses import MISSING, fields
from pathlib import Path

import pytest

import fleet
from fleet.faults import Blackout, Faults, PlannedBreakdown
from fleet.modes import Rounds, Stream
from fleet.motion.options import DriveOptions
from fleet.power import ExtraPower, PowerModel
from fleet.radio.csma import CsmaSpec
from fleet.radio.lossy import RadioSpec
from fleet.radio.trace import TraceSpec
from fleet.results import Summary
from fleet.robot import RobotSpec
from fleet.scenario.model import Scenario
from fleet.service import StreamFigures
from fleet.study.side_tables import TABLES
from worlds.catalogue import EVENTS, WORLDS
from worlds.sensors import SensorSpec

DOCS = Path(__file__).parents[1] / "docs"
SCENARIOS = (DOCS / "scenarios.md").read_text(encoding="utf-8")
RESULTS = (DOCS / "results.md").read_text(encoding="utf-8")
PROSE = {"robots", "robot"}  # whose defaults are told in words


def of_class(kind):
    return {
        f.name: ... if f.default is MISSING and f.default_factory is MISSING else f.default
        for f in fields(kind)
    }


def of_function(function):
    parameters = inspect.signature(function).parameters.values()
    return {
        p.name: ... if p.default is p.empty else p.default
        for p in parameters
        if p.kind is p.KEYWORD_ONLY
    }


def tables():
    """Each table of the page: the text since the one before, and its keys with their defaults."""
    found = []
    for before, table in re.findall(r"((?:(?!^\|).*\n)*)((?:^\|.*\n)+)", SCENARIOS, re.MULTILINE):
        rows = [line.strip("|\n").split("|") for line in table.splitlines()[2:]]
        found.append((before, {row[0].strip(" `"): row[1].strip() for row in rows}))
    return found


def table_after(words):
    (keys,) = [keys for before, keys in tables() if words in before]
    return keys


DESCRIBED = [
    ("## The run", of_class(Scenario)),
    ("## Robot", of_class(RobotSpec)),
    ("`robot.power` is", of_class(PowerModel)),
    ("`robot.extra` is", of_class(ExtraPower)),
    ("## Motion", of_class(DriveOptions)),
    ("`rounds`: ", of_class(Rounds)),
    ("`stream`: ", of_class(Stream)),
    ("`lossy`: ", of_class(RadioSpec)),
    ("`csma`: ", of_class(CsmaSpec)),
    ("`trace` among the radios", of_class(TraceSpec)),
    ("## Faults", of_class(Faults)),
    ("A planned breakdown:", of_class(PlannedBreakdown)),
    ("A blackout:", of_class(Blackout)),
    ("## Sensors", of_class(SensorSpec)),
    *((f"`{name}`: ", of_function(EVENTS[name].function)) for name in EVENTS if name != "uniform"),
    *((f"`{name}`:", of_function(WORLDS[name].function)) for name in WORLDS),
]


@pytest.mark.parametrize(("words", "expected"), DESCRIBED, ids=[words for words, _ in DESCRIBED])
def test_every_key_is_there_with_its_default(words, expected):
    described = table_after(words)
    assert list(described) == list(expected)
    for name, default in expected.items():
        said = described[name]
        if default is ...:
            assert said == "required", name
        elif default is None or default == ():
            assert said == "none" or name in PROSE
        elif isinstance(default, tuple):
            assert said == ", ".join(map(str, default))
        elif isinstance(default, bool | int | float | str):
            assert_default(said.strip("`"), default)


def assert_default(said, default):
    value = tomllib.loads(f"x = {said}")["x"]
    assert (
        value == pytest.approx(default, rel=1e-3)
        if isinstance(default, float)
        else (value == default)
    )


@pytest.mark.parametrize("kind", [Summary, StreamFigures])
def test_every_figure_is_defined(kind):
    for field in fields(kind):
        assert f"`{field.name}`" in RESULTS


@pytest.mark.parametrize("name", TABLES)
def test_every_column_of_a_table_is_defined_under_its_name(name):
    table = TABLES[name]()
    fleet.run(fleet.Scenario.of(motion="straight", rounds=1), [table])
    described = RESULTS.partition(f"`{name}`: a row")[2].partition("\n`")[0]
    told = re.findall(r"`(\w+)`", "".join(re.findall(r"^\| (`.*?) \|", described, re.MULTILINE)))
    assert told == list(table.rows[0])
