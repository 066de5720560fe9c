"""Files into signals: any dress that a table can wear, and what is said where it does not fit."""

from __future__ import annotations

import numpy as np
import pytest
from driven_logs import logged, table

from fleet.logs.signals import signals_of
from fleet.logs.sniffing import read_sheet
from fleet.scenario.errors import BadInput

PLAIN = "time,v,omega,power\n0,1,0.5,3\n0.1,1.25,0.5,4\n0.2,1.5,0.5,5\n"


def read(tmp_path, text, *told, encoding="utf-8"):
    path = tmp_path / "log.csv"
    path.write_bytes(text.encode(encoding))
    return signals_of(read_sheet(path), told)


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        (PLAIN, "utf-8"),
        ("\ufeff" + PLAIN, "utf-8"),
        (PLAIN, "utf-16"),
        (PLAIN.replace("\n", "\r\n"), "utf-8"),
        (PLAIN.replace(",", ";"), "utf-8"),
        (PLAIN.replace(",", "\t"), "utf-8"),
        (PLAIN.replace(",", "   "), "utf-8"),
        (PLAIN.replace(",", ";").replace(".", ","), "utf-8"),
        (PLAIN.replace("\n", ",\n"), "utf-8"),
        ("# " + PLAIN, "utf-8"),
        ("Robot: two\nDate: today\n\n" + PLAIN, "utf-8"),
        ("time,v,omega,power\ns,m/s,rad/s,W\nt,v,w,p\n" + PLAIN.partition("\n")[2], "utf-8"),
        (PLAIN + "0.3,1", "utf-8"),
    ],
)
def test_a_table_in_any_dress_is_the_same(tmp_path, text, encoding):
    signals = read(tmp_path, text, encoding=encoding)
    assert signals.motion["time"][:3] == pytest.approx([0.0, 0.1, 0.2])
    assert signals.motion["v"][:3] == pytest.approx([1.0, 1.25, 1.5])
    assert signals.power["power"][:3] == pytest.approx([3.0, 4.0, 5.0])


@pytest.mark.parametrize(
    ("name", "role", "factor"),
    [
        ("speed [mm/s]", "v", 1e-3),
        ("speed_kmh", "v", 1 / 3.6),
        ("linear_velocity", "v", 1.0),
        ("odom/twist/twist/linear/x", "v", 1.0),
        ("yaw_rate_deg_s", "omega", np.pi / 180),
        ("Yaw Rate (rad/s)", "omega", 1.0),
        ("velL", "v_left", 1.0),
        ("Left Wheel Speed", "v_left", 1.0),
        ("wheel_right_velocity", "v_right", 1.0),
        ("curL", "i_left", 1.0),
        ("battery_voltage_mV", "voltage", 1e-3),
        ("Current [mA]", "current", 1e-3),
        ("V", "voltage", 1.0),
        ("I", "current", 1.0),
        ("energy_wh", "energy", 3600.0),
        ("power [kW]", "power", 1e3),
        ("imu_gyro_z", "gyro", 1.0),
    ],
)
def test_roles_and_units_are_known_by_name(tmp_path, name, role, factor):
    signals = read(tmp_path, f"time,{name}\n0,1\n1,2\n2,1\n")
    found = {**signals.motion, **signals.power, **signals.gyro}
    assert found[role] == pytest.approx(np.array([1.0, 2.0, 1.0]) * factor)
    assert any(note.startswith(f"{role} [") for note in signals.notes)


def test_a_factor_is_told(tmp_path):
    signals = read(tmp_path, "time,foo,power\n0,1000,1\n1,2000,1\n", "v=foo*0.001")
    assert signals.motion["v"] == pytest.approx([1.0, 2.0])


def test_stamps_may_be_dates_or_seconds_and_nanoseconds(tmp_path):
    dates = read(tmp_path, "date,v\n2024-05-01T10:00:00Z,1\n2024-05-01T10:00:00.5Z,2\n")
    assert np.diff(dates.motion["time"]) == pytest.approx([0.5])
    split = read(tmp_path, "header.stamp.sec,header.stamp.nanosec,v\n1,0,1\n1,500000000,2\n")
    assert np.diff(split.motion["time"]) == pytest.approx([0.5])


def test_commands_are_no_measurements(tmp_path):
    signals = read(tmp_path, "time,cmd_vel,v,power\n0,9,1,1\n1,9,1,1\n")
    assert signals.motion["v"] == pytest.approx([1.0, 1.0])
    assert any("cmd_vel" in note and "commands" in note for note in signals.notes)


@pytest.mark.parametrize(
    ("text", "told", "said"),
    [
        ("time,v,speed\n0,1,1\n1,1,1\n", (), "'v' and 'speed' could both be the speed"),
        ("time,current,battery_current\n0,1,1\n1,1,1\n", (), "could both be the current"),
        ("0,1\n1,1\n", (), "no header line"),
        ("foo,v\n0,1\n1,1\n", (), "no column of times"),
        ("time,v\n0,1\n1,1\n", ("v=speed",), "unknown column 'speed'"),
        ("time,v\n0,1\n1,1\n", ("w=v",), "unknown role 'w'"),
        ("time,v\n0,1\n1,1\n", ("v=v*fast",), "factor 'fast'"),
        ("time,x [px]\n0,1\n1,1\n", (), "is in 'px'"),
        ("time,left_speed,right_speed\n0,20,20\n1,20,20\n", (), "rad/s"),
        ("", (), "no lines of numbers"),
        ("only words\n", (), "no lines of numbers"),
    ],
)
def test_what_cannot_be_understood_is_one_sentence(tmp_path, text, told, said):
    with pytest.raises(BadInput, match=r"expected|choose|name it|Say so|named|did you") as error:
        read(tmp_path, text, *told)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_is_no_text_is_refused(tmp_path):
    path = tmp_path / "log.csv"
    path.write_bytes(b"\x00\x01" * 50)
    with pytest.raises(BadInput, match="is not text"):
        read_sheet(path)


def test_cells_that_are_no_numbers_are_missing(tmp_path):
    path = table(tmp_path / "log.csv", logged(0, seconds=5.0))
    lines = path.read_text().splitlines()
    lines[10] = "0.45,broken,0,1"
    path.write_text("\n".join(lines))
    assert np.isnan(read_sheet(path).columns["v"]).sum() == 1
