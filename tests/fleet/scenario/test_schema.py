"""The schemas take what is taken when a file is read, and their copies are current."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import jsonschema
import nasty
import pytest

from fleet.catalogue import takers
from fleet.scenario.binding import required
from fleet.scenario.errors import BadInput
from fleet.scenario.json_schema import scenario_schema
from fleet.scenario.loading import load_scenario
from fleet.scenario.model import Scenario
from fleet.scenario.resolving import resolved
from fleet.study.study_file import load_study
from fleet.study.study_schema import study_schema

ROOT = Path(__file__).parents[3]
SCENARIO = jsonschema.Draft202012Validator(scenario_schema())
STUDY = jsonschema.Draft202012Validator(study_schema())


def valid(schema, data):
    # TOML's dates are no JSON; nothing takes them
    return schema.is_valid(json.loads(json.dumps(data, default=str)))


@pytest.mark.parametrize(("kind", "made"), [("scenario", SCENARIO), ("study", STUDY)])
def test_the_copies_in_the_docs_are_current(kind, made):
    copy = (ROOT / "docs" / "schema" / f"{kind}.json").read_text()
    assert json.loads(copy) == made.schema, f"fleet schema {kind} > docs/schema/{kind}.json"
    jsonschema.Draft202012Validator.check_schema(made.schema)


@pytest.mark.parametrize(
    ("key", "name"), [(key, name) for key in nasty.CATALOGUES for name in takers(key)]
)
def test_everything_with_its_defaults_is_valid(key, name):
    choice = {"name": name, **dict.fromkeys(required(takers(key)[name]), "a.csv")}
    whole = resolved(Scenario.of(**{key: choice}))
    assert valid(SCENARIO, json.loads(json.dumps(whole)))
    assert not valid(SCENARIO, whole | {key: {**choice, "no_such_key": 1}})
    assert not valid(SCENARIO, whole | {key: f"{name}x"})


def test_studies_of_the_repository_are_valid():
    found = list(ROOT.glob("studies/*.toml"))
    assert found
    for path in found:
        assert valid(STUDY, tomllib.loads(path.read_text())), path


@pytest.mark.parametrize("kind", ["scenario", "study"])
def test_what_is_read_is_valid(kind, tmp_path, monkeypatch):
    """Whatever the reader takes, the schema takes: nobody is told off for what is right."""
    monkeypatch.chdir(tmp_path)
    read = 0
    for seed in range(400):
        made = nasty.draw(kind, seed)
        nasty.write(made, tmp_path)
        path = tmp_path / f"{kind}.toml"
        try:
            load_scenario(path) if kind == "scenario" else load_study(path)
        except BadInput:
            continue
        data = tomllib.loads(path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n"))
        read += 1
        assert valid(SCENARIO if kind == "scenario" else STUDY, data), path.read_text()
    assert read > 30


@pytest.mark.parametrize(
    "text",
    ['range = "far"', "sead = 1", "[robot]\nmass = true", '[world]\nname = "rooms"\nradius = 1.0',
     'graph = "x"', "[faults]\nplanned = [{time = 1.0}]", "[protocol.search]\nradius = 1.0"],
)  # fmt: skip
def test_slips_of_the_pen_are_marked(text):
    assert not valid(SCENARIO, tomllib.loads(text))
