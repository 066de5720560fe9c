"""Numbers beside figures: as files in full, as text with their intervals."""

from __future__ import annotations

import csv
from math import nan

from fleet.experiments.energy.exhibits import Column, Exhibit
from fleet.study.statistics import Interval


def exhibit(*rows):
    return Exhibit("name", "", [Column("what"), Column("n", ","), Column("x [J]", ".1f")], rows)


def test_intervals_take_three_columns_of_a_file(tmp_path):
    exhibit(["a", 1234, Interval(1.25, 1.0, 1.5)], ["b", 2, Interval(2.0, nan, nan)]).write_csv(
        tmp_path
    )
    with (tmp_path / "name.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["what", "n", "x [J]", "x [J], low", "x [J], high"]
    assert rows[1] == ["a", "1234", "1.25", "1.0", "1.5"]
    assert len(rows) == 3


def test_people_read_minus_signs_bounds_and_dashes():
    cells = exhibit(
        ["a", 1234, Interval(-1.25, -2.0, 0.5)], ["b", 2, nan], ["c", 3, Interval(2.0, nan, nan)]
    ).cells()
    assert cells == [["a", "1,234", "−1.2 [−2.0, 0.5]"], ["b", "2", "–"], ["c", "3", "2.0"]]
