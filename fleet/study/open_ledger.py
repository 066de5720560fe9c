"""The ledger as its one writer has it."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any
from uuid import uuid4

from fleet.scenario.errors import bad
from fleet.study.endings import BrokenOff
from fleet.study.job import Job, Outcome, canonical, checksum
from fleet.study.ledger import (
    FORMAT,
    IDENTITY,
    NAME,
    REVISION,
    SCHEMA,
    Ledger,
    check_format,
    unread,
)
from fleet.study.lock import sole


class OpenLedger(Ledger):
    """The record of one folder, written to."""

    def plan(self, jobs: Iterable[Job]) -> None:
        """Make ``jobs`` what the study is made of.

        What was done before is kept. A job that comes twice in one cell counts once.
        """
        before = self._database.total_changes
        with self._transaction():
            for job in self._from_first_change(_distinct(jobs)):
                self._add(job)
            if self._database.total_changes > before:
                self._revise()

    def _add(self, job: Job) -> None:
        """Put a job at the end of the plan."""
        self._database.execute("INSERT OR IGNORE INTO origin(made_by) VALUES (?)", (job.origin,))
        self._database.execute(
            "INSERT OR REPLACE INTO job SELECT ?, ?, ?, ?, number FROM origin WHERE made_by = ?",
            (job.key, canonical(job.scenario), canonical(job.tables), job.function, job.origin),
        )
        labels = json.dumps(job.labels)
        self._database.execute(
            "INSERT INTO plan(key, cell, labels, checksum) VALUES (?, ?, ?, ?)",
            (job.key, job.cell, labels, checksum(job.key, job.cell, labels)),
        )

    def _revise(self) -> None:
        """What tables were made from is no longer what there is."""
        self._database.execute(
            "INSERT INTO meta VALUES (?, 1)"
            " ON CONFLICT(name) DO UPDATE SET value = CAST(value AS INTEGER) + 1",
            (REVISION,),
        )

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
            "SELECT total(version = ?1), total(version <> ?1) FROM"
            " (SELECT json_extract(made_by, '$.version') version FROM run JOIN job USING (key)"
            " JOIN origin ON number = origin"
            " WHERE status = 'done' AND key NOT IN (SELECT key FROM plan))",
            (version,),
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
                    "INSERT INTO run VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT(key) DO UPDATE SET"
                    " status = excluded.status, row = excluded.row, error = excluded.error,"
                    " attempts = excluded.attempts, seconds = excluded.seconds,"
                    " checksum = excluded.checksum WHERE run.status <> 'done'",
                    (
                        o.key, o.status, o.row, o.error, o.attempts, o.seconds,
                        checksum(o.key, o.status, o.row, o.error),
                    ),
                )  # fmt: skip
                if written.rowcount:
                    self._database.executemany(
                        "INSERT OR REPLACE INTO side VALUES (?, ?, ?, ?)",
                        [
                            (o.key, name, stream, checksum(o.key, name, stream))
                            for name, stream in o.tables.items()
                        ],
                    )
            self._revise()

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
                database.execute(
                    "INSERT OR IGNORE INTO meta VALUES (?, ?)", (IDENTITY, json.dumps(uuid4().hex))
                )
            check_format(database, folder)
        except sqlite3.OperationalError as error:
            raise _unwritten(error) from error
        except sqlite3.DatabaseError as error:
            raise unread(folder, error) from error
        try:
            yield OpenLedger(database, folder / NAME)
        except sqlite3.DatabaseError as error:
            raise unread(folder, error) from error


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


def _is_new(database: sqlite3.Connection) -> bool:
    """Whether nothing has been written to it, or not all of its tables."""
    (version,) = database.execute("PRAGMA user_version").fetchone()
    return bool(version == 0)


def _is_ours(error: sqlite3.OperationalError) -> bool:
    """Whether it is a mistake in this file, rather than trouble with the disk."""
    return error.sqlite_errorcode & 0xFF == sqlite3.SQLITE_ERROR


def _unwritten(error: sqlite3.Error) -> BrokenOff:
    return BrokenOff(f"the ledger cannot be written: {error}")
