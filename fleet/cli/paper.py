"""``fleet paper``: the paper's campaign, run anew."""

from __future__ import annotations

from pathlib import Path

import click

from fleet.cli.exits import say
from fleet.cli.resuming import conclude, progress, resumable, this_command


@click.command("paper")
@click.option("--out", type=click.Path(path_type=Path), required=True,
              help="Folder for results and report. What is there is not run again.")  # fmt: skip
@click.option("--quick", is_flag=True, help="A tenth of the networks.")
@click.option("--networks", type=click.IntRange(min=2), metavar="N",
              help="Networks for each range and topology.  [100]")  # fmt: skip
@click.option("--motion", type=click.Choice(["straight", "physics"]), default="straight",
              help="straight: as the paper; physics: on pymunk as well.  [straight]")  # fmt: skip
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [all cores]")
@click.option("--scheduler", metavar="ADDRESS", help="A Dask scheduler to run on.")
def command(
    out: Path,
    quick: bool,
    networks: int | None,
    motion: str,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Run the paper's campaign: every figure, table and claim beside the published ones.

    Writes OUT/report.html, with figures (PNG, SVG) and tables (CSV) beside it. Interrupted
    and run again, it goes on where it was.
    """
    from fleet.experiments.paper.cases import NETWORKS, NETWORKS_QUICK
    from fleet.experiments.paper.paper_campaign import paper_campaign

    with resumable():
        with progress("paper") as show:
            result, page = paper_campaign(
                out, networks=networks or (NETWORKS_QUICK if quick else NETWORKS),
                physics=motion == "physics", workers=workers, scheduler=scheduler,
                progress=show, say=say, command=this_command(),
            )  # fmt: skip
        click.echo(f"Report: {page}")
        conclude(result)
