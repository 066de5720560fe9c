"""The tables of a study: every reader opens them in one line, and finds the same in them."""

from __future__ import annotations

import json

import pytest

from fleet.scenario.errors import BadInput
from fleet.study import StudyResult, run_jobs
from fleet.study.study_file import study_from
from fleet.study.sweeping import sweep

STUDY = {
    "scenario": {"motion": "straight", "rounds": 8, "robots": 40, "range": 3.0},
    "axes": {"protocol": ["rfta2", "gfgf2a"], "search_radius": [1.0, 2.0]},
    "seeds": 2,
    "tables": ["rounds", "robots"],
}


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return sweep(STUDY, tmp_path_factory.mktemp("study"), workers=2)


def test_a_row_a_run_with_summary_axes_and_provenance(result):
    table = result.table()
    assert table.num_rows == 8
    rows = table.to_pylist()
    assert [row["protocol"] for row in rows] == ["rfta2", "rfta2", "gfgf2a", "gfgf2a"] * 2
    assert {row["search_radius"] for row in rows} == {1.0, 2.0}
    for row in rows:
        assert row["lifetime"] == row["served"] == 8
        assert row["messages"] == sum(
            row[f"messages_by_kind_{kind}"]
            for kind in ("route_greedy", "route_face", "call", "bid", "assign")
        )
        assert json.loads(row["scenario"])["seed"] == row["seed"]
        assert len(row["key"]) == 64


def test_parquet_opens_in_pandas(result):
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    runs = pandas.read_parquet(result.folder / "runs.parquet")
    assert runs.equals(result.frame())
    assert runs.groupby("protocol").lifetime.mean().to_dict() == {"gfgf2a": 8.0, "rfta2": 8.0}


def test_parquet_opens_in_polars(result):
    polars = pytest.importorskip("polars", reason="polars is not installed")
    runs = polars.read_parquet(result.folder / "runs.parquet")
    assert runs["key"].to_list() == result.table()["key"].to_pylist()


def test_parquet_opens_in_duckdb(result):
    duckdb = pytest.importorskip("duckdb", reason="duckdb is not installed")
    path = result.folder / "runs.parquet"
    found = duckdb.sql(f"SELECT protocol, avg(lifetime) FROM '{path}' GROUP BY protocol").fetchall()
    assert sorted(found) == [("gfgf2a", 8.0), ("rfta2", 8.0)]


def test_rounds_add_up_to_the_run(result):
    rounds = result.table("rounds").to_pylist()
    for run in result.table().to_pylist():
        mine = [row for row in rounds if row["key"] == run["key"]]
        assert len(mine) == run["events"] + run["failed"]
        assert sum(row["messages"] for row in mine) == run["messages"]
        assert sum(row["hops"] for row in mine) == run["hops_greedy"] + run["hops_face"]
        assert sum(row["energy"] for row in mine) == pytest.approx(run["energy_drained"])
        assert sum(row["path"] for row in mine) == pytest.approx(40 * run["path_per_robot"])
        assert sum(row["outcome"] == "arrived" for row in mine) == run["served"]
        assert mine[-1]["fleet_energy_left"] == pytest.approx(40 * run["energy_left_mean"])
        assert {row["search_radius"] for row in mine} == {run["search_radius"]}


def test_robots_add_up_to_the_run(result):
    robots = result.table("robots").to_pylist()
    for run in result.table().to_pylist():
        mine = [row for row in robots if row["key"] == run["key"]]
        assert [row["robot"] for row in mine] == list(range(40))
        assert sum(row["reactions"] for row in mine) == run["served"]
        assert sum(row["energy_left"] for row in mine) == pytest.approx(
            40 * run["energy_left_mean"]
        )
        assert min(row["energy_left"] for row in mine) == run["energy_left_min"]
        assert sum(row["distance"] for row in mine) == pytest.approx(40 * run["distance_per_robot"])


def test_files_and_memory_hold_the_same(result):
    import pyarrow.parquet as pq

    assert result.table_names() == ["runs", "robots", "rounds"]
    for name in result.table_names():
        assert pq.read_table(result.folder / f"{name}.parquet").equals(result.table(name))


def test_one_seed_is_one_network_for_all_cells(result):
    robots = result.table("robots").to_pylist()
    starts = {}
    for row in robots:
        starts.setdefault(row["seed"], {}).setdefault(row["key"], []).append(
            (row["start_x"], row["start_y"])
        )
    for by_run in starts.values():
        assert len(by_run) == 4
        assert len({tuple(places) for places in by_run.values()}) == 1
    assert starts[0].values() != starts[1].values()


def test_results_are_the_same_to_the_bit_however_many_processes(result, tmp_path):
    alone = sweep(STUDY, tmp_path / "one", workers=1)
    assert without_time(alone.table()).equals(without_time(result.table()))
    for name in ("rounds", "robots"):
        assert alone.table(name).equals(result.table(name))
    from fleet.assembly import run
    from fleet.scenario.loading import scenario_from

    for row, job in zip(result.rows(), study_from(STUDY).jobs(), strict=True):
        here = json.loads(json.dumps(run(scenario_from(job.scenario)).as_dict()))
        assert {k: row[k] for k in here if k != "wall_time"} == {
            k: v for k, v in here.items() if k != "wall_time"
        }


def without_time(table):
    return table.drop_columns(["wall_time"])


def test_tables_of_a_work_function(tmp_path, make_tasks):
    result = run_jobs(make_tasks(4, "with_tables"), tmp_path / "out", workers=2)
    assert result.table_names() == ["runs", "parts"]
    parts = result.table("parts").to_pylist()
    assert [(row["label"], row["part"]) for row in parts] == [
        (1, 0), (2, 0), (2, 1), (0, 0), (0, 1), (0, 2)
    ]  # fmt: skip
    assert result.table()["by_kind_route_face"].to_pylist() == [0, 1, 2, 3]
    assert (tmp_path / "out" / "parts.parquet").is_file()
    with pytest.raises(BadInput, match="unknown table 'part'; did you mean 'parts'"):
        result.table("part")


def test_a_folder_with_nothing_done_has_an_empty_table(tmp_path, make_tasks):
    result = run_jobs(make_tasks(1, "deadly", victim=0, deed="raise"), tmp_path, workers=1)
    assert result.table().num_rows == 0
    assert list(result.rows()) == []
    assert "0 of 1 runs done, 1 failed" in repr(result)


def test_a_world_without_a_connected_network_is_that_run_s_failure(tmp_path):
    study = {"scenario": {"motion": "straight", "rounds": 1}, "axes": {"range": [0.3, 2.5]}}
    result = sweep(study, tmp_path, workers=1)
    assert result.counts() == (2, 1, 1)
    (failure,) = result.failures()
    assert "ImpossibleWorld: range is 0.3 m" in failure.error
    assert failure.cell == "range=0.3"


def test_a_study_that_cannot_be_leaves_no_folder(tmp_path):
    with pytest.raises(BadInput):
        sweep({"axes": {"range": [-1.0]}}, tmp_path / "out")
    assert not (tmp_path / "out").exists()
    assert repr(StudyResult(tmp_path / "out").folder).endswith("out')")
