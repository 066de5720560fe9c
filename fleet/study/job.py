"""One piece of a study: what is to be run, and the key that its result is kept under."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, TypeAlias

from fleet.study.inputs import made_by

PLAY = "fleet.study.play:play"
"""The work function of a study: play the scenario, give its summary."""

Status: TypeAlias = Literal["done", "raised", "killed", "overdue", "stale"]

canonical = json.JSONEncoder(sort_keys=True, separators=(",", ":")).encode
"""A value as JSON that is the same text for the same value."""


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
    origin: str = "{}"  # JSON of fleet.study.inputs.made_by: all else that the row depends on

    @classmethod
    def of(
        cls,
        scenario: Mapping[str, Any],
        *,
        cell: str = "",
        labels: Mapping[str, Any] | None = None,
        tables: tuple[str, ...] = (),
        function: str = PLAY,
        origin: str | None = None,
    ) -> Job:
        """A job with the key that belongs to what it runs.

        The key is a sha256 of the scenario with its keys in order and of everything else that
        the row depends on: see :func:`fleet.study.inputs.made_by`. ``cell`` and ``labels`` are
        no part of it: one run may stand in several cells. ``origin`` is that of a job of the same
        files, tables and function, if there is one: finding it anew reads the disk.

        Raises:
            ModuleNotFoundError: the work function's module is not there.
            TypeError: the scenario holds something that JSON does not.
        """
        described = dict(scenario)
        text = canonical(described)
        if origin is None:
            ours = function.startswith("fleet.")
            origin = canonical(made_by(described, tables, function, ours=ours))
        key = key_of(text, origin)
        return cls(key, described, cell, dict(labels or {}), tables, function, origin)

    @property
    def made_by(self) -> dict[str, Any]:
        """What the row depends on besides the scenario."""
        described: dict[str, Any] = json.loads(self.origin)
        return described


def key_of(scenario: str, origin: str) -> str:
    """The key of a job, from both as canonical JSON."""
    return hashlib.sha256(f"{scenario}\n{origin}".encode()).hexdigest()


def checksum(*parts: str | bytes) -> str:
    """A sha256 of texts and bytes, by which damage to them is seen."""
    whole = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else bytes(part)
        whole.update(f"{len(data)}\0".encode())
        whole.update(data)
    return whole.hexdigest()


class Outcome(NamedTuple):
    """What became of a job."""

    key: str
    status: Status
    row: str  # JSON object; empty unless done
    tables: dict[str, bytes]  # Arrow streams
    error: str  # a traceback, or how the worker died; empty if done
    attempts: int
    seconds: float  # in the worker
