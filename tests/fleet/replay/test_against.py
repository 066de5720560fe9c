"""``fleet replay DIR KEY --against KEY2``: two runs of a study beside each other."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner

from fleet.cli import main
from fleet.replay import scheme
from fleet.replay.readback import Recording
from fleet.study import StudyResult

STUDY = """
seeds = 1
[scenario]
motion = "straight"
robots = 30
range = 3.0
rounds = 6
[axes]
protocol = ["rfta2", "rfta1"]
"""


def fleet(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("swept")
    (folder / "study.toml").write_text(STUDY)
    done = fleet("sweep", folder / "study.toml", "--out", folder / "out", "--workers", 1)
    assert done.exit_code == 0, done.output
    return folder / "out", [row["key"] for row in StudyResult(folder / "out").rows()]


def test_two_runs_of_a_study_are_compared(swept, tmp_path):
    folder, (one, other) = swept
    out = tmp_path / "both.rrd"
    done = fleet("replay", folder, one[:10], "--against", other, "--rrd", out, "--json")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["names"] == [one[:12], other[:12]]
    assert {*found["settings"]["protocol"]} == {"rfta1", "rfta2"}
    assert found["events"] == [6, 6]
    assert done.stderr.count("is the same to the last bit") == 2
    both = Recording(out)
    for root in "ab":
        assert f"{root}/{scheme.ROBOTS}" in both.entities
    assert scheme.DIFFERENCE in both.entities
    assert f"{scheme.DIFFERENCE_MESSAGES}/b" in both.entities


def test_what_differs_is_said(swept):
    folder, (one, other) = swept
    done = fleet("replay", folder, one, "--against", other)
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith(("## They part at event ", "## They never part"))
    assert "| scenario |" in done.stdout


@pytest.mark.parametrize(
    ("key", "complaint"),
    [("nothing", "begins with 'nothing'"), (None, "is run {} itself; expected another run")],
)
def test_a_run_that_is_not_there_or_the_same(swept, key, complaint):
    folder, (one, _) = swept
    done = fleet("replay", folder, one, "--against", key or one)
    assert done.exit_code == 2
    assert complaint.format(one[:12]) in done.stderr
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
