"""Occupancy maps from the user's files, as ROS's map_server keeps them: YAML and an image.

The format: https://wiki.ros.org/map_server. All values are read as text and checked here as they
stand: YAML would take 1e-2 for text, and no for false.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any
from warnings import catch_warnings

import numpy as np
from numpy.typing import NDArray

from fleet.scenario.errors import bad, unknown
from worlds.occupancy import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
KEYS = (*REQUIRED, "mode")
MOST_CELLS = 100_000_000
_PLAIN = {"1": "L", "P": "RGB"}  # the modes of images that have as many shades as these


def occupancy_grid(value: Any, key: str) -> OccupancyGrid:
    """The map that a YAML file describes.

    Read again only if one of its files has changed.

    Raises:
        BadInput: a file is not there, or something in it cannot be used.
    """
    if not isinstance(value, str):
        raise bad(key, f"is {value!r}; expected the YAML file of a map")
    path = Path(value)
    image = image_of(path, key)
    return _grid(path, key, image, _modified(path, key), _modified(image, key))


def read_yaml(path: Path, key: str) -> dict[str, Any]:
    """The keys of a map's YAML file; values are text, or lists of text, as they stand there.

    Raises:
        BadInput: the file is not there, or has something else in it than a map's keys.
    """
    import yaml

    try:
        found = yaml.load(path.read_text("utf-8"), Loader=yaml.BaseLoader)  # noqa: S506  # makes text alone
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise bad(key, f"{str(path)!r} cannot be read: {reason}") from error
    except yaml.YAMLError as error:
        raise bad(key, f"{path}{_line(error)}: {_problem(error)}; expected YAML") from error
    if not isinstance(found, dict):
        raise bad(key, f"{path}: is no table of keys; expected {', '.join(REQUIRED)}")
    for name in found:
        if name not in KEYS:
            raise bad(key, f"{path}: {unknown('key', name, KEYS)}")
    if missing := [name for name in REQUIRED if not found.get(name)]:
        raise bad(key, f"{path}: {missing[0]} is missing; it is required")
    return found


def _line(error: Exception) -> str:
    mark = getattr(error, "problem_mark", None)
    return f":{mark.line + 1}" if mark else ""


def _problem(error: Exception) -> str:
    return getattr(error, "problem", None) or "it cannot be read"


def image_of(path: Path, key: str) -> Path:
    """The image's path: as the YAML file says, from where that is."""
    name = read_yaml(path, key)["image"]
    if not isinstance(name, str):
        raise bad(key, f"{path}: image is {name!r}; expected the path of a file")
    return path.parent / name


def _modified(path: Path, key: str) -> int:
    try:
        return path.stat().st_mtime_ns
    except OSError as error:
        raise bad(key, f"{str(path)!r} cannot be read: {error.strerror}") from error


@lru_cache(8)
def _grid(path: Path, key: str, image: Path, _written: int, _painted: int) -> OccupancyGrid:
    keys = read_yaml(path, key)

    def number(name: str, low: float, high: float, said: str) -> float:
        try:
            value = float(str(keys[name]))
        except ValueError:
            value = np.nan
        if not low <= value <= high:
            raise bad(key, f"{path}: {name} is {keys[name]!r}; expected {said}")
        return value

    resolution = number("resolution", 1e-9, 1e9, "metres a pixel, more than 0")
    occupied = number("occupied_thresh", 0.0, 1.0, "0 to 1")
    free = number("free_thresh", 0.0, 1.0, "0 to 1")
    if free > occupied:
        raise bad(key, f"{path}: free_thresh is {free}; expected at most occupied_thresh")
    negate = {"0": False, "1": True, "false": False, "true": True}.get(str(keys["negate"]).lower())
    if negate is None:
        raise bad(key, f"{path}: negate is {keys['negate']!r}; expected 0 or 1")
    _check_origin(keys["origin"], path, key)
    if keys.get("mode", "trinary") != "trinary":
        raise bad(key, f"{path}: mode is {keys['mode']!r}; expected 'trinary'")
    shade = _shades(image, key) / 255.0
    taken = shade if negate else 1.0 - shade
    cells = np.full(shade.shape, UNKNOWN, np.int8)
    cells[taken > occupied] = OCCUPIED
    cells[taken < free] = FREE
    return OccupancyGrid(cells[::-1].copy(), resolution)


def _check_origin(origin: Any, path: Path, key: str) -> None:
    """It places the map in a larger frame. Here that of the map is the only one."""
    try:
        pose = [float(part) for part in origin] if isinstance(origin, list) else []
    except ValueError:
        pose = []
    if len(pose) != 3 or not np.isfinite(pose).all():
        raise bad(key, f"{path}: origin is {origin!r}; expected [x, y, yaw]")


def _shades(path: Path, key: str) -> NDArray[np.float64]:
    """The mean of all channels (rows, columns), as map_server takes it, 0 black to 255 white."""
    from PIL import Image, UnidentifiedImageError

    try:
        with catch_warnings(action="ignore"), Image.open(path) as image:  # of large images
            if image.width * image.height > MOST_CELLS:
                raise bad(
                    key,
                    f"{str(path)!r} has {image.width} × {image.height} pixels;"
                    f" expected {MOST_CELLS} at most",
                )
            mode = image.mode
            pixels = np.asarray(image.convert(_PLAIN[mode]) if mode in _PLAIN else image)
    except UnidentifiedImageError as error:
        raise bad(key, f"{str(path)!r} is no image; expected a PNG file") from error
    except (OSError, SyntaxError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise bad(key, f"{str(path)!r} cannot be read: {reason}") from error
    if pixels.dtype != np.uint8:
        raise bad(key, f"{str(path)!r} is of mode {mode}; expected 8 bits a channel")
    return np.asarray(pixels if pixels.ndim == 2 else pixels.mean(axis=2), float)
