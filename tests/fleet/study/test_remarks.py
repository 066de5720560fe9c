"""What does nothing in a study is said before it runs, once, with how much of it is meant."""

from __future__ import annotations

from fleet.scenario.model import Scenario
from fleet.study.design import Study
from fleet.study.remarks import study_remarks
from fleet.study.sweeping import sweep

BASE = {"motion": "straight", "rounds": 1, "robots": 30, "range": 4.0}


def test_what_does_nothing_in_any_run_is_said_once(tmp_path):
    study = {"scenario": {**BASE, "robot": {"mass": 20.0}}, "axes": {"range": [4.0, 5.0]}}
    said = []
    sweep(study, tmp_path / "out", workers=1, say=said.append)
    assert said == ["robot.mass does nothing in straight motion, which is Eq. (1) and a speed"]


def test_of_what_does_nothing_in_some_runs_it_is_said_how_many():
    axes = {"motion": ["straight", "path"], "range": [4.0, 5.0]}
    said = list(study_remarks(Study({**BASE, "robot": {"mass": 20.0}}, axes)))
    assert len(said) == 1
    assert said[0].startswith("robot.mass does nothing in straight motion")
    assert said[0].endswith(" (2 of 4 combinations, such as motion=straight range=4.0)")


def test_a_study_of_what_was_meant_has_no_remarks():
    assert not list(study_remarks(Study(Scenario().as_dict() | BASE)))
