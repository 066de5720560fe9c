"""Running one job where it is: find the work function, call it, and write down what came."""

from __future__ import annotations

import json
import time
import traceback
from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from typing import Any

from fleet.study.inputs import changed
from fleet.study.job import Job, Outcome
from fleet.study.version import program_version


class Changed(RuntimeError):
    """What the job's key was made of is no longer what there is: its row would be another's."""


def attempt(job: Job) -> Outcome:
    """The outcome of a job. What the work function raises is part of the outcome."""
    started = time.perf_counter()
    try:
        _hold(job)
        row = dict(work_function(job.function)(job))
        _hold(job)
        tables = {name: pack(rows) for name, rows in row.pop("tables", {}).items() if rows}
        text = json.dumps(row, default=_as_plain)
    except Changed as error:
        return Outcome(job.key, "stale", "", {}, str(error), 1, time.perf_counter() - started)
    except Exception:  # noqa: BLE001  # whatever a job raises is recorded, and the study goes on
        seconds = time.perf_counter() - started
        return Outcome(job.key, "raised", "", {}, traceback.format_exc(limit=-12), 1, seconds)
    return Outcome(job.key, "done", text, tables, "", 1, time.perf_counter() - started)


def _hold(job: Job) -> None:
    """See that a job is run with the files and the program that its key was made of."""
    made_by = job.made_by
    for name in changed(made_by):
        raise Changed(f"{name!r} has changed since the study began")
    if made_by and made_by["version"] != program_version():
        raise Changed(
            f"the program has changed from {made_by['version']} to {program_version()} since the"
            f" study began"
        )


@cache
def work_function(path: str) -> Callable[[Job], Mapping[str, Any]]:
    """The function that ``module:name`` means.

    Raises:
        ModuleNotFoundError, AttributeError: there is none.
        ValueError: the path is not of that form.
    """
    module, colon, name = path.partition(":")
    if not (module and colon and name):
        raise ValueError(f"work function is {path!r}; expected module:name")
    found: Callable[[Job], Mapping[str, Any]] = getattr(import_module(module), name)
    return found


def pack(rows: list[dict[str, Any]]) -> bytes:
    """A table as a compressed Arrow stream."""
    import pyarrow as pa

    table = pa.Table.from_pylist(rows)
    sink = pa.BufferOutputStream()
    options = pa.ipc.IpcWriteOptions(compression="zstd")
    with pa.ipc.new_stream(sink, table.schema, options=options) as stream:
        stream.write_table(table)
    packed: bytes = sink.getvalue().to_pybytes()
    return packed


def _as_plain(value: Any) -> Any:
    """NumPy's numbers and arrays as Python's."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a row holds {value!r} of type {type(value).__name__}; expected plain values")
