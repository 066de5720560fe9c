"""The report of a study: what it draws and says, and that it needs nothing but itself."""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from html.parser import HTMLParser
from math import isnan, nan

import numpy as np
import pyarrow as pa
import pytest
from click.testing import CliRunner

from fleet.cli import main
from fleet.scenario.errors import BadInput
from fleet.study import StudyResult, run_jobs
from fleet.study.report.derived import derived, possible, uncensored
from fleet.study.report.layout import layout
from fleet.study.report.quantities import measures
from fleet.study.report.runs import Runs, ended, runs_of
from fleet.study.report.study_report import write_report
from fleet.study.statistics import mean_interval, paired_difference
from fleet.study.sweeping import sweep

STUDY = {
    "title": "Two protocols & two radii",
    "scenario": {"motion": "straight", "robots": 40, "range": 3.0, "robot": {"capacity": 15.0}},
    "axes": {"protocol": ["rfta2", "gfgf2a"], "search_radius": [1.0, 1.5, 2.0]},
    "seeds": 5,
    "tables": ["robots"],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    sweep(STUDY, folder, workers=2, command="fleet sweep it.toml")
    write_report(folder)
    return folder


def read(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


class Page(HTMLParser):
    """Checks that every element is closed, and collects what a browser would have to fetch."""

    VOID = frozenset({"meta", "br", "hr", "img", "link", "input"})

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.fetched = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.ids += [given["id"]] if "id" in given else []
        self.fetched += [
            v for k, v in attributes if k in {"src", "xlink:href", "href"} and tag != "a"
        ]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        while self.open and self.open.pop() != tag:
            assert tag != "body"


def test_the_page_is_whole_and_needs_no_network(folder):
    text = (folder / "report.html").read_text()
    page = Page(text)
    assert all(target.startswith("#") for target in page.fetched)
    assert len(page.ids) == len(set(page.ids))
    assert "<title>Two protocols &amp; two radii</title>" in text
    assert "<script" not in text
    assert "@import" not in text
    assert text.count("<figure") == text.count("<svg") == 4
    for number in range(1, 5):
        assert f"<b>Figure {number}.</b>" in text
    assert "fleet sweep it.toml" in text
    assert StudyResult(folder).table()["version"][0].as_py() in text


def test_everything_that_the_page_links_to_is_there(folder):
    text = (folder / "report.html").read_text()
    links = set(re.findall(r'<a[^>]* href="([^"#]+)"', text))
    assert {"report/means.csv", "report/differences.csv", "report/survival.csv"} <= links
    for link in links:
        assert (folder / link).is_file()


def test_colours_are_the_page_s_own(folder):
    svg = (folder / "report.html").read_text().partition("<svg")[2]
    assert "var(--s0)" in svg
    assert "var(--ink)" in svg
    assert "#0072b2" not in svg.lower()


def with_shares(folder):
    """The rows, with what the report works out of them."""
    rows = StudyResult(folder).table().to_pylist()
    for row in rows:
        row["served_share"] = row["served"] / row["events"]
        served = row["served"] or nan  # of a run that served nobody there is nothing to tell
        row["drained_per_served"] = row["energy_drained"] / served
        row["messages_per_event"] = row["messages"] / row["events"]
    return rows


def test_means_are_those_of_the_runs(folder):
    runs = with_shares(folder)
    means = read(folder / "report" / "means.csv")
    assert len(means) == 6 * len({row["measure"] for row in means})
    for row in means:
        values = [
            run[row["measure"]]
            for run in runs
            if run["protocol"] == row["protocol"]
            and run["search_radius"] == float(row["search_radius"])
        ]
        values = [value for value in values if not isnan(value)]
        expected = mean_interval(values, possible(row["measure"]))
        found = [float(row[name]) for name in ("mean", "low", "high")]
        assert found == pytest.approx(list(expected))
        assert int(row["runs"]) == len(values)


def test_differences_are_paired_by_seed(folder):
    runs = with_shares(folder)
    for row in read(folder / "report" / "differences.csv"):
        assert (row["protocol"], row["baseline"]) == ("gfgf2a", "rfta2")

        def of(protocol, row=row):
            return [
                run[row["measure"]]
                for run in sorted(runs, key=lambda run: run["seed"])
                if (run["protocol"], run["search_radius"])
                == (protocol, float(row["search_radius"]))
            ]

        pairs = [p for p in zip(of("gfgf2a"), of("rfta2"), strict=True) if not isnan(sum(p))]
        expected = paired_difference(*np.transpose(pairs))[:6]
        found = [float(row[n]) for n in ("difference", "low", "high", "cohens_d", "pairs", "p")]
        assert found == pytest.approx(list(expected), nan_ok=True)


def test_energy_and_survival_are_of_all_robots_and_runs(folder):
    energy = read(folder / "report" / "energy.csv")
    assert len(energy) == 6 * 101
    robots = StudyResult(folder).table("robots").to_pylist()
    least = min(r["energy_left"] for r in robots if r["protocol"] == "rfta2")
    assert min(float(e["energy_left"]) for e in energy if e["protocol"] == "rfta2") == least
    survival = read(folder / "report" / "survival.csv")
    assert all(0.0 <= float(row["alive"]) < 1.0 for row in survival)


def test_a_report_is_the_same_text_for_the_same_results(folder):
    before = (folder / "report.html").read_bytes()
    write_report(folder)
    assert (folder / "report.html").read_bytes() == before


@pytest.mark.slow
def test_a_report_while_the_study_goes_on_tells_what_there_is(tmp_path):
    pages = []

    def look(counts):
        if not pages and 4 <= counts.done < counts.total:
            pages.append((counts, write_report(tmp_path).read_text()))

    sweep({**STUDY, "tables": []}, tmp_path, workers=1, progress=look)
    ((counts, text),) = pages
    assert f"{counts.left} runs are still to be done" in text
    assert f"{counts.done} of 30 runs" in text
    write_report(tmp_path)
    assert "still to be done" not in (tmp_path / "report.html").read_text()


def test_failures_are_named_with_key_and_traceback(tmp_path):
    study = {"scenario": {"motion": "straight", "rounds": 3}, "axes": {"range": [0.2, 3.0]}}
    result = sweep(study, tmp_path, workers=1)
    text = write_report(tmp_path).read_text()
    assert result.failures()[0].key[:12] in text
    assert "ImpossibleWorld" in text
    assert 'href="#failures"' in text


def test_a_study_without_axes_or_results_still_has_a_page(tmp_path, make_tasks):
    sweep({"scenario": {"motion": "straight", "rounds": 3}}, tmp_path / "one", workers=1)
    text = write_report(tmp_path / "one").read_text()
    assert "1 of 1 runs" in text
    assert "lifetime" in text
    run_jobs(make_tasks(1, "deadly", victim=0, deed="raise"), tmp_path / "none", workers=1)
    assert "No run is done yet." in write_report(tmp_path / "none").read_text()


def test_rows_of_another_kind_of_work_are_reported_too(tmp_path, make_tasks):
    run_jobs(make_tasks(12), tmp_path, workers=1)
    text = write_report(tmp_path).read_text()
    assert "square" in text
    assert {row["measure"] for row in read(tmp_path / "report" / "means.csv")} >= {"square"}


@pytest.mark.slow
def test_the_study_may_choose_axes_baseline_and_measures(tmp_path):
    chosen = {
        "x": "search_radius", "series": "protocol", "baseline": "gfgf2a",
        "measures": ["messages", "simulated_time"],
    }  # fmt: skip
    sweep({**STUDY, "seeds": 2, "report": chosen}, tmp_path, workers=2)
    write_report(tmp_path)
    rows = read(tmp_path / "report" / "differences.csv")
    assert {(row["protocol"], row["baseline"]) for row in rows} == {("rfta2", "gfgf2a")}
    assert {row["measure"] for row in rows} == {"messages", "simulated_time"}


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"x": "rnage"}, "report.x: unknown axis 'rnage'; did you mean 'range'?"),
        ({"x": "protocol"}, "report.x: is 'protocol', whose values are names"),
        ({"baseline": "rfta3"}, "report.baseline: unknown value 'rfta3'"),
    ],
)
def test_axes_that_are_not_there_are_said(asked, said):
    with pytest.raises(BadInput) as caught:
        layout(some_runs(), asked)
    assert said in str(caught.value)


def test_measures_that_are_not_there_are_said():
    with pytest.raises(BadInput, match="unknown measure 'lifetimes'; did you mean 'lifetime'"):
        measures(some_runs(), ["lifetimes"])


def some_runs(**more):
    columns = {
        "protocol": ["a", "a", "a", "b", "b", "b"],
        "range": [1.0, 2.0, 3.0] * 2,
        "width": [10.0, 20.0, 30.0] * 2,
        "seed": [0] * 6,
        "lifetime": [1, 2, 3, 4, 5, 6],
        **more,
    }
    return runs_of(pa.table(columns), ["protocol", "range", "width", "seed"])


def test_axes_that_go_together_count_as_one():
    runs = some_runs()
    assert runs.axes == ("protocol", "range")
    plan = layout(runs, {})
    assert (plan.x, plan.series, plan.facets, plan.baseline) == ("range", "protocol", (), "a")


def test_measures_that_say_the_same_or_nothing_are_left_out():
    runs = some_runs(
        distance_per_robot=[1.0, 2.0, 3.0, 4.0, 5.0, 6.5],
        path_per_robot=[1.0, 2.0, 3.0, 4.0, 5.0, 6.5],
        failed=[0] * 6,
    )
    assert measures(runs, None) == ["lifetime", "distance_per_robot"]


def test_a_key_that_not_every_cell_sets_is_named_where_it_is_set(tmp_path):
    cases = [{"label": "few", "robots": 40, "rounds": 9}, {"label": "usual", "rounds": 10}]
    base = {"motion": "straight", "range": 3.0}
    result = sweep({"scenario": base, "cases": cases, "seeds": 2}, tmp_path, workers=1)
    assert result.table()["robots"].to_pylist() == [40, 100, 40, 100]
    text = write_report(tmp_path).read_text()
    assert "few" in text
    assert ">nan<" not in text
    assert {row["case"] for row in read(tmp_path / "report" / "means.csv")} == {"few", "usual"}


def test_runs_that_were_cut_off_have_not_ended():
    table = pa.table({"censored": [False, True, False]})
    np.testing.assert_array_equal(ended(runs_of(table, [])), [True, False, True])


def test_the_command_says_where_the_page_is(folder):
    done = CliRunner().invoke(main, ["report", str(folder)])
    assert done.exit_code == 0
    assert done.stdout.strip() == str(folder / "report.html")


def test_the_command_refuses_a_folder_without_a_study(tmp_path):
    done = CliRunner().invoke(main, ["report", str(tmp_path)])
    assert done.exit_code == 2
    assert "holds no study" in done.stderr
    missing = tmp_path / "missing"
    done = CliRunner().invoke(main, ["report", str(missing)])
    assert (done.exit_code, "holds no study" in done.stderr) == (2, True)
    assert not missing.exists()  # only who finds something writes


STREAMS = {
    "scenario": {
        "motion": "straight", "robots": 40, "range": 3.0, "radio": {"name": "lossy", "loss": 0.2},
        "time": {"name": "stream", "rate": 1.0, "duration": 30.0, "deadline": 20.0},
        "robot": {"capacity": 90.0, "extra": {"idle": 0.5}}, "faults": {"motor_rate": 1e-3},
    },
    "axes": {"protocol": ["rfta2", "gfgf2a"]},
    "seeds": 4,
}  # fmt: skip


@pytest.fixture(scope="module")
def streams(tmp_path_factory):
    folder = tmp_path_factory.mktemp("streams")
    sweep(STREAMS, folder, workers=1)
    write_report(folder)
    return folder


def test_the_head_lists_every_setting_that_is_not_the_default(streams):
    text = re.sub(r"<[^>]+>", "", (streams / "report.html").read_text())
    said = re.search(r"not the default(.*)", text)[1]
    for setting in (
        "motion straight", "radio lossy", "radio.loss 0.2", "time stream", "time.deadline 20.0",
        "time.duration 30.0", "robot.capacity 90.0", "robot.extra.idle 0.5",
        "faults.motor_rate 0.001", "robots 40",
    ):  # fmt: skip
        assert setting in said
    assert "protocol" not in said
    assert "seed" not in said
    assert "robot.mass" not in said


def test_what_became_of_events_and_of_energy_adds_up(streams):
    runs = StudyResult(streams).table().to_pylist()
    events = read(streams / "report" / "events.csv")
    spent = read(streams / "report" / "accounts.csv")
    for protocol in ("rfta2", "gfgf2a"):
        mine = [run for run in runs if run["protocol"] == protocol]
        told = {r["measure"]: float(r["mean"]) for r in events if r["protocol"] == protocol}
        assert told["events"] == pytest.approx(np.mean([run["events"] for run in mine]))
        assert told["events"] == pytest.approx(
            told["served"] + told["waiting"] + told["expired"] + told["lost"]
        )
        assert 0.0 <= told["stream_within_deadline"] <= 1.0
        took = {r["measure"]: float(r["mean"]) for r in spent if r["protocol"] == protocol}
        drained = np.mean([run["energy_drained"] / run["served"] for run in mine])
        assert took["drained_per_served"] == pytest.approx(drained)
        accounts = [v for name, v in took.items() if name.startswith("energy_by_account_")]
        assert sum(accounts) == pytest.approx(drained, rel=1e-6)
        assert took["drained_per_served"] > 1.5 * took["predicted_per_served"]  # idle robots


def test_no_interval_of_a_report_holds_what_cannot_be(streams):
    for name in ("means", "events", "accounts"):
        for row in read(streams / "report" / f"{name}.csv"):
            low, high = possible(row["measure"])
            assert not float(row["low"]) < low
            assert not float(row["high"]) > high


def test_messages_of_each_event_are_beside_those_of_each_robot():
    runs = some_runs(
        messages=[30, 10, 20, 40, 50, 60], events=[3, 1, 2, 4, 5, 6], served=[1] * 6,
        energy_drained=[1.0] * 6, energy_predicted=[1.0] * 6,
    )  # fmt: skip
    assert derived(runs)["messages_per_event"].tolist() == [10.0] * 6


def test_lifetimes_that_were_cut_off_are_not_taken_for_short_ones():
    runs = some_runs(
        lifetime=[4.0, 9.0, 6.0, 5.0, 9.0, 9.0],
        censored=np.array(["no", "yes", "no", "no", "yes", "yes"], object),
    )
    plan = layout(runs, {"series": "protocol"})
    changed, said = uncensored(Runs(runs.columns, ("protocol",)), layout_of(plan))
    assert changed["lifetime"].tolist() == [4.0, 9.0, 6.0, 5.0, 9.0, 9.0]  # none before 9
    assert said.startswith("3 of 6 runs were cut off")
    early = some_runs(
        lifetime=[4.0, 2.0, 6.0, 5.0, 9.0, 9.0],
        censored=np.array(["no", "yes", "no", "no", "yes", "yes"], object),
    )
    changed, _ = uncensored(Runs(early.columns, ("protocol",)), layout_of(plan))
    assert changed["lifetime"][:3].mean() == pytest.approx(5.0)  # not 4: the second went on


def layout_of(plan):
    """The layout with nothing but series."""
    return replace(plan, x=None, facets=())
