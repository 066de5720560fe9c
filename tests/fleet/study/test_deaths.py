"""Events before the first robot dies on its way: told from the rounds, beside the lifetime."""

from __future__ import annotations

import numpy as np
import pytest

from fleet.study.report.derived import with_deaths
from fleet.study.report.runs import Runs
from fleet.study.report.study_report import write_report
from fleet.study.sweeping import sweep


def table(**columns):
    return Runs({name: np.array(values, object) for name, values in columns.items()})


def test_what_was_served_after_the_first_death_does_not_count():
    runs = table(key=["a", "b", "c"])
    rounds = table(
        key=["a", "a", "a", "b", "a", "b", "b"],
        outcome=["arrived", "stuck", "arrived", "battery empty", "battery empty", "arrived",
                 "nobody"],
    )  # fmt: skip
    assert with_deaths(runs, rounds)["before_death"].tolist() == [2.0, 0.0, 0.0]


def test_where_nobody_dies_it_is_all_that_were_served():
    rounds = table(key=["a", "a", "a"], outcome=["arrived", "arrived", "nobody"])
    assert with_deaths(table(key=["a"]), rounds)["before_death"].tolist() == [2.0]


@pytest.mark.parametrize("tables", [["rounds"], []])
def test_a_report_has_it_if_the_study_asked_for_rounds(tmp_path, tables):
    study = {
        "seeds": 2,
        "tables": tables,
        "scenario": {"motion": "straight", "rounds": 6, "robots": 30, "range": 4.0,
                     "robot": {"capacity": 40.0}},
        "axes": {"protocol": ["rfta2", "gfgf2a"]},
        "report": {"measures": ["lifetime", *(["before_death"] if tables else [])]},
    }  # fmt: skip
    sweep(study, tmp_path, workers=1)
    write_report(tmp_path)
    text = (tmp_path / "report" / "means.csv").read_text()
    assert ("before_death" in text) == bool(tables)
