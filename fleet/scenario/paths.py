"""Paths in a file are relative to the file that names them."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from fleet.catalogue import CATALOGUES
from fleet.scenario.binding import columns_of
from fleet.scenario.reading import is_file
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
    if isinstance(value, str) and (_is_path(value, key) or _is_users(value, key, folder)):
        return value if value.startswith("~") else str(folder / value)
    return value


def _is_path(value: str, key: str) -> bool:
    """Whether the text at a dotted key is the path of a file."""
    if key in ROBOTS:
        return value.endswith(".toml")
    return key in path_keys() or (key in OBJECTS and ".py" in value)


def _is_users(value: str, key: str, folder: Path) -> bool:
    """Whether it is a file for a protocol or metric of the user's, who alone knows that it is.

    One that is not there yet cannot be told from other text.
    """
    return key.startswith("protocol.") and "." in value and is_file(folder / value)
