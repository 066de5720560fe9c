"""``fleet export``: the tables of a recording as files."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("export")
@click.argument("recording", type=click.Path(path_type=Path))
@click.option("--out", "folder", required=True, type=click.Path(path_type=Path),
              help="Folder for transcript, trips, tasks and poses as Parquet.")  # fmt: skip
@click.option("--mcap", is_flag=True, help="Also as MCAP, for Foxglove.")
def command(recording: Path, folder: Path, mcap: bool) -> None:
    """Write the tables of a RECORDING: every transmission, trip, task and pose is a row."""
    export_recording(recording, folder, mcap=mcap)


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
