"""Paths in a file are relative to the file that names them."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from fleet.catalogue import CATALOGUES
from fleet.scenario.binding import columns_of
from worlds.occupancy import OccupancyGrid

OBJECTS = ("protocol", "protocol.name", "protocol.metric", "protocol.metric.name")
"""The keys that may hold ``file.py:name``."""
ROBOTS = ("robot", "robot.preset")
"""The keys that may hold the file of a robot."""


@cache
def path_keys() -> frozenset[str]:
    """The dotted scenario keys whose text is the path of a file, whatever it is called."""
    return frozenset(
        f"{choice}.{parameter.name}"
        for choice in ("world", "events", "radio")
        for entry in CATALOGUES[choice].values()
        for parameter in inspect.signature(entry.function, eval_str=True).parameters.values()
        if parameter.kind is parameter.KEYWORD_ONLY and is_file_type(parameter.annotation)
    )


def is_file_type(kind: Any) -> bool:
    """Whether a value of that type is read from a file, if a text stands for it."""
    return kind is OccupancyGrid or columns_of(kind) is not None


def anchored(value: Any, folder: Path, key: str = "") -> Any:
    """``value``, as it stands at the dotted ``key`` of a file in ``folder``, with its paths from
    where we are.
    """
    if isinstance(value, Mapping):
        return {
            name: anchored(item, folder, f"{key}.{name}" if key else name)
            for name, item in value.items()
        }
    if isinstance(value, list):
        return [anchored(item, folder, key) for item in value]
    if isinstance(value, str) and _is_path(value, key):
        return value if value.startswith("~") else str(folder / value)
    return value


def _is_path(value: str, key: str) -> bool:
    """Whether the text at a dotted key is the path of a file."""
    if key in ROBOTS:
        return value.endswith(".toml")
    return key in path_keys() or (key in OBJECTS and ".py" in value)
