"""How a command ends: bad input with clear sentences and exit code 2, never with a traceback."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from fleet.scenario.errors import BadInput, shortened

BAD_INPUT = 2
INTERRUPTED = 130
MOST_SAID = 480  # characters of all sentences together; what is more is counted
MOST_LINE = 300  # characters of one sentence
NO_NUMBER = re.compile(r"^(.*) is not a valid (integer|float)\b.*$")


@contextmanager
def exits() -> Iterator[None]:
    """Turn how a command ends into what is said of it, and its exit code.

    What the user can mend has exit code 2, Ctrl-C 130, what the machine does not let us do 1.
    Anything else is our own failure, and is not hidden.
    """
    try:
        yield
    except click.ClickException as error:
        say(shortened(_said(error), MOST_LINE))
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        say("interrupted")
        sys.exit(INTERRUPTED)
    except Exception as error:
        code = _code(error)
        if code is None:
            raise
        for line in told(str(error).splitlines()):
            say(line)
        sys.exit(code)


def _said(error: click.ClickException) -> str:
    """What click found, in the project's words."""
    message = error.format_message().removesuffix(".")
    context = getattr(error, "ctx", None)
    missing = isinstance(error, click.MissingParameter)
    if isinstance(error, click.BadParameter) and error.param is not None and not missing:
        name = error.param.opts[0]
        said = NO_NUMBER.sub(r"is \1; expected a \2", error.message).replace(
            "integer", "whole number"
        )
        return f"{name if name.startswith('-') else name.upper()}: {said}"
    if context is None or message.endswith("?"):
        return message
    return f"{message}; see {context.command_path} --help"


def _code(error: Exception) -> int | None:
    """The exit code of what a command raised; None: it is our own failure."""
    from fleet.replay.failures import CannotRecord
    from worlds.arena import ImpossibleWorld

    if isinstance(error, BadInput | ImpossibleWorld):
        return BAD_INPUT
    return 1 if isinstance(error, CannotRecord) else None


def told(sentences: list[str]) -> Iterator[str]:
    """The sentences, no longer than can be read; how many more there are."""
    room = MOST_SAID
    for number, sentence in enumerate(sentences):
        line = shortened(sentence, MOST_LINE)
        room -= len(line)
        if number and room < 0:
            yield f"and {len(sentences) - number} more"
            return
        yield line


def say(text: str) -> None:
    """A line on standard error."""
    click.echo(f"fleet: {text}", err=True)


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
