"""``fleet energy --log`` and ``fleet export`` as a user meets them."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from click.testing import CliRunner
from driven_logs import folder_of

from fleet.assembly import run
from fleet.cli import main
from fleet.logs.exporting import COLUMNS, TripExport
from fleet.observer import Observer
from fleet.scenario.loading import scenario_from


def fleet(*arguments):
    return CliRunner().invoke(main, [str(part) for part in arguments])


def test_a_folder_is_judged_and_leaves_a_robot_that_runs(tmp_path):
    tiles = folder_of(tmp_path / "tiles", runs=4, seconds=80.0)
    said = fleet(
        "energy", "--log", tiles, "--mass", "20", "--track", "0.4", "--out", tmp_path / "out"
    )
    assert said.exit_code == 0, said.output
    assert "Energy linear in distance: trip by trip it does not hold" in said.output
    assert "power [W] is 'power'" in said.output
    assert "Distance is not enough; a law of speed and turning is better." in said.output
    for name in ("report.html", "preset.toml", "trips.csv", "windows.csv"):
        assert (tmp_path / "out" / name).stat().st_size > 100
    preset = tmp_path / "out" / "preset.toml"
    ran = fleet("run", "--robot", preset, "--motion", "path", "--robots", "9", "--rounds", "3",
                "--set", "world.width=20", "--set", "world.height=20", "--range", "12",
                "--json")  # fmt: skip
    assert ran.exit_code == 0, ran.output
    assert json.loads(ran.stdout)["robots"] == 9


def test_grounds_are_judged_apart_and_compared(tmp_path):
    folder_of(tmp_path / "logs" / "tiles", runs=4, seconds=80.0)
    dear = {"change": lambda c: c | {"power": 2.0 * c["power"]}}
    folder_of(tmp_path / "logs" / "grass", runs=4, seconds=80.0, **dear)
    said = fleet("energy", "--log", tmp_path / "logs", "--out", tmp_path / "out")
    assert said.exit_code == 0, said.output
    assert (tmp_path / "out" / "tiles" / "report.html").is_file()
    assert (tmp_path / "out" / "grass" / "preset.toml").is_file()
    assert "Metres cost differently on grass and tiles" in said.output


def test_files_after_the_first_are_logs_too(tmp_path):
    tiles = folder_of(tmp_path / "tiles", runs=4, seconds=60.0)
    said = fleet("energy", "--out", tmp_path / "out", "--log", *sorted(tiles.glob("*.csv")))
    assert said.exit_code == 0, said.output
    assert "tiles: 4 runs" in said.output


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--log", "nothing.csv"), "does not exist"),
        (("--log", ".", "--motor", "1,x"), "--motor: is '1,x'; expected k,R,bias"),
        (("--log", ".", "--within", "-1"), "within is -1; expected more than 0"),
        (("--log", ".", "--log-column", "v"), "--log-column: is 'v'; expected ROLE=COLUMN"),
        (("--mass", "3"), "expected it together with --log"),
    ],
)
def test_what_is_wrong_is_one_sentence_and_exit_code_2(tmp_path, arguments, said):
    result = fleet("energy", *arguments, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert said in result.output
    assert result.output.count("\n") == 1


class Spent(Observer):
    """Adds up what trips took."""

    def __init__(self):
        self.energy = self.path = 0.0

    def trip_ended(self, event, trip):
        self.energy += trip.energy
        self.path += trip.path


@pytest.mark.parametrize("motion", ["path", "physics"])
def test_an_exported_log_holds_all_energy_and_all_metres(tmp_path, motion):
    scenario = scenario_from({"robots": 30, "rounds": 12, "motion": motion, "seed": 3})
    spent = Spent()
    run(scenario, [TripExport(tmp_path, scenario.robot), spent])
    energy = metres = 0.0
    for path in tmp_path.glob("*.csv"):
        with path.open() as file:
            rows = list(csv.DictReader(file))
        assert tuple(rows[0]) == COLUMNS
        table = {name: np.array([float(row[name]) for row in rows]) for name in COLUMNS}
        assert np.diff(table["time"]) == pytest.approx(1.0 / 60.0, abs=1e-6)
        assert (np.diff(table["energy"]) >= 0.0).all()
        energy += table["energy"][-1]
        metres += np.abs(table["v"]).sum() / 60.0
    assert energy == pytest.approx(spent.energy, rel=0.003)
    assert metres == pytest.approx(spent.path, rel=0.01)


def test_exported_logs_are_judged(tmp_path):
    made = fleet("export", "--set", "robots=30", "--set", "rounds=25", "--set", "motion=path",
                 "--speeds", "1,0.5", "--log", tmp_path / "logs")  # fmt: skip
    assert made.exit_code == 0, made.output
    assert "mass = 9.0" in (tmp_path / "logs" / "log.toml").read_text()
    said = fleet("energy", "--log", tmp_path / "logs", "--out", tmp_path / "out")
    assert said.exit_code == 0, said.output
    assert "Energy linear in distance" in said.output
    wrong = fleet("export", "--speeds", "fast", "--log", tmp_path / "logs")
    assert wrong.exit_code == 2
    assert "--speeds: is 'fast'; expected shares" in wrong.output


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("mas = 3.0\n", "preset.toml:1: mas"),
        ("mass = -3.0\n", "mass"),
        ('preset = "other.toml"\n', "names another file"),
    ],
)
def test_a_wrong_robot_file_is_one_sentence(tmp_path, text, said):
    path = tmp_path / "preset.toml"
    path.write_text(text)
    result = fleet("run", "--robot", path, "--rounds", "1")
    assert result.exit_code == 2
    assert said in result.output
    missing = fleet("run", "--robot", tmp_path / "none.toml", "--rounds", "1")
    assert missing.exit_code == 2
    assert "no such file" in missing.output


def test_a_scenario_names_a_robot_file_beside_it(tmp_path):
    (tmp_path / "mine.toml").write_text("mass = 5.0\n[power]\nlinear = 1.0\n")
    (tmp_path / "scenario.toml").write_text('robot = "mine.toml"\nrounds = 1\n')
    said = fleet("run", tmp_path / "scenario.toml", "--dump")
    assert said.exit_code == 0, said.output
    assert "mass = 5.0" in said.output
