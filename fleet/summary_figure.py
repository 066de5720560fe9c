"""A run's summary as a picture: what its energy went into, and what was said."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from fleet.notebook_figure import NotebookFigure
from fleet.summary_lines import title

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from fleet.results import Summary

SIZE = (7.4, 2.6)  # [inch]


def draw(summary: Summary) -> NotebookFigure:
    """Two panels of bars: energy drained by account [J], transmissions by kind."""
    figure = NotebookFigure(figsize=SIZE, layout="constrained")
    figure.suptitle(title(summary).replace("\n", "; "), fontsize=9.0)
    energy, talk = figure.subplots(1, 2)
    _bars(energy, summary.energy_by_account, "energy drained [J]")
    _bars(talk, summary.messages_by_kind, "transmissions")
    return figure


def _bars(axes: Axes, parts: Mapping[str, float], label: str) -> None:
    """The parts that are not 0, the largest on top."""
    shown = sorted((value, name) for name, value in parts.items() if value)
    axes.barh([name for _, name in shown], [value for value, _ in shown], color="#0072b2")
    axes.set_xlabel(label)
    axes.spines[["top", "right"]].set_visible(False)
