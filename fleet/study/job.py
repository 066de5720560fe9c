"""One piece of a study: what is to be run, and the key that its result is kept under."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias

from fleet.scenario.maps import image_of
from fleet.study.version import program_version, source_digest

PLAY = "fleet.study.play:play"
"""The work function of a study: play the scenario, give its summary."""

Status: TypeAlias = Literal["done", "raised", "killed"]

FILE_NAME = re.compile(r'"([^"]+\.(?:csv|json|npy|py|toml|txt|ya?ml))(?::\w+)?"')


@dataclass(frozen=True, slots=True)
class Job:
    """One run of a study. Make it with :meth:`of`, which finds the key.

    ``function`` is the import path, ``module:name``, of what is called with the job in a
    worker process. It returns a row: a dict of numbers and text. Under the key ``tables`` there
    may be tables of its own, lists of such rows by name.
    """

    key: str  # sha256, 64 hexadecimal digits
    scenario: dict[str, Any]  # for the work function; of plain values, as JSON has them
    cell: str = ""  # what it belongs to: runs of one cell differ only in their seed
    labels: dict[str, Any] = field(default_factory=dict)  # columns beside those of the row
    tables: tuple[str, ...] = ()  # tables asked for besides the row
    function: str = PLAY

    @classmethod
    def of(
        cls,
        scenario: Mapping[str, Any],
        *,
        cell: str = "",
        labels: Mapping[str, Any] | None = None,
        tables: tuple[str, ...] = (),
        function: str = PLAY,
    ) -> Job:
        """A job with the key that belongs to what it runs.

        The key is a sha256 of the scenario with its keys in order, of the files that it names,
        of the work function and of the program version. ``cell`` and ``labels`` are no part of
        it: one run may stand in several cells.

        Raises:
            ModuleNotFoundError: the work function's module is not there.
            TypeError: the scenario holds something that JSON does not.
        """
        described = dict(scenario)
        text = canonical(described)
        made_by: dict[str, Any] = {"version": program_version()}
        if files := dict(file_digests(text)):
            made_by["files"] = files
        if tables:
            made_by["tables"] = sorted(tables)
        if function != PLAY:
            made_by["function"] = [function, source_digest(function.partition(":")[0])]
        key = hashlib.sha256(f"{text}\n{canonical(made_by)}".encode()).hexdigest()
        return cls(key, described, cell, dict(labels or {}), tables, function)


class Outcome(NamedTuple):
    """What became of a job."""

    key: str
    status: Status
    row: str  # JSON object; empty unless done
    tables: dict[str, bytes]  # Arrow streams
    error: str  # a traceback, or how the worker died; empty if done
    attempts: int
    seconds: float  # in the worker


canonical = json.JSONEncoder(sort_keys=True, separators=(",", ":")).encode
"""A value as JSON that is the same text for the same value."""


def file_digests(scenario: str) -> Iterator[tuple[str, str]]:
    """The files of the user's that a scenario, as JSON, names; each with a sha256 of its bytes.

    A map is two files: the image that a YAML file names counts too.
    """
    for quoted in FILE_NAME.findall(scenario):
        path = Path(json.loads(f'"{quoted}"'))
        named = [path]
        if path.suffix in {".yaml", ".yml"}:
            named.append(image_of(path, "world.file"))
        for file in named:
            if file.is_file():
                yield str(file), _file_digest(file, file.stat().st_mtime_ns)


@lru_cache(64)
def _file_digest(path: Path, _modified: int) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
