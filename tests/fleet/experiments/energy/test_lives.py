"""Lifetimes are compared with those of the same seed."""

from __future__ import annotations

import pytest

from fleet.experiments.energy.lives import MEASURES, find, lives


def runs(bids, lifetimes, first=0):
    return [
        {"place": "rooms", "protocol": "rfta2", "bids": bids, "seed": first + number}
        | dict.fromkeys(MEASURES, 0.0)
        | {"lifetime": life}
        for number, life in enumerate(lifetimes)
    ]


def test_differences_are_over_pairs():
    listed = lives(runs("straight", [10, 200, 35]) + runs("corrected", [15, 205, 40]))
    better = find(listed, "rooms", "rfta2", "corrected")
    assert better.means["lifetime"].value == pytest.approx(260 / 3)
    assert better.differences["lifetime"][:3] == (5.0, 5.0, 5.0)
    assert find(listed, "rooms", "rfta2", "straight").differences["lifetime"].mean == 0.0
    assert find(listed, "pit", "rfta2", "straight") is None


def test_runs_without_a_partner_are_left_out_of_differences():
    listed = lives(runs("straight", [10, 20]) + runs("path", [12, 25, 90], first=1))
    other = find(listed, "rooms", "rfta2", "path")
    assert other.runs == 3
    assert other.differences["lifetime"].pairs == 1
    assert other.differences["lifetime"].mean == 12 - 20
