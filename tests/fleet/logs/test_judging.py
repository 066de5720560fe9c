"""Verdicts on logs with a known truth, and what is made of them."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from driven_logs import STANDING, TRUTH, drive, folder_of, logged, power_of, table

from fleet.logs.asking import LogSettings
from fleet.logs.fitting import non_negative
from fleet.logs.forces import Chassis, linearised, wheel_forces
from fleet.logs.gathering import gather
from fleet.logs.grounds import LogGround, ground_from_runs, run_from_arrays
from fleet.logs.judging import judge, trips_needed
from fleet.logs.log_report import write
from fleet.logs.presets import power_coefficients, preset_keys
from fleet.logs.sentences import outcome_sentences, verdict_sentence
from fleet.scenario.errors import BadInput


def ground(runs=8, law=power_of, noise=0.02, spread=0.0, **keys):
    rng = np.random.default_rng(1)
    made = []
    for seed in range(runs):
        time, v, omega = drive(seed, **keys)
        factor = 1.0 + spread * rng.standard_normal()
        power = law(v, omega) * factor * (1.0 + noise * rng.standard_normal(len(v)))
        made.append(run_from_arrays(time, v, omega, power, f"run {seed}"))
    return ground_from_runs("tiles", made, LogSettings(mass=20.0, track=0.4))


@pytest.fixture(scope="module")
def turning():
    return judge(ground())


def test_a_law_of_speed_and_turning_is_found_where_distance_is_not_enough(turning):
    assert turning.outcome == "a law is"
    assert turning.by_trip == "fails"
    assert turning.best.terms == ("distance", "time", "angle", "turning")
    for term, truth in TRUTH.items():
        interval = turning.intervals[term]
        assert interval.value == pytest.approx(truth, rel=0.1)
        assert interval.low <= truth <= interval.high
    assert turning.best.left_out.median < 0.01
    assert abs(turning.best.left_out.total) < 0.01
    assert turning.motion.samples.standing == pytest.approx(STANDING, rel=0.05)
    assert "What is missing is turning" in verdict_sentence(turning)


def test_distance_is_enough_where_every_metre_costs_the_same():
    judged = judge(ground(20, law=lambda v, _: 30.0 * np.abs(v), turning=False))
    assert judged.outcome == "accurate"
    assert judged.share.low >= 0.9
    assert judged.by_total == "holds"


def test_no_law_of_motion_is_better_where_the_ground_varies_from_run_to_run():
    judged = judge(ground(12, law=lambda v, _: 30.0 * np.abs(v), spread=0.4, turning=False))
    assert judged.outcome == "no law is"
    assert any("from run to run" in text and "J/m" in text for text in outcome_sentences(judged))


def test_four_perfect_trips_do_not_tell():
    judged = judge(ground(4, law=lambda v, _: 30.0 * np.abs(v), seconds=15.0, turning=False))
    assert judged.linear.within(0.1) == 1.0
    assert judged.outcome == "cannot tell"
    assert any("takes 35 independent trips" in text for text in outcome_sentences(judged))


@pytest.mark.parametrize(("share", "answer"), [(1.0, "holds"), (0.97, "holds"), (0.5, "fails")])
def test_trips_needed_settle_it(share, answer):
    needed = trips_needed(share, answer)
    assert needed is not None
    assert {1.0: needed == 35, 0.97: 35 < needed < 200, 0.5: 3 < needed < 10}[share]
    assert trips_needed(0.9, answer) is None


def test_one_run_is_cut_in_stretches_that_never_say_holds():
    judged = judge(ground(1, law=lambda v, _: 30.0 * np.abs(v), seconds=900.0, turning=False))
    assert judged.by_trip == "cannot tell"
    assert any("nothing of how the robot differs from day to day" in text
               for text in outcome_sentences(judged))  # fmt: skip


def test_a_run_that_holds_most_is_cut_so_that_enough_is_left_to_fit():
    runs = list(ground(5, seconds=40.0).runs)
    runs += ground(1, seconds=600.0).runs
    runs[-1] = run_from_arrays(runs[-1].time, runs[-1].v, runs[-1].omega, runs[-1].power, "long")
    judged = judge(ground_from_runs("tiles", runs))
    assert "cut in parts" in judged.motion.samples.regrouped
    driven = np.bincount(judged.motion.samples.run, judged.motion.samples.step)
    assert driven.max() < 0.45 * driven.sum()


@pytest.mark.parametrize(
    ("keys", "term", "said"),
    [
        ({"turning": False}, "angle", "this log never turns"),
        ({"speeds": (0.5, 0.5), "turning": False}, "time", "one speed only, 0.50 m/s"),
        ({"speeds": (0.5, 0.6), "turning": False}, "square", "speeds from 0.5"),
    ],
)
def test_what_a_log_cannot_tell_apart_is_not_fitted_and_said(keys, term, said):
    judged = judge(ground(5, seconds=80.0, noise=0.2, **keys))
    assert term not in judged.best.terms
    assert any(said in text for text in outcome_sentences(judged))


def test_a_log_without_heading_says_so():
    made = ground(5, seconds=80.0)
    blind = LogGround("tiles", made.runs, made.settings, turns=False)
    judged = judge(blind)
    assert "angle" not in judged.motion.richest
    assert any("shows no heading" in text for text in outcome_sentences(judged))


def test_least_squares_are_those_of_scipy():
    from scipy.optimize import nnls

    rng = np.random.default_rng(0)
    for _ in range(20):
        matrix, values = rng.standard_normal((30, 4)), rng.standard_normal(30)
        matrix *= [1.0, 1e3, 1e-2, 5.0]
        found = non_negative((matrix.T @ matrix)[None], (matrix.T @ values)[None])[0]
        assert found == pytest.approx(nnls(matrix, values)[0], rel=1e-5, abs=1e-9)


def test_power_by_forces_is_linear_near_its_parameters():
    chassis = Chassis(20.0, 0.5, 0.2, 0.7, 0.01, 0.4, 0.3)
    time, v, omega = drive(0, seconds=30.0)
    v, omega = np.convolve(v, np.ones(9) / 9, "same"), np.convolve(omega, np.ones(9) / 9, "same")
    motion = time, v, omega
    at = np.array([8.0, 3.0, 2.0, 1.0, 4.0])
    terms, rest = linearised(chassis, *motion, at)
    left, right = wheel_forces(chassis, time, v, omega, at)
    v, omega = 0.5 * (v[1:] + v[:-1]), 0.5 * (omega[1:] + omega[:-1])
    work = [f * (v + s * 0.2 * omega) for f, s in ((left, -1.0), (right, 1.0))]
    paid = sum(np.maximum(w, 0.0) / 0.7 + np.minimum(w, 0.0) * 0.7 * 0.3 for w in work)
    share = np.abs(np.clip(omega / (0.02 + 0.4 * np.abs(v)), -1.0, 1.0))
    power = 3.0 + share + paid + 0.01 * (left**2 + right**2)
    assert terms @ at + rest == pytest.approx(power)
    for k in range(5):
        more = at.copy()
        more[k] += 1e-6
        terms_, rest_ = linearised(chassis, *motion, more)
        slope = (terms_ @ more + rest_ - power) / 1e-6
        assert slope == pytest.approx(terms[:, k], rel=1e-3, abs=1e-3)


def test_steady_driving_costs_what_the_presets_power_says():
    chassis = Chassis(20.0, 0.5, 0.2, 0.7, 0.01)
    at = np.array([8.0, 3.0, 2.0, 1.0, 4.0])
    (c2, c1, c0), slopes = power_coefficients(chassis, at)
    for speed in (0.2, 0.76):
        time = np.arange(5.0)
        terms, rest = linearised(chassis, time, np.full(5, speed), np.zeros(5), at)
        assert terms @ at + rest == pytest.approx(np.full(4, c2 * speed**2 + c1 * speed + c0))
    assert slopes[0, 4] > 0.0


def test_a_preset_has_every_key_with_its_interval(turning, tmp_path):
    write(turning, tmp_path, "fleet energy --log tiles")
    text = (tmp_path / "preset.toml").read_text()
    table_ = tomllib.loads(text)
    assert table_["mass"] == 20.0
    assert table_["track"] == 0.4
    assert set(table_["power"]) == {"quadratic", "linear", "constant"}
    assert table_["extra"]["idle"] == pytest.approx(STANDING, rel=0.05)
    line = next(line for line in text.splitlines() if line.startswith("linear"))
    assert "W·s/m [" in line
    for key in preset_keys(turning):
        assert key.interval is None or key.interval.low <= key.value <= key.interval.high


def test_the_interval_of_the_constant_has_room_for_an_offset(turning):
    low = turning.intervals["time"].low
    assert low <= TRUTH["time"] - STANDING <= turning.intervals["time"].high
    told = LogGround("tiles", turning.ground.runs, LogSettings(mass=20.0, track=0.4, offset=0.0))
    assert judge(told).intervals["time"].low > low + 1.5


def test_report_tables_and_figures_are_written(turning, tmp_path):
    page = write(turning, tmp_path, "fleet energy --log tiles").read_text()
    assert page.count("<figure") == page.count("<svg") == 6
    assert verdict_sentence(turning) in page
    assert "fleet energy --log tiles" in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    trips = (tmp_path / "trips.csv").read_text().splitlines()
    assert len(trips) == 1 + len(turning.trips)
    assert trips[0].startswith("run,distance [m],time [s]")
    assert len((tmp_path / "windows.csv").read_text().splitlines()) == 1 + len(
        turning.motion.windows
    )


def test_arrays_that_do_not_fit_are_refused():
    with pytest.raises(BadInput, match="of one length"):
        run_from_arrays([0, 1], [0, 1], [0, 1], [0, 1, 2])
    with pytest.raises(BadInput, match="missing or infinite"):
        run_from_arrays([0, 1], [0, 1], [0, 1], [0, np.nan])
    with pytest.raises(BadInput, match="do not ascend"):
        run_from_arrays([0, 0], [0, 1], [0, 1], [0, 1])


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda c: c | {"v": 0 * c["v"], "omega": 0 * c["v"]}, "it never drives"),
        (lambda c: c | {"v": 0.1 * c["v"]}, "never as far as a metre"),
        (lambda c: c | {"power": -c["power"]}, "is the sign of the current right?"),
    ],
)
def test_logs_without_trips_or_energy_are_refused(tmp_path, change, said):
    folder_of(tmp_path / "tiles", runs=2, seconds=40.0, change=change)
    with pytest.raises(BadInput) as error:
        judge(gather([tmp_path / "tiles"])[0])
    assert said in str(error.value)


def test_a_slow_battery_is_matched_with_the_motion_that_it_measured(tmp_path):
    """At 1 Hz, as means over the second before, half a second late: the law is found."""
    for seed in range(6):
        columns = logged(seed, seconds=300.0)
        so_far = np.r_[0.0, np.cumsum(columns["power"]) / 20.0]
        rows = np.arange(20, len(columns["time"]), 20)
        power = np.full(len(columns["time"]), np.nan)
        power[np.minimum(rows + 10, len(power) - 1)] = so_far[rows] - so_far[rows - 20]
        table(tmp_path / "tiles" / f"{seed}.csv", columns | {"power": power})
    judged = judge(gather([tmp_path / "tiles"])[0])
    assert "the mean over 1 s" in judged.reading
    for term, truth in TRUTH.items():
        assert judged.best.law[term] == pytest.approx(truth, rel=0.06 if term != "turning" else 0.3)
