"""``fleet energy`` from end to end."""

from __future__ import annotations

import csv
import html
import re
from dataclasses import replace

import pytest
from click.testing import CliRunner

from fleet.cli import main
from fleet.experiments.energy import sensitivity, settings
from fleet.robot import PRESETS
from fleet.study import StudyResult

NAMES = (
    "distance", "presets", "parts", "models", "settings", "lifetimes-trips", "traffic", "lifetimes",
    "differences", "choices", "headlines",
)  # fmt: skip


def energy(*arguments):
    return CliRunner().invoke(main, ["energy", *map(str, arguments)], catch_exceptions=False)


@pytest.fixture
def tiny(monkeypatch):
    """The study with two settings, two places and two protocols."""
    monkeypatch.setattr(settings, "QUICK", settings.Size(2, 60, 2, 1, 1))
    chosen = [s for s in settings.SETTINGS if s.name in {settings.PAPER, "rooms"}]
    monkeypatch.setattr(settings, "HEADLINES", {settings.PAPER: {}})
    monkeypatch.setattr(sensitivity, "COMPARED", (("rfta2", "gfgf2a"),))
    monkeypatch.setattr(settings, "SETTINGS", tuple(chosen))
    monkeypatch.setattr(settings, "PLACES", settings.PLACES[::2][:2])
    monkeypatch.setattr(settings, "PROTOCOLS", ("rfta2", "gfgf2a"))
    monkeypatch.setattr(settings, "RATES", (1.0, 4.0))
    monkeypatch.setattr(settings, "STREAM", 20.0)


def lead_of(out):
    page = (out / "report.html").read_text("utf-8")
    return html.unescape(re.search(r"<p[^>]*>(.*?)</p>", page, re.DOTALL)[1])


def test_a_tiny_study_is_run_and_reported(tmp_path, tiny):
    out = tmp_path / "out"
    done = energy("--out", out, "--quick", "--workers", 2)
    assert done.exit_code == 0, done.output
    assert done.stdout == f"Report: {out / 'report.html'}\n"
    assert done.stderr == ""
    lead = lead_of(out)
    assert "Energy is linear in the straight distance, but not proportional to it." in lead
    assert "Eq. (1) may not be used for what the protocols ask for" in lead
    assert re.search(r"and 1\d\.\d\sJ a launch has R²", lead)
    page = (out / "report.html").read_text("utf-8")
    assert "the parts add up to what the batteries lost" in page
    assert "docs/motion.md" in page
    assert page.count("<figure") == len(NAMES)
    assert page.count("<svg") == len(NAMES) - 1  # choices are a table alone
    assert "http" not in re.sub(r"http://www\.w3\.org\S*", "", page)
    for name in NAMES:
        for kind in ("csv",) if name == "choices" else ("png", "svg", "csv"):
            assert (out / "figures" / f"{name}.{kind}").stat().st_size > 100
    with (out / "figures" / "models.csv").open(encoding="utf-8") as file:
        models = {row["model"]: float(row["R²"]) for row in csv.DictReader(file)}
    assert models["Eq. (1)"] < models["Eq. (1) on the planned path + launch"] <= 1.0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--workers", 0], "--workers: 0 is not in the range x>=1"),
        (["--seed", -1], "--seed: -1 is not in the range x>=0"),
        (["--seed", "one"], "--seed: is 'one'; expected a whole number"),
    ],
)
def test_bad_options_are_exit_2(tmp_path, arguments, said):
    done = energy("--out", tmp_path / "out", *arguments)
    assert done.exit_code == 2
    assert said in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_folder_that_is_a_file_is_exit_2(tmp_path):
    (tmp_path / "out").write_text("")
    done = energy("--out", tmp_path / "out")
    assert done.exit_code == 2
    assert "cannot be used: " in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.slow
def test_a_study_of_a_scenario_of_ones_own(tmp_path, tiny):
    """Its robot, its floor, its motion; and the robot's own law in the report."""
    (tmp_path / "own.toml").write_text(
        'robot = "pioneer"\nrobots = 12\nrange = 5.0\n[world]\nname = "rooms"\n'
    )
    out = tmp_path / "out"
    keys = ("--set", "robot.power.linear=20.0", "--out", out, "--quick", "--workers", 2)
    done = energy(tmp_path / "own.toml", *keys)
    assert done.exit_code == 0, done.output
    page = html.unescape((out / "report.html").read_text("utf-8"))
    spec = replace(PRESETS["pioneer"].power, linear=20.0)
    assert f"here {spec.per_metre(0.76):.2f} J at 0.76 m/s" in page
    assert "its floor of 10 m × 10 m" in page
    assert "Linear is not proportional: four robots" not in page  # what is of the paper's alone
    assert re.search(r"drain what was foreseen within \d", page.replace("\xa0", " "))
    shown = {name for name in NAMES if f'id="{name}"' in page}
    assert shown == set(NAMES) - {"presets", "traffic", "headlines"}
    rows = list(StudyResult(out / "lifetimes").rows())
    assert {row["robots"] for row in rows} == {12}
    with (out / "figures" / "settings.csv").open(encoding="utf-8") as file:
        launch = {row["setting"]: float(row["a launch [J]"]) for row in csv.DictReader(file)}
    assert launch["weighs half"] < launch["as it is"] < launch["weighs twice as much"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--set", "motion=straight"], "motion: is 'straight', where trips cost Eq. (1) by"),
        (["--set", "time.name=stream"], "time: is 'stream'; the study lives lifetimes in 'rounds'"),
        (["--set", "robot.mass=-1"], "--set: robot.mass: "),
        (["nowhere.toml"], "nowhere.toml: no such file"),
        (["run.csv"], "run.csv: is no scenario, which ends in .toml; logs of a real robot are"),
        (["--log", "run.csv", "--set", "robot.mass=1"], "--set: says something of a scenario"),
    ],
)
def test_what_cannot_be_studied_is_exit_2(tmp_path, arguments, said):
    done = energy("--out", tmp_path / "out", *arguments)
    assert done.exit_code == 2
    assert said in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_quick_study_says_what_the_full_one_does(tmp_path):
    out = tmp_path / "out"
    assert energy("--out", out, "--quick").exit_code == 0
    lead = lead_of(out)
    assert "Eq. (1) may not be used for what the protocols ask for" in lead
    assert "linear in the straight distance, but not proportional to it" in lead
    assert "(husky) it is neither" in lead
    assert "over the paper’s open floor it is nowhere within a tenth, up to 7" in lead.replace(
        "\xa0", " "
    )
    assert float(re.search(r"a launch has R² = ([\d.]+)", lead)[1]) > 0.98
    assert "the parts add up to" in (out / "report.html").read_text("utf-8")
    counts = [StudyResult(out / part).counts() for part in ("trips", "lifetimes")]
    parts = [list(StudyResult(out / part).rows()) for part in ("trips", "lifetimes")]
    assert energy("--out", out, "--quick").exit_code == 0  # there is nothing left to run
    assert [StudyResult(out / part).counts() for part in ("trips", "lifetimes")] == counts
    assert [list(StudyResult(out / part).rows()) for part in ("trips", "lifetimes")] == parts
    assert lead_of(out) == lead
