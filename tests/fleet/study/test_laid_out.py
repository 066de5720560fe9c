"""Pages of reports in a real browser: nothing sticks out, nothing is cut, all can be read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from laid_out import faults

import fleet
from fleet.logs.asking import LogSettings
from fleet.logs.grounds import ground_from_runs, run_from_arrays
from fleet.logs.judging import judge
from fleet.logs.log_report import write

CHROMIUM = Path("/usr/bin/chromium")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not CHROMIUM.exists(), reason=f"there is no {CHROMIUM}"),
]


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox"])
        yield started
        started.close()


@pytest.fixture(scope="module")
def study_page(tmp_path_factory):
    study = {
        "title": "Two protocols at two ranges",
        "scenario": {"motion": "straight", "robots": 40, "rounds": 12},
        "axes": {"protocol": ["rfta2", "gfgf2a"], "range": [3.0, 3.5], "search_radius": [1.0, 2.0]},
        "seeds": 4,
        "tables": ["robots"],
    }
    return fleet.sweep(study, tmp_path_factory.mktemp("study"), workers=1).report()


def drive(seed, rate=20.0):
    """Times (n,) [s], speeds [m/s], turning rates [rad/s], power [W]."""
    rng = np.random.default_rng(seed)
    v = np.repeat(rng.choice([0.0, 0.3, 0.5, 0.76], 30), int(4 * rate))
    power = 6.25 * v**2 + 9.79 * v + 3.66 + 0.1 * rng.standard_normal(len(v))
    return np.arange(len(v)) / rate, v, np.zeros(len(v)), power


@pytest.fixture(scope="module")
def log_page(tmp_path_factory):
    runs = [run_from_arrays(*drive(seed), f"run {seed}") for seed in range(6)]
    judgement = judge(ground_from_runs("floor", runs, LogSettings(mass=9.0)))
    return write(judgement, tmp_path_factory.mktemp("log"))


@pytest.mark.parametrize("kind", ["study_page", "log_page"])
def test_a_report_can_be_read_anywhere(kind, browser, request, tmp_path):
    page = request.getfixturevalue(kind)
    assert faults(browser, page.as_uri(), picture=tmp_path / kind) == {}


def test_what_sticks_out_or_is_too_small_is_found(browser, tmp_path):
    page = tmp_path / "bad.html"
    page.write_text(
        "<!doctype html><p style='font-size: 8px'>small</p>"
        "<div style='overflow-x: auto'><p style='width: 2000px'>cut</p></div>"
        "<svg width='100' viewBox='0 0 200 50'><text y='20' font-size='12'>drawn</text></svg>",
        encoding="utf-8",
    )
    found = faults(browser, page.as_uri())
    assert len(found) == 5
    assert any("small" in fault for fault in found["1280 px, dark"])
    assert any("6.0 px" in fault for fault in found["390 px, light"])
    assert any("cut on paper" in fault for fault in found["printed"])
