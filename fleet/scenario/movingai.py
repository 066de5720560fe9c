"""Maps and scenarios of the MovingAI benchmarks, as their page describes them.

Sturtevant, IEEE Trans. Comput. Intell. AI Games 4:144, 2012, doi:10.1109/TCIAIG.2012.2197681;
https://movingai.com/benchmarks/formats.html.
"""

from __future__ import annotations

from math import nan
from pathlib import Path

import numpy as np

from fleet.scenario.errors import bad, shown
from fleet.scenario.reading import read_text
from worlds.occupancy import FREE, OCCUPIED, OccupancyGrid
from worlds.shapes import FloatArray

PASSABLE = ".GS"  # ground, and swamp
KNOWN = PASSABLE + "@OTW"  # out of bounds, trees, water
MOST_CELLS = 100_000_000


def grid_of(path: Path, key: str) -> OccupancyGrid:
    """The map of a ``.map`` file, with cells of 1 m: ground and swamp are free.

    Raises:
        BadInput: the file is not there, or not such a map.
    """
    lines = read_text(path, key).splitlines()
    head = dict(line.lower().split(maxsplit=1) for line in lines[:3] if len(line.split()) == 2)
    try:
        width, height = int(head["width"]), int(head["height"])
        begin = [line.strip().lower() for line in lines[:8]].index("map") + 1
    except (KeyError, ValueError):
        raise bad(key, f"{path}: is no MovingAI map; expected type, height, width, map") from None
    if not (width > 0 and height > 0 and width * height <= MOST_CELLS):
        raise bad(key, f"{path}: is {width} × {height} cells; expected 1 to {MOST_CELLS}")
    rows = lines[begin : begin + height]
    for k, row in enumerate(rows):
        if len(row) != width or set(row) - set(KNOWN):
            raise bad(
                key, f"{path}:{begin + k + 1}: is {shown(row)}; expected {width} of {KNOWN!r}"
            )
    if len(rows) < height:
        raise bad(key, f"{path}: has {len(rows)} rows; expected {height}")
    free = np.isin(np.array([list(row) for row in rows]), list(PASSABLE))
    return OccupancyGrid(np.where(free, FREE, OCCUPIED).astype(np.int8)[::-1].copy(), 1.0)


def trips(path: Path, columns: tuple[str, ...], key: str) -> FloatArray:
    """The trips of a ``.scen`` file as a table (n, columns), in cells from the lower left corner.

    A row holds bucket, map, its width and height, x and y of start and goal in cells from the
    upper left corner, and the length of the best way. Places are starts, events are goals.

    Raises:
        BadInput: the file is not there, or a row is no trip.
    """
    found = []
    for number, line in enumerate(read_text(path, key).splitlines(), 1):
        cells = line.split()
        if not cells or cells[0].lower() == "version":
            continue
        try:
            height, sx, sy, gx, gy = (int(cell) for cell in (cells[3], *cells[4:8]))
        except (ValueError, IndexError):
            raise bad(
                key,
                f"{path}:{number}: is {shown(line)}; expected bucket, map, width, height, and x and"
                f" y of start and goal",
            ) from None
        x, y = (gx, gy) if "time" in columns else (sx, sy)
        row = [nan] * len(columns)
        row[columns.index("x")], row[columns.index("y")] = x + 0.5, height - y - 0.5
        found.append(row)
    if not found:
        raise bad(key, f"{path}: holds no trips")
    return np.array(found)
