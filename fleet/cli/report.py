"""``fleet report``: a study as a page to read."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("report")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path),
              help="Write it here instead of into FOLDER.")  # fmt: skip
@click.option("--bundle", type=click.Path(path_type=Path), metavar="FILE.zip",
              help="Put the study into one file too, for `fleet verify`.")  # fmt: skip
def command(folder: Path, out: Path | None, bundle: Path | None) -> None:
    """Write FOLDER/report.html from what a sweep has so far, also while it goes on.

    The figures are beside it as SVG, and what they show as CSV, in FOLDER/report. A bundle is an
    RO-Crate: study, versions, keys, tables and report in a ZIP file. What has a report of its own,
    as `fleet paper` writes, keeps it.
    """
    from fleet.cli.exits import say
    from fleet.study.report.study_report import has_report_of_its_own, write_report

    if not has_report_of_its_own(folder):
        click.echo(write_report(folder, out))
    if bundle is not None:
        from fleet.study.bundle import write_bundle

        written = write_bundle(folder, bundle)
        for name in written.missing:
            say(f"{name} cannot come along: it has changed, or is not below where the study began")
        click.echo(f"{written.path}: {written.parts} files")
