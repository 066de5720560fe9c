"""Tables of places and events, as people and programs write them."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import fleet
from fleet.cli import main
from fleet.scenario.delimited import numbers
from fleet.scenario.errors import BadInput

PLACES = ("x", "y")
EVENTS = ("time", "x", "y", "service", "deadline")
NAN = np.nan


@pytest.fixture
def read(tmp_path):
    def reader(text, columns=EVENTS):
        content = text if isinstance(text, bytes) else text.encode()
        (tmp_path / "table.csv").write_bytes(content)
        return numbers(str(tmp_path / "table.csv"), columns, "key")

    return reader


@pytest.mark.parametrize(
    "text",
    [
        "1,2,3\n4,5,6\n",
        "time,x,y\n1,2,3\n4,5,6",
        "Time [s],X (m),y_m\n1,2,3\n4,5,6",
        "y,time,x\n3,1,2\n6,4,5",
        'robot;y;remark;x;t\na;3;"far; away";2;1\nb;6;;5;4',
        "x\ty\ttime\n2,0\t3,0\t1,0\n5,0\t6,0\t4,0",
        "time x y\n1 2 3\n4   5 6",
        "1,0 2,0 3,0\n4,0 5,0 6,0",
        "x|y|stamp\n2|3|1\n5|6|4",
        "# made by hand\n\n# time, x, y\n1, 2, 3\n4, 5, 6",
        "# y x time\n3 2 1\n% between\n6 5 4",
        "\ufefftime,x,y\r\n1,2,3\r\n4,5,6\r\n",
        "time,x,y\r1,2,3\r4,5,6",
        "time;x;y;;\n1,0;2,0;3,0;;\n4e0;5;6;;",
        "// log\ntime,x,y,service,deadline\n1,2,3,,\n4,5,6,nan,",
    ],
)
def test_the_same_table_in_many_hands(read, text):
    found = read(text)
    assert found[:, :3].tolist() == [[1, 2, 3], [4, 5, 6]]
    assert np.isnan(found[:, 3:]).all()


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("1631534400", "1631534402.5"),
        ("1631534400000", "1631534402500"),
        ("1631534400000000000", "1631534402500000000"),
        ("2021-09-13T12:00:00", "2021-09-13T12:00:02.5"),
        ("2021-09-13 12:00:00Z", "2021-09-13 14:00:02.5+02:00"),
        ("12:00:00", "12:00:02.500"),
    ],
)
def test_dates_and_epochs_count_from_the_first(read, first, second):
    found = read(f"time,x,y\n{second},1,1\n{first},2,2\n")
    assert found[:, 0] == pytest.approx([2.5, 0.0], abs=1e-6)


def test_times_may_be_left_out_altogether(read):
    assert np.isnan(read("x,y\n1,2\n")[:, 0]).all()
    assert read("x,y,service\n1,2,5\n")[0, 3] == 5.0


def test_places_are_two_columns(read):
    assert read("x,y\n1,2\n3,4", PLACES).tolist() == [[1, 2], [3, 4]]
    assert read("id,y,x\n7,2,1\n", PLACES).tolist() == [[1, 2]]
    assert read("1 2\n", PLACES).tolist() == [[1, 2]]


@pytest.mark.parametrize(
    ("text", "columns", "said"),
    [
        ("time,x,y\n1,,3", EVENTS, "table.csv:2: x is ''; expected a number"),
        ("time,x,y\n1,2,3\n\n1,2,nan", EVENTS, "table.csv:4: y is 'nan'; expected a number"),
        ("time,x,y\n1,2,inf", EVENTS, "table.csv:2: y is 'inf'"),
        ("time,x,y\n1,2", EVENTS, "table.csv:2: y is ''"),
        ("time,x,y\n1,2,1e300", EVENTS, "table.csv:2: y is '1e300'"),
        ("time,x,y\nsoon,2,3", EVENTS, "table.csv:2: time is 'soon'; expected seconds, or a date"),
        ("time,x,y\n1,2,3\n,2,3", EVENTS, "table.csv:3: time is ''"),
        ("time,x,y\n2021-09-13T12:00:00,2,3\n5,2,3", EVENTS, "table.csv:3: time is '5'"),
        (
            "time,x,y\n2021-09-13T12:00:00,2,3\n2021-09-13T12:00:00Z,2,3",
            EVENTS,
            "with or without a time zone",
        ),
        ("time,x,z\n1,2,3", EVENTS, "table.csv:1: the columns are 'time,x,z'; expected time,x,y"),
        ("time,x,x,y\n1,2,3,4", EVENTS, "expected x once"),
        ("1,2,3", PLACES, "table.csv:1: has 3 cells, and there is no line that names them"),
        ("1,2", EVENTS, "table.csv:1: has 2 cells"),
        ("time,x,y,service\n1,2,3,-1", EVENTS, "service is '-1'; expected 0 s or more"),
        ("time,x,y,deadline\n1,2,3,0", EVENTS, "deadline is '0'; expected more than 0 s"),
        ("time,x,y", EVENTS, "holds no rows but the names"),
        ("# nothing\n", EVENTS, "table.csv: holds no rows; expected time,x,y, and if wanted serv"),
        ("", PLACES, "table.csv: holds no rows; expected x,y"),
        (b"\xff\x00\x81", PLACES, "it is not UTF-8 text"),
        ("1,2".encode("utf-16"), PLACES, "it is UTF-16"),
        ("x,y\n" + "9" * 200_000 + ",1", PLACES, "table.csv:2: "),
    ],
)
def test_what_is_no_table_is_said_with_its_line(read, text, columns, said):
    with pytest.raises(BadInput) as caught:
        read(text, columns)
    ((key, sentence),) = caught.value.problems
    assert key == "key"
    assert said in sentence
    assert len(sentence) < 400


@pytest.mark.parametrize("value", [3, [[1.0]], [[1, 2], [3]], [[1.0, NAN]], [], [[1, "x"]], {}])
def test_values_that_are_no_table(value):
    with pytest.raises(BadInput, match="expected the path of a table, or rows of x,y"):
        numbers(value, PLACES, "key")


def read_or_refused(path, columns):
    try:
        found = numbers(str(path), columns, "key")
    except BadInput as error:
        return len(str(error)) < 500
    return np.isfinite(found[:, columns.index("x") : columns.index("y") + 1]).all()


@given(st.binary(max_size=200), st.sampled_from([PLACES, EVENTS]))
@settings(deadline=None, max_examples=300)
def test_whatever_a_file_holds_is_read_or_refused(tmp_path_factory, content, columns):
    path = tmp_path_factory.mktemp("any") / "any.csv"
    path.write_bytes(content)
    assert read_or_refused(path, columns)


cells = st.text('0123456789.,;:-+eE \tTZnaxy#|"', max_size=12)


@given(st.lists(st.lists(cells, min_size=1, max_size=6), max_size=6), st.sampled_from(",;\t |"))
@settings(deadline=None, max_examples=300)
def test_whatever_stands_in_the_cells_is_read_or_refused(tmp_path_factory, rows, mark):
    path = tmp_path_factory.mktemp("any") / "any.csv"
    path.write_text("\n".join(mark.join(row) for row in [["time", "x", "y"], *rows]))
    assert read_or_refused(path, EVENTS)


def test_a_trace_is_cut_at_the_end_of_the_run_and_says_so(tmp_path):
    path = tmp_path / "events.csv"
    path.write_text("time,x,y\n1,2,3\n2,4,4\n70,5,5\n80,5,5\n")
    arguments = [
        "run", "--motion", "straight", "--set", "time=stream", "--set", "events.name=trace",
        "--set", f"events.occurrences={path}", "--json",
    ]  # fmt: skip
    done = CliRunner().invoke(main, [*arguments, "--set", "time.duration=60"])
    assert done.exit_code == 0, done.output
    assert "events.csv: 2 of 4 events happen after time.duration = 60 s" in done.stderr
    assert json.loads(done.stdout)["events"] == 2
    done = CliRunner().invoke(main, [*arguments, "--set", "time.duration=0.5"])
    assert done.exit_code == 2
    assert "events.csv: none of 4 events happens within time.duration = 0.5 s" in done.stderr


def test_positions_of_a_map_are_in_its_frame(tmp_path):
    """A trace and starting places where the origin puts them."""
    from PIL import Image

    Image.fromarray(np.full((100, 100), 254, np.uint8)).save(tmp_path / "floor.png")
    (tmp_path / "map.yaml").write_text(
        "image: floor.png\nresolution: 0.1\norigin: [-5.0, -5.0, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (tmp_path / "starts.csv").write_text("x,y\n-4,-4\n-3,-4\n4,4\n")
    (tmp_path / "events.csv").write_text("time,x,y\n0,-4.5,-4.5\n")
    summary = fleet.run(
        fleet.Scenario.of(
            world={
                "name": "map",
                "file": str(tmp_path / "map.yaml"),
                "positions": str(tmp_path / "starts.csv"),
            },
            events={"name": "trace", "occurrences": str(tmp_path / "events.csv")},
            motion="straight",
            connected=False,
            handler="nearest-known",
            protocol={"name": "rfta2", "auctioneer_bids": True},
        )
    )
    assert summary.served == 1
    assert summary.distance_per_robot * 3 == pytest.approx(0.5**0.5)
