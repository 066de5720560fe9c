"""How figures look: for light pages and dark ones, in the page's own letters."""

from __future__ import annotations

import io
import re
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from fleet.study.atomic import write_text

INK, DIM, RULE = "#1b1f23", "#5b636b", "#d4d8dc"
SERIES = (  # after Okabe and Ito's, which colour-blind readers tell apart
    "#0072b2", "#d55e00", "#00896b", "#b8559b", "#b07d00", "#3b9bd4", "#6f7780", "#8a5a44",
)  # fmt: skip
SERIES_DARK = (
    "#5ab1ea", "#ff9152", "#46cfa6", "#ec9fd2", "#f0bf55", "#9cd4f7", "#b4bbc2", "#d0a48f",
)  # fmt: skip
MARKERS = "osD^vPX*"
DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (5, 1, 1, 1)))

WIDTH = 7.4  # of a figure over the whole measure of the page [inch]

_STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": DIM,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.labelsize": 8.5,
    "axes.linewidth": 0.7,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.titlesize": 9.0,
    "figure.constrained_layout.h_pad": 0.06,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.w_pad": 0.06,
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "grid.color": RULE,
    "grid.linewidth": 0.6,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "legend.labelcolor": INK,
    "lines.linewidth": 1.4,
    "lines.markersize": 3.6,
    "svg.fonttype": "none",
    "text.color": INK,
    "xtick.color": DIM,
    "xtick.labelcolor": INK,
    "xtick.labelsize": 8.0,
    "xtick.major.size": 2.5,
    "xtick.major.width": 0.7,
    "ytick.color": DIM,
    "ytick.labelcolor": INK,
    "ytick.labelsize": 8.0,
    "ytick.major.size": 2.5,
    "ytick.major.width": 0.7,
}


def in_style(name: str) -> AbstractContextManager[None]:
    """Draw in the style of reports; ``name`` keeps the marks of one figure apart from others'."""
    style: Any = _STYLE | {"svg.hashsalt": name}
    context: AbstractContextManager[None] = mpl.rc_context(style)
    return context


def svg_of(figure: Figure) -> str:
    """The figure as an SVG document, the same text for the same figure."""
    text = io.StringIO()
    figure.savefig(text, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    return text.getvalue()


def saved(figure: Figure, folder: Path, name: str) -> str:
    """Write a figure as PNG and SVG; returns it as an element of a page."""
    figure.savefig(folder / f"{name}.png", dpi=200)
    svg = svg_of(figure)
    write_text(folder / f"{name}.svg", svg)
    return inline(svg)


def inline(svg: str) -> str:
    """An SVG document as an element of a page, with the page's letters and colours."""
    element = svg[svg.index("<svg") :]
    width = float(re.search(r'width="([\d.]+)pt"', element)[1])  # type: ignore[index]  # matplotlib always says it
    share = min(100.0, 100.0 * width / (72.0 * WIDTH))
    element = re.sub(r' (?:width|height)="[\d.]+pt"', "", element, count=2)
    element = element.replace("<svg", f'<svg style="max-width: {share:.0f}%"', 1)
    element = re.sub(r"<metadata>.*?</metadata>", "", element, flags=re.DOTALL)
    needed = set(re.findall(r"#([\w.-]+)", element))
    element = re.sub(
        r' id="([\w.-]+)"', lambda found: found[0] if found[1] in needed else "", element
    )
    element = re.sub(r"font: ([\d.]+px) [^;\"]+", r"font: \1 var(--sans)", element)
    element = re.sub(r"font-family: [^;\"]+", "font-family: var(--sans)", element)
    for colour, variable in VARIABLES.items():
        element = element.replace(colour, f"var(--{variable})")
    return element


VARIABLES = {INK: "ink", DIM: "dim", RULE: "rule"} | {
    colour: f"s{number}" for number, colour in enumerate(SERIES)
}
"""The page's names for the colours."""
