"""``fleet replay``: one run of a study again, recorded."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from fleet.cli.parameters import RecordingFile

DIFFERENT = 1


@click.command("replay")
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("key")
@click.option("--rrd", type=RecordingFile(), help="Record the run to this file.")
@click.option("--view", is_flag=True, help="Watch the run in the Rerun viewer as it goes.")
@click.option("--trust", is_flag=True,
              help="Run Python files that FOLDER names, though you have not swept with them.",
              )  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
def command(
    folder: Path, key: str, rrd: Path | None, view: bool, trust: bool, as_json: bool
) -> None:
    """Run one run of a sweep again, and compare it with what the sweep found.

    FOLDER is that of the sweep. KEY is a key of runs.parquet, or its first digits. Exit code 1
    if the run is not the same to the last bit. A folder is data, and may come from anybody:
    Python files that it names are run only if you have swept with them as they are.
    """
    from fleet.cli.exits import say
    from fleet.cli.progress import RunProgress
    from fleet.cli.summary import print_summary
    from fleet.observer import Observer
    from fleet.study.kept import kept_run

    kept = kept_run(folder, key, trust=trust)
    observers: list[Observer] = [RunProgress(kept.scenario.rounds)] if sys.stderr.isatty() else []
    if rrd is not None or view:
        from fleet.replay import recorder

        observers.append(recorder(kept.scenario, rrd and rrd.resolve(), live=view))
    summary = kept.play(observers)
    if as_json:
        click.echo(json.dumps(summary.as_dict()))
    else:
        print_summary(summary)
    differences = kept.differences(summary)
    for difference in differences:
        say(difference)
    for change in kept.changes():
        say(change)
    if differences:
        say(f"run {kept.key[:12]} is not the run that is kept")
        sys.exit(DIFFERENT)
    verdict = "the same to the last bit" if kept.row else "done; there was none to compare it with"
    say(f"run {kept.key[:12]} is {verdict}")
