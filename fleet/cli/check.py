"""``fleet check``: whether a results folder is as it was written, or a protocol keeps the rules."""

from __future__ import annotations

import sys
from pathlib import Path

import click

WRONG = 1


@click.command("check")
@click.argument("target", type=click.Path(path_type=Path))
def command(target: Path) -> None:
    """Check TARGET, a results folder, or a protocol or metric of yours as FILE.py:NAME.

    A folder: rows against checksums, tables against the ledger; nothing in it is run, and nothing
    is written. A protocol or metric: what those of the catalogue are put through, on networks that
    stand still. Exit code 1 if a folder is damaged, 2 if a protocol or metric has to be mended.
    """
    from fleet.cli.exits import BAD_INPUT, say
    from fleet.scenario.plugins import looks_like_file

    if looks_like_file(str(target)):
        from fleet.scenario.trial import trial

        verdicts = trial(str(target))
        for claim, problem in verdicts:
            click.echo(f"{'no ' if problem else 'yes'}  {claim}{problem and ': '}{problem}")
        sys.exit(BAD_INPUT if any(problem for _, problem in verdicts) else 0)
    from fleet.study.audit import audit

    found = audit(target)
    for problem in found.problems:
        say(problem)
    if found.problems:
        sys.exit(WRONG)
    click.echo(f"{target}: {found.runs} runs and {found.tables} tables are as they were written")
