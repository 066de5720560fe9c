"""Ratios of lifetimes, and choices, against what is worked out by hand."""

from __future__ import annotations

import pytest

from fleet.experiments.energy import sensitivity
from fleet.experiments.energy.settings import HEADLINES, PAPER, PROTOCOLS

OTHER = "scrubs with 2.4 N·m"


def lived(setting, **lifetimes):
    return [
        {"setting": setting, "protocol": name, "seed": seed, "lifetime": lifetime + seed}
        for name in PROTOCOLS
        for seed in (0, 1, 2)
        for lifetime in [lifetimes.get(name, 100)]
    ]


ROWS = lived(PAPER, rfta3=199, rfta2ge=99, rfta2=99, gfgf2a=49) + lived(
    OTHER, rfta3=79, rfta2ge=99, rfta2=99, gfgf2a=49
)


def test_ratios_are_of_mean_lifetimes():
    found = sensitivity.ratios(ROWS)
    assert found[PAPER]["rfta3", "rfta2ge"].value == pytest.approx(2.0)
    assert found[OTHER]["rfta3", "rfta2ge"].value == pytest.approx(0.8)
    assert found[OTHER]["rfta2", "gfgf2a"].value == pytest.approx(2.0)


def test_an_order_that_is_turned_is_said():
    said = sensitivity.on_headlines(ROWS)
    assert "rfta3 / rfta2ge is 2.00 [" in said
    assert f"0.80 [0.80, 0.80] ({OTHER})" in said
    assert "turned with 1 of 2 robots, in 1 of these cases beyond the interval" in said
    assert said.count("the order is the same with all robots") == 2
    assert sensitivity.on_headlines([]) == ""


def test_choices_are_percentages_of_choices():
    rows = [
        {"place": "open floor", "protocol": "rfta2", "bids": "driven", "seed": seed,
         "choices": made, "misled": wrong, "regret": 3.0}
        for seed, made, wrong in ((0, 50, 10), (1, 150, 20))
    ]  # fmt: skip
    ((place, protocol, made, share, regret),) = sensitivity.misled(rows)
    assert (place, protocol, made) == ("open floor", "rfta2", 200)
    assert share.value == pytest.approx(15.0)
    assert regret == pytest.approx(0.2)
    assert "rfta2 15 % (0.20 J each)" in sensitivity.on_choices(rows)
    assert list(sensitivity.misled([{**rows[0], "bids": "straight"}])) == []


def test_scrub_is_varied_to_several_times_the_paper_s():
    scrubs = [v["robot"]["scrub"] for v in HEADLINES.values() if "scrub" in v.get("robot", {})]
    assert max(scrubs) >= 12 * 0.2 - 1e-9
    assert PAPER in HEADLINES
