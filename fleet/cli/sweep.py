"""``fleet sweep``: every combination of a study with every seed."""

from __future__ import annotations

from pathlib import Path

import click

from fleet.cli.exits import say
from fleet.cli.resuming import conclude, progress, resumable, this_command


@click.command("sweep")
@click.argument("study", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), required=True,
              help="Folder for the results. What is there already is not run again.")  # fmt: skip
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [all cores]")
@click.option("--scheduler", metavar="ADDRESS",
              help="A Dask scheduler to run on, such as tcp://127.0.0.1:8786.")  # fmt: skip
@click.option("--until", metavar="TARGET", default="",
              help="Add seeds until a measure is known so well everywhere, as 'lifetime ±2%'; +- "
                   "will do.")  # fmt: skip
@click.option("--limit", type=click.FloatRange(min=0.0, min_open=True), metavar="SECONDS",
              help="End a run that takes longer; it counts as failed.  [3600]")  # fmt: skip
@click.option("--retry", is_flag=True, help="Run those again that failed.")
def command(
    study: Path,
    out: Path,
    workers: int | None,
    scheduler: str | None,
    until: str,
    limit: float | None,
    retry: bool,
) -> None:
    """Run every combination of a study with every seed, in parallel.

    STUDY is a TOML file: a scenario, axes that vary it, and seeds. The results are in
    OUT/runs.parquet. However the command ends, the same command goes on where it stopped.

    Exit codes: 0 done, 1 some runs failed, 2 bad input, 3 the disk is full or the scheduler is
    lost, 130 Ctrl-C, 143 SIGTERM.
    """
    from fleet.study.local import LIMIT
    from fleet.study.sweeping import sweep

    with resumable():
        with progress("sweep") as show:
            result = sweep(
                study, out, workers=workers, scheduler=scheduler, retry=retry,
                limit=limit or LIMIT, until=until, progress=show, say=say, command=this_command(),
            )  # fmt: skip
        conclude(result)
