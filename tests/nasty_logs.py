"""Recorded logs and files of robots as people have them, right or not: for the fuzz tests."""

from __future__ import annotations

import random

from garbling import Input, garbled

ROLES = {
    "time": ("time", "t", "timestamp", "Time [s]", "stamp_ns", "secs", "x0", ""),
    "v": ("v", "speed", "velocity", "vx [m/s]", "cmd_vel.linear.x", "speed_mm_s", "v"),
    "omega": ("omega", "w", "yaw_rate", "wz [rad/s]", "gyro_z", "turn", "omega"),
    "power": ("power", "P [W]", "watts", "load", "Power", "power", "p"),
    "volts": ("voltage", "V", "battery_voltage", "u", "volts [V]"),
    "amperes": ("current", "I", "battery_current", "amps", "i_left", "current [mA]"),
    "x": ("x", "pos_x", "pose.x", "odom.x"),
    "y": ("y", "pos_y", "pose.y", "odom.y"),
    "left": ("left", "wheel_left", "v_left", "rpm_l"),
    "right": ("right", "wheel_right", "v_right", "rpm_r"),
    "note": ("comment", "mode", "lat", "seq"),
}
MEASURED = (
    *(("time", "v", "omega", "power"),) * 5, ("time", "v", "power"), ("time", "v", "omega"),
    ("time", "v", "omega", "volts", "amperes"), ("time", "x", "y", "power"), ("time", "power"),
    ("v", "omega", "power"), ("time", "left", "right", "power"), ("time", "v", "v", "power"),
    ("time", "v", "omega", "power", "note"), ("time", "v", "omega", "volts"), (),
)  # fmt: skip
CELLS = ("", "nan", "NaN", "inf", "x", "1e400", "-", "0", "1,5", "NULL", '"', "9" * 400, "é")
OPTIONS = (
    "--log-column=v=speed", "--log-column=v=speed*0.001", "--log-column=power=nowhere",
    "--log-column=v", "--log-column==", "--log-column=v=*", "--log-column=mood=v",
    "--voltage=24", "--voltage=0", "--voltage=nan", "--motor=1,2,3", "--motor=1", "--motor=a,b,c",
    "--track=0.5", "--track=-1", "--mass=20", "--mass=0", "--mass=1e308", "--offset=0.3",
    "--offset=inf", "--electronics=5", "--within=10", "--within=0", "--within=1e9",
)  # fmt: skip
BESIDE = (
    "", "v = 3", 'v = "speed"', "[columns]\nv = 'speed'", "mass = 'much'", "mass = 20.0", "[[x]]",
    "track = -1", "motor = [1, 2]", "motor = [1.0, 0.1, 0.2]", "voltage = nan", "unknown = 1", "=",
)  # fmt: skip


def recorded_log(rng: random.Random) -> Input:
    """``fleet energy --log`` with some files of one drive each."""
    files = {}
    for run in range(rng.choice((1, 2, 3, 6))):
        files[f"run{run}{rng.choice(('.csv',) * 9 + ('.txt', '.bag', '.db3', '.mcap', ''))}"] = (
            _drive(rng)
        )
    if rng.random() < 0.3:
        files["log.toml"] = rng.choice(BESIDE).encode()
    logs = rng.choice(([*files], ["."], ["."]))
    asked = rng.choices(OPTIONS, k=rng.choice((0, 0, 1, 2)))
    return Input(["energy", "--log", *logs, "--out", "judged", *asked], files)


def _drive(rng: random.Random) -> bytes:
    """A table of samples: stop and go along a line and around corners."""
    measured = rng.choice(MEASURED)
    rate = rng.choice((10.0, 10.0, 20.0, 1.0, 1e-3))
    count = rng.choice((600, 600, 300, 40, 3, 0))
    between, decimal = rng.choice(
        ((",", "."),) * 6 + ((";", ","), ("\t", "."), (" ", "."), ("|", "."))
    )
    names = [rng.choice(ROLES[role]) for role in measured]
    lines = [between.join(names)] if rng.random() < 0.9 else []
    if rng.random() < 0.15:
        lines.insert(rng.randrange(len(lines) + 1), rng.choice(("# a robot", "s,m/s,rad/s,W", "")))
    x = y = 0.0
    for n in range(count):
        v = 0.5 if n // 60 % 2 else 0.0
        omega = rng.choice((0.0, 0.4)) if v else 0.0
        x, y = x + v / rate, y + 0.3 * v / rate
        power = 5.0 + 20.0 * v + 3.0 * abs(omega) + rng.gauss(0.0, 0.2)
        values = {
            "time": n / rate, "v": v, "omega": omega, "power": power, "volts": 24.0,
            "amperes": power / 24.0, "x": x, "y": y, "left": v - 0.2 * omega,
            "right": v + 0.2 * omega, "note": n % 3,
        }  # fmt: skip
        row = [f"{values[role]:.6g}".replace(".", decimal) for role in measured]
        if row and rng.random() < 0.002:
            row[rng.randrange(len(row))] = rng.choice(CELLS)
        if rng.random() < 0.001:
            row = row[:1] + row
        lines.append(between.join(row))
    content = "\n".join(lines).encode()
    return garbled(rng, content) if rng.random() < 0.3 else content


PRESETS = ("small", "husky", "pioneer", "ideal", "nobody", "own.toml")
KEYS = ("mass", "efficiency", "traction", "scrub", "capacity", "motor", "electronics", "rolling")
VALUES = ("1", "0", "-1", "nan", "inf", "1e308", "'x'", "[1]", "{a = 1}", "true", "0.5", "20.0")


def robot_file(rng: random.Random) -> Input:
    """``fleet run --robot FILE``."""
    lines = [
        f'preset = "{rng.choice(("small", "husky", "pioneer", "ideal", "nobody", "own.toml"))}"'
    ]
    lines += [f"{key} = {rng.choice(VALUES)}" for key in rng.sample(KEYS, rng.randrange(3))]
    if rng.random() < 0.2:
        lines.append(rng.choice(("[extra]\nidle = 1", "[power]\nrolling = 'x'", "x", "power = 3")))
    content = "\n".join(lines).encode()
    content = garbled(rng, content) if rng.random() < 0.3 else content
    arguments = ["run", "--robot", "own.toml", "--robots", "5", "--set", "connected=false"]
    motion = rng.choice(("straight", "path", "path"))
    return Input([*arguments, "--motion", motion, "--rounds", "1"], {"own.toml": content})
