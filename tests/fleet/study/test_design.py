"""Studies: what is run, and what is said of a study that cannot be."""

from __future__ import annotations

import pytest

from fleet.scenario.errors import BadInput
from fleet.scenario.model import Scenario
from fleet.study.design import Study, label
from fleet.study.job import Job
from fleet.study.study_file import load_study, study_from

STUDY = """\
title = "Protocols on two floors"
seeds = {first = 10, count = 3}
tables = ["robots"]

[scenario]
motion = "straight"
rounds = 20

[axes]
protocol = ["rfta2", {name = "rfta2", metric = "distance"}, "gfgf2a"]
range = [2, 3.0]

[[paired]]
robots = [60, 100]
world.width = [8.0, 10.0]

[report]
x = "range"
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def test_a_study_is_all_combinations_with_all_seeds(file):
    study = load_study(file)
    jobs = list(study.jobs())
    assert len(jobs) == len(study) == 3 * 2 * 2 * 3
    assert len({job.key for job in jobs}) == len(jobs)
    assert study.varied == ["protocol", "range", "robots", "world.width"]
    assert jobs[0].labels == {
        "protocol": "rfta2", "range": 2, "robots": 60, "world_width": 8.0, "seed": 10
    }  # fmt: skip
    assert jobs[0].cell == "protocol=rfta2 range=2 robots=60 world_width=8.0"
    assert jobs[0].tables == ("robots",)
    assert {job.labels["protocol"] for job in jobs} == {
        "rfta2", "rfta2 metric=distance", "gfgf2a"
    }  # fmt: skip


def test_the_tasks_scenarios_are_whole_and_paired_by_seed(file):
    jobs = list(load_study(file).jobs())
    for job in jobs:
        scenario = Scenario.of(**job.scenario)
        assert scenario.as_dict() == job.scenario
        assert scenario.rounds == 20
        assert (scenario.robots, scenario.world.parameters["width"]) in [(60, 8.0), (100, 10.0)]
    seeds = [job.scenario["seed"] for job in jobs]
    assert seeds == sorted(seeds)  # a study that is stopped has something of every cell
    assert set(seeds) == {10, 11, 12}


def test_a_name_comes_before_what_it_is_given():
    study = study_from(
        {"axes": {"protocol.metric": ["distance", "energy-left"], "protocol": ["rfta1", "rfta2"]}}
    )
    chosen = [job.scenario["protocol"] for job in study.jobs()]
    assert sorted((protocol["name"], protocol["metric"]) for protocol in chosen) == [
        (name, metric) for name in ("rfta1", "rfta2") for metric in ("distance", "energy-left")
    ]


def test_cases_stand_where_a_product_makes_no_sense():
    study = study_from(
        {
            "cases": [
                {"label": "few", "robots": 60, "protocol": {"name": "k-saap", "hops": 3}},
                {"robot": {"capacity": 50.0}, "protocol": {"metric": "distance"}},
            ],
            "seeds": [4, 2],
        }
    )
    first, second = [cell.labels for cell in study.resolved]
    assert first == {
        "case": "few", "robots": 60, "protocol": "k-saap hops=3", "robot_capacity": 100.0,
        "protocol_metric": None,
    }  # fmt: skip
    assert (
        study.resolved[0].name == "case=few robots=60 protocol=k-saap hops=3 robot_capacity=100.0"
    )
    assert second["protocol_metric"] == "distance"
    assert second["robot_capacity"] == 50.0
    assert len(study) == 4
    assert [job.scenario["seed"] for job in study.jobs()] == [4, 4, 2, 2]


def test_labels_of_one_column_are_of_one_kind():
    study = study_from(
        {"cases": [{"world": "random"}, {"world": {"name": "random", "width": 9.0}}]}
    )
    assert [cell.labels["world"] for cell in study.resolved] == ["random", "random width=9.0"]
    assert label({"name": "a", "b": {"c": 1}}) == "a b=c=1"
    assert label([1, 2]) == "[1, 2]"


def test_a_study_without_anything_is_the_default_scenario_once():
    (job,) = study_from({}).jobs()
    assert Scenario.of(**job.scenario) == Scenario()


def test_a_study_is_equal_to_its_file(file):
    by_file = load_study(file)
    assert by_file == Study(
        scenario={"motion": "straight", "rounds": 20},
        axes={
            "protocol": ["rfta2", {"name": "rfta2", "metric": "distance"}, "gfgf2a"],
            "range": [2, 3.0],
        },
        paired=[{"robots": [60, 100], "world.width": [8.0, 10.0]}],
        seeds=range(10, 13),
        tables=("robots",),
        title="Protocols on two floors",
        cases=[],
        report={"x": "range"},
    )


def test_the_base_may_be_a_scenario_or_the_file_of_one(tmp_path):
    (tmp_path / "base.toml").write_text('protocol = "gfgf2a"\nrange = 3.0\n')
    by_path = study_from({"scenario": str(tmp_path / "base.toml")})
    over = study_from({"scenario": {"file": str(tmp_path / "base.toml"), "range": 4.0}})
    by_value = study_from({"scenario": Scenario.of(protocol="gfgf2a", range=3.0)})
    assert by_path.resolved == by_value.resolved
    assert (over.resolved[0].scenario["protocol"], over.resolved[0].scenario["range"]) == (
        "gfgf2a",
        4.0,
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("sead = 3", ":1: sead: unknown key 'sead'; did you mean 'seeds'?"),
        ("seeds = 0", ":1: seeds: is 0; expected how many, a list, or"),
        ("seeds = [1, 1]", ":1: seeds: is [1, 1]; expected each seed once"),
        ("seeds = [1, -1]", ":1: seeds: is [1, -1]"),
        ('seeds = "ten"', ":1: seeds: is 'ten'"),
        ('tables = ["round"]', ":1: tables: is ['round']; expected a list of 'rounds' or 'robots'"),
        ("scenario = 3", ":1: scenario: is 3; expected a table, or the path"),
        ('scenario = "none.toml"', "none.toml: no such file"),
        ("[scenario]\nrange = -1.0", ":2: scenario.range: range is -1.0 m; expected more than 0"),
        ("[scenario]\nseed = 1", ":2: scenario.seed: the study has its own; set seeds"),
        ("[scenario]\nraduis = 1.0", ":2: scenario.raduis: unknown key 'raduis'"),
        ("[axes]\n\nrange = 2.0", ":3: axes.range: is 2.0; expected a list of values"),
        ("[axes]\nrange = []", ":2: axes.range: has no values"),
        ("[axes]\nrange = [2.0, 3.0, 2.0]", ":2: axes.range: holds 2.0 twice"),
        ("[axes]\nrange = [2.0, -3.0]", ":2: axes.range: range is -3.0 m; expected more than 0"),
        ("[axes]\nrange = [2.0, 'far']", ":2: axes.range: is 'far'; expected a number"),
        ("[axes]\nseed = [1, 2]", ":2: axes.seed: seeds are not an axis"),
        ("[axes]\nrobot.capacity = [-1.0]", ":2: axes.robot.capacity: robot capacity is -1.0"),
        ('[axes]\n"robot.capacity" = [-1.0]', ":2: axes.robot.capacity: robot capacity is -1.0"),
        ('[axes]\nprotocol = ["rfta2", "rfta"]', ":2: axes.protocol: unknown protocol 'rfta'"),
        ('[axes]\nprotocol = [{name="rfta2", foo=1}]', ":2: axes.protocol.foo: unknown key 'foo'"),
        ('[axes]\n"protocol.metric" = ["near"]', ":2: axes.protocol.metric: unknown metric 'near'"),
        ("axes = 3", ":1: axes: is 3; expected a table of lists"),
        (
            "[[paired]]\nrange = [2.0]\n[[paired]]\nrobots = [60, 70]\nrounds = [1]",
            ":3: paired[1]: robots has 2, rounds has 1 values; expected the same number of each",
        ),
        ("[[paired]]\n", ":1: paired[0]: has no keys"),
        (
            "[[paired]]\nrange = [2.0]\n\n[axes]\nrange = [3.0]",
            ":2: paired[0].range: stands in axes",
        ),
        ("[[cases]]\nrange = 2.0\n[[cases]]\nrange = -2.0", ":4: cases[1].range: range is -2.0 m"),
        ("[[cases]]\n[cases.robot]\nmass = -1.0", ":3: cases[0].robot.mass: robot mass is -1.0"),
        ("cases = [3]", ":1: cases[0]: is 3; expected a table of scenario keys"),
        ("cases = 3", ":1: cases: is 3; expected a list of tables, each written [[cases]]"),
        ("report = 3", ":1: report: is 3; expected a table"),
        ("[report]\nxaxis = 'range'", ":2: report.xaxis: unknown key 'xaxis'"),
        ("[report]\nx = 'range'", ":2: report.x: unknown axis 'range'"),
        ("[report]\nmeasures = 'lifetime'", ":2: report.measures: is 'lifetime'; expected a list"),
        ("seeds = 99999999", ":1: seeds: is 99999999; expected 10000000 at most"),
        ("seeds = ", "study.toml: not TOML"),
    ],
)
def test_what_is_wrong_is_said_with_its_place_before_anything_runs(tmp_path, text, said):
    path = tmp_path / "study.toml"
    path.write_text(text)
    with pytest.raises(BadInput) as caught:
        load_study(path)
    assert said in str(caught.value)


def test_all_mistakes_are_said_once_each(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text("[axes]\nrange = [2.0, -1.0]\nsearch_radius = [1.0, -2.0]\nrobots = [60, 70]\n")
    with pytest.raises(BadInput) as caught:
        load_study(path)
    assert [key.rpartition(": ")[2] for key, _ in caught.value.problems] == [
        "axes.search_radius", "axes.range"
    ]  # fmt: skip


MINE = """\
from protocols.metrics import distance

def nearest(robot, site):
    return {sign}distance(robot, site)
"""


def test_a_key_follows_the_user_s_own_files(tmp_path):
    mine = tmp_path / "mine.py"
    mine.write_text(MINE.format(sign=""))
    scenario = {"protocol": {"name": "rfta2", "metric": f"{mine}:nearest"}, "seed": 1}
    before = Job.of(scenario)
    assert Job.of(dict(reversed(scenario.items()))).key == before.key
    mine.write_text(MINE.format(sign="- "))
    assert Job.of(scenario).key != before.key
    mine.write_text(MINE.format(sign=""))
    assert Job.of(scenario).key == before.key


def test_a_key_is_of_what_is_run_and_nothing_else():
    job = Job.of({"seed": 1})
    assert Job.of({"seed": 1}, cell="a", labels={"b": 2}).key == job.key
    assert Job.of({"seed": 2}).key != job.key
    assert Job.of({"seed": 1}, tables=("robots",)).key != job.key
    assert Job.of({"seed": 1}, function="deeds:note").key != job.key


def test_a_varied_event_process_does_not_hide_how_many_events_there_were():
    study = study_from({"axes": {"events": ["uniform", "bursts"]}})
    assert [cell.labels["event_process"] for cell in study.resolved] == ["uniform", "bursts"]
    assert all("events" not in cell.labels for cell in study.resolved)
