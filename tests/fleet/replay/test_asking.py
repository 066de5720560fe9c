"""What can be asked of a recording: tables as files, comparisons, one event, one chart."""

from __future__ import annotations

import http.client
import json
import re
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader
from PIL import Image

from fleet.replay import scheme
from fleet.replay.chart_figure import chart
from fleet.replay.comparison import Aim, arrange, framed, names
from fleet.replay.parting import parting
from fleet.replay.readback import Recording
from fleet.replay.table_files import export_tables
from fleet.replay.web_server import Part, serving

from .conftest import record

DOCS = Path(__file__).parents[3] / "docs" / "replay.md"


def test_tables_are_written_as_they_are(stream, tmp_path):
    written = export_tables(stream.path, tmp_path / "out")
    assert [path.name for path in written] == [
        "transcript.parquet", "trips.parquet", "tasks.parquet", "poses.parquet"
    ]  # fmt: skip
    said = pq.read_table(written[0])
    assert said.equals(stream.recording.table(scheme.TRANSCRIPT))
    poses = pq.read_table(written[3]).to_pandas()
    samples = np.concatenate(stream.witness.samples)
    keys = set(zip(np.round(poses["time"], 6), poses["robot"], strict=True))
    assert {(round(t, 6), int(r)) for r, t, *_ in samples.tolist()} <= keys | {
        (round(trip.ended, 6), trip.robot) for _, trip, _ in stream.witness.trips
    }


def test_mcap_has_a_topic_for_each_table(rounds, tmp_path):
    path = export_tables(rounds.path, tmp_path, mcap=True)[-1]
    with path.open("rb") as file:
        found = [
            (channel.topic, json.loads(message.data))
            for _, channel, message in make_reader(file).iter_messages()
        ]
    bids = [row for topic, row in found if topic == "/transcript" and row["kind"] == "bid"]
    said = [line for line in rounds.witness.said if line.transmission.kind == "bid"]
    assert [row["cost"] for row in bids] == [line.transmission.bid.cost for line in said]
    assert {topic for topic, _ in found} == {"/transcript", "/trips", "/tasks", "/poses"}


def test_the_query_of_the_documentation_finds_all_bids_of_a_robot(rounds, capsys):
    (code,) = re.findall(r"```python\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL)
    assert len(code.strip().splitlines()) <= 11
    robot = next(
        line.transmission.sender for line in rounds.witness.said if line.transmission.kind == "bid"
    )
    exec(code.replace("run.rrd", str(rounds.path)).replace("17", str(robot)), {})
    told = eval(capsys.readouterr().out)
    own = [
        line
        for line in rounds.witness.said
        if line.transmission.kind == "bid"
        and line.transmission.sender == line.transmission.bid.robot == robot
    ]
    assert [row["number"] for row in told] == [line.number for line in own]
    assert [row["cost"] for row in told] == [line.transmission.bid.cost for line in own]


def test_two_runs_part_where_their_winners_do(rounds, tmp_path):
    other = record(
        tmp_path / "other.rrd", world="random-hole", rounds=60, protocol="rfta1",
        robots=50, robot={"capacity": 60.0, "extra": {"idle": 1.0}}, seed=12,
    )  # fmt: skip
    winners = [
        {event.id: award.winner for event, award, *_ in run.witness.awards}
        for run in (rounds, other)
    ]
    parted = next(e for e in winners[0] if winners[0][e] != winners[1].get(e))
    found = parting(rounds.recording, other.recording)
    assert found.parted == parted + 1
    talks = [
        [
            (s.transmission.kind, s.transmission.sender, s.heard)
            for s in run.witness.said
            if s.event == e
        ]
        for e in range(found.said)
        for run in (rounds, other)
    ]
    assert all(a == b for a, b in zip(talks[:-2:2], talks[1:-2:2], strict=True))
    assert talks[-2] != talks[-1]
    for k, run in enumerate((rounds, other)):
        later = [t.energy for e, t, _ in run.witness.trips if e.id >= parted]
        assert found.energy[k] == pytest.approx(sum(later))
        assert found.messages[k] == sum(line.event >= parted for line in run.witness.said)
    assert f"## They part at event {parted + 1}\n" in found.markdown()
    alike = parting(rounds.recording, rounds.recording)
    assert (alike.parted, alike.said, alike.ends, alike.energy) == (None, None, [], (0.0, 0.0))
    assert alike.markdown().startswith("## They never part")
    arrange([rounds.path, other.path], tmp_path / "both.rrd")
    both = Recording(tmp_path / "both.rrd")
    for root, run in (("a", rounds), ("b", other)):
        mean = both.rows(f"{root}/{scheme.COMPARED_ENERGY}", "Scalars:scalars").values
        own = run.recording.rows(scheme.FLEET_ENERGY, "Scalars:scalars").values
        assert [v[0] for v in mean] == pytest.approx([v[0] for v in own])
    for path, counted in (
        (scheme.DIFFERENCE_ENERGY, lambda run, e: sum(
            t.energy for event, t, _ in run.witness.trips if event.id < e)),
        (scheme.DIFFERENCE_MESSAGES, lambda run, e: sum(s.event < e for s in run.witness.said)),
    ):  # fmt: skip
        rows = both.rows(f"{path}/b", "Scalars:scalars")
        assert len(rows.values) > 5
        for round_, value in zip(rows.moments[scheme.ROUND].tolist(), rows.values, strict=True):
            more = counted(other, round_) - counted(rounds, round_)
            assert value[0] == pytest.approx(more, abs=1e-6)
    assert names([rounds.recording, other.recording]) == [
        f"{p} · random-hole · straight · seed 12" for p in ("rfta2", "rfta1")
    ]
    assert len(set(names([rounds.recording, rounds.recording, other.recording]))) >= 2


def test_an_event_or_a_robot_is_framed(rounds):
    event, trip, _ = rounds.witness.trips[3]
    stage, span = framed(rounds.recording, Aim(event=event.id + 1))
    left, low, right, high = stage.frame
    assert left < event.position[0] < right
    assert low < event.position[1] < high
    assert right - left < stage.width
    assert span.start < span.end
    first = next(e for e, t, _ in rounds.witness.trips if t.robot == trip.robot)
    assert framed(rounds.recording, Aim(robot=trip.robot)) == framed(
        rounds.recording, Aim(event=first.id + 1)
    )
    for aim, complaint in (
        (Aim(event=999), "there is no event 999; expected 1 to"),
        (Aim(robot=50), "there is no robot 50; expected 0 to 49"),
    ):
        with pytest.raises(ValueError, match=complaint):
            framed(rounds.recording, aim)


def test_a_sequence_chart(rounds, tmp_path):
    out = chart(rounds.path, 2, tmp_path / "chart.png")
    image = np.array(Image.open(out).convert("RGB")).astype(int)
    for kind in {line.transmission.kind for line in rounds.witness.said if line.event == 1}:
        colour = scheme.KINDS_ON_WHITE[kind]
        rgb = [colour >> shift & 255 for shift in (24, 16, 8)]
        assert (np.abs(image - rgb).max(axis=2) < 12).sum() > 40
    with pytest.raises(ValueError, match="nothing was said about an event 999"):
        chart(rounds.path, 999, out)


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"Host": "evil.example"}, 403),
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": "null"}, 403),
    ],
)
def test_the_web_viewer_answers_its_own_page_alone(headers, status, tmp_path):
    file = tmp_path / "run.rrd"
    file.write_bytes(b"RRF2")
    with serving({"/": Part("text/html", b"page")}, file) as address:
        host = address.split("/")[2]
        connection = http.client.HTTPConnection(host, timeout=10)
        connection.request("GET", "/recording.rrd", headers={"Host": host, **headers})
        answer = connection.getresponse()
        assert answer.status == status
        if status == 200:
            assert answer.read() == b"RRF2"
            file.unlink()
            connection = http.client.HTTPConnection(host, timeout=10)
            connection.request("GET", "/recording.rrd", headers={"Host": host})
            gone = connection.getresponse()
            assert (gone.status, gone.reason) == (
                410, "cannot open run.rrd: No such file or directory"
            )  # fmt: skip
