"""From the ledger to Arrow tables and Parquet files."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import pyarrow as pa
import pyarrow.parquet as pq

from fleet.study.atomic import replacing
from fleet.study.endings import BrokenOff
from fleet.study.ledger import Ledger

T = TypeVar("T")

CHUNK = 4096  # rows that are Python objects at a time
STREAMS = 256  # runs whose side tables are in memory at a time
STAMP = b"fleet.made_from"  # in a file's metadata: the ledger's stamp


def runs_table(rows: Iterable[dict[str, Any]]) -> pa.Table:
    """One row a run; tables within a row become columns of their own: ``messages_by_kind_call``."""
    chunks = [_columns(chunk) for chunk in _batched(map(flat, rows), CHUNK)]
    if not chunks:
        return pa.table({})
    table = pa.concat_tables(chunks, promote_options="permissive")
    return table.cast(_typed(table.schema))


def flat(row: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """A row whose values are no tables; names are joined by underscores."""
    result: dict[str, Any] = {}
    for name, value in row.items():
        column = f"{prefix}{name}".replace("-", "_").replace(".", "_")
        if isinstance(value, Mapping):
            result |= flat(value, f"{column}_")
        else:
            result[column] = value
    return result


def side_pieces(ledger: Ledger, name: str) -> Iterator[pa.Table]:
    """A table that came with runs, piece by piece: key and labels of its run before each row."""
    schemas = {table.schema for table in _labelled(ledger, name, schema_only=True)}
    schema = _typed(pa.unify_schemas(list(schemas), promote_options="permissive"))
    for batch in _batched(_labelled(ledger, name), STREAMS):
        piece = pa.concat_tables(batch, promote_options="permissive")
        absent = [field for field in schema if field.name not in piece.column_names]
        for field in absent:
            piece = piece.append_column(field, pa.nulls(len(piece), field.type))
        yield piece.select(schema.names).cast(schema)


def side_table(ledger: Ledger, name: str) -> pa.Table:
    """A table that came with runs, in one piece."""
    return pa.concat_tables(list(side_pieces(ledger, name)))


def parquet_pieces(ledger: Ledger, name: str) -> Iterator[pa.Table]:
    """A table of the ledger in pieces of one schema, as a file is written."""
    if name == "runs":
        yield runs_table(ledger.rows())
    else:
        yield from side_pieces(ledger, name)


def bring_up_to_date(ledger: Ledger, folder: Path) -> list[Path]:
    """Write each table that is not made from the ledger as it stands, and remove what is no more.

    A file says in its metadata what it was made from, so whatever ended an earlier call, this one
    knows what is to be made again. Returns the paths of all tables.

    Raises:
        BrokenOff: the disk is full, or fails.
        BadInput: the ledger is damaged.
    """
    stamp = ledger.stamp()
    paths = [folder / f"{name}.parquet" for name in ("runs", *ledger.table_names())]
    for path in paths:
        if made_from(path) != stamp:
            write_parquet(path, parquet_pieces(ledger, path.stem), stamp)
    for path in set(folder.glob("*.parquet")) - set(paths):
        if made_from(path).partition(":")[0] == stamp.partition(":")[0]:
            path.unlink(missing_ok=True)
    return paths


def made_from(path: Path) -> str:
    """The stamp of the ledger that a file was made from; empty: it is not there, or not ours."""
    try:
        metadata = pq.read_schema(path).metadata or {}
    except (OSError, pa.ArrowException):
        return ""
    return str(metadata.get(STAMP, b"").decode())


def write_parquet(path: Path, pieces: Iterable[pa.Table], stamp: str) -> None:
    """Write a table; the file appears whole, or the one that was there stays.

    Raises:
        BrokenOff: the disk is full, or fails.
    """
    try:
        with replacing(path) as draft, draft.open("wb") as file:
            writer = None
            for piece in pieces:
                if writer is None:
                    schema = piece.schema.with_metadata({STAMP: stamp})
                    writer = pq.ParquetWriter(
                        file, schema, compression="zstd", write_page_checksum=True
                    )
                writer.write_table(piece.replace_schema_metadata({STAMP: stamp}))
            if writer is not None:
                writer.close()
    except OSError as error:
        raise BrokenOff(f"{str(path)!r} cannot be written: {error.strerror or error}") from error


def _labelled(ledger: Ledger, name: str, *, schema_only: bool = False) -> Iterator[pa.Table]:
    for cell, labels, stream in ledger.streams(name):
        with pa.ipc.open_stream(stream) as reader:
            table = reader.schema.empty_table() if schema_only else reader.read_all()
        labelled = {"cell": cell, **flat(json.loads(labels))}
        columns = {
            column: pa.array([value]).take(pa.array([0] * len(table), pa.int64()))
            for column, value in labelled.items()
            if column not in table.column_names
        }
        yield pa.table(columns | {c: table[c] for c in table.column_names})


def _typed(schema: pa.Schema) -> pa.Schema:
    """The schema with columns that hold nothing yet as numbers: readers know what to do."""
    return pa.schema([f.with_type(pa.float64()) if pa.types.is_null(f.type) else f for f in schema])


def _columns(rows: list[dict[str, Any]]) -> pa.Table:
    names = dict.fromkeys(name for row in rows for name in row)
    return pa.table({name: [row.get(name) for row in rows] for name in names})


def _batched(items: Iterable[T], size: int) -> Iterator[list[T]]:
    iterator = iter(items)
    while batch := list(islice(iterator, size)):
        yield batch
