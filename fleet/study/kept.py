"""One run of a study again, from its key alone."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fleet.observer import Observer
from fleet.results import Summary
from fleet.scenario.errors import bad, or_list
from fleet.scenario.loading import scenario_from
from fleet.scenario.model import Scenario
from fleet.study.job import PLAY
from fleet.study.ledger import Ledger, reading

SHORT = 12  # digits of a key that people are shown
UNLIKE = ("wall_time",)  # figures that differ from run to run


@dataclass(frozen=True, slots=True)
class Kept:
    """A run as its study's ledger has it."""

    key: str
    scenario: Scenario
    row: dict[str, Any] | None  # its summary; None: it is not done, or failed
    version: str  # of the program that the key belongs to
    folder: Path  # that the user's files are named from

    def play(self, observers: Sequence[Observer] = ()) -> Summary:
        """Run it again. What it raises, it raises here."""
        from fleet.assembly import run

        with chdir(self.folder if self.folder.is_dir() else Path.cwd()):
            return run(self.scenario, observers)

    def differences(self, summary: Summary) -> list[str]:
        """How a summary differs from the one that is kept: nothing, if it is the same run."""
        if self.row is None:
            return []
        now = json.loads(json.dumps(summary.as_dict()))
        names = [name for name in {**self.row, **now} if name not in UNLIKE]
        return [
            f"{name} was {self.row.get(name)!r}, is {now.get(name)!r}"
            for name in names
            if self.row.get(name) != now.get(name)
        ]


def kept_run(folder: Path, prefix: str) -> Kept:
    """The run whose key begins with ``prefix``.

    Raises:
        BadInput: there is none, or more than one, or it is no run of a scenario.
    """
    with reading(folder) as ledger:
        key = _find(ledger, folder, prefix.lower())
        job = ledger.job(key)
        if job.function != PLAY:
            raise bad("KEY", f"is of work by {job.function!r}; expected a run of a scenario")
        started_in = Path(ledger.meta().get("folder", "."))
        row, version = ledger.row(key), ledger.version(key)
    with chdir(started_in if started_in.is_dir() else Path.cwd()):
        return Kept(key, scenario_from(job.scenario), row, version, started_in)


def _find(ledger: Ledger, folder: Path, prefix: str) -> str:
    found = ledger.find(prefix) if prefix else []
    if len(found) == 1:
        return found[0]
    if found:
        raise bad("KEY", f"{prefix!r} begins several keys: {_named(found)}; expected more of it")
    near: list[str] = []
    for length in range(len(prefix) - 1, 0, -1):
        near = ledger.find(prefix[:length])
        if near:
            break
    hint = f"; did you mean {or_list(key[:SHORT] for key in near[:3])}?" if near else ""
    raise bad("KEY", f"no run in {str(folder)!r} has a key that begins with {prefix!r}{hint}")


def _named(keys: Sequence[str]) -> str:
    return ", ".join(key[:SHORT] for key in keys[:5]) + (" …" if len(keys) > 5 else "")
