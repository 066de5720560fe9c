"""Scenarios from files and options, and what is said when they are wrong."""

from __future__ import annotations

import json

import pytest

import fleet
from fleet.scenario.errors import BadInput
from fleet.scenario.loading import load_scenario, scenario_from

FILE = """\
protocol = "gfgf2a"
range = 3.0   # [m]

[robot]
radius = 0.15

[world]
name = "random-hole"
radius = 2.0
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "two.toml"
    path.write_text(FILE)
    return path


def refusal(*arguments, **keywords):
    with pytest.raises(BadInput) as caught:
        load_scenario(*arguments, **keywords)
    return str(caught.value)


def test_a_file_means_what_the_options_mean(file):
    by_file = load_scenario(file)
    by_option = load_scenario(
        None,
        {"protocol": "gfgf2a", "range": 3.0, "world": "random-hole"},
        ["robot.radius=0.15", "world.radius=2.0"],
    )
    assert by_file == by_option
    assert by_file.world.parameters == {"radius": 2.0}


def test_options_win_over_the_file_and_settings_over_options(file):
    scenario = load_scenario(file, {"range": 4.0, "seed": 1}, ["seed=2"])
    assert (scenario.range, scenario.seed) == (4.0, 2)
    assert scenario.robot.radius == 0.15


def test_a_name_replaces_a_table_and_a_table_adds_to_a_name(file):
    assert load_scenario(file, {"world": "random"}).world.parameters == {}
    added = load_scenario(None, {"protocol": "rfta2"}, ["protocol.auctioneer_bids=true"])
    assert added.protocol.parameters == {"auctioneer_bids": True}
    assert load_scenario(None, {}, ["protocol.auctioneer_bids=true"]) == added


def test_a_scenario_survives_being_written_down():
    scenario = fleet.Scenario.of(
        protocol={"name": "rfta2", "search": {"stop": "node"}}, robot="small", seed=3, rounds=7
    )
    assert scenario_from(json.loads(json.dumps(scenario.as_dict()))) == scenario


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("raduis = 1", "two.toml:1: raduis: unknown key 'raduis'"),
        ("[robot]\nraduis = 1", "two.toml:2: robot.raduis: unknown key 'raduis'; did you mean"),
        ('range = "far"', "two.toml:1: range: is 'far'; expected a number"),
        ("range = -2.0", "two.toml:1: range is -2.0 m; expected more than 0"),
        ("robots = 2.5", "robots: is 2.5; expected a whole number"),
        ("robots = 0", "robots is 0; expected 1 to 1000000"),
        ("robots = true", "robots: is True; expected a whole number"),
        ("seed = -1", "seed is -1; expected 0 or more"),
        ("rounds = 0", "rounds is 0; expected 1 or more"),
        ("[robot]\nradius = -1.0", "robot radius is -1.0; expected more than 0"),
        ('robot = "huge"', "unknown preset 'huge'; expected"),
        ("robot = 3", "robot: is 3; expected the name of a preset, or a table"),
        ('graph = "gabriell"', "is 'gabriell'; expected 'gabriel', 'udg', 'rng' or 'emst'"),
        ('protocol = "rfta"', "unknown protocol 'rfta'; did you mean 'rfta"),
        ("protocol = 7", "is 7; expected a name, or a table with one"),
        ('[protocol]\nname = "rfta2"\nfoo = 1', "two.toml:3: protocol.foo: unknown key 'foo'"),
        ('[protocol.search]\nstop = "nod"', "protocol.search.stop: is 'nod'; expected 'edge' or"),
        ("[protocol.search]\nhops = 2", "protocol.search.hops: unknown key 'hops'"),
        ("[protocol.search]\nradius = 2.0", "set search_radius instead"),
        ('[protocol]\nmetric = "distanse"', "unknown metric 'distanse'; did you mean 'distance'?"),
        ('[protocol.metric]\nname = "distance"\npower = 2', "'distance' has no parameters"),
        ("[protocol]\nmetric = 3", "is 3; expected the name of a metric"),
        ('world = "mars"', "unknown world 'mars'; expected 'map', 'pit', 'placed'"),
        ("world = {width = -1.0}", "arena width -1.0 m; expected more than 0"),
        (
            'world = {name = "random-hole", radius = "big"}',
            "world.radius: is 'big'; expected a num",
        ),
        ('motion = "fly"', "unknown motion 'fly'"),
        ("range = ", "not TOML: invalid value"),
        ("range = 1\nrange = 2", "not TOML"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(tmp_path, text, said):
    path = tmp_path / "two.toml"
    path.write_text(text)
    assert said in refusal(path)


def test_several_mistakes_are_all_said(tmp_path):
    path = tmp_path / "two.toml"
    path.write_text('range = "far"\nrobots = 2.5\nsead = 1\n')
    said = refusal(path)
    assert "sead: unknown key 'sead'; did you mean 'seed'?" in said


def test_options_are_named_as_they_were_given():
    assert refusal(None, {"search_radius": -1.0}).startswith("--search-radius: is -1.0; expected 0")
    assert refusal(None, {}, ["robot.radius=oops"]).startswith("--set: robot.radius: is 'oops'")


def test_missing_file_names_the_near_one(file):
    said = refusal(file.with_name("tow.toml"))
    assert "no such file; did you mean" in said
    assert "two.toml" in said


def test_a_folder_or_bytes_are_no_scenario(tmp_path):
    assert "cannot be read" in refusal(tmp_path)
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfb\x00")
    assert "not UTF-8" in refusal(tmp_path / "bytes.toml")


@pytest.mark.parametrize("setting", ["seed", "=3", "a b=3", ""])
def test_settings_need_a_key_and_a_value(setting):
    assert "expected key=value" in refusal(None, {}, [setting])


MINE = """\
from protocols.auctions import keep
from protocols.metrics import distance

def whoever_heard(view, event, source, *, search_radius: float = 1.0, times: int = 1):
    yield from ()
    return keep(view, source, event, distance)

def laziest(robot, site):
    return -robot.cost_to(site)

number = 3
"""


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(MINE)
    return path


def test_a_protocol_of_the_user_s_own_runs_by_its_file(mine):
    summary = fleet.run(
        fleet.Scenario.of(
            protocol={"name": f"{mine}:whoever_heard", "times": 2}, motion="straight", rounds=5
        )
    )
    assert summary.messages == 0
    assert summary.protocol == f"{mine}:whoever_heard"


def test_a_metric_of_the_user_s_own(mine):
    far = fleet.run(
        fleet.Scenario.of(protocol={"metric": f"{mine}:laziest"}, motion="straight", rounds=30)
    )
    near = fleet.run(
        fleet.Scenario.of(protocol={"metric": "distance"}, motion="straight", rounds=30)
    )
    assert far.distance_per_robot > 1.5 * near.distance_per_robot


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        ("{}:whoever_herd", "unknown name 'whoever_herd'"),
        ("{}:whoever_herd", "did you mean 'whoever_heard'?"),
        ("{}:number", "is of type int; expected a function"),
        ("{}", "names no object; expected file.py:name"),
        ("nine.py:x", "'nine.py' is not a file"),
    ],
)
def test_user_files_that_do_not_serve_say_why(mine, reference, said):
    assert said in refusal(None, {"protocol": reference.format(mine)})


def test_a_user_file_that_raises_is_named_with_its_line(tmp_path):
    path = tmp_path / "broken.py"
    path.write_text("import math\nmath.sqrt(-1)\n")
    said = refusal(None, {"protocol": f"{path}:x"})
    assert "does not import in line 2 of broken.py: ValueError" in said
    path.write_text("def x(:\n")
    said = refusal(None, {"protocol": f"{path}:x"})
    assert "does not import in line 1 of broken.py: SyntaxError" in said


def test_a_trace_goes_by_the_names_of_its_columns(tmp_path):
    path = tmp_path / "events.csv"
    events = {"name": "trace", "occurrences": str(path)}
    path.write_text("Time,y,x\n1.0,2.0,13.0\n")
    with pytest.raises(BadInput, match=r"events.csv: row 1: the event at \(13, 2\) lies outside"):
        fleet.run(fleet.Scenario.of(events=events, motion="straight"))
    path.write_text("Time, x, y\n1.0,2.0,3.0\n")
    assert fleet.run(fleet.Scenario.of(events=events, motion="straight")).events == 1
    path.write_text("-1.0,2.0,3.0\n")
    with pytest.raises(BadInput, match=r"row 1: .* happens at -1 s; expected 0 or more"):
        fleet.run(fleet.Scenario.of(events=events, motion="straight"))
