"""Occupancy maps from the user's files, as ROS's map_server keeps them: YAML and an image.

The format: https://wiki.ros.org/map_server. All values are read as text and checked here as they
stand: YAML would take 1e-2 for text, and no for false. Keys that map_server does not know are
passed over, as there, unless they look like one that it does.
"""

from __future__ import annotations

from difflib import get_close_matches
from functools import lru_cache
from math import isfinite, isnan
from pathlib import Path
from typing import Any, NamedTuple
from warnings import catch_warnings

import numpy as np
from numpy.typing import NDArray

from fleet.scenario.errors import BadInput, bad, or_list, shown
from fleet.scenario.movingai import MOST_CELLS, grid_of
from fleet.scenario.reading import read_text, reason
from worlds.occupancy import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from worlds.shapes import Corner

REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
KEYS = (*REQUIRED, "mode")
MODES = ("trinary", "scale", "raw")
MOST_YAML = 100_000  # bytes; a map's header has some two hundred
NOTHING = {"", "~", "null"}
SAVED_UNKNOWN = 205  # the grey that map_saver writes for unknown cells
WORTH_SAYING = 0.001  # share of the cells from which on it is
_PLAIN = {  # modes of images, and those that hold the same as grey or colours, with or without
    "1": "L", "L": "L", "RGB": "RGB", "P": "RGBA", "PA": "RGBA", "LA": "LA", "RGBA": "RGBA",
}  # fmt: skip
Shades = NDArray[np.float32]


class _Header(NamedTuple):
    """What the YAML file says."""

    resolution: float  # [m] a pixel
    corner: Corner  # of the image, in the map's frame [m]
    negate: bool
    occupied: float  # probability above which a cell is
    free: float  # and below which it is free
    mode: str


def occupancy_grid(value: Any, key: str) -> OccupancyGrid:
    """The map that a YAML file describes, or that a MovingAI file (``.map``) holds.

    Read again only if one of its files has changed.

    Raises:
        BadInput: a file is not there, or something in it cannot be used.
    """
    if not isinstance(value, str):
        raise bad(key, f"is {shown(value)}; expected the YAML file of a map")
    path = Path(value)
    if path.suffix.lower() == ".map":
        return _benchmark(path, key, _modified(path, key))
    image = image_of(path, key)
    return _grid(path, key, image, _modified(path, key), _modified(image, key))


def read_yaml(path: Path, key: str) -> dict[str, Any]:
    """The keys of a map's YAML file; values are text, or lists of text, as they stand there.

    Raises:
        BadInput: the file is not there, or has something else in it than a map's keys.
    """
    import yaml

    text = read_text(path.expanduser(), key, most=MOST_YAML)
    try:
        found = yaml.load(text, Loader=yaml.BaseLoader)  # noqa: S506  # makes text alone
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise bad(key, f"{path}{_line(error)}: {_problem(error)}; expected YAML") from error
    if not isinstance(found, dict):
        raise bad(key, f"{path}: is no table of keys; expected {', '.join(REQUIRED)}")
    keys = {
        str(name).lower(): value
        for name, value in found.items()
        if not (isinstance(value, str) and value in NOTHING)  # written out, aliases can be endless
    }
    for name in keys:
        near = get_close_matches(name, KEYS, 1, 0.75)
        if name not in KEYS and near and near[0] not in keys:
            raise bad(key, f"{path}: unknown key {shown(name)}; did you mean {near[0]!r}?")
    if missing := [name for name in REQUIRED if not keys.get(name)]:
        raise bad(key, f"{path}: {missing[0]} is missing; it is required")
    return keys


def _line(error: Exception) -> str:
    mark = getattr(error, "problem_mark", None)
    return f":{mark.line + 1}" if mark else ""


def _problem(error: Exception) -> str:
    return getattr(error, "problem", None) or "it cannot be read"


def image_of(path: Path, key: str) -> Path:
    """The image's path: as the YAML file says, from where that is."""
    name = read_yaml(path, key)["image"]
    if not isinstance(name, str):
        raise bad(key, f"{path}: image is {shown(name)}; expected the path of a file")
    try:
        return path.expanduser().parent / Path(name).expanduser()
    except RuntimeError as error:  # nobody of that name
        raise bad(key, f"{path}: image is {shown(name)}; {error}") from error


def _modified(path: Path, key: str) -> int:
    try:
        return path.expanduser().stat().st_mtime_ns
    except (OSError, ValueError, RuntimeError) as error:
        raise bad(key, f"{shown(str(path))} cannot be read: {reason(error)}") from error


@lru_cache(8)
def _benchmark(path: Path, key: str, _written: int) -> OccupancyGrid:
    return grid_of(path, key)


@lru_cache(8)
def _grid(path: Path, key: str, image: Path, _written: int, _painted: int) -> OccupancyGrid:
    header = _header(read_yaml(path, key), path, key)
    shade, opaque = _shades(image, key)
    cells = np.full(shade.shape, UNKNOWN, np.int8)
    if header.mode == "raw":  # the shade is the probability in hundredths
        taken = np.where(shade <= 100.0, shade / 100.0, np.nan)
    else:
        taken = (shade if header.negate else 255.0 - shade) / np.float32(255.0)
    cells[taken > header.occupied] = OCCUPIED
    cells[taken < header.free] = FREE
    cells[~opaque] = UNKNOWN
    notices = tuple(_notices(shade, header, path))
    return OccupancyGrid(cells[::-1].copy(), header.resolution, header.corner, notices)


def _header(keys: dict[str, Any], path: Path, key: str) -> _Header:
    def number(name: str, low: float, high: float, said: str) -> float:
        value = _float(keys[name])
        if not low <= value <= high:
            raise bad(key, f"{path}: {name} is {shown(keys[name])}; expected {said}")
        return value

    resolution = number("resolution", 1e-6, 1e6, "metres a pixel, more than 0")
    occupied = number("occupied_thresh", 0.0, 1.0, "0 to 1")
    free = number("free_thresh", 0.0, 1.0, "0 to 1")
    if free > occupied:
        raise bad(key, f"{path}: free_thresh is {free}; expected at most occupied_thresh")
    negate = {"0": False, "1": True, "false": False, "true": True}.get(str(keys["negate"]).lower())
    if negate is None:
        raise bad(key, f"{path}: negate is {shown(keys['negate'])}; expected 0 or 1")
    mode = str(keys.get("mode", "trinary")).lower()
    if mode not in MODES:
        raise bad(key, f"{path}: mode is {shown(keys['mode'])}; expected {or_list(MODES)}")
    return _Header(resolution, _corner(keys["origin"], path, key), negate, occupied, free, mode)


def _float(text: Any) -> float:
    """A number as YAML writes them; NaN: it is none."""
    try:
        return float(str(text).replace(".nan", "nan").replace(".inf", "inf"))
    except ValueError:
        return np.nan


def _corner(origin: Any, path: Path, key: str) -> Corner:
    """Where the lower left corner of the image lies in the map's frame [m]."""
    parts = origin if isinstance(origin, list) else []
    pose = [_float(part) for part in parts]
    said = f"{path}: origin is {shown(origin)}"
    if len(pose) != 3 or not all(isfinite(part) and abs(part) <= 1e9 for part in pose[:2]):
        raise bad(key, f"{said}; expected [x, y, yaw]")
    yaw = pose[2]
    if isnan(yaw) and str(parts[2]).strip(".-+").lower() != "nan":
        raise bad(key, f"{said}; expected [x, y, yaw]")
    if abs(yaw) > 1e-9:  # NaN is what some tools write for none
        raise bad(key, f"{said}; a turned map cannot be used: expected a yaw of 0, and the image"
                  f" turned instead")  # fmt: skip
    return pose[0], pose[1]


def _notices(shade: Shades, header: _Header, path: Path) -> list[str]:
    """That the grey of unknown cells counts as free, if it does."""
    taken = (SAVED_UNKNOWN if header.negate else 255 - SAVED_UNKNOWN) / 255.0
    share = float((shade == SAVED_UNKNOWN).mean())
    if header.mode == "raw" or taken >= header.free or share < WORTH_SAYING:
        return []
    said = (
        f"{path}: by free_thresh = {header.free:g} the grey {SAVED_UNKNOWN}, which map_saver writes"
        f" for unknown cells, is free: {share:.1%} of the cells; free_thresh = 0.196 keeps them"
        f" unknown"
    )
    return [said]


def _shades(path: Path, key: str) -> tuple[Shades, NDArray[np.bool_]]:
    """The mean of the colours (rows, columns), 0 black to 255 white; and what is opaque.

    map_server averages the alpha channel in with the colours, which makes what is black lighter
    and what is unknown free. Here opaque pixels are what they look like, others are unknown.
    """
    pixels, alpha = _pixels(path, key)
    colours = pixels if pixels.ndim == 2 else pixels.mean(axis=2, dtype=np.float32)
    opaque = np.ones(colours.shape, bool) if alpha is None else alpha == 255
    return colours.astype(np.float32), opaque


def _pixels(path: Path, key: str) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    """The image's colours (rows, columns[, 3]), and its alpha channel if it has one."""
    from PIL import Image, UnidentifiedImageError

    try:
        with catch_warnings(action="ignore"), Image.open(path) as image:  # of large images
            if image.width * image.height > MOST_CELLS:
                raise bad(
                    key,
                    f"{shown(str(path))} has {image.width} × {image.height} pixels;"
                    f" expected {MOST_CELLS} at most",
                )
            if image.mode not in _PLAIN:
                raise bad(
                    key,
                    f"{shown(str(path))} is of mode {image.mode};"
                    f" expected grey or colours of 8 bits, as PNG and PGM files have them",
                )
            pixels = np.asarray(image.convert(_PLAIN[image.mode]))
    except BadInput:
        raise
    except Image.DecompressionBombError as error:
        raise bad(
            key, f"{shown(str(path))} has too many pixels; expected {MOST_CELLS} at most"
        ) from error
    except UnidentifiedImageError as error:
        raise bad(key, f"{shown(str(path))} is no image; expected a PNG or PGM file") from error
    except _DAMAGED as error:
        raise bad(key, f"{shown(str(path))} cannot be read: {reason(error)}") from error
    if pixels.ndim == 2:
        return pixels, None
    if pixels.shape[2] == 3:
        return pixels, None
    return (pixels[:, :, 0] if pixels.shape[2] == 2 else pixels[:, :, :3]), pixels[:, :, -1]


_DAMAGED = (OSError, SyntaxError, ValueError, TypeError, LookupError, EOFError, OverflowError,
            MemoryError, ArithmeticError)  # fmt: skip
"""What Pillow raises about damaged headers and data."""
