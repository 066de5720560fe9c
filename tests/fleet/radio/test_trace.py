"""Links as they were measured."""

from __future__ import annotations

import numpy as np
import pytest

import fleet
from fleet.agenda import Agenda
from fleet.radio.hearsay import Scattered
from fleet.radio.trace import TraceSpec
from fleet.scenario.errors import BadInput
from protocols.messages import Transmission
from worlds.arena import Arena

LINE = [(1.0, 1.0), (2.0, 1.0), (9.0, 9.0)]
"""Robot 2 is far away: the table, not distance, says who hears whom."""


def radio(links, points=LINE, **spec):
    scattered = Scattered(points, 2.5, "udg", Arena())
    return TraceSpec(links=np.array(links, float), **spec).over(scattered, 1, Agenda())


def test_who_hears_whom_and_how_often_is_what_the_table_says():
    air = radio([(0, 2, 0.7), (2, 0, 1.0), (1, 2, 1.0), (2, 1, 1.0)], retries=0)
    through = [air.transmit(Transmission("bid", 0, 2), 0.001).attempts == 1 for _ in range(3)]
    assert all(through)
    assert air.hearers(0) == [2]
    assert air.hearers(1) == [2]
    assert air.hearers(2) == [0, 1]
    assert air.transmit(Transmission("bid", 0, 1), 0.002).heard == ()
    heard = [air.transmit(Transmission("bid", 0, 2), 0.01).heard == (2,) for _ in range(3000)]
    assert np.mean(heard) == pytest.approx(0.7, abs=4 * np.sqrt(0.7 * 0.3 / 3000))


def test_links_change_when_the_table_says_so():
    both = [(0, 1, 1.0, 0.0), (1, 0, 1.0, 0.0)]
    air = radio([*both, (0, 1, 0.0, 10.0), (1, 0, 0.0, 10.0), (0, 1, 1.0, 20.0)])
    for time, hears in ((0.0, [1]), (9.9, [1]), (10.0, []), (19.9, []), (20.0, [1])):
        air.refresh([], time)
        assert air.hearers(0) == hears
    assert air.tables[0] == {}  # the other way is still shut: it has forgotten robot 1


def test_a_run_reads_its_links_from_a_file_by_column_names(tmp_path):
    table = tmp_path / "links.csv"
    n = 6
    rows = [f"{u};{v};1,0" for u in range(n) for v in range(n) if abs(u - v) == 1]
    table.write_text("From;To;Ratio\n" + "\n".join(rows) + "\n")
    scenario = fleet.Scenario.of(
        robots=n, motion="straight", connected=False, seed=2, rounds=10, graph="udg",
        radio={"name": "trace", "links": str(table)},
    )  # fmt: skip
    summary = fleet.run(scenario)
    assert summary.served > 0
    assert summary.beacons > 0


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([(0, 0, 1.0)], "two robots"),
        ([(0, 1, 1.5)], "0 to 1"),
        ([(0.5, 1, 1.0)], "two robots"),
        ([(0, 7, 1.0)], "0 to 5"),
    ],
)
def test_what_cannot_be_is_refused_with_a_sentence(rows, said):
    scenario = fleet.Scenario.of(robots=6, connected=False, radio={"name": "trace", "links": rows})
    with pytest.raises(BadInput, match=said):
        fleet.run(scenario)
