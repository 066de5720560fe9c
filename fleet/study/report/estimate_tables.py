"""The tables of a report: as CSV files in full, and on the page as far as a reader would read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from fleet.study.report import text
from fleet.study.report.csv_files import write_csv
from fleet.study.report.estimates import ROBOTS_AT, Contrast, Coordinates, Curve, Energies, Mean
from fleet.study.report.layout import Layout
from fleet.study.report.quantities import name_of

MOST_ROWS = 60  # on the page

M = TypeVar("M", Mean, Contrast)


class TableCell(NamedTuple):
    """What stands in one place of a table."""

    text: str
    stressed: bool = False
    beside: str = ""  # smaller, after it
    below: str = ""  # smaller, on a line of its own


class TableRow(NamedTuple):
    """A row of a table; one that begins a group names what the others have in common with it."""

    entries: list[TableCell]
    begins: bool


@dataclass(frozen=True, slots=True)
class Table:
    """A table of the page."""

    head: list[tuple[str, str]]  # names and units
    rows: list[TableRow]
    named: int  # columns that say where in the study a row belongs
    left_out: int  # rows that are in the CSV file only


def means_table(means: Sequence[Mean], layout: Layout) -> Table:
    """A row a cell, a column a measure."""
    rows = [
        (
            cell,
            [TableCell(str(found[0].runs)), *(TableCell(text.estimate(m.estimate)) for m in found)],
        )
        for cell, found in _by_cell(means)
    ]
    return _table([("runs", ""), *_heads(means)], rows, layout)


def contrasts_table(contrasts: Sequence[Contrast], layout: Layout) -> Table:
    """A row a cell, a column a measure: the difference, its interval and its effect size."""
    rows = [
        (cell, [TableCell(str(found[0].difference.pairs)), *(_contrast(c) for c in found)])
        for cell, found in _by_cell(contrasts)
    ]
    return _table([("pairs", ""), *_heads(contrasts)], rows, layout)


def curves_table(curves: Sequence[Curve], layout: Layout) -> Table:
    """A row a cell: how many runs, and the round that half of them outlive."""
    rows = [
        (
            curve.cell,
            [
                TableCell(str(curve.runs)),
                TableCell(str(curve.cut)),
                TableCell(f"{curve.curve.median:g}".replace("inf", "later")),
            ],
        )
        for curve in curves
    ]
    return _table([("runs", ""), ("cut off", ""), ("median lifetime", "rounds")], rows, layout)


def write_means(path: Path, means: Iterable[Mean], layout: Layout) -> None:
    """All means, a row each."""
    _write(
        path, layout, ["measure", "runs", "mean", "low", "high"],
        ((mean.cell, [mean.measure, mean.runs, *mean.estimate]) for mean in means),
    )  # fmt: skip


def write_contrasts(path: Path, contrasts: Iterable[Contrast], layout: Layout) -> None:
    """All paired differences, a row each."""
    _write(
        path, layout,
        ["baseline", "measure", "difference", "low", "high", "cohens_d", "pairs", "p", "p_holm"],
        (
            (c.cell, [layout.baseline, c.measure, *c.difference[:6], c.chance])
            for c in contrasts
        ),
    )  # fmt: skip


def write_curves(path: Path, curves: Iterable[Curve], layout: Layout) -> None:
    """All survival curves, a row a step."""
    _write(
        path, layout, ["round", "alive", "low", "high"],
        (
            (curve.cell, list(map(float, step)))
            for curve in curves
            for step in zip(*curve.curve, strict=True)
        ),
    )  # fmt: skip


def write_energies(path: Path, energies: Iterable[Energies], layout: Layout) -> None:
    """All distributions of energy, a row a percentage of robots."""
    _write(
        path, layout, ["robots_with_less_percent", "energy_left"],
        (
            (item.cell, [float(share), float(left)])
            for item in energies
            for share, left in zip(ROBOTS_AT, item.left, strict=True)
        ),
    )  # fmt: skip


def _write(
    path: Path, layout: Layout, head: list[str], rows: Iterable[tuple[Coordinates, list[Any]]]
) -> None:
    names = [*layout.facets, *(name for name in (layout.series, layout.x) if name is not None)]
    write_csv(path, [*names, *head], ([*_place(cell, layout), *row] for cell, row in rows))


def _place(cell: Coordinates, layout: Layout) -> list[Any]:
    place = [*cell.facet, *([cell.series] if layout.series is not None else [])]
    return place + ([cell.x] if layout.x is not None else [])


def _contrast(contrast: Contrast) -> TableCell:
    found = contrast.difference
    return TableCell(
        text.difference(found),
        stressed=text.stands_out(found, contrast.chance),
        beside=f"d {text.effect(found)}",
        below=text.bounds(found),
    )


def _by_cell(items: Sequence[M]) -> Iterator[tuple[Coordinates, list[M]]]:
    cells: dict[Coordinates, list[M]] = {}
    for item in items:
        cells.setdefault(item.cell, []).append(item)
    yield from cells.items()


def _heads(items: Sequence[Mean] | Sequence[Contrast]) -> list[tuple[str, str]]:
    return [_head(measure) for measure in dict.fromkeys(item.measure for item in items)]


def _head(column: str) -> tuple[str, str]:
    name, _, unit = name_of(column).partition(" [")
    return name, unit.rstrip("]")


def _table(
    head: list[tuple[str, str]], rows: list[tuple[Coordinates, list[TableCell]]], layout: Layout
) -> Table:
    """The table with the places of its rows in front; what repeats is left blank."""
    columns = [*layout.facets, *(c for c in (layout.series, layout.x) if c is not None)]
    laid: list[TableRow] = []
    before: list[str] = []
    for cell, entries in rows[:MOST_ROWS]:
        values = [*cell.facet, *([cell.series] if layout.series is not None else [])]
        values += [cell.x] if layout.x is not None else []
        place = [text.plain(value) for value in values]
        same = next((n for n, name in enumerate(place) if before[n : n + 1] != [name]), 0)
        shown = [TableCell("" if n < same else name) for n, name in enumerate(place)]
        laid.append(TableRow([*shown, *entries], begins=same < len(place) - 1))
        before = place
    return Table([*map(_head, columns), *head], laid, len(columns), max(0, len(rows) - MOST_ROWS))
