"""Bundles: an RO-Crate of a study, and what is said of one that is not as it was written."""

from __future__ import annotations

import json
import sqlite3
import zipfile
from pathlib import Path
from shutil import copyfile, copytree

import pytest
from click.testing import CliRunner

from fleet.cli import main
from fleet.study.bundle import METADATA, PROFILE, sha256_of
from fleet.study.job import checksum
from fleet.study.sweeping import sweep

STUDY = """\
title = "A small study"
seeds = 2
[scenario]
motion = "straight"
rounds = 4
robots = 30
range = 4.0
[axes]
protocol = ["rfta2", "gfgf2a"]
"""
CODE = """\
from protocols.auctions import keep
from protocols.metrics import distance


def mine(view, event, source):
    yield from ()
    return keep(view, source, event, distance)
"""


def fleet(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments], catch_exceptions=False)


def again(bundle, change):
    """The bundle with one of its files changed; None: without it."""
    with zipfile.ZipFile(bundle) as file:
        parts = {name: file.read(name) for name in file.namelist()}
    change(parts)
    with zipfile.ZipFile(bundle, "w") as file:
        for name, data in parts.items():
            file.writestr(name, data)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bundled")
    (folder / "study.toml").write_text(STUDY)
    sweep(folder / "study.toml", folder / "out", workers=1)
    return folder / "out"


@pytest.fixture(scope="module")
def written(folder):
    path = folder.parent / "study.zip"
    done = fleet("report", folder, "--bundle", path)
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines()[0] == str(folder / "report.html")
    return path


@pytest.fixture
def bundle(written, tmp_path):
    """A copy, to be spoiled."""
    return Path(copyfile(written, tmp_path / "study.zip"))


def test_a_bundle_is_a_crate_that_tells_of_all_its_files(bundle):
    with zipfile.ZipFile(bundle) as file:
        told = json.loads(file.read(METADATA))
        names = set(file.namelist()) - {METADATA}
    graph = {entity["@id"]: entity for entity in told["@graph"]}
    assert told["@context"] == f"{PROFILE}/context"
    assert graph[METADATA]["conformsTo"] == {"@id": PROFILE}
    assert {part["@id"] for part in graph["./"]["hasPart"]} == names
    assert names == {name for name, entity in graph.items() if entity["@type"] == "File"}
    assert {"ledger.sqlite", "study.toml", "versions.txt", "keys.csv", "runs.parquet",
            "report.html", "report/means.csv"} <= names  # fmt: skip
    assert graph["./"]["name"] == "A small study"
    assert graph["#talking-fleet"]["version"].startswith("0.")


def test_the_study_its_versions_and_its_keys_come_along(folder, bundle):
    with zipfile.ZipFile(bundle) as file:
        assert file.read("study.toml").decode() == STUDY
        versions = file.read("versions.txt").decode()
        keys = file.read("keys.csv").decode().splitlines()
    assert "numpy==" in versions
    assert keys[0] == "key,cell"
    assert len(keys) == 1 + 4


def test_a_sample_is_the_same_to_the_last_bit(bundle):
    done = fleet("verify", bundle, "--sample", 2)
    assert done.exit_code == 0, done.output
    assert done.stdout == (
        f"{bundle}: its files are as written, and 2 of its 4 runs are the same to the last bit\n"
    )


def test_a_row_that_was_written_anew_is_found_by_running_it(bundle, tmp_path):
    """Whoever changes a figure and every checksum over it is found out by the run itself."""

    def change(parts):
        record = tmp_path / "ledger.sqlite"
        record.write_bytes(parts["ledger.sqlite"])
        with sqlite3.connect(record) as database:
            rows = database.execute("SELECT key, row, error FROM run").fetchall()
            for key, row, error in rows:
                better = json.dumps(json.loads(row) | {"messages": 1})
                database.execute(
                    "UPDATE run SET row = ?, checksum = ? WHERE key = ?",
                    (better, checksum(key, "done", better, error), key),
                )
        parts["ledger.sqlite"] = record.read_bytes()
        told = json.loads(parts[METADATA])
        for entity in told["@graph"]:
            if entity["@id"] == "ledger.sqlite":
                entity["sha256"] = sha256_of(record)
        parts[METADATA] = json.dumps(told).encode()

    again(bundle, change)
    done = fleet("verify", bundle, "--sample", 0)
    assert done.exit_code == 1
    assert "messages was 1, is " in done.stderr
    assert done.stderr.endswith("4 of 4 runs are not the runs that are kept\n")


def _write(name, data):
    return lambda parts: parts.update({name: data})


def _without(name):
    return lambda parts: parts.pop(name)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (_write("runs.parquet", b"nonsense"), "is damaged: 'runs.parquet' is not as written"),
        (_write("more.txt", b"new"), "is damaged: 'more.txt' is not told of in its metadata"),
        (_without("keys.csv"), "is damaged: 'keys.csv' is told of and not there"),
        (_without(METADATA), f"is no bundle: it has no {METADATA}"),
        (_write(METADATA, b"[]"), f"is no bundle: {METADATA} is no RO-Crate of ours"),
        (_write(METADATA, b"{"), f"is no bundle: {METADATA} is no RO-Crate of ours"),
    ],
    ids=["another table", "a file more", "a file less", "no metadata", "a list", "no JSON"],
)
def test_a_bad_bundle_is_refused_in_one_sentence(bundle, change, said):
    again(bundle, change)
    done = fleet("verify", bundle)
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert said in done.stderr


def test_what_is_no_zip_file_is_refused_in_one_sentence(tmp_path):
    (tmp_path / "text").write_text("no bundle")
    for path in (tmp_path / "text", tmp_path, tmp_path / "nowhere"):
        done = fleet("verify", path)
        assert done.exit_code == 2
        assert done.stderr.count("\n") == 1, done.stderr


def test_a_bundle_cannot_be_put_where_nothing_can_be_written(folder, tmp_path):
    done = fleet("report", folder, "--bundle", tmp_path / "nowhere" / "study.zip")
    assert done.exit_code == 2
    assert "--bundle: " in done.stderr


def test_an_experiment_keeps_the_page_that_it_wrote(folder, tmp_path):
    out = tmp_path / "out"
    copytree(folder, out)
    with sqlite3.connect(out / "ledger.sqlite") as database:
        database.execute("DELETE FROM meta WHERE name = 'study'")
    (out / "report.html").write_text("a page of its own")
    done = fleet("report", out, "--bundle", tmp_path / "own.zip")
    assert done.exit_code == 0, done.output
    assert (out / "report.html").read_text() == "a page of its own"
    with zipfile.ZipFile(tmp_path / "own.zip") as file:
        assert file.read("report.html") == b"a page of its own"


def test_code_comes_along_and_is_run_only_with_trust(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(CODE)
    Path("study.toml").write_text(STUDY.replace('"rfta2", "gfgf2a"', '"mine.py:mine"'))
    sweep("study.toml", "out", workers=1)
    assert fleet("report", "out", "--bundle", "mine.zip").exit_code == 0
    Path("mine.py").unlink()
    refused = fleet("verify", "mine.zip")
    assert refused.exit_code == 2
    assert "which you have not swept with" in refused.stderr
    assert "--trust" in refused.stderr
    trusted = fleet("verify", "mine.zip", "--trust")
    assert trusted.exit_code == 0, trusted.output
    assert "2 of its 2 runs are the same" in trusted.stdout
