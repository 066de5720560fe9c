"""``fleet report``: a study as a page to read."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("report")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path),
              help="Write it here instead of into FOLDER.")  # fmt: skip
def command(folder: Path, out: Path | None) -> None:
    """Write FOLDER/report.html from what a sweep has so far, also while it goes on.

    The figures are beside it as SVG, and what they show as CSV, in FOLDER/report.
    """
    from fleet.study.report.study_report import write_report

    click.echo(write_report(folder, out))
