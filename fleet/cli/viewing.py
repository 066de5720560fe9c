"""``fleet view``: recordings in the Rerun viewer."""

from __future__ import annotations

from pathlib import Path

import click

from fleet.cli.failing import bad_input_exits


@click.command("view")
@click.argument("recordings", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--web", is_flag=True, help="Serve it to a browser, on this machine only.")
def command(recordings: tuple[Path, ...], web: bool) -> None:
    """Open recordings in the Rerun viewer; several are shown side by side."""
    from fleet.replay.view import view

    with bad_input_exits():
        view(recordings, web=web)
