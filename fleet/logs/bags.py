"""ROS 1 and ROS 2 bags, read by rosbags (https://ternaris.gitlab.io/rosbags): no ROS is needed."""

from __future__ import annotations

import importlib
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fleet.logs.signals import MOTION, POWER, ROLES, Signals, told_column
from fleet.scenario.errors import BadInput, bad

Floats = NDArray[np.float64]

FIELDS: dict[str, dict[str, str]] = {
    "nav_msgs/msg/Odometry": {"v": "twist.twist.linear.x", "omega": "twist.twist.angular.z"},
    "sensor_msgs/msg/BatteryState": {"voltage": "voltage", "current": "current"},
    "sensor_msgs/msg/Imu": {"gyro": "angular_velocity.z"},
}
"""What is taken from messages without being told. Twists are commands and are never taken."""

_WHAT = {"v": "odometry", "current": "state of the battery", "gyro": "inertial unit"}


def read_bag(path: Path, told: Sequence[str] = ()) -> Signals:
    """The signals of a bag: a folder that ROS 2 wrote, or a lone ``.mcap``, ``.db3`` or ``.bag``.

    ``told`` names what the messages above do not say: ``current=/status.total_current``, or
    ``v_left=/joint_states.velocity.left_wheel*0.13``; ``v=/odom`` chooses among topics.

    Raises:
        BadInput: rosbags is not installed, the bag is damaged, or a topic is not there, not told
            apart, or of a type that the bag does not define.
    """
    anyreader = _rosbags(path)
    wanted = {role: (column, factor) for role, column, factor in map(told_column, told)}
    signals = Signals(path.name, in_seconds=True)
    with _opened(anyreader, path) as reader:
        topics: dict[str, list[Any]] = {}
        for connection in reader.connections:
            topics.setdefault(connection.topic, []).append(connection)
        chosen = _chosen(path, topics, wanted, signals.notes)
        columns = _columns(path, reader, topics, chosen)
    for role, (time, values) in columns.items():
        part = (
            signals.motion if role in MOTION else signals.power if role in POWER else signals.gyro
        )
        if "time" in part and not np.array_equal(part["time"], time):
            part[role] = _onto(part["time"], time, values)
        else:
            part["time"], part[role] = time, values
    if not signals.motion or not signals.power:
        lacks = "odometry" if not signals.motion else "state of a battery"
        listed = ", ".join(f"{name} [{c[0].msgtype}]" for name, c in list(topics.items())[:12])
        raise bad(
            "--log", f"{path}: has no {lacks}; its topics are {listed or 'none'}; name a field"
                     f" of one:"
            f" --log-column {'v' if not signals.motion else 'power'}=/TOPIC.FIELD",
        )  # fmt: skip
    return signals


def _rosbags(path: Path) -> Any:
    try:
        return importlib.import_module("rosbags.highlevel").AnyReader
    except ImportError as error:
        raise bad(
            "--log", f"{path}: reading bags needs rosbags, which is not installed: pip install"
            " 'talking-fleet[bags]'",
        ) from error  # fmt: skip


@contextmanager
def _opened(anyreader: Any, path: Path) -> Iterator[Any]:
    """A reader of a bag, whose failures are sentences."""
    from rosbags.typesys import Stores, get_typestore

    try:
        with anyreader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            yield reader
    except BadInput:
        raise
    except (UnicodeDecodeError, EOFError, struct.error) as error:
        raise bad("--log", f"{path}: is damaged, or no bag ({error})") from error
    except Exception as error:
        if type(error).__module__.partition(".")[0] not in {"rosbags", "apsw", "lz4", "zstandard"}:
            raise
        raise bad("--log", f"{path}: {_reason(str(error), path)}") from error


def _reason(message: str, path: Path) -> str:
    """What a failure of rosbags means, and what to do."""
    first = message.strip().splitlines()[0] if message.strip() else "unreadable"
    if "magic" in message or "truncat" in message.lower() or "end of file" in message.lower():
        tool = {".mcap": "mcap recover", ".bag": "rosbag reindex"}.get(
            path.suffix, "ros2 bag reindex"
        )
        return f"is cut off or damaged ({first}); mend it with `{tool}`"
    if "CDR" in message and path.is_file():
        return f"its messages are compressed ({first}); give the bag's folder, with metadata.yaml"
    if "storage format" in message or "zstd" in message:
        return f"is compressed as a whole ({first}); give the bag's folder, or unpack it"
    return f"cannot be read as a bag: {first}"


Chosen = dict[str, list[tuple[str, str, float]]]
"""For each topic: the roles that it fills, from which field, times which factor."""


def _chosen(
    path: Path, topics: dict[str, list[Any]], wanted: dict[str, tuple[str, float]],
    notes: list[str],
) -> Chosen:  # fmt: skip
    chosen: Chosen = {}
    settled: dict[str, str] = {}  # by type of message: the topic that was told
    filled = set()
    for role, (column, factor) in wanted.items():
        topic, field = _topic_and_field(path, column, topics)
        kind = topics[topic][0].msgtype
        if not field:
            field = FIELDS.get(kind, {}).get(role, "")
            settled[kind] = topic
            if not field:
                raise bad(
                    "--log-column", f"{path}: {topic} is {kind}; name a field: {role}={topic}.FIELD"
                )
        chosen.setdefault(topic, []).append((role, field, factor))
        filled.add(role)
        notes.append(f"{role} [{ROLES[role].unit}] is {topic}.{field} × {factor:g}, as told")
    moves = bool(filled & set(MOTION))
    powers = bool(filled & set(POWER))
    for kind, fields in FIELDS.items():
        if (kind == "nav_msgs/msg/Odometry" and moves and kind not in settled) or (
            kind == "sensor_msgs/msg/BatteryState" and powers and kind not in settled
        ):
            continue
        here = sorted(
            name for name, found in topics.items()
            if found[0].msgtype == kind and sum(c.msgcount for c in found) > 0
        )  # fmt: skip
        if kind in settled:
            here = [settled[kind]]
        if len(here) > 1:
            role = next(role for role in _WHAT if role in fields)
            raise bad(
                "--log", f"{path}: {here[0]!r} and {here[1]!r} could both be the {_WHAT[role]};"
                         f" choose"
                f" one: --log-column {role}={here[0]}",
            )  # fmt: skip
        for role, field in fields.items():
            if here and role not in filled:
                chosen.setdefault(here[0], []).append((role, field, 1.0))
                notes.append(f"{role} [{ROLES[role].unit}] is {here[0]}.{field}")
    return chosen


def _topic_and_field(path: Path, column: str, topics: dict[str, list[Any]]) -> tuple[str, str]:
    """The topic that a name begins with, and the field after it."""
    for topic in sorted(topics, key=len, reverse=True):
        if column == topic or column.startswith(topic + "."):
            return topic, column[len(topic) + 1 :]
    listed = ", ".join(list(topics)[:12])
    raise bad("--log-column", f"{path}: no topic {column.partition('.')[0]!r}; it has {listed}")


def _columns(
    path: Path, reader: Any, topics: dict[str, list[Any]], chosen: Chosen
) -> dict[str, tuple[Floats, Floats]]:
    rows: dict[str, list[tuple[float, ...]]] = {topic: [] for topic in chosen}
    connections = [connection for topic in chosen for connection in topics[topic]]
    for connection, received, raw in reader.messages(connections):
        try:
            message = reader.deserialize(raw, connection.msgtype)
        except KeyError as error:
            raise bad(
                "--log", f"{path}: does not define the messages {connection.msgtype} of"
                f" {connection.topic}; record with Iron or later, which writes definitions into"
                f" bags,"
                " or convert the bag to MCAP",
            ) from error  # fmt: skip
        values = [
            _field(path, message, connection, field) * factor
            for _, field, factor in chosen[connection.topic]
        ]
        rows[connection.topic].append((_stamp(message, received), *values))
    columns = {}
    for topic, found in rows.items():
        if not found:
            raise bad("--log", f"{path}: holds no messages of {topic}")
        table = np.array(found)
        for number, (role, _, _) in enumerate(chosen[topic], 1):
            columns[role] = (table[:, 0], table[:, number])
    return columns


def _stamp(message: Any, received: int) -> float:
    """The time in a message's header [s]; when it was received, if it has none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    seconds = 0.0 if stamp is None else float(stamp.sec) + 1e-9 * float(stamp.nanosec)
    return seconds if seconds > 0.0 else 1e-9 * received


def _field(path: Path, message: Any, connection: Any, field: str) -> float:
    """A number in a message; names of joints stand for their places in its lists."""
    value = message
    for part in field.split("."):
        if isinstance(value, list | tuple | np.ndarray):
            names = list(getattr(message, "name", []))
            at = names.index(part) if part in names else int(part) if part.isdigit() else -1
            value = value[at] if 0 <= at < len(value) else None
        else:
            value = getattr(value, part, None)
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise bad(
            "--log-column", f"{path}: {connection.topic} [{connection.msgtype}] has no number"
            f" {field!r}",
        ) from error  # fmt: skip


def _onto(time: Floats, known: Floats, values: Floats) -> Floats:
    """Values at other times; NaN before the first and after the last."""
    order = np.argsort(known, kind="stable")
    return np.interp(time, known[order], values[order], left=np.nan, right=np.nan)
