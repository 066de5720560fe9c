"""The one record of what has been done: a SQLite file with one writer and any number of readers.

``job`` holds what was ever asked for, ``run`` what became of it, ``side`` the tables that came
with it, and ``plan`` which jobs the study as it stands is made of, in order. A row of ``run``
is written once, in a transaction that is on the disk before anybody is told of it.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from fleet.scenario.errors import BadInput, bad
from fleet.study.endings import BrokenOff
from fleet.study.job import Job, Outcome, Status, canonical
from fleet.study.lock import sole

NAME = "ledger.sqlite"
FORMAT = 1
SCHEMA = """
CREATE TABLE IF NOT EXISTS job(
    key TEXT PRIMARY KEY, scenario TEXT NOT NULL, tables TEXT NOT NULL, function TEXT NOT NULL,
    version TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS plan(
    position INTEGER PRIMARY KEY, key TEXT NOT NULL, cell TEXT NOT NULL, labels TEXT NOT NULL);
CREATE INDEX IF NOT EXISTS plan_key ON plan(key);
CREATE TABLE IF NOT EXISTS run(
    key TEXT PRIMARY KEY, status TEXT NOT NULL, row TEXT NOT NULL, error TEXT NOT NULL,
    attempts INTEGER NOT NULL, seconds REAL NOT NULL);
CREATE TABLE IF NOT EXISTS side(
    key TEXT NOT NULL, name TEXT NOT NULL, stream BLOB NOT NULL, PRIMARY KEY(key, name));
CREATE TABLE IF NOT EXISTS meta(name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
"""


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


class Ledger:
    """The record of one folder, read."""

    def __init__(self, database: sqlite3.Connection) -> None:
        self._database = database

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
        return {n: json.loads(v) for n, v in self._database.execute("SELECT * FROM meta")}

    def failures(self) -> list[Failure]:
        """The planned jobs that came to nothing, in the order of the plan."""
        found = self._database.execute(
            "SELECT key, min(cell), status, error, scenario FROM plan"
            " JOIN run USING (key) JOIN job USING (key)"
            " WHERE status <> 'done' GROUP BY key ORDER BY min(position)"
        )
        return [
            Failure(key, cell, status, error, json.loads(scenario))
            for key, cell, status, error, scenario in found
        ]

    def rows(self) -> Iterator[dict[str, Any]]:
        """What was found, a row a planned run: labels over the work function's row, and more.

        A label of None says that the cell does not set the key: what the row says stands.
        """
        found = self._database.execute(
            "SELECT cell, labels, row, key, version, scenario FROM plan"
            " JOIN run USING (key) JOIN job USING (key) WHERE status = 'done' ORDER BY position"
        )
        for cell, labels, row, key, version, scenario in found:
            yield {
                "cell": cell, **json.loads(row), **_given(json.loads(labels)),
                "key": key, "version": version, "scenario": scenario,
            }  # fmt: skip

    def labels(self) -> list[str]:
        """The names of all labels, in the order in which they first come."""
        found = self._database.execute(
            "SELECT labels FROM plan GROUP BY cell ORDER BY min(position)"
        )
        return list(dict.fromkeys(name for (labels,) in found for name in json.loads(labels)))

    def table_names(self) -> list[str]:
        """The tables that some planned run brought besides its row."""
        found = self._database.execute(
            "SELECT DISTINCT name FROM side WHERE key IN (SELECT key FROM plan) ORDER BY name"
        )
        return [name for (name,) in found]

    def streams(self, name: str) -> Iterator[tuple[str, str, bytes]]:
        """Cell, labels (JSON) and Arrow stream of a table, for each planned run that has it."""
        yield from self._database.execute(
            "SELECT cell, json_set(labels, '$.key', key), stream FROM plan JOIN side USING (key)"
            " JOIN run USING (key) WHERE name = ? AND status = 'done' ORDER BY position",
            (name,),
        )

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

    def job(self, key: str) -> Job:
        """What is run under a key."""
        scenario, tables, function = self._database.execute(
            "SELECT scenario, tables, function FROM job WHERE key = ?", (key,)
        ).fetchone()
        return Job(key, json.loads(scenario), tables=tuple(json.loads(tables)), function=function)

    def version(self, key: str) -> str:
        """The program version that a key belongs to."""
        (version,) = self._database.execute(
            "SELECT version FROM job WHERE key = ?", (key,)
        ).fetchone()
        return str(version)

    def row(self, key: str) -> dict[str, Any] | None:
        """What a run gave; None: it is not done."""
        found = self._database.execute(
            "SELECT row FROM run WHERE key = ? AND status = 'done'", (key,)
        ).fetchone()
        row: dict[str, Any] | None = json.loads(found[0]) if found else None
        return row


class OpenLedger(Ledger):
    """The record of one folder, written to."""

    def plan(self, jobs: Iterable[Job], version: str) -> bool:
        """Make ``jobs`` what the study is made of; whether that changes anything.

        What was done before is kept. A job that comes twice in one cell counts once.
        """
        database, before = self._database, self._database.total_changes
        with self._transaction():
            for job in self._from_first_change(_distinct(jobs)):
                database.execute(
                    "INSERT OR IGNORE INTO job VALUES (?, ?, ?, ?, ?)",
                    (
                        job.key, canonical(job.scenario), canonical(job.tables),
                        job.function, version,
                    ),
                )  # fmt: skip
                database.execute(
                    "INSERT INTO plan(key, cell, labels) VALUES (?, ?, ?)",
                    (job.key, job.cell, json.dumps(job.labels)),
                )
        return database.total_changes > before

    def _from_first_change(self, jobs: Iterable[Job]) -> Iterator[Job]:
        """The jobs from the first one that is not in its place; the plan is cut off there."""
        planned = self._database.execute("SELECT key, cell, labels FROM plan ORDER BY position")
        same, unchanged = 0, True
        for job in jobs:
            place = (job.key, job.cell, json.dumps(job.labels))
            if unchanged and planned.fetchone() == place:
                same += 1
                continue
            if unchanged:
                unchanged = False
                self._cut(same)
            yield job
        if unchanged:
            self._cut(same)

    def _cut(self, length: int) -> None:
        self._database.execute("DELETE FROM plan WHERE position > ?", (length,))

    def describe(self, meta: Mapping[str, Any]) -> None:
        """Write down what is known of the study as a whole."""
        with self._transaction():
            self._database.executemany(
                "INSERT OR REPLACE INTO meta VALUES (?, ?)",
                [(name, json.dumps(value)) for name, value in meta.items()],
            )

    def aside(self, version: str) -> tuple[int, int]:
        """Runs that are done but not in the plan: of this program version, and of others."""
        same, others = self._database.execute(
            "SELECT total(version = ?), total(version <> ?) FROM run JOIN job USING (key)"
            " WHERE status = 'done' AND key NOT IN (SELECT key FROM plan)",
            (version, version),
        ).fetchone()
        return int(same), int(others)

    def todo(self, *, retry: bool = False) -> list[str]:
        """The keys of the plan that are to be run, in order; with the failed ones to ``retry``."""
        settled = "status = 'done'" if retry else "status IS NOT NULL"
        found = self._database.execute(
            f"SELECT key FROM plan LEFT JOIN run USING (key) WHERE NOT coalesce({settled}, 0)"  # noqa: S608  # one of the two texts above
            " GROUP BY key ORDER BY min(position)"
        )
        return [key for (key,) in found]

    def record(self, outcomes: Iterable[Outcome]) -> None:
        """Write outcomes down, all or none; what is done already stays as it is."""
        with self._transaction():
            for o in outcomes:
                written = self._database.execute(
                    "INSERT INTO run VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT(key) DO UPDATE SET"
                    " status = excluded.status, row = excluded.row, error = excluded.error,"
                    " attempts = excluded.attempts, seconds = excluded.seconds"
                    " WHERE run.status <> 'done'",
                    (o.key, o.status, o.row, o.error, o.attempts, o.seconds),
                )
                if written.rowcount:
                    self._database.executemany(
                        "INSERT OR REPLACE INTO side VALUES (?, ?, ?)",
                        [(o.key, name, stream) for name, stream in o.tables.items()],
                    )

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        """All of it on the disk at the end, or nothing of it.

        Raises:
            BrokenOff: the disk is full, or fails.
        """
        try:
            self._database.execute("BEGIN IMMEDIATE")
            yield
            self._database.execute("COMMIT")
        except BaseException as error:
            with suppress(sqlite3.Error):  # a full disk has ended the transaction by itself
                self._database.execute("ROLLBACK")
            if isinstance(error, sqlite3.OperationalError) and not _is_ours(error):
                raise _unwritten(error) from error
            raise


@contextmanager
def writing(folder: Path) -> Iterator[OpenLedger]:
    """The folder's ledger, made if need be, for this process alone to write.

    Raises:
        BadInput: the folder cannot be used, or another process is at work in it.
        BrokenOff: the disk is full, or fails.
    """
    with ExitStack() as stack:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            stack.enter_context(sole(folder))
        except OSError as error:
            raise bad("", f"{str(folder)!r} cannot be used: {error.strerror}") from error
        database = sqlite3.connect(folder / NAME, isolation_level=None, timeout=10.0)
        stack.callback(_close, database)
        try:
            database.execute("PRAGMA journal_mode = WAL")
            database.execute("PRAGMA synchronous = FULL")
            database.execute("PRAGMA cache_size = -65536")  # KiB
            if _is_new(database):
                database.executescript(f"{SCHEMA} PRAGMA user_version = {FORMAT};")
            _check_format(database, folder)
        except sqlite3.OperationalError as error:
            raise _unwritten(error) from error
        except sqlite3.DatabaseError as error:
            raise _unread(folder, error) from error
        yield OpenLedger(database)


@contextmanager
def reading(folder: Path) -> Iterator[Ledger]:
    """The folder's ledger as it stands, also while a study is writing it.

    Raises:
        BadInput: there is none.
    """
    path = folder / NAME
    if not path.is_file():
        raise bad("", f"{str(folder)!r} holds no study; expected a folder that a sweep wrote to")
    with closing(_open_read_only(path)) as database:
        try:
            database.execute("BEGIN")  # one view of it, while others go on writing
            _check_format(database, folder)
        except sqlite3.DatabaseError as error:
            raise _unread(folder, error) from error
        yield Ledger(database)


def _open_read_only(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=10.0)


def _close(database: sqlite3.Connection) -> None:
    with suppress(sqlite3.DatabaseError):  # somebody is reading it, or it is beyond repair
        database.execute("PRAGMA journal_mode = DELETE")  # one file, to be copied about
    database.close()


def _distinct(jobs: Iterable[Job]) -> Iterator[Job]:
    seen = set()
    for job in jobs:
        if (job.key, job.cell) not in seen:
            seen.add((job.key, job.cell))
            yield job


def _given(labels: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in labels.items() if value is not None}


def _check_format(database: sqlite3.Connection, folder: Path) -> None:
    (version,) = database.execute("PRAGMA user_version").fetchone()
    if version != FORMAT:
        raise bad("", f"{str(folder / NAME)!r} is of format {version}; expected {FORMAT}")


def _is_new(database: sqlite3.Connection) -> bool:
    """Whether nothing has been written to it, or not all of its tables."""
    (version,) = database.execute("PRAGMA user_version").fetchone()
    return bool(version == 0)


def _is_ours(error: sqlite3.OperationalError) -> bool:
    """Whether it is a mistake in this file, rather than trouble with the disk."""
    return error.sqlite_errorcode & 0xFF == sqlite3.SQLITE_ERROR


def _unwritten(error: sqlite3.Error) -> BrokenOff:
    return BrokenOff(f"the ledger cannot be written: {error}")


def _unread(folder: Path, error: sqlite3.Error) -> BadInput:
    return bad("", f"{str(folder / NAME)!r} cannot be read: {error}")
