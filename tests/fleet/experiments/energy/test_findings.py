"""The first paragraph says what the numbers say, whichever way they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fleet.experiments.energy.energy_report import on_engine
from fleet.experiments.energy.findings import details, findings, on_bids, on_closure, verdict
from fleet.experiments.energy.lives import MEASURES, lives
from fleet.experiments.energy.settings import ENGINE, HUSKIES, papers
from fleet.experiments.energy.trip_table import TripTable


def life(bids, lifetime, unbroken, failed):
    return [
        {"place": "open floor", "protocol": "rfta2", "bids": bids, "seed": seed}
        | dict.fromkeys(MEASURES, 0.0)
        | {"lifetime": lifetime, "unbroken": unbroken, "failed": failed}
        for seed in (1, 2)
    ]


LISTED = lives(
    life("as in the paper", 300, 300, 0) + life("straight", 200, 80, 4.0)
    + life("path", 210, 90, 3.0) + life("corrected", 190, 180, 0.5)
)  # fmt: skip


def test_where_launches_cost_eq1_may_not_be_used_for_short_trips(make_trips):
    single = make_trips(20_000, launch=5.0)
    asked = single.take(single["straight"] < 1.0)
    found = findings(single, asked, asked, LISTED, papers())
    assert found.launch.value == pytest.approx(5.0)
    assert found.paper.within_10 == pytest.approx(2.33, abs=0.011)
    assert found.skid is None
    said = verdict(found)
    assert said.startswith("Energy is linear in the straight distance, but not proportional to it.")
    assert "from 2.33 m on it is within a tenth of what is drained" in said
    assert "5.0 J and 19.4 J a metre, is within 0 % at all lengths (R² 1.000)" in said
    assert "Eq. (1) may not be used for what the protocols ask for" in said
    assert "husky" not in said
    assert f"{asked['straight'].mean():.2f} m long on average" in said
    assert "5.0 J a launch has R² = 1.0000 on tasks" in said
    more = " ".join(details(found))
    assert "rfta2 49 % more" in more
    assert "cost 5.00 J [5.00, 5.00]" in more
    assert "live longer than those that drive: rfta2 1.50 times" in more


def test_where_eq1_is_true_it_may_be_used(make_trips):
    trips = make_trips()
    found = findings(trips, trips, trips, [], papers())
    said = verdict(found)
    assert "linear in the straight distance, and proportional to it, within a tenth" in said
    assert "from 0 m on it is within a tenth of what is drained, and from 0 m on" in said
    assert "Eq. (1) may be used for what the protocols ask for" in said
    assert "drained 0 % more than it says" in said
    assert not any("Networks simulated" in sentence for sentence in details(found))


def test_percentages_are_shares_of_eq1(make_trips):
    trips = make_trips(detour=1.0)
    drained = trips.columns["drained"]
    drained *= 1.3
    found = findings(trips, trips, trips, [], papers())
    assert "drained 30 % more than it says" in verdict(found)
    assert "rfta2 30 % more" in details(found)[0]
    drained *= 0.75 / 1.3
    assert "drained 25 % less than it says" in verdict(findings(trips, trips, trips, [], papers()))


def test_where_a_robot_skids_no_line_holds(make_trips):
    single = make_trips(4000, launch=5.0)
    skid = make_trips(4000, launch=5.0)
    skid.columns["setting"][:] = HUSKIES
    skid.columns["drained"][:] += 10.0 * skid["straight"] ** 2  # whatever is not a line
    both = TripTable({name: np.concatenate([single[name], skid[name]]) for name in single.columns})
    said = verdict(findings(both, single, single, [], papers()))
    assert said.startswith("Energy is linear in the straight distance, but not proportional to it.")
    assert "(husky) it is neither linear in the straight distance nor proportional to it" in said


def test_how_far_a_line_is_off_is_said_in_percent(make_trips):
    trips = make_trips(launch=5.0)
    found = findings(trips, trips, trips, [], papers())
    tolerable = replace(found.paper, line_off=0.07)
    said = verdict(replace(found, paper=tolerable, skid=replace(found.paper, line_off=0.42)))
    assert "is within 7 % at all lengths" in said
    assert "the best line is off by up to 42 %" in said
    said = verdict(replace(found, paper=replace(found.paper, line_off=0.12)))
    assert said.startswith("Energy is neither linear in the straight distance nor proportional")


def test_how_far_bodies_are_from_what_was_foreseen_is_said_in_percent(make_trips):
    foreseen, driven = make_trips(100), make_trips(100)
    driven.columns["setting"][:] = ENGINE.name
    driven.columns["drained"][:50] *= 1.02
    driven.columns["drained"][50:] *= 0.99
    both = TripTable(
        {name: np.concatenate([foreseen[name], driven[name]]) for name in foreseen.columns}
    )
    said = on_engine(both, papers())
    assert "within 1.500 % on average and 2.00 % at most, over 100 trips" in said
    assert on_engine(foreseen, papers()) == ""


def test_where_detours_are_everywhere_it_may_not_be_used_at_all(make_trips):
    trips = make_trips(detour=1.3)
    said = verdict(findings(trips, trips, trips, [], papers()))
    assert "it is nowhere within a tenth, up to 7 m" in said


def test_bids_are_compared_by_failures_and_lifetimes():
    said = on_bids(LISTED)
    assert "rfta2 4.0 and 0.5 a lifetime, 80 and 180 events before the first" in said
    assert "changes by −5 % to −5 %" in said
    assert "planned path make it longer in 1 of 1 cases, at most by 5 % (open floor, rfta2)" in said
    assert "corrected model make it longer in 0 of 1 cases, and shorter in 1" in said
    assert on_bids([]) == ""


def test_an_account_that_does_not_close_is_said(make_trips):
    trips = make_trips(launch=5.0)
    assert "the parts add up to what" in on_closure(findings(trips, trips, trips, [], papers()))
    trips["energy_launch"][3] += 1.0
    found = findings(trips, trips, trips, [], papers())
    assert "the parts do NOT add up to what" in on_closure(found)
