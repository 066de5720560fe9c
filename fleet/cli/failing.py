"""Bad input ends with one clear sentence and exit code 2, never with a traceback."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click

from fleet.replay.errors import CannotRecord
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
