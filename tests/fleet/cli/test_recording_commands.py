"""``fleet export``, charts, and one event or robot of a recording, as a user meets them; damaged
files.
"""

from __future__ import annotations

import random
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner
from PIL import Image

from fleet.cli import main
from fleet.replay import scheme, viewer
from fleet.replay.readback import Recording


def fleet(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    path = tmp_path_factory.mktemp("recorded") / "run.rrd"
    done = fleet(
        "run", "--motion", "straight", "--robots", 30, "--range", 3, "--rounds", 6, "--rrd", path
    )
    assert done.exit_code == 0
    return path


def test_export_writes_every_table(recorded, tmp_path):
    done = fleet("export", recorded, "--out", tmp_path / "tables")
    assert done.exit_code == 0
    written = [Path(line) for line in done.stdout.splitlines()]
    assert {path.name for path in written} == {
        "transcript.parquet", "trips.parquet", "tasks.parquet", "poses.parquet"
    }  # fmt: skip
    for path in written:
        assert pq.read_table(path).num_rows > 0


def test_a_chart_of_an_event(recorded, tmp_path):
    out = tmp_path / "chart.png"
    done = fleet("picture", recorded, "--chart", 2, "-o", out)
    assert (done.exit_code, done.stdout) == (0, f"{out}\n")
    with Image.open(out) as image:
        assert len(image.convert("RGB").getcolors(1 << 20)) > 20
    done = fleet("picture", recorded, "--chart", 99, "-o", out)
    assert done.exit_code == 2
    assert "nothing was said about an event 99" in done.stderr


@pytest.mark.parametrize("option", ["--event", "--robot"])
def test_one_event_or_robot_is_opened(recorded, monkeypatch, option):
    trip = Recording(recorded).table(scheme.TRIPS).to_pylist()[-1]
    opened = []
    monkeypatch.setattr(viewer, "_open_window", lambda path: opened.append(Recording(path)))
    done = fleet("view", recorded, option, trip[option.removeprefix("--")])
    assert done.exit_code == 0, done.output
    assert opened[0].table(scheme.TRIPS).equals(Recording(recorded).table(scheme.TRIPS))
    done = fleet("view", recorded, option, 999)
    assert done.exit_code == 2
    assert f"there is no {option.removeprefix('--')} 999; expected" in done.stderr


DAMAGES = {
    "flipped": lambda data: data[: len(data) // 2] + bytes([data[len(data) // 2] ^ 16])
    + data[len(data) // 2 + 1 :],
    "cut": lambda data: data[: len(data) // 3],
    "empty": lambda data: b"",
    "only begun": lambda data: data[:6],
    "of another type": lambda data: b"PAR1" + data[4:],
}  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_files_are_refused_in_a_sentence(recorded, tmp_path, damage):
    path = tmp_path / "x.rrd"
    path.write_bytes(DAMAGES[damage](recorded.read_bytes()))
    for command in (
        ["picture", path, "--at", "round=1", "-o", tmp_path / "p.png"],
        ["export", path, "--out", tmp_path / "out"],
        ["view", path, "--by", "round"],
        ["view", path, recorded],
    ):
        refused(fleet(*command), command)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_damage_anywhere_never_traces_back(recorded, tmp_path, seed):
    """A picture is drawn, or a sentence says why not."""
    draw = random.Random(seed)
    for _ in range(3):
        data = bytearray(recorded.read_bytes())
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
        path = tmp_path / "x.rrd"
        path.write_bytes(data)
        done = fleet("picture", path, "--at", "round=1", "--dpi", 30, "-o", tmp_path / "p.png")
        if done.exit_code != 0:
            refused(done, seed)


def refused(done, what):
    assert done.exit_code == 2, what
    assert done.stdout == "", what
    assert len(done.stderr.splitlines()) == 1, what
    assert done.exception is None or isinstance(done.exception, SystemExit), what
