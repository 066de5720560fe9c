"""``fleet check``: whether a results folder holds what was written."""

from __future__ import annotations

import sys
from pathlib import Path

import click

WRONG = 1


@click.command("check")
@click.argument("target", type=click.Path(path_type=Path))
def command(target: Path) -> None:
    """Check the results folder TARGET: rows against checksums, tables against the ledger.

    Nothing in it is run, and nothing is written. Exit code 1 if something is wrong.
    """
    from fleet.cli.exits import say
    from fleet.study.audit import audit

    found = audit(target)
    for problem in found.problems:
        say(problem)
    if found.problems:
        sys.exit(WRONG)
    click.echo(f"{target}: {found.runs} runs and {found.tables} tables are as they were written")
