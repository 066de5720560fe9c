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
from fleet.study.inputs import changed, code_named
from fleet.study.job import PLAY
from fleet.study.ledger import Ledger, reading
from fleet.study.trust import unnamed
from fleet.study.version import libraries, program_version

SHORT = 12  # digits of a key that people are shown
UNLIKE = ("wall_time",)  # figures that differ from run to run


@dataclass(frozen=True, slots=True)
class Kept:
    """A run as its study's ledger has it."""

    key: str
    scenario: Scenario
    row: dict[str, Any] | None  # its summary; None: it is not done, or failed
    made_by: dict[str, Any]  # what it depends on besides: fleet.study.inputs.made_by
    folder: Path  # that the user's files are named from

    def play(self, observers: Sequence[Observer] = ()) -> Summary:
        """Run it again. What it raises, it raises here."""
        from fleet.assembly import run

        with chdir(self.folder if self.folder.is_dir() else Path.cwd()):
            return run(self.scenario, observers)

    def changes(self) -> list[str]:
        """What is not as it was when the run was made: program, libraries, files."""
        now = {"program": program_version(), **libraries()}
        then = {"program": self.made_by["version"], **self.made_by["libraries"]}
        found = [
            f"{name} was {then[name]}, is {now.get(name, 'not there')}"
            for name in then
            if then[name] != now.get(name)
        ]
        with chdir(self.folder if self.folder.is_dir() else Path.cwd()):
            return found + [f"{name} has changed since" for name in changed(self.made_by)]

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


def kept_run(
    folder: Path, prefix: str, *, trust: bool = False, named_from: Path | None = None
) -> Kept:
    """The run whose key begins with ``prefix``.

    Files are named from where the study was started, or ``named_from``.

    A folder is data: Python files that it names are run only if this user has swept with the same
    files at the same paths, or if ``trust`` is given.

    Raises:
        BadInput: there is none, or more than one, or it is no run of a scenario, or it needs
            code that the user has not named.
    """
    with reading(folder) as ledger:
        key = _find(ledger, folder, prefix.lower())
        job = ledger.job(key)
        if job.function != PLAY:
            raise bad("KEY", f"is of work by {job.function!r}; expected a run of a scenario")
        started_in = named_from or Path(ledger.meta().get("folder", "."))
        row = ledger.row(key)
    with chdir(started_in if started_in.is_dir() else Path.cwd()):
        named = code_named(job.made_by).items()
        strange = unnamed((Path(name).resolve(), digest) for name, digest in named)
        if strange and not trust:
            files = ", ".join(map(str, strange))
            raise bad(
                "KEY",
                f"run {key[:SHORT]} runs {files}, which you have not swept with as it was then;"
                f" look at it, and give --trust to run it",
            )
        return Kept(key, scenario_from(job.scenario), row, job.made_by, started_in)


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
