"""Bags of ROS 2, as rosbags writes them: read, and refused in one sentence."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from driven_logs import drive, power_of
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from fleet.logs.asking import LogSettings
from fleet.logs.bags import read_bag
from fleet.logs.gathering import gather
from fleet.logs.judging import judge
from fleet.scenario.errors import BadInput

STORE = get_typestore(Stores.ROS2_HUMBLE)
ODOMETRY, BATTERY = "nav_msgs/msg/Odometry", "sensor_msgs/msg/BatteryState"


def message(kind, **values):
    """A message with zeros where nothing is said."""
    made = STORE.types[kind]
    fields = STORE.get_msgdef(kind).fields
    return made(**{name: values.get(name, blank(form)) for name, form in fields})


def blank(form):
    kind, detail = form
    if kind.name == "NAME":
        return message(detail)
    if kind.name == "BASE":
        return "" if detail[0] == "string" else False if detail[0] == "bool" else 0
    length = detail[1]
    return np.zeros(length, float) if detail[0][1][0].startswith("float") else []


def header(time):
    stamp = STORE.types["builtin_interfaces/msg/Time"](int(time), round(time % 1.0 * 1e9))
    return message("std_msgs/msg/Header", stamp=stamp)


def vector(**values):
    return message("geometry_msgs/msg/Vector3", **values)


def odometry(time, v, omega):
    twist = message(
        "geometry_msgs/msg/Twist", linear=vector(x=float(v)), angular=vector(z=float(omega))
    )
    carried = STORE.types["geometry_msgs/msg/TwistWithCovariance"](twist, np.zeros(36))
    return message(ODOMETRY, header=header(time), twist=carried)


def battery(time, current):
    empty = np.zeros(0, np.float32)
    return message(BATTERY, header=header(time), voltage=12.0, current=float(current),
                   cell_voltage=empty, cell_temperature=empty)  # fmt: skip


def bag(path, seed=0, topics=("/odom",), storage=StoragePlugin.MCAP, current=None, seconds=60.0,
        compressed=None):  # fmt: skip
    time, v, omega = drive(seed, seconds=seconds)
    amperes = power_of(v, omega) / 12.0 if current is None else np.full(len(v), current)
    writer = Writer(path, version=9, storage_plugin=storage)
    if compressed is not None:
        writer.set_compression(compressed, CompressionFormat.ZSTD)
    with writer:
        ways = [writer.add_connection(topic, ODOMETRY, typestore=STORE) for topic in topics]
        state = writer.add_connection("/battery", BATTERY, typestore=STORE)
        for k, t in enumerate(time + 1000.0):
            stamp = round(t * 1e9)
            for way in ways:
                writer.write(way, stamp, STORE.serialize_cdr(odometry(t, v[k], omega[k]), ODOMETRY))
            if k % 2 == 0:
                writer.write(state, stamp, STORE.serialize_cdr(battery(t, -amperes[k]), BATTERY))
    return path


@pytest.mark.parametrize("storage", list(StoragePlugin))
def test_odometry_and_battery_are_read(tmp_path, storage):
    signals = read_bag(bag(tmp_path / "bag", storage=storage))
    time, v, omega = drive(0, seconds=60.0)
    assert signals.motion["v"] == pytest.approx(v)
    assert signals.motion["omega"] == pytest.approx(omega)
    assert np.diff(signals.motion["time"]) == pytest.approx(np.diff(time))
    assert signals.power["current"] == pytest.approx(-power_of(v, omega)[::2] / 12.0, rel=1e-6)


def test_a_folder_of_bags_is_judged(tmp_path):
    for seed in range(4):
        bag(tmp_path / "tiles" / f"run-{seed}", seed)
    judged = judge(gather([tmp_path / "tiles"])[0])
    assert judged.best.law["distance"] == pytest.approx(20.0, rel=0.05)
    assert any("turned round" in note for note in judged.ground.notes)


def test_a_field_may_be_told(tmp_path):
    path = bag(tmp_path / "bag", topics=("/odom", "/wheels"))
    with pytest.raises(BadInput, match="'/odom' and '/wheels' could both be the odometry"):
        read_bag(path)
    assert read_bag(path, ("v=/wheels",)).motion["omega"].any()
    halved = read_bag(path, ("v=/odom.twist.twist.linear.x*0.5", "omega=/odom"))
    assert halved.motion["v"] == pytest.approx(0.5 * drive(0, seconds=60.0)[1])
    with pytest.raises(BadInput, match="no topic '/nothing'"):
        read_bag(path, ("v=/nothing",))
    with pytest.raises(BadInput, match=r"no number 'twist\.speed'"):
        read_bag(path, ("v=/odom.twist.speed", "omega=/odom"))


def test_a_driver_that_does_not_measure_current_is_named(tmp_path):
    bag(tmp_path / "bag", current=np.nan)
    with pytest.raises(BadInput, match="does not measure current"):
        gather([tmp_path / "bag"], LogSettings())


def test_a_bag_without_odometry_lists_its_topics(tmp_path):
    with pytest.raises(BadInput, match=r"has no odometry; its topics are /battery \[sensor_msgs"):
        read_bag(bag(tmp_path / "bag", topics=()))


@pytest.mark.parametrize("ending", ["mcap", "db3"])
def test_a_bag_that_is_cut_off_is_one_sentence(tmp_path, ending):
    storage = StoragePlugin.MCAP if ending == "mcap" else StoragePlugin.SQLITE3
    whole = next(bag(tmp_path / "bag", storage=storage).glob(f"*.{ending}"))
    cut = tmp_path / f"cut.{ending}"
    cut.write_bytes(whole.read_bytes()[:-30_000])
    with pytest.raises(BadInput) as error:
        read_bag(cut)
    assert "\n" not in str(error.value)
    assert str(cut) in str(error.value)


def test_what_is_no_bag_is_refused(tmp_path):
    (tmp_path / "log.bag").write_bytes(b"hello")
    with pytest.raises(BadInput, match=r"as a bag|damaged"):
        read_bag(tmp_path / "log.bag")


def ros1_bag(path, compression=None):
    """The same drive as ROS 1 leaves it: its headers count, its stamps are in nanoseconds."""
    store = get_typestore(Stores.ROS1_NOETIC)
    time, v, omega = drive(0, seconds=20.0)
    writer = Ros1Writer(path)
    if compression is not None:
        writer.set_compression(compression)
    with writer:
        way = writer.add_connection("/odom", ODOMETRY, typestore=store)
        state = writer.add_connection("/battery", BATTERY, typestore=store)
        for k, t in enumerate(time + 1000.0):
            for connection, said in (
                (way, odometry(t, v[k], omega[k])), (state, battery(t, -1.0 - abs(v[k])))
            ):  # fmt: skip
                kind = connection.msgtype
                raw = store.serialize_ros1(as_ros1(store, kind, said), kind)
                writer.write(connection, round(t * 1e9), raw)
    return path


def as_ros1(store, kind, said):
    """A message with the fields that ROS 1 has of it."""
    values = {}
    for name, (form, detail) in store.get_msgdef(kind).fields:
        value = getattr(said, name, 0)
        values[name] = (
            as_ros1(store, detail, value) if form.name == "NAME" and value != 0 else value
        )
    return store.types[kind](**values)


@pytest.mark.parametrize("compression", [None, *Ros1Writer.CompressionFormat])
def test_bags_of_ros_1_are_read_compressed_or_not(tmp_path, compression):
    signals = read_bag(ros1_bag(tmp_path / "log.bag", compression))
    _, v, omega = drive(0, seconds=20.0)
    assert signals.motion["v"] == pytest.approx(v)
    assert signals.motion["omega"] == pytest.approx(omega)
    assert signals.power["current"] == pytest.approx(-1.0 - np.abs(v), rel=1e-6)


@pytest.mark.parametrize("mode", list(CompressionMode)[1:])
def test_compressed_bags_of_ros_2_are_read_by_their_folder(tmp_path, mode):
    storage = StoragePlugin.MCAP if mode is CompressionMode.STORAGE else StoragePlugin.SQLITE3
    signals = read_bag(bag(tmp_path / "bag", seconds=20.0, compressed=mode, storage=storage))
    assert signals.motion["v"] == pytest.approx(drive(0, seconds=20.0)[1])


def test_a_text_that_is_called_a_bag_is_one_sentence(tmp_path):
    path = tmp_path / "log.bag"
    for content in (b"time,v\n0,1\n", b"#ROSBAG V2.0\n" + struct.pack("<II", 8, 4) + b"\xff=ab"):
        path.write_bytes(content)
        with pytest.raises(BadInput) as error:
            read_bag(path)
        assert "\n" not in str(error.value)


def test_joints_are_wheels_if_they_are_told_and_commands_are_no_motion(tmp_path):
    time, v, _ = drive(0, seconds=20.0)
    joints, twist = "sensor_msgs/msg/JointState", "geometry_msgs/msg/Twist"
    with Writer(tmp_path / "bag", version=9) as writer:
        wheels = writer.add_connection("/joint_states", joints, typestore=STORE)
        command = writer.add_connection("/cmd_vel", twist, typestore=STORE)
        state = writer.add_connection("/battery", BATTERY, typestore=STORE)
        for k, t in enumerate(time + 1000.0):
            stamp = round(t * 1e9)
            turning = message(joints, header=header(t), name=["left", "right"],
                              velocity=np.full(2, v[k] / 0.13))  # fmt: skip
            writer.write(wheels, stamp, STORE.serialize_cdr(turning, joints))
            wish = message(twist, linear=vector(x=9.0), angular=vector())
            writer.write(command, stamp, STORE.serialize_cdr(wish, twist))
            writer.write(state, stamp, STORE.serialize_cdr(battery(t, -1.0), BATTERY))
    told = (f"v_{side}=/joint_states.velocity.{side}*0.13" for side in ("left", "right"))
    assert read_bag(tmp_path / "bag", tuple(told)).motion["v_left"] == pytest.approx(v)
    with pytest.raises(
        BadInput, match=r"has no odometry; its topics are .*/cmd_vel .* name a field"
    ):
        read_bag(tmp_path / "bag")
