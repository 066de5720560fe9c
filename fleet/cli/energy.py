"""``fleet energy``: the paper's Eq. (1) against motion."""

from __future__ import annotations

from pathlib import Path

import click

from fleet.cli.exits import say
from fleet.cli.resuming import conclude, progress, resumable, this_command


@click.command("energy")
@click.option("--out", type=click.Path(path_type=Path), required=True,
              help="Folder for results and report. What is there is not run again.")  # fmt: skip
@click.option("--quick", is_flag=True, help="A tenth of it.")
@click.option("--seed", type=click.IntRange(min=0), default=0,
              help="The first seed of placements and networks.  [0]")  # fmt: skip
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [all cores]")
def command(out: Path, quick: bool, seed: int, workers: int | None) -> None:
    """Test whether the energy of a trip is linear in its straight distance, as in Eq. (1).

    Thousands of tasks, traffic and whole lifetimes are driven; Eq. (1) is compared with what
    was drained, and robots that bid by it with robots that know better. Writes OUT/report.html,
    with figures (PNG, SVG) and their numbers (CSV) in OUT/figures. Interrupted and run again,
    it goes on where it was.
    """
    from fleet.experiments.energy.energy_study import energy_study
    from fleet.experiments.energy.settings import FULL, QUICK

    with resumable():
        results, page = energy_study(
            out, progress, size=QUICK if quick else FULL, seed=seed, workers=workers, say=say,
            command=this_command(),
        )  # fmt: skip
        click.echo(f"Report: {page}")
        for result in results:
            if result.counts().failed:
                conclude(result)
