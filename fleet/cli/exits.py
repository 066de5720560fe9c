"""Bad input ends with one clear sentence and exit code 2, never with a traceback."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from fleet.replay.failures import CannotRecord
from fleet.scenario.errors import BadInput
from worlds.arena import ImpossibleWorld

INTERRUPTED = 130


@contextmanager
def bad_input_exits() -> Iterator[None]:
    """Turn what the user can mend into exit code 2, and Ctrl-C into 130; what the machine does not
    let a recording do is said in a sentence too, with exit code 1.
    """
    try:
        yield
    except (BadInput, ImpossibleWorld) as error:
        for line in str(error).splitlines():
            click.echo(f"fleet: {line}", err=True)
        sys.exit(2)
    except CannotRecord as error:
        click.echo(f"fleet: {error}", err=True)
        sys.exit(1)
    except KeyboardInterrupt:
        click.echo("fleet: interrupted", err=True)
        sys.exit(INTERRUPTED)


def program() -> str:
    """How this program was called, for commands that are printed for the user."""
    called = Path(sys.argv[0])
    if not called.is_absolute() and called.parent != Path():
        return str(called)
    if called.name == "__main__.py":
        return f"{Path(sys.executable).name} -m fleet"
    try:
        return str(called.relative_to(Path.cwd()))
    except ValueError:
        return called.name
