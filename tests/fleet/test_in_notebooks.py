"""What a notebook shows of a run and of a study: tables and figures, by themselves."""

from __future__ import annotations

import re

import pytest

import fleet
from fleet.scenario.errors import BadInput
from fleet.summary_lines import summary_lines

STUDY = {
    "scenario": {"motion": "straight", "robots": 40, "range": 3.0, "rounds": 8},
    "axes": {"protocol": ["rfta2", "gfgf2a"], "search_radius": [1.0, 2.0]},
    "seeds": 3,
}


@pytest.fixture(scope="module")
def summary():
    return fleet.run(fleet.Scenario.of(motion="straight", robots=40, range=3.0, rounds=8))


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return fleet.sweep(STUDY, tmp_path_factory.mktemp("study") / "a < b", workers=1)


def test_a_summary_shows_itself_as_the_table_of_the_command(summary):
    page = summary._repr_html_()
    for name, said in summary_lines(summary):
        assert f">{name}</th>" in page
        assert f">{said}</td>" in page
    assert "rfta2 on random, straight motion, seed 0<br>40 robots" in page


def test_a_summary_draws_what_energy_went_into(summary):
    figure = summary.plot()
    assert figure._repr_png_().startswith(b"\x89PNG")
    energy, talk = figure.axes
    assert energy.get_xlabel() == "energy drained [J]"
    drawn = sum(bar.get_width() for bar in energy.patches)
    assert drawn == pytest.approx(summary.energy_drained)
    assert sum(bar.get_width() for bar in talk.patches) == summary.messages


def test_a_study_shows_its_means_a_row_a_combination(study):
    page = study._repr_html_()
    assert "12 of 12 runs done" in page
    assert "a &lt; b" in page
    assert page.count("<tr>") == 1 + 4
    assert "messages per event" in page
    assert re.search(r">\d+\.\d+ ± \d", page)


def test_a_study_draws_the_measures_that_are_asked_for(study):
    figure = study.plot("messages", "energy_drained")
    shown = [axes.get_title(loc="left") for axes in figure.axes if axes.get_visible()]
    assert shown == ["messages", "energy drained [J]"]
    assert figure._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(BadInput, match="measure"):
        study.plot("mesages")


def test_a_study_writes_its_report(study, tmp_path):
    assert study.report() == study.folder / "report.html"
    assert study.report(tmp_path / "page").read_text(encoding="utf-8").startswith("<!doctype html>")
