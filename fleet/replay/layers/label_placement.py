"""Where labels go so that they do not lie on each other."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from protocols.messages import Point

LETTER = 0.021  # width of a letter, in shares of the floor's longer side, at the usual zoom
LINE = 0.042  # height of a line of text, likewise
HANG = 0.02  # how far below its anchor the viewer draws a label, likewise
ROBOT = 0.005  # radius of a robot, about, likewise
AWAY = 0.034  # from what is named to its label's middle, upwards or downwards

FloatArray: TypeAlias = NDArray[np.float64]
Box: TypeAlias = tuple[float, ...]  # x and y of the middle, width, height [m]


class LabelPlacement:
    """LabelPlacement of what is on a ``floor`` (width, height) [m]. Once placed, they stay."""

    def __init__(self, floor: Point) -> None:
        width, height = floor
        self._side = side = max(floor)
        self._beside = [
            (-0.5 * width, 0.5 * height, width, 4.0 * side),
            (1.5 * width, 0.5 * height, width, 4.0 * side),
            (0.5 * width, 1.02 * height + side, 4.0 * side, 2.0 * side),
            (0.5 * width, -side, 4.0 * side, 2.0 * side),
        ]
        self._taken: list[Box] = []
        self._shapes: dict[int, FloatArray] = {}  # of labels, by their letters
        self._robots = np.empty((0, 2))

    def clear(self, robots: ArrayLike = ()) -> None:
        """Take all of them away; they had better not cover ``robots`` (n, 2) [m] from now on."""
        self._taken = list(self._beside)
        self._robots = np.array(robots, float).reshape(-1, 2)

    def keep_off(self, place: Point) -> None:
        """There is something to be seen at ``place`` [m]."""
        self._taken.append((*place, LINE * self._side, LINE * self._side))

    def place(self, x: float, y: float, letters: int) -> Point:
        """The anchor [m] of a label of so many ``letters`` for what is at (x, y) [m].

        Of some places around, it goes to the one where it covers the least of what is known of
        and of what is beside the floor; of several such, where it hides the fewest robots.
        """
        side = self._side
        choices = self._around(letters) + np.array((x, y, 0.0, 0.0))
        others = [box for box in self._taken if (box[0], box[1]) != (x, y)]
        covered = self._covered(choices, np.array(others).reshape(-1, 4))
        free = choices[covered == covered.min()]
        best = tuple(free[np.argmin(self._hidden(free))].tolist())
        self._taken.append(best)
        return best[0], best[1] + HANG * side

    def _around(self, letters: int) -> FloatArray:
        """Boxes (k, 4) of a label of so many letters, around the origin."""
        if letters not in self._shapes:
            side = self._side
            width, height = LETTER * side * letters, LINE * side
            up, beside = AWAY * side, AWAY * side + 0.5 * width
            self._shapes[letters] = np.array(
                [
                    (dx, dy, width, height)
                    for dx, dy in (
                        (0.0, up), (0.0, -up), (beside, 0.0), (-beside, 0.0),
                        (0.6 * beside, 1.4 * up), (-0.6 * beside, 1.4 * up),
                        (0.6 * beside, -1.4 * up), (-0.6 * beside, -1.4 * up),
                        (0.0, 2.4 * up), (0.0, -2.4 * up),
                        (0.6 * beside, 2.4 * up), (-0.6 * beside, 2.4 * up),
                        (0.6 * beside, -2.4 * up), (-0.6 * beside, -2.4 * up),
                    )
                ]
            )  # fmt: skip
        return self._shapes[letters]

    def _covered(self, choices: FloatArray, others: FloatArray) -> FloatArray:
        """The area [m²] that each of these boxes (k, 4) has in common with ``others`` (j, 4)."""
        one, other = choices[:, None], others[None]
        shared = 0.5 * (one[..., 2:] + other[..., 2:]) - np.abs(one[..., :2] - other[..., :2])
        area = np.maximum(shared, 0.0).prod(axis=2).sum(axis=1)
        return np.asarray(area)

    def _hidden(self, choices: FloatArray) -> NDArray[np.intp]:
        """How many robots each of these boxes (k, 4) covers, if only in part."""
        boxes = choices[:, None]
        near = np.abs(self._robots - boxes[..., :2]) < 0.5 * boxes[..., 2:] + ROBOT * self._side
        return np.asarray(np.count_nonzero(near[..., 0] & near[..., 1], axis=1))
