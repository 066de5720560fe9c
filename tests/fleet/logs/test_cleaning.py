"""Every rule of cleaning: that it is applied, and that it is told."""

from __future__ import annotations

import numpy as np
import pytest
from driven_logs import drive, folder_of, logged, power_of, table

from fleet.logs.asking import LogSettings, MotorConstants, over, settings_from
from fleet.logs.cleaning import runs_of
from fleet.logs.gathering import gather
from fleet.logs.signals import signals_of
from fleet.logs.sniffing import read_sheet
from fleet.scenario.errors import BadInput

MOTOR = MotorConstants(27.2, 0.46)


def cleaned(tmp_path, columns, **settings):
    sheet = read_sheet(table(tmp_path / "log.csv", columns))
    return runs_of(signals_of(sheet), LogSettings(**settings))


def energy(run):
    return float((run.power[1:] * np.diff(run.meter)).sum())


@pytest.mark.parametrize(("factor", "start"), [(1.0, 0.0), (1e3, 0.0), (1e9, 0.0), (1e9, 1.7e18)])
def test_the_unit_of_time_is_found(tmp_path, factor, start):
    columns = logged(0)
    columns["time"] = start + np.round(columns["time"] * factor, 6)
    if start:
        columns["time"] -= 1.7e18  # what float64 can tell apart is written
        text = [
            f"{1_700_000_000_000_000_000 + int(t)},{v},{w},{p}"
            for t, v, w, p in zip(*columns.values(), strict=True)
        ]
        path = tmp_path / "log.csv"
        path.write_text("\n".join(["time,v,omega,power", *text]))
        found = runs_of(signals_of(read_sheet(path)), LogSettings())
    else:
        found = cleaned(tmp_path, columns)
    assert found.runs[0].duration == pytest.approx(149.95, abs=1e-3)
    assert (factor == 1.0) == (not any("times taken as" in note for note in found.notes))


def test_nothing_is_integrated_across_gaps_and_backward_times(tmp_path):
    columns = logged(1)
    whole = energy(cleaned(tmp_path, columns).runs[0])
    columns["time"][1000:] += 100.0
    columns["time"][2000:] -= 130.0
    columns["time"][50] = columns["time"][49]
    found = cleaned(tmp_path, columns)
    assert [len(run.time) for run in found.runs] == [999, 1000, 1000]
    assert sum(map(energy, found.runs)) == pytest.approx(whole, rel=0.01)
    assert any("cut at 2 places" in note for note in found.notes)
    assert any("1 repeated times" in note for note in found.notes)


def test_a_drive_current_loses_what_it_reads_at_standstill_channel_by_channel(tmp_path):
    time, v, omega = drive(2)
    left, right = v - 0.2 * omega, v + 0.2 * omega
    pulls = {"i_left": np.abs(left) * 10.0, "i_right": np.abs(right) * 10.0}
    columns = {"time": time, "v_left": left, "v_right": right}
    clean = cleaned(tmp_path, columns | pulls, motor=MOTOR, track=0.4)
    off = {"i_left": pulls["i_left"] + 0.59, "i_right": pulls["i_right"] + 0.2}
    found = cleaned(tmp_path, columns | off, motor=MOTOR, track=0.4)
    assert found.runs[0].power == pytest.approx(clean.runs[0].power)
    assert any("0.59 A at standstill" in note for note in found.notes)
    assert any("0.20 A at standstill" in note for note in found.notes)
    assert any("braking counts as driving" in note for note in found.notes)


def test_motor_power_is_work_and_heat(tmp_path):
    time, v, _ = drive(2, turning=False)
    columns = {
        "time": time,
        "v_left": v,
        "v_right": v,
        "i_left": 3.0 * (v > 0),
        "i_right": 5.0 * (v > 0),
    }
    run = cleaned(tmp_path, columns, motor=MOTOR, track=0.4).runs[0]
    expected = (27.2 * v * (3.0 + 5.0) + 0.46 * (9.0 + 25.0)) * (v > 0)
    assert run.power == pytest.approx(expected)


def test_motor_currents_taken_for_the_batterys_are_refused(tmp_path):
    time, v, omega = drive(3)
    columns = {
        "time": time,
        "v": v,
        "omega": omega,
        "voltage": 24.0 + 0 * v,
        "current": 12.0 * (v > 0),
    }
    with pytest.raises(BadInput, match=r"V·I would push with .* times the robot's weight"):
        cleaned(tmp_path, columns, mass=8.0)
    assert cleaned(tmp_path, columns, mass=800.0).runs
    sides = {
        "time": time,
        "v_left": v,
        "v_right": v,
        "i_left": 8.0 * (v > 0),
        "i_right": 8.0 * (v > 0),
    }
    with pytest.raises(BadInput, match="times the robot's weight"):
        cleaned(tmp_path, sides, mass=20.0, voltage=24.0, track=0.4)
    with pytest.raises(BadInput, match="are they the motors'"):
        cleaned(tmp_path, sides, voltage=24.0, track=0.4)


def test_a_current_that_does_not_rise_with_speed_is_asked_about(tmp_path):
    time, v, omega = drive(3, turning=False)
    columns = {
        "time": time,
        "v": v,
        "omega": omega,
        "voltage": 24.0 + 0 * v,
        "current": 1.0 * (v > 0),
    }
    assert any("does not rise with speed" in note for note in cleaned(tmp_path, columns).notes)
    columns["current"] = v
    assert not any("does not rise" in note for note in cleaned(tmp_path, columns).notes)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_battery_current_may_have_either_sign(tmp_path, sign):
    columns = logged(4)
    power = columns.pop("power")
    columns |= {"voltage": 24.0 + 0 * power, "current": sign * power / 24.0}
    found = cleaned(tmp_path, columns)
    assert found.runs[0].power == pytest.approx(power)
    assert any("turned round" in note for note in found.notes) == (sign < 0)


def test_what_is_returned_is_kept_and_told(tmp_path):
    columns = logged(4)
    columns["power"][columns["v"] > 0.7] = -3.0
    found = cleaned(tmp_path, columns)
    assert (found.runs[0].power < 0).any()
    assert any("is returned" in note for note in found.notes)


def test_speeds_that_never_change_are_asked_about(tmp_path):
    found = cleaned(tmp_path, logged(4))
    assert any("commands, not measurements?" in note for note in found.notes)


def test_a_gyro_tells_the_effective_track(tmp_path):
    time, v, omega = drive(5)
    columns = {"time": time, "v_left": v - 0.4 * omega, "v_right": v + 0.4 * omega,
               "gyro_z": omega, "power": power_of(v, omega)}  # fmt: skip
    found = cleaned(tmp_path, columns, track=0.55)
    assert any("the effective track is 0.80 m" in note for note in found.notes)
    assert found.runs[0].omega == pytest.approx(omega)
    odometry = {
        "time": time,
        "v": v,
        "omega": 1.6 * omega,
        "gyro_z": omega,
        "power": power_of(v, omega),
    }
    found = cleaned(tmp_path, odometry)
    assert any("1.60 times as much as the gyro" in note for note in found.notes)
    assert found.runs[0].omega == pytest.approx(omega)


def test_a_battery_that_is_held_between_readings_is_read_once_each(tmp_path):
    rng = np.random.default_rng(0)
    time, v, omega = drive(6)
    v = v + rng.normal(0.0, 0.001, len(v))
    power = power_of(v, omega) + rng.normal(0.0, 0.5, len(v))
    held = power[np.arange(len(power)) // 20 * 20]
    found = cleaned(tmp_path, {"time": time, "v": v, "omega": omega, "power": held})
    assert len(found.runs[0].meter) == pytest.approx(150, abs=3)
    assert any("held in between" in note for note in found.notes)
    blank = np.where(np.arange(len(power)) % 20 == 0, power, np.nan)
    found = cleaned(tmp_path, {"time": time, "v": v, "omega": omega, "power": blank})
    assert len(found.runs[0].meter) == pytest.approx(150, abs=3)


def test_energy_so_far_and_energy_left_are_power(tmp_path):
    columns = logged(7)
    power = columns.pop("power")
    used = np.cumsum(power) / 20.0
    for energy_ in (used, 5e4 - used):
        run = cleaned(tmp_path, columns | {"energy": energy_}).runs[0]
        assert energy(run) == pytest.approx(used[-1] - used[0], rel=0.01)


def test_places_are_motion(tmp_path):
    time, v, omega = drive(8, rate=50.0)
    theta = np.cumsum(omega) / 50.0
    columns = {"time": time, "x": np.cumsum(v * np.cos(theta)) / 50.0,
               "y": np.cumsum(v * np.sin(theta)) / 50.0,
               "yaw": (theta + np.pi) % (2 * np.pi) - np.pi}  # fmt: skip
    columns["power"] = power_of(v, omega)
    run = cleaned(tmp_path, columns).runs[0]
    assert run.v.sum() == pytest.approx(v.sum(), rel=0.01)
    assert np.abs(run.omega).sum() == pytest.approx(np.abs(omega).sum(), rel=0.02)


def test_noise_is_averaged_and_clean_speeds_are_left_alone(tmp_path):
    columns = logged(9)
    assert cleaned(tmp_path, columns).runs[0].v == pytest.approx(columns["v"])
    noisy = columns | {
        "v": columns["v"] + np.random.default_rng(0).normal(0, 0.05, len(columns["v"]))
    }
    found = cleaned(tmp_path, noisy)
    assert any("averaged over 0.5 s" in note for note in found.notes)
    assert np.std(found.runs[0].v - columns["v"]) < np.std(noisy["v"] - columns["v"])


@pytest.mark.parametrize(
    ("lacks", "said"),
    [
        ({"power": None}, "holds no power"),
        ({"power": None, "voltage": 24.0}, "a voltage and no current"),
        ({"power": None, "voltage": 24.0, "current": np.nan}, "does not measure current"),
        ({"power": None, "battery_percent": 90.0}, "too coarse for power"),
        ({"v": None, "omega": None}, "holds no motion"),
        ({"power": None, "current": 1.0}, "--voltage"),
        ({"power": None, "voltage": 24000.0, "current": 1.0}, "is it in mV?"),
        ({"v": None}, "alone is no motion"),
    ],
)
def test_what_is_missing_is_said_with_how_to_get_it(tmp_path, lacks, said):
    columns = logged(0)
    for name, value in lacks.items():
        if value is None:
            del columns[name]
        else:
            columns[name] = value + 0.0 * columns["time"]
    with pytest.raises(BadInput, match=r"expected|give|log the|Say so") as error:
        cleaned(tmp_path, columns)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("rows", [1, 3, 50])
def test_a_log_that_is_too_short_is_refused(tmp_path, rows):
    columns = {name: values[:rows] for name, values in logged(0).items()}
    with pytest.raises(BadInput, match="expected a drive"):
        cleaned(tmp_path, columns)


def test_a_file_is_a_run_and_a_folder_a_ground(tmp_path):
    folder_of(tmp_path / "tiles", runs=3, seconds=30.0)
    folder_of(tmp_path / "grass", runs=2, seconds=30.0)
    grounds = gather([tmp_path])
    assert [(ground.name, len(ground.files)) for ground in grounds] == [("grass", 2), ("tiles", 3)]
    loose = gather([tmp_path / "tiles" / "run-0.csv", tmp_path / "tiles" / "run-1.csv"])
    assert [len(ground.files) for ground in loose] == [2]


def test_log_toml_beside_the_files_says_what_options_say(tmp_path):
    folder_of(tmp_path / "tiles", runs=1, seconds=30.0)
    (tmp_path / "tiles" / "log.toml").write_text(
        'mass = 20\nwithin = 5\nmotor = {k = 2, resistance = 1}\n[columns]\nv = "v*0.5"\n'
    )
    with pytest.raises(BadInput, match="no currents of two drives"):
        gather([tmp_path / "tiles"])
    told = settings_from({"mass": 20.0, "columns": {"v": "v*0.5"}})
    first = LogSettings(columns=("v=w",), mass=3.0)
    assert over(first, told) == LogSettings(columns=("v=w",), mass=3.0)
    assert over(LogSettings(), told).mass == 20.0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("mas = 3\n", "log.toml:1: mas: unknown key 'mas'; did you mean 'mass'?"),
        ("mass = 'x'\n", "expected a number"),
        ("mass = -1\n", "expected more than 0"),
        ("motor = 3\n", "expected {k"),
        ("columns = ['v']\n", "expected a table"),
        ("mass =\n", "not TOML"),
    ],
)
def test_a_wrong_log_toml_is_one_sentence(tmp_path, text, said):
    folder_of(tmp_path / "tiles", runs=1, seconds=30.0)
    (tmp_path / "tiles" / "log.toml").write_text(text)
    with pytest.raises(BadInput) as error:
        gather([tmp_path / "tiles"])
    assert said in str(error.value)


def test_turning_below_a_gyros_noise_is_none(tmp_path):
    columns = logged(3, turning=False)
    noise = np.random.default_rng(0).normal(0.0, 0.01, len(columns["omega"]))
    found = cleaned(tmp_path, columns | {"omega": noise})
    assert any("of less than its noise" in note for note in found.notes)
    assert (found.runs[0].omega == 0.0).mean() > 0.99
    assert not any("its noise" in note for note in cleaned(tmp_path, columns).notes)
