"""Whether a results folder still holds what was written: rows, and the tables made from them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pyarrow as pa
import pyarrow.parquet as pq

from fleet.scenario.errors import BadInput
from fleet.study.ledger import Ledger, reading
from fleet.study.parquet import made_from, runs_table, side_table


class Audit(NamedTuple):
    """What was looked at, and what is wrong with it, in sentences."""

    runs: int
    tables: int
    problems: list[str]


def audit(folder: Path) -> Audit:
    """Hold each row of a folder's ledger against its checksum, and each table against the rows.

    Nothing is run, and nothing is written.

    Raises:
        BadInput: the folder holds no study, or its ledger cannot be opened.
    """
    with reading(folder) as ledger:
        problems = list(ledger.faults())
        problems += list(dict.fromkeys(_damaged_runs(ledger)))
        names = ["runs", *ledger.table_names()]
        if not problems:
            for name in names:
                problems += _differences(ledger, folder, name)
        return Audit(ledger.counts().done, len(names), problems)


def _damaged_runs(ledger: Ledger) -> Iterator[str]:
    for key in ledger.keys():  # noqa: SIM118  # a ledger is no mapping
        try:
            ledger.job(key)
        except BadInput as error:
            yield str(error)
    readers = [ledger.rows(), *map(ledger.streams, ledger.table_names())]
    for rows in readers:
        try:
            for _ in rows:
                pass
        except BadInput as error:
            yield str(error)


def _differences(ledger: Ledger, folder: Path, name: str) -> Iterator[str]:
    path = folder / f"{name}.parquet"
    again = "the same fleet sweep, or fleet report, makes it again"
    if not path.is_file():
        yield f"{str(path)!r} is not there; {again}"
        return
    if made_from(path) != ledger.stamp():
        yield f"{str(path)!r} was not made from the ledger as it stands; {again}"
        return
    expected = runs_table(ledger.rows()) if name == "runs" else side_table(ledger, name)
    try:
        found = pq.read_table(path, page_checksum_verification=True)
        same = found.equals(expected)
    except (OSError, pa.ArrowException):
        same = False
    if not same:
        yield f"{str(path)!r} is not as it was written; remove it, and {again}"
