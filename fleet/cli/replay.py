"""``fleet replay``: one run of a study again, recorded, or two of them compared."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import click

from fleet.cli.parameters import RecordingFile

if TYPE_CHECKING:
    from fleet.results import Summary
    from fleet.study.kept import Kept

DIFFERENT = 1
DIGITS = 12  # of a key that people are shown


@click.command("replay")
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("key")
@click.option("--against", "other", metavar="KEY2",
              help="Compare it with this run of the same study: where they part, and what then.",
              )  # fmt: skip
@click.option("--rrd", type=RecordingFile(), help="Record the run, or both, to this file.")
@click.option("--view", is_flag=True, help="Watch the run in the Rerun viewer as it goes; two runs"
              " are shown side by side when both are done.")  # fmt: skip
@click.option("--trust", is_flag=True,
              help="Run Python files that FOLDER names, though you have not swept with them.",
              )  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
def command(
    folder: Path,
    key: str,
    other: str | None,
    rrd: Path | None,
    view: bool,
    trust: bool,
    as_json: bool,
) -> None:
    """Run one run of a sweep again, and compare it with what the sweep found.

    FOLDER is that of the sweep. KEY is a key of runs.parquet, or its first digits. Exit code 1
    if the run is not the same to the last bit. A folder is data, and may come from anybody:
    Python files that it names are run only if you have swept with them as they are.

    With --against two runs are recorded, and compared: what of their scenarios differs, the first
    event at which they part, and the difference from there on.
    """
    from fleet.study import kept as ledger

    kept = ledger.kept_run(folder, key, trust=trust)
    if other is None:
        single(kept, rrd, view=view, as_json=as_json)
        return
    pair = [kept, ledger.kept_run(folder, other, trust=trust)]
    both(pair, rrd and rrd.resolve(), view=view, as_json=as_json)


def single(kept: Kept, rrd: Path | None, *, view: bool, as_json: bool) -> None:
    """One run again."""
    from fleet.cli.progress import RunProgress
    from fleet.cli.summary import print_summary
    from fleet.observer import Observer

    observers: list[Observer] = [RunProgress(kept.scenario.rounds)] if sys.stderr.isatty() else []
    if rrd is not None or view:
        from fleet.replay import recorder

        observers.append(recorder(kept.scenario, rrd and rrd.resolve(), live=view))
    summary = kept.play(observers)
    if as_json:
        click.echo(json.dumps(summary.as_dict()))
    else:
        print_summary(summary)
    if not judged(kept, summary):
        sys.exit(DIFFERENT)


def both(pair: list[Kept], rrd: Path | None, *, view: bool, as_json: bool) -> None:
    """Two runs again, recorded beside each other."""
    from fleet.replay import recorder
    from fleet.replay.comparison import arrange, comparison
    from fleet.scenario.errors import bad

    if pair[0].key == pair[1].key:
        raise bad("--against", f"is run {pair[1].key[:DIGITS]} itself; expected another run")
    with TemporaryDirectory() as scratch:
        paths = [Path(scratch) / f"{kept.key[:DIGITS]}.rrd" for kept in pair]
        same = [
            judged(kept, kept.play([recorder(kept.scenario, path)]))
            for kept, path in zip(pair, paths, strict=True)
        ]
        found = comparison(*paths)
        click.echo(json.dumps(found.as_dict()) if as_json else found.markdown())
        if rrd is not None:
            try:
                arrange(paths, rrd)
            except (OSError, RuntimeError) as error:
                raise bad("--rrd", f"cannot record to {rrd}: {error}") from error
        if view:
            from fleet.replay.viewer import view as show

            try:
                show(paths)
            except ValueError as error:
                raise bad("--view", str(error)) from error
    if not all(same):
        sys.exit(DIFFERENT)


def judged(kept: Kept, summary: Summary) -> bool:
    """Say whether this is the run that is kept; returns whether it is."""
    from fleet.cli.exits import say

    differences = kept.differences(summary)
    for difference in differences:
        say(difference)
    for change in kept.changes():
        say(change)
    if differences:
        say(f"run {kept.key[:DIGITS]} is not the run that is kept")
        return False
    verdict = "the same to the last bit" if kept.row else "done; there was none to compare it with"
    say(f"run {kept.key[:DIGITS]} is {verdict}")
    return True
