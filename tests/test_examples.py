"""The examples run as they stand, and say what they promise."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"


def said_by(name, *arguments):
    return subprocess.run(
        [sys.executable, EXAMPLES / name, *map(str, arguments)],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip


@pytest.mark.slow
def test_the_study_in_python_runs_and_goes_on(tmp_path):
    texts = [said_by("study_in_python.py", tmp_path / "out", 6) for _ in range(2)]
    assert texts[0] == texts[1]
    assert texts[0].count("95 % CI") == 6
    assert "at 3.0 m rfta2 lives +" in texts[0]


@pytest.mark.slow
def test_rfta3_lives_longer_beside_rfta2(tmp_path):
    text = said_by("rfta3_beside_rfta2.py", tmp_path)
    rounds = {name: int(n) for name, n in re.findall(r"^(rfta\d) +(\d+)", text, re.MULTILINE)}
    assert rounds["rfta3"] > 1.4 * rounds["rfta2"]
    for protocol in rounds:
        assert (tmp_path / f"{protocol}.rrd").stat().st_size > 1_000_000


@pytest.mark.slow
def test_a_protocol_and_a_metric_of_ones_own():
    text = said_by("own_protocol.py")
    lives = [int(n) for n in re.findall(r"lives +(\d+) rounds", text)]
    assert len(lives) == 3
    assert len(set(lives)) == 3  # they are not all the same protocol


@pytest.mark.slow
def test_short_trips_drain_more_than_eq_1_says():
    text = said_by("own_observer.py")
    ratios = [float(r) for r in re.findall(r"m: (\d\.\d+) over", text)]
    assert len(ratios) == 4
    assert ratios == sorted(ratios, reverse=True)
    assert 1.0 < ratios[-1] < 1.3 < 1.7 < ratios[0]


@pytest.mark.slow
def test_what_would_have_been_differs_from_what_was():
    lives = [int(life) for life in re.findall(r"(\d+)(?: events served)?\n", said_by("what_if.py"))]
    as_it_was, otherwise, ge = lives[-3:]
    assert len({as_it_was, otherwise, ge}) == 3


def test_each_example_is_tested():
    tested = Path(__file__).read_text(encoding="utf-8")
    for example in EXAMPLES.glob("*.py"):
        assert f'"{example.name}"' in tested


@pytest.mark.slow
def test_a_log_of_three_wheels_is_judged(tmp_path):
    text = said_by("own_log.py", tmp_path / "out")
    assert "half within 0 %" in text
    assert (tmp_path / "out" / "report.html").is_file()
