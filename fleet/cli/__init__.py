"""The command line. Each command loads what it needs when it runs."""

from __future__ import annotations

import sys
from difflib import get_close_matches
from importlib import import_module
from typing import Any

import click

from fleet import __version__
from fleet.cli.exits import exits

# A command is in the file of its name.
COMMANDS = {
    "check": "Check a results folder, or a protocol or metric of yours.",
    "energy": "Test Eq. (1), energy linear in distance, against motion.",
    "export": "Write the tables of a recording, or a run's trips as logs of robots.",
    "list": "All that a scenario can name, with its sources.",
    "paper": "Reproduce the paper: its figures, tables and claims.",
    "picture": "Draw a moment of a recording, or a clip of it.",
    "replay": "Run one run of a study again, from its key.",
    "report": "Write the figures and tables of a study as a page.",
    "run": "Play one run and print its summary.",
    "schema": "Print what may stand in a scenario or study file, for editors.",
    "sweep": "Run a study: every combination with every seed.",
    "verify": "Check a study's bundle, and run a sample of its runs again.",
    "view": "Open recordings in the Rerun viewer.",
}


class LazyGroup(click.Group):
    """Commands that are imported only when they are called, or asked for their own help."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run a command, and end as :mod:`fleet.cli.exits` says."""
        with exits():
            code = super().main(*args, **extra | {"standalone_mode": False})
        sys.exit(code if isinstance(code, int) else 0)

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All command names, in order."""
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command:
        """The command of that name; a near one is suggested if there is none."""
        if name not in COMMANDS:
            near = get_close_matches(name, COMMANDS, 1, 0.5)
            hint = f" Did you mean {near[0]!r}?" if near else ""
            ctx.fail(f"No such command {name!r}.{hint}")
        command: click.Command = import_module(f"fleet.cli.{name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """One line a command, from the table above."""
        with formatter.section("Commands"):
            formatter.write_dl(sorted(COMMANDS.items()))


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="fleet")
def main() -> None:
    """Robot fleets that drive, talk and run out of energy."""
