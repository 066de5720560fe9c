"""How a study can end before its end."""

from __future__ import annotations

from pathlib import Path

from fleet.scenario.errors import bad


class Interrupted(KeyboardInterrupt):
    """Somebody asked the study to stop: Ctrl-C, or a SIGTERM from a batch system."""

    def __init__(self, done: int, total: int, signal: int) -> None:
        self.done = done  # runs that are kept
        self.total = total
        self.signal = signal  # the number of it
        super().__init__(f"stopped; {done} of {total} runs are done and kept")


class BrokenOff(RuntimeError):
    """What the study stands on gave way: the scheduler is gone, the disk is full."""


def busy(folder: Path, holder: str) -> Exception:
    """The refusal of a second study in a folder where one is at work."""
    who = f" ({holder})" if holder else ""
    return bad(
        "",
        f"another study{who} is at work in {str(folder)!r};"
        f" wait for it to end, or give another folder",
    )
