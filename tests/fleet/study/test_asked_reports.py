"""What a report is asked for is known before anything runs; its CSV is text to a spreadsheet."""

from __future__ import annotations

import csv
import re

import pytest

from fleet.scenario.errors import BadInput
from fleet.study.report.csv_files import write_csv
from fleet.study.sweeping import sweep


@pytest.mark.parametrize(
    ("report", "said"),
    [
        ({"baseline": "rfta22"}, "report.baseline: unknown value 'rfta22'; did you mean 'rfta2'"),
        ({"measures": ["lifetim"]}, "report.measures: unknown measure 'lifetim'"),
        ({"x": "protocol"}, "report.x: is 'protocol', whose values are names"),
    ],
)
def test_what_a_report_cannot_show_is_refused_before_any_run(tmp_path, report, said):
    study = {"axes": {"protocol": ["rfta2", "gfgf2a"]}, "report": report}
    with pytest.raises(BadInput, match=re.escape(said)):
        sweep(study, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_text_that_a_spreadsheet_would_compute_is_escaped(tmp_path):
    path = tmp_path / "x.csv"
    write_csv(path, ["=a", "b"], [["=1+1", -2.5], ["@x", "-0.5"], ["+cmd|x", "\tx"]])
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    assert rows[1:] == [
        ["'=1+1", "-2.5"], ["'@x", "-0.5"], ["'+cmd|x", "'\tx"]
    ]  # fmt: skip
    assert path.read_text().startswith("'=a,b")
