"""The one record of what has been done: a SQLite file with one writer and any number of readers.

``job`` holds what was ever asked for, ``origin`` what that depends on besides its scenario,
``run`` what became of it, ``side`` the tables that came with it, and ``plan`` which jobs the
study as it stands is made of, in order. A row of ``run`` is written once, in a transaction that is
on the disk before anybody is told of it. Whatever is read is held against its checksum; a job's is
its key.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from functools import cache
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from fleet.scenario.errors import BadInput, bad
from fleet.study.inputs import code_named
from fleet.study.job import Job, Status, checksum, key_of

NAME = "ledger.sqlite"
FORMAT = 2
SCHEMA = """
CREATE TABLE IF NOT EXISTS origin(number INTEGER PRIMARY KEY, made_by TEXT NOT NULL UNIQUE);
CREATE TABLE IF NOT EXISTS job(
    key TEXT PRIMARY KEY, scenario TEXT NOT NULL, tables TEXT NOT NULL, function TEXT NOT NULL,
    origin INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS plan(
    position INTEGER PRIMARY KEY, key TEXT NOT NULL, cell TEXT NOT NULL, labels TEXT NOT NULL,
    checksum TEXT NOT NULL);
CREATE INDEX IF NOT EXISTS plan_key ON plan(key);
CREATE TABLE IF NOT EXISTS run(
    key TEXT PRIMARY KEY, status TEXT NOT NULL, row TEXT NOT NULL, error TEXT NOT NULL,
    attempts INTEGER NOT NULL, seconds REAL NOT NULL, checksum TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS side(
    key TEXT NOT NULL, name TEXT NOT NULL, stream BLOB NOT NULL, checksum TEXT NOT NULL,
    PRIMARY KEY(key, name));
CREATE TABLE IF NOT EXISTS meta(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
"""
REVISION, IDENTITY = "revision", "identity"  # in meta: see Ledger.stamp


class Counts(NamedTuple):
    """How far a study is. A run that stands in several cells counts once."""

    total: int
    done: int
    failed: int  # raised, or killed its worker

    @property
    def left(self) -> int:
        """What nobody has run yet."""
        return self.total - self.done - self.failed


class Failure(NamedTuple):
    """A job that came to nothing."""

    key: str
    cell: str
    status: Status
    error: str
    scenario: dict[str, Any]


class Origin(NamedTuple):
    """What a job depends on besides its scenario."""

    text: str  # JSON of fleet.study.inputs.made_by
    version: str  # of the program
    libraries: str  # with their versions


class Ledger:
    """The record of one folder, read."""

    def __init__(self, database: sqlite3.Connection, path: Path) -> None:
        self._database = database
        self._path = path
        self._origin = cache(self._read_origin)

    def counts(self) -> Counts:
        """How many runs are planned, and how many of them came to what."""
        total, done, failed = self._database.execute(
            "SELECT count(*), total(status = 'done'), total(status <> 'done')"
            " FROM (SELECT DISTINCT key FROM plan) LEFT JOIN run USING (key)"
        ).fetchone()
        return Counts(total, int(done), int(failed))

    def seconds(self) -> float:
        """The time that the planned runs took in their workers, summed [s]."""
        (seconds,) = self._database.execute(
            "SELECT total(seconds) FROM run WHERE key IN (SELECT key FROM plan)"
        ).fetchone()
        return float(seconds)

    def meta(self) -> dict[str, Any]:
        """What is known of the study as a whole."""
        found = self._database.execute("SELECT name, value FROM meta")
        return {name: self._parsed(value, f"the entry {name!r}") for name, value in found}

    def stamp(self) -> str:
        """What tables are made from: another text whenever the plan or a run is another."""
        meta = self.meta()
        return f"{meta.get(IDENTITY)}:{meta.get(REVISION, 0)}"

    def failures(self) -> list[Failure]:
        """The planned jobs that came to nothing, in the order of the plan."""
        found = self._database.execute(
            "SELECT key, min(cell), status, error, scenario FROM plan"
            " JOIN run USING (key) JOIN job USING (key)"
            " WHERE status <> 'done' GROUP BY key ORDER BY min(position)"
        )
        return [
            Failure(key, cell, status, error, self._parsed(scenario, f"run {key[:12]}"))
            for key, cell, status, error, scenario in found
        ]

    def rows(self) -> Iterator[dict[str, Any]]:
        """What was found, a row a planned run: labels over the work function's row, and more.

        A label of None says that the cell does not set the key: what the row says stands.
        ``version`` and ``libraries`` say what the run was made with.

        Raises:
            BadInput: the ledger is damaged.
        """
        found = self._database.execute(
            "SELECT key, cell, labels, plan.checksum, scenario, origin, row, error, run.checksum"
            " FROM plan JOIN run USING (key) JOIN job USING (key)"
            " WHERE status = 'done' ORDER BY position"
        )
        for key, cell, labels, planned, scenario, origin, row, error, whole in found:
            what = f"run {str(key)[:12]}"
            self._hold(planned == checksum(key, cell, labels), f"the plan of {what}")
            self._hold(whole == checksum(key, "done", row, error), what)
            made_by = self._origin(origin)
            self._hold(key == key_of(scenario, made_by.text), f"the scenario of {what}")
            yield {
                "cell": cell,
                **self._parsed(row, what),
                **_given(self._parsed(labels, what)),
                "key": key,
                "version": made_by.version,
                "libraries": made_by.libraries,
                "scenario": scenario,
            }

    def labels(self) -> list[str]:
        """The names of all labels, in the order in which they first come."""
        found = self._database.execute(
            "SELECT labels FROM plan GROUP BY cell ORDER BY min(position)"
        )
        plans = (self._parsed(labels, "the plan") for (labels,) in found)
        return list(dict.fromkeys(name for labels in plans for name in labels))

    def table_names(self) -> list[str]:
        """The tables that some planned run brought besides its row."""
        found = self._database.execute(
            "SELECT DISTINCT name FROM side WHERE key IN (SELECT key FROM plan) ORDER BY name"
        )
        return [name for (name,) in found]

    def streams(self, name: str) -> Iterator[tuple[str, str, bytes]]:
        """Cell, labels (JSON) and Arrow stream of a table, for each planned run that has it."""
        found = self._database.execute(
            "SELECT cell, json_set(labels, '$.key', key), stream, key, side.checksum FROM plan"
            " JOIN side USING (key) JOIN run USING (key)"
            " WHERE name = ? AND status = 'done' ORDER BY position",
            (name,),
        )
        for cell, labels, stream, key, whole in found:
            what = f"the table {name!r} of run {str(key)[:12]}"
            self._hold(whole == checksum(key, name, stream), what)
            yield cell, labels, stream

    def find(self, prefix: str) -> list[str]:
        """The keys, in the plan or not, that begin with ``prefix``; ten at most."""
        end = prefix + "g"  # after every hexadecimal digit
        found = self._database.execute(
            "SELECT key FROM job WHERE key >= ? AND key < ? ORDER BY key LIMIT 10", (prefix, end)
        )
        return [key for (key,) in found]

    def keys(self) -> list[str]:
        """All keys, in the plan or not."""
        return [key for (key,) in self._database.execute("SELECT key FROM job ORDER BY key")]

    def places(self) -> Iterator[tuple[str, str]]:
        """The key and the cell of each planned run, in order."""
        yield from self._database.execute("SELECT key, cell FROM plan ORDER BY position")

    def done_by(self, function: str) -> list[str]:
        """The keys of the planned runs of that work function that are done, in order."""
        found = self._database.execute(
            "SELECT key FROM plan JOIN run USING (key) JOIN job USING (key)"
            " WHERE status = 'done' AND function = ? GROUP BY key ORDER BY min(position)",
            (function,),
        )
        return [key for (key,) in found]

    def origins(self) -> list[dict[str, Any]]:
        """What planned runs depend on besides their scenarios, each once."""
        found = self._database.execute(
            "SELECT DISTINCT origin FROM plan JOIN job USING (key) ORDER BY origin"
        ).fetchall()
        return [self._parsed(self._origin(number).text, f"origin {number}") for (number,) in found]

    def job(self, key: str) -> Job:
        """What is run under a key: the very job that the key was made of.

        Raises:
            BadInput: what is kept under the key is another job.
        """
        scenario, tables, function, origin = self._database.execute(
            "SELECT scenario, tables, function, origin FROM job WHERE key = ?", (key,)
        ).fetchone()
        made_by = self._origin(origin)
        what = f"the job of run {key[:12]}"
        job = Job(
            key,
            self._parsed(scenario, what),
            tables=tuple(self._parsed(tables, what)),
            function=function,
            origin=made_by.text,
        )
        named = job.made_by
        self._hold(
            key == key_of(scenario, made_by.text)
            and named["function"][0] == function
            and named.get("tables", []) == sorted(job.tables),
            what,
        )
        return job

    def row(self, key: str) -> dict[str, Any] | None:
        """What a run gave; None: it is not done."""
        found = self._database.execute(
            "SELECT row, error, checksum FROM run WHERE key = ? AND status = 'done'", (key,)
        ).fetchone()
        if found is None:
            return None
        text, error, whole = found
        self._hold(whole == checksum(key, "done", text, error), f"run {key[:12]}")
        row: dict[str, Any] = self._parsed(text, f"run {key[:12]}")
        return row

    def code(self) -> Iterator[tuple[Path, str]]:
        """The user's Python files that planned jobs run, each with the sha256 that it had."""
        for described in self.origins():
            for name, digest in code_named(described).items():
                yield Path(name), digest

    def faults(self) -> Iterator[str]:
        """What is wrong with the file as SQLite sees it, and with any run, in the plan or not."""
        for (said,) in self._database.execute("PRAGMA integrity_check"):
            if said != "ok":
                yield f"{str(self._path)!r} is damaged: {said}"
        for key, *parts, whole in self._database.execute(
            "SELECT key, status, row, error, checksum FROM run ORDER BY key"
        ):
            if whole != checksum(key, *map(str, parts)):
                yield str(self._damage(f"run {key[:12]}"))

    def _read_origin(self, number: int) -> Origin:
        found = self._database.execute(
            "SELECT made_by FROM origin WHERE number = ?", (number,)
        ).fetchone()
        self._hold(found is not None, f"origin {number}")
        described = self._parsed(found[0], f"origin {number}")
        versions = described.get("libraries", {}).items()
        return Origin(
            found[0],
            str(described.get("version", "")),
            ", ".join(f"{name} {version}" for name, version in versions),
        )

    def _parsed(self, text: str, what: str) -> Any:
        try:
            return json.loads(text)
        except (ValueError, TypeError):
            raise self._damage(what) from None

    def _hold(self, good: bool, what: str) -> None:
        if not good:
            raise self._damage(what)

    def _damage(self, what: str) -> BadInput:
        return bad("", f"{str(self._path)!r} is damaged: {what} is not as it was written")


@contextmanager
def reading(folder: Path) -> Iterator[Ledger]:
    """The folder's ledger as it stands, also while a study is writing it.

    Nothing is written to the folder: what a kill left half done is put right in a copy.

    Raises:
        BadInput: there is none, or it is damaged.
    """
    path = folder / NAME
    if not path.is_file():
        raise bad("", f"{str(folder)!r} holds no study; expected a folder that a sweep wrote to")
    with ExitStack() as stack:
        try:
            try:
                database = stack.enter_context(closing(_view(path, "ro")))
            except sqlite3.OperationalError as error:
                if error.sqlite_errorcode & 0xFF not in UNMENDED:
                    raise
                copy = _copy(path, Path(stack.enter_context(TemporaryDirectory(prefix="fleet-"))))
                database = stack.enter_context(closing(_view(copy, "rw")))
            check_format(database, folder)
            yield Ledger(database, path)
        except sqlite3.DatabaseError as error:
            raise unread(folder, error) from error


UNMENDED = (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN)
"""How SQLite says that it would have to write before it can read."""


def _view(path: Path, mode: str) -> sqlite3.Connection:
    """One view of a ledger, while others go on writing it."""
    database = sqlite3.connect(
        f"{path.resolve().as_uri()}?mode={mode}", uri=True, timeout=10.0, isolation_level=None
    )
    try:
        database.execute("BEGIN")
        database.execute("SELECT count(*) FROM sqlite_schema").fetchone()  # the view begins here
    except BaseException:
        database.close()
        raise
    return database


def _copy(path: Path, folder: Path) -> Path:
    """A copy of a ledger with what SQLite needs to put it right."""
    for suffix in ("", "-wal", "-journal"):
        part = path.with_name(path.name + suffix)
        if part.exists():
            copyfile(part, folder / part.name)
    return folder / path.name


def _given(labels: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in labels.items() if value is not None}


def check_format(database: sqlite3.Connection, folder: Path) -> None:
    """See that a ledger is of this program's format.

    Raises:
        BadInput: it is of another one.
    """
    (version,) = database.execute("PRAGMA user_version").fetchone()
    if version != FORMAT:
        raise bad("", f"{str(folder / NAME)!r} is of format {version}; expected {FORMAT}")


def unread(folder: Path, error: sqlite3.Error) -> BadInput:
    """What is said of a ledger that SQLite cannot read."""
    return bad("", f"{str(folder / NAME)!r} cannot be read: {error}")
