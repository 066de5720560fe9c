"""A figure that a notebook shows by itself, whatever drew before it there."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

DPI = 110  # of the picture in a notebook


class NotebookFigure(Figure):
    """Matplotlib's figure; a notebook shows it although no state of pyplot knows of it."""

    def _repr_png_(self) -> bytes:
        """The picture, as notebooks ask for it."""
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=DPI)
        return picture.getvalue()
