"""What the README and CONTRIBUTING show works as it stands there."""

from __future__ import annotations

import re
from pathlib import Path

import fleet
from fleet.cli import COMMANDS
from fleet.scenario.loading import load_scenario
from fleet.study.study_file import load_study

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def block(text, language, containing):
    """The one code block of that language in which these words stand."""
    (found,) = [
        re.sub(r"^ {3}", "", code, flags=re.MULTILINE) if code.startswith("   ") else code
        for code in re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)
        if containing in code
    ]
    return found


def test_the_scenario_loads_and_runs(tmp_path):
    path = tmp_path / "scenario.toml"
    path.write_text(block(README, "toml", "# scenario.toml"), encoding="utf-8")
    scenario = load_scenario(path, {}, ["time.duration=20", "motion=path"])
    assert scenario.protocol.name == "rfta3"
    assert fleet.run(scenario).stream is not None


def test_the_study_loads(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(block(README, "toml", "# study.toml"), encoding="utf-8")
    assert len(list(load_study(path).jobs())) == 3 * 3 * 30


def test_a_run_from_python(capsys):
    exec(block(README, "python", "fleet.Scenario.of(protocol="), {})
    lifetime, left = capsys.readouterr().out.split()
    assert int(lifetime) > 300
    assert 0.0 < float(left) < 100.0


def test_the_protocol_of_the_readme_runs(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(block(README, "python", "def first_there"), encoding="utf-8")
    scenario = fleet.Scenario.of(protocol=f"{path}:first_there", motion="straight", rounds=5)
    assert fleet.run(scenario).served == 5


def test_the_protocol_of_contributing_runs(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(block(CONTRIBUTING, "python", "def whoever_heard"), encoding="utf-8")
    scenario = fleet.Scenario.of(protocol=f"{path}:whoever_heard", motion="straight", rounds=5)
    assert fleet.run(scenario).messages == 0


def test_every_command_is_there_and_shown():
    shown = set(re.findall(r"^fleet (\w+)", README, re.MULTILINE)) | set(
        re.findall(r"`fleet (\w+)", README)
    )
    assert shown == set(COMMANDS)


def test_links_lead_somewhere():
    for page in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")]:
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name}: {target}"
