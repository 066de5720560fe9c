"""``fleet view``: recordings in the Rerun viewer."""

from __future__ import annotations

from pathlib import Path

import click

TIMELINES = ("story", "sim_time", "round", "msg")


@click.command("view")
@click.argument("recordings", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--web", is_flag=True, help="Serve it to a browser, on this machine only.")
@click.option("--by", type=click.Choice(TIMELINES),
              help="The timeline to scrub by at first.  [story; several: round]")  # fmt: skip
@click.option("--event", type=click.IntRange(min=1), help="Frame this event, and play it.")
@click.option("--robot", type=click.IntRange(min=0), help="The first event this robot drove to.")
def command(
    recordings: tuple[Path, ...], web: bool, by: str | None, event: int | None, robot: int | None
) -> None:
    """Open recordings in the Rerun viewer; several are shown side by side."""
    from fleet.replay.viewer import view
    from fleet.scenario.errors import bad

    try:
        view(recordings, web=web, timeline=by, event=event, robot=robot, tell=announce)
    except ValueError as error:
        raise bad("", str(error)) from error


def announce(address: str) -> None:
    """Say where to look."""
    click.echo(f"Open {address}\nCtrl-C ends it.")
