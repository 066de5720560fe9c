"""What the work functions measure, on real motion."""

from __future__ import annotations

from math import inf
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest

from fleet.experiments.energy import settings
from fleet.experiments.energy.measuring import ChoiceLog, drive_tasks, play
from fleet.experiments.energy.settings import DRIVE, ENGINE, PAPER, PLAY, QUICK, SETTINGS, Size
from fleet.experiments.energy.trip_table import TripTable, closure
from fleet.robot import Appraisal, RobotSpec
from fleet.study import Job

SMALL = Size(placements=1, tasks=60, seeds=1, recorded=1, streams=1)
SINGLE = {task.cell: task for task in settings.single_tasks(SMALL, 3, settings.papers())}


def trips_of(row):
    return TripTable.of(pa.Table.from_pylist(row["tables"]["trips"]))


@pytest.mark.parametrize("cell", [PAPER, "radius 0.2 m", "rooms", "weighs 30 kg"])
def test_single_tasks_add_up_and_cover_all_distances(cell):
    trips = trips_of(drive_tasks(SINGLE[cell]))
    assert len(trips) == 60
    assert closure(trips) < 1e-9
    straight = trips["straight"]
    assert straight.min() >= settings.SHORTEST
    assert straight.max() <= settings.LONGEST
    assert straight.std() == pytest.approx(7.0 / 12.0**0.5, rel=0.2)
    arrived = trips.arrived()
    assert (arrived["drained"] > 0.0).all()
    assert (arrived.part("scrub") >= 0.0).all()


def test_the_engine_drains_what_was_foreseen_but_not_to_the_bit():
    foreseen, driven = (trips_of(drive_tasks(SINGLE[name])) for name in (PAPER, ENGINE.name))
    # a body that comes to rest a millimetre elsewhere goes another way next time
    assert driven["drained"] == pytest.approx(foreseen["drained"], rel=0.01)
    assert (driven["drained"] != foreseen["drained"]).all()


def test_what_a_controller_does_not_know_is_driven_by_forces():
    unknown = [v for v in SETTINGS if {"payload", "error"} & set(v.scenario.get("robot", {}))]
    assert len(unknown) == 2
    assert all(v.scenario["motion"] == "physics" for v in unknown)


def test_choices_count_where_eq1_takes_another_robot_and_what_it_costs():
    robots = [SimpleNamespace(position=(x, 0.0)) for x in (1.0, 2.0, 3.0)]
    log = ChoiceLog()
    log.run_started(SimpleNamespace(robots=robots, spec=RobotSpec()))
    event = SimpleNamespace(position=(0.0, 0.0))

    def asked(*costs):
        log.appraised(event, [Appraisal(n, c, 100.0, "") for n, c in enumerate(costs)], 0.0)

    asked(20.0, 40.0, 60.0)  # the nearest is the cheapest
    assert (log.made, log.misled, log.regret) == (1, 0, 0.0)
    asked(45.0, 40.0, inf)  # the nearest has to turn
    assert (log.made, log.misled, log.regret) == (2, 1, 5.0)
    asked(inf, 40.0, 101.0)  # only one can go
    assert (log.made, log.misled, log.regret) == (2, 1, 5.0)
    assert play(life(protocol="rfta2", motion={"name": "path", "belief": "driven"}))["choices"] > 50
    assert "choices" not in play(life(protocol="rfta2", rounds=3))


def test_without_inertia_eq1_is_true_of_the_planned_path():
    trips = trips_of(drive_tasks(SINGLE["no inertia at all"])).arrived()
    eq1 = trips["per_metre"] * trips["planned"]
    idle = 2.0 * 3.66 / 60.0  # the electronics' while a drive begins and ends, two steps [J]
    assert trips["drained"] == pytest.approx(eq1, rel=5e-3, abs=idle)


def test_the_same_task_is_the_same_again():
    assert drive_tasks(SINGLE["pit"]) == drive_tasks(SINGLE["pit"])
    assert len({task.key for task in SINGLE.values()}) == len(SETTINGS) + 1


def life(**scenario):
    return Job.of({"motion": "path", "seed": 2, **scenario}, tables=("trips",), function=PLAY)


def test_a_lifetime_s_trips_are_all_that_was_drained():
    row = play(life(protocol="rfta2"))
    trips = trips_of(row)
    assert closure(trips) < 1e-9
    assert trips["drained"].sum() == pytest.approx(row["energy_drained"], rel=1e-9)
    assert trips.eq1.sum() == pytest.approx(row["energy_predicted"], rel=1e-9)
    failed = trips["outcome"] != "arrived"
    assert failed.sum() == row["failed"]
    assert trips["drained"][failed].sum() == pytest.approx(row["energy_failed"])
    before = np.argmax(failed) if failed.any() else len(trips)
    assert row["unbroken"] == before


def test_bidding_what_it_costs_nobody_dies_on_the_way():
    wrong = play(life(protocol="rfta2", seed=1))
    right = play(
        life(
            protocol="rfta2",
            seed=1,
            motion={"name": "path", "belief": "corrected", "per_launch": 18.0},
        )
    )
    assert wrong["failed"] > 0
    assert right["failed"] == 0
    assert right["unbroken"] == right["lifetime"]


@pytest.mark.parametrize("traffic", ["reserved", "free"])
def test_streams_have_waiting_or_contact_and_add_up(traffic):
    (task,) = [
        task
        for task in settings.streams(SMALL, 0)
        if task.labels["traffic"] == traffic
        and (task.labels["radius"], task.labels["rate"]) == (0.2, settings.RATES[-1])
    ]
    trips = trips_of(play(task))
    assert closure(trips) < 1e-9
    found = {"reserved": "waiting", "free": "contact"}[traffic]
    other = {"reserved": "contact", "free": "waiting"}[traffic]
    assert trips.part(found).sum() > 1.0
    assert abs(trips.part(other)).max() < 1e-9


def test_lifetimes_differ_in_nothing_but_their_bids():
    launch = {place.setting: 5.0 for place in settings.PLACES}
    tasks = list(settings.lifetimes(SMALL, 0, launch, settings.papers()))
    by_bids = {}
    for task in tasks:
        if (task.labels["place"], task.labels["protocol"]) == ("rooms", "rfta3"):
            by_bids[task.labels["bids"]] = {**task.scenario, "motion": None}
    assert set(by_bids) == set(settings.BIDS)
    assert len({str(scenario) for scenario in by_bids.values()}) == 1
    assert len({task.key for task in tasks}) == len(tasks)
    assert QUICK.seeds < settings.FULL.seeds
    assert all(task.function in {DRIVE, PLAY} for task in tasks)
