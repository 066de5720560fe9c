"""Commands that run studies: their progress, their exit codes, and how to go on after them.

0: all runs are done. 1: the study is through, but some runs failed. 2: bad input. 3: the disk
is full, or the scheduler is lost. 130: Ctrl-C. 143: SIGTERM. After 3, 130 and 143 the same
command goes on where it stopped.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from fleet.cli.exits import program, say

if TYPE_CHECKING:
    from fleet.study.ledger import Counts, Failure
    from fleet.study.result import StudyResult

SOME_FAILED = 1
BROKEN_OFF = 3
MOST_NAMED = 10  # reasons that are named


@contextmanager
def resumable() -> Iterator[None]:
    """Exit with what is kept and how to go on, when a study ends before its end."""
    from fleet.study.endings import BrokenOff, Interrupted

    try:
        yield
    except Interrupted as stopped:
        say(f"{stopped}; to go on:  {this_command()}")
        sys.exit(128 + stopped.signal)
    except BrokenOff as broken:
        say(f"{broken}; what is done is kept; run the same command to go on:  {this_command()}")
        sys.exit(BROKEN_OFF)


@contextmanager
def progress(title: str) -> Iterator[Callable[[Counts], None]]:
    """A bar with an estimate, on standard error, for those who watch a terminal."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    with Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(),
        TextColumn("{task.fields[failed]}"), TimeElapsedColumn(),
        TimeRemainingColumn(elapsed_when_finished=False),
        console=Console(stderr=True), transient=True,
    ) as bar:  # fmt: skip
        row = bar.add_task(title, total=None, failed="")

        def show(counts: Counts) -> None:
            settled = counts.done + counts.failed
            if bar.tasks[row].total is None:  # what an earlier call did is no measure of speed
                bar.reset(row, total=counts.total, completed=settled)
            failed = f"{counts.failed} failed" if counts.failed else ""
            bar.update(row, completed=settled, failed=failed)

        yield show


def conclude(result: StudyResult) -> None:
    """Say what there is; exit with 1 if runs failed, naming them."""
    total, done, failed = result.counts()
    report = f"{program()} report {result.folder}"
    click.echo(f"{done} of {total} runs are done, in {result.folder}. To read them:  {report}")
    if not failed:
        return
    reasons: dict[str, list[Failure]] = {}
    for failure in result.failures():
        reason = f"{failure.status}: {failure.error.strip().splitlines()[-1]}"
        reasons.setdefault(reason, []).append(failure)
    for reason, failures in list(reasons.items())[:MOST_NAMED]:
        others = f" and {len(failures) - 1} more" if len(failures) > 1 else ""
        say(f"run {failures[0].key[:12]} ({failures[0].cell}){others} {reason}")
    say(f"{failed} of {total} runs failed; the report has them all, with their tracebacks")
    sys.exit(SOME_FAILED)


def this_command() -> str:
    """The command that was given, to be given again."""
    return f"{program()} {shlex.join(sys.argv[1:])}"
