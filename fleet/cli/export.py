"""``fleet export``: a recording's tables as files, or a run's trips as logs of real robots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from fleet.scenario.model import Scenario


@click.command("export")
@click.argument("source", required=False, type=click.Path(path_type=Path))
@click.option(
    "--out",
    "tables",
    type=click.Path(path_type=Path),
    help="Folder for a recording's transcript, trips, tasks and poses as Parquet.",
)
@click.option("--mcap", is_flag=True, help="Also as MCAP, for Foxglove.")
@click.option(
    "--log",
    "logs",
    type=click.Path(path_type=Path),
    help="Folder for a scenario's trips: a CSV of each robot that drives, and log.toml.",
)
@click.option(
    "--speeds",
    default="1,0.7,0.4",
    metavar="SHARES",
    help="With --log: shares of the cruise speed, a run at each.  [1,0.7,0.4]",
)
@click.option("--robot", help="With --log: a preset, or the file of one.")
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    help="With --log: any scenario key, such as rounds=40. Repeatable.",
)
def command(
    source: Path | None,
    tables: Path | None,
    mcap: bool,
    logs: Path | None,
    speeds: str,
    robot: str | None,
    settings: tuple[str, ...],
) -> None:
    """Write what a recording holds, or what a run's robots would have logged.

    With --out SOURCE is a recording: every transmission, trip, task and pose becomes a row.

    With --log SOURCE is a scenario, the paper's by default. It is played, and its trips are
    written as a real robot's log has them, which `fleet energy --log` reads: times, places,
    speeds, turning rates and power, 60 times a second, without what only a simulation knows.
    What a robot's owner knows, mass, track and motors, is in log.toml. Trips at one speed cannot
    tell what a metre costs from what a second does, so there are several.
    """
    from fleet.scenario.errors import bad
    from fleet.scenario.loading import load_scenario

    if (tables is None) == (logs is None):
        raise bad("", "expected --out DIR for a recording's tables, or --log DIR for logs of trips")
    if tables is not None:
        if source is None:
            raise bad("", "expected the recording whose tables --out is for")
        export_recording(source, tables, mcap=mcap)
    elif logs is not None:
        given = {} if robot is None else {"robot": robot}
        export_trips(load_scenario(source, given, settings), logs, shares_of(speeds))


def export_recording(recording: Path, folder: Path, *, mcap: bool) -> None:
    """Write the tables, and say where they are."""
    from fleet.replay.table_files import export_tables
    from fleet.scenario.errors import bad

    try:
        for path in export_tables(recording, folder, mcap=mcap):
            click.echo(path)
    except OSError as error:
        raise bad("--out", f"cannot write to {folder}: {error.strerror or error}") from error
    except ValueError as error:
        raise bad("", str(error)) from error


def export_trips(scenario: Scenario, folder: Path, speeds: Sequence[float]) -> None:
    """Play the scenario once at each of these shares of its cruise speed; log its trips."""
    from fleet.assembly import run
    from fleet.logs.exporting import TripExport

    for number, share in enumerate(speeds):
        robot = replace(scenario.robot, cruise=share * scenario.robot.cruise)
        log = TripExport(folder, robot, run=number)
        run(replace(scenario, robot=robot), [log])
    click.echo(f"Logs: {folder}. Judge them with:  fleet energy --log {folder} --out DIR")


def shares_of(text: str) -> list[float]:
    """Numbers parted by commas.

    Raises:
        BadInput: one is no share of a speed.
    """
    from fleet.scenario.errors import bad, shown

    try:
        shares = [float(part) for part in text.split(",")]
    except ValueError:
        shares = []
    if not shares or not all(0.0 < share <= 10.0 for share in shares):
        raise bad("--speeds", f"is {shown(text)}; expected shares of the cruise speed: 1,0.7,0.4")
    return shares
