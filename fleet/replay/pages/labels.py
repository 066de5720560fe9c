"""Where labels go so that they do not lie on each other."""

from __future__ import annotations

from typing import TypeAlias

from protocols.messages import Point

LETTER = 0.021  # width of a letter, in shares of the floor's longer side, at the usual zoom
LINE = 0.042  # height of a line of text, likewise
HANG = 0.02  # how far below its anchor the viewer draws a label, likewise
AWAY = 0.034  # from what is named to its label's middle, upwards or downwards

Box: TypeAlias = tuple[float, float, float, float]  # x and y of the middle, width, height [m]


class Labels:
    """Labels of what is on a ``floor`` (width, height) [m]. Once placed, they stay."""

    def __init__(self, floor: Point) -> None:
        width, height = floor
        self._side = side = max(floor)
        self._beside = [(x, 0.5 * height, width, 4.0 * side) for x in (-0.5 * width, 1.5 * width)]
        self._taken: list[Box] = []

    def clear(self) -> None:
        """Take all of them away."""
        self._taken = list(self._beside)

    def keep_off(self, place: Point) -> None:
        """There is something to be seen at ``place`` [m]."""
        self._taken.append((*place, LINE * self._side, LINE * self._side))

    def place(self, x: float, y: float, letters: int) -> Point:
        """The anchor [m] of a label of so many ``letters`` for what is at (x, y) [m].

        It goes to the first of ten places around where it covers nothing that is known of,
        nor what is beside the floor; if there is none, to the one where it covers the least.
        """
        side = self._side
        width, height = LETTER * side * letters, LINE * side
        up, beside = AWAY * side, AWAY * side + 0.5 * width
        choices = [
            (x + dx, y + dy, width, height)
            for dx, dy in (
                (0.0, up), (0.0, -up), (beside, 0.0), (-beside, 0.0),
                (0.6 * beside, 1.4 * up), (-0.6 * beside, 1.4 * up),
                (0.6 * beside, -1.4 * up), (-0.6 * beside, -1.4 * up),
                (0.0, 2.4 * up), (0.0, -2.4 * up),
            )
        ]  # fmt: skip
        others = [box for box in self._taken if (box[0], box[1]) != (x, y)]
        free = (box for box in choices if not any(_shared(box, other) for other in others))
        best = next(free, None) or min(
            choices, key=lambda box: sum(_shared(box, other) for other in others)
        )
        self._taken.append(best)
        return best[0], best[1] + HANG * side


def _shared(a: Box, b: Box) -> float:
    """The area [m²] that two boxes have in common."""
    wide = 0.5 * (a[2] + b[2]) - abs(a[0] - b[0])
    if wide <= 0.0:
        return 0.0
    high = 0.5 * (a[3] + b[3]) - abs(a[1] - b[1])
    return wide * high if high > 0.0 else 0.0
