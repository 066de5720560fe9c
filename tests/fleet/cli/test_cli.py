"""The command line as a user meets it."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

from fleet.catalogue import CATALOGUES
from fleet.cli import COMMANDS, main
from fleet.results import Summary
from fleet.scenario.model import Scenario

KEYS = [
    "protocol",
    "motion",
    "world",
    "seed",
    "robots",
    "radio_range",
    "search_radius",
    "ended",
    "lifetime",
    "censored",
    "events",
    "served",
    "waiting",
    "expired",
    "lost",
    "lost_by_reason",
    "failed",
    "messages",
    "messages_per_robot",
    "messages_by_kind",
    "hops_greedy",
    "hops_face",
    "energy_initial",
    "energy_predicted",
    "energy_drained",
    "energy_by_account",
    "energy_left_mean",
    "energy_left_min",
    "energy_left_sd",
    "reactions_per_robot",
    "distance_per_robot",
    "path_per_robot",
    "closest_found",
    "conversations",
    "conflicts",
    "broken",
    "restarts",
    "repeated",
    "unheard",
    "beacons",
    "frames_on_air",
    "frames_drowned",
    "doubts",
    "sensor_messages",
    "breakdowns",
    "relocations",
    "simulated_time",
    "wall_time",
]


def fleet(*arguments):
    return CliRunner().invoke(main, arguments, catch_exceptions=False)


def test_json_prints_exactly_the_documented_keys():
    result = fleet("run", "--motion", "straight", "--rounds", "5", "--json")
    assert result.exit_code == 0
    assert list(json.loads(result.stdout)) == KEYS
    assert [*KEYS, "stream"] == list(Summary.__dataclass_fields__)


def test_every_option_means_its_scenario_key(tmp_path):
    options = fleet(
        "run", "--protocol", "gfgf2a", "--world", "random-hole", "--motion", "straight",
        "--robots", "50", "--range", "3", "--search-radius", "1.5", "--rounds", "6",
        "--seed", "4", "--set", "world.radius=2.0", "--json",
    )  # fmt: skip
    file = tmp_path / "scenario.toml"
    file.write_text(
        'protocol = "gfgf2a"\nmotion = "straight"\nrobots = 50\nrange = 3.0\n'
        'search_radius = 1.5\nrounds = 6\nseed = 4\n[world]\nname = "random-hole"\nradius = 2.0\n'
    )
    by_file = json.loads(fleet("run", str(file), "--json").stdout)
    by_options = json.loads(options.stdout)
    del by_file["wall_time"], by_options["wall_time"]
    assert by_file == by_options


def test_the_table_names_units():
    result = fleet("run", "--motion", "straight", "--rounds", "5")
    assert "5 rounds" in result.stdout
    assert "J by Eq. (1)" in result.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["--protocol", "nobody"],
        ["--range", "0.2"],
        ["--robots", "-3"],
        ["nowhere.toml"],
        ["--set", "robot.mass=heavy"],
        ["--rounds", "many"],
        ["--world", "placed"],
    ],
    ids=" ".join,
)
def test_bad_input_is_one_sentence_and_exit_code_2(arguments):
    result = fleet("run", "--motion", "straight", *arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.strip()
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "--protocol", "RFTA22"], "--protocol: unknown protocol 'RFTA22'; did you mean"),
        (["run", "--robots", "2.5"], "--robots: is 2.5; expected a whole number"),
        (["run", "--range", "wide"], "--range: is 'wide'; expected a number"),
        (["run", "--rrd", "clip.mp4"], "--rrd: is 'clip.mp4'; expected a file that ends in .rrd"),
        (["run", "--set", "time.rate=3"], "does nothing in 'rounds'; it belongs to"),
        (["run", "--motion=straight", "--set=motion.dt=1"], "does nothing in 'straight'"),
        (["run", "--set", "rate=3"], "unknown key 'rate'; did you mean 'time.rate'"),
        (["run", "--set", "robot.seed=3"], "is no key of [robot], but of the scenario"),
        (["run", "--set", "seed=1979-05-27"], "seed: is 1979-05-27, a date or time; expected"),
        (["run", "--set", "protocol.search=5"], "protocol.search: is 5; expected a table"),
        (["run", "--set", 'protocol={name=""}'], "protocol.name: is ''; expected a name"),
        (["run", "--set", "seed=1\nrange=3"], "seed: holds a line break; expected one value"),
        (["run", "--set", f"seed={'7' * 5000}"], "seed: is '7777"),
        (["run", "--set", f"x={'[' * 3000}"], "x: is '[[["),
        (["run", "--search-radius", "inf"], "--search-radius: is inf; expected 0 to 1000000"),
        (["run", "--range", "1e308"], "--range: is 1e+308; expected at most"),
        (["run", "--set", r'protocol="a\u0000.py:b"'], "is not a file"),
        (["run", "--world=placed", "--set", r'world.positions="\u0000"'], "read: embedded null"),
        (["run", "x" * 5000], "cannot be read: File name too long"),
        (["sweep", "a.toml", "--out", "b", "--workers", "x"], "--workers: is 'x'; expected a"),
        (["sweep"], "Missing argument 'STUDY'; see "),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_once_shortly_and_with_its_key(arguments, said):
    result = fleet(*arguments)
    assert result.exit_code == 2
    assert said in result.stderr
    assert len(result.stderr) < 500
    assert result.stderr.count("\n") == 1


def test_no_help_shows_how_it_was_written():
    for name in COMMANDS:
        text = fleet(name, "--help").stdout
        assert "\b" not in text
        assert "\\" not in text


def test_a_dump_read_back_is_the_same_run(tmp_path):
    (tmp_path / "own.py").write_text("from protocols.metrics import distance as nearest\n")
    (tmp_path / "one.toml").write_text(
        'robots = 40\nrange = 3.0\nrounds = 8\nmotion = "straight"\n'
        '[protocol]\nname = "k-sap"\nmetric = "own.py:nearest"\n'
        '[radio]\nname = "lossy"\nloss = 0.1\n'
    )
    dumped = fleet("run", str(tmp_path / "one.toml"), "--seed", "3", "--dump").stdout
    (tmp_path / "other").mkdir()
    copy = tmp_path / "other" / "copy.toml"
    copy.write_text(dumped)
    one = json.loads(fleet("run", str(tmp_path / "one.toml"), "--seed", "3", "--json").stdout)
    two = json.loads(fleet("run", str(copy), "--json").stdout)
    del one["wall_time"], two["wall_time"]
    assert one == two
    assert fleet("run", str(copy), "--dump").stdout == dumped
    for key in Scenario.__dataclass_fields__:  # what has no value is left out
        assert key in dumped or key in ("sensors", "robots")


@pytest.mark.parametrize("protocol", sorted(CATALOGUES["protocol"]))
def test_every_protocol_can_be_dumped_and_read_back(tmp_path, protocol):
    dumped = fleet("run", "--protocol", protocol, "--dump").stdout
    (tmp_path / "all.toml").write_text(dumped)
    assert fleet("run", str(tmp_path / "all.toml"), "--dump").stdout == dumped


def test_a_dry_run_puts_everybody_in_place_and_runs_nothing():
    said = fleet("run", "--motion", "straight", "--robots", "30", "--range", "5", "--dry")
    assert said.stdout == (
        "Ready: rfta2 on random, straight motion, 30 robots, seed 0. Nothing was run.\n"
    )
    assert fleet("run", "--motion", "straight", "--range", "0.1", "--dry").exit_code == 2


def test_list_names_everything_with_its_source():
    listed = fleet("list").stdout
    for catalogue in [c for kind, c in CATALOGUES.items() if kind != "preset"]:
        for name in catalogue:
            assert f" {name} " in listed


def test_unknown_commands_and_options_are_met_with_a_hint():
    assert fleet("rum").exit_code == 2
    assert "did you mean" in fleet("rum").stderr.lower()
    assert fleet("run", "--sead", "3").exit_code == 2


HEAVY = ("numba", "scipy", "pymunk", "rerun", "matplotlib", "pydantic", "numpy", "rich", "pyarrow")


def test_help_loads_nothing_heavy():
    script = (
        "import sys; sys.argv = ['fleet', '--help']\n"
        "from fleet.cli import main\n"
        "try: main()\nexcept SystemExit: pass\n"
        f"print('LOADED', [m for m in {HEAVY} if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert "LOADED []" in done.stdout
    assert "Commands:" in done.stdout


def test_a_straight_run_of_a_small_fleet_does_not_wait_for_the_compiler():
    script = (
        "import sys, fleet\n"
        "fleet.run(fleet.Scenario.of(motion='straight', rounds=3))\n"
        "print([m for m in ('numba', 'pymunk', 'rerun', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_a_recording_that_cannot_be_written_is_refused_before_the_run(tmp_path):
    (tmp_path / "taken").write_text("a file")
    said = fleet("run", "--rounds", "1", "--rrd", str(tmp_path / "taken" / "run.rrd"))
    assert said.exit_code == 2
    assert "cannot record to" in said.stderr
    assert "taken" in said.stderr
