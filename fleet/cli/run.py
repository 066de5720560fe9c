"""``fleet run``: one run, its summary, and its recording."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from fleet.cli.exits import program
from fleet.cli.parameters import RecordingFile, Value

if TYPE_CHECKING:
    from fleet.observer import Observer


@click.command("run")
@click.argument("scenario", required=False, type=click.Path(path_type=Path))
@click.option("--protocol", help="A name from `fleet list`, or file.py:name.  [rfta2]")
@click.option("--world", help="A name from `fleet list`.  [random]")
@click.option("--robot", help="A preset, or the file of one, as `fleet energy --log` writes.")
@click.option("--motion", help="straight, path or physics.  [physics]")
@click.option("--robots", type=Value("integer"), help="How many.  [100]")
@click.option("--range", "range_", type=Value("metres"), help="Radio range r.  [2.5]")
@click.option("--search-radius", type=Value("metres"), help="SR.  [2.0]")
@click.option(
    "--rounds", type=Value("integer"), help="Stop after so many.  [a whole network lifetime]"
)
@click.option("--seed", type=Value("integer"), help="Decides everything that is random.  [0]")
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE",
              help="Any scenario key, such as robot.radius=0.2. Repeatable.")  # fmt: skip
@click.option("--rrd", type=RecordingFile(), help="Record the run to this file.")
@click.option("--view", is_flag=True, help="Watch the run in the Rerun viewer as it goes.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
@click.option("--dry", is_flag=True, help="Check everything, put everybody in place, do not run.")
@click.option("--dump", is_flag=True, help="Print the whole scenario as a file; do not run.")
def command(
    scenario: Path | None,
    range_: Any,
    settings: tuple[str, ...],
    rrd: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Play one run and print its summary.

    SCENARIO is a TOML file; options win over it, --set over both. Defaults, in brackets, are the
    paper's.
    """
    flags = {name: options.pop(name) for name in ("view", "dry", "dump")}
    given = {k: v for k, v in {**options, "range": range_}.items() if v is not None}
    if flags["dump"] or flags["dry"]:
        look(scenario, given, settings, dump=flags["dump"])
        return
    with ExitStack() as stack:
        writer = None
        if rrd is not None or flags["view"]:
            from fleet.replay.writer_process import WriterProcess

            writer = stack.enter_context(WriterProcess())  # it gets ready while we do
        from fleet.assembly import run
        from fleet.cli.notices import Notices
        from fleet.cli.progress import RunProgress
        from fleet.cli.summary import SummaryFirst
        from fleet.scenario.loading import load_scenario

        loaded = load_scenario(scenario, given, settings)
        observers: list[Observer] = [Notices()]
        if sys.stderr.isatty():
            observers.append(progress := RunProgress(loaded.rounds))
            stack.callback(progress.closed)  # also if the run is refused
        observers.append(SummaryFirst(as_json=as_json))  # a recording is still to be drawn
        if writer is not None:
            from fleet.replay import recorder

            observers.append(recorder(loaded, rrd, live=flags["view"], writer=writer))
        run(loaded, observers)
    if rrd is not None and not as_json:
        click.echo(f"\nRecorded to {rrd}. Open it with:  {program()} view {rrd}")


def look(
    scenario: Path | None, given: dict[str, Any], settings: tuple[str, ...], *, dump: bool
) -> None:
    """Everything but the run itself."""
    from fleet.assembly import prepare
    from fleet.cli.notices import Notices
    from fleet.scenario.loading import load_scenario
    from fleet.scenario.resolving import as_toml

    loaded = load_scenario(scenario, given, settings)
    if dump:
        click.echo(as_toml(loaded), nl=False)
        return
    ready = prepare(loaded, [Notices()]).fleet
    click.echo(
        f"Ready: {loaded.protocol.name} on {loaded.world.name}, {loaded.motion.name} motion,"
        f" {len(ready.robots)} robots, seed {loaded.seed}. Nothing was run."
    )
