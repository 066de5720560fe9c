"""``fleet verify``: a sample of a bundle's runs again."""

from __future__ import annotations

import sys
from pathlib import Path

import click

DIFFERENT = 1
SAMPLE = 10


@click.command("verify")
@click.argument("bundle", type=click.Path(path_type=Path))
@click.option("--sample", type=click.IntRange(min=0), default=SAMPLE, metavar="N",
              help=f"How many runs to run again; 0: all.  [{SAMPLE}]")  # fmt: skip
@click.option("--trust", is_flag=True, help="Run Python files that come with BUNDLE.")
def command(bundle: Path, sample: int, trust: bool) -> None:
    """Check a bundle that `fleet report --bundle` wrote, and run a sample of its runs again.

    Exit code 1 if a run is not the same to the last bit, 2 if BUNDLE is none or is damaged. A
    bundle is data, and may come from anybody: Python files that come with it are run only with
    --trust.
    """
    from fleet.cli.exits import say
    from fleet.study.verifying import verify

    found = verify(bundle, sample, trust=trust, say=say)
    if found.different:
        say(f"{len(found.different)} of {found.tried} runs are not the runs that are kept")
        sys.exit(DIFFERENT)
    click.echo(
        f"{bundle}: its files are as written, and {found.tried} of its {found.runs} runs are the"
        f" same to the last bit"
    )
