"""A bundle held against itself: its files as they were written, a sample of its runs run again."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from fleet.scenario.errors import BadInput, bad, shown
from fleet.study.bundle import FILES, METADATA, PROFILE, sha256_of
from fleet.study.job import PLAY
from fleet.study.kept import SHORT, kept_run
from fleet.study.ledger import NAME, reading
from fleet.study.runner import Say, silent

MOST_BYTES = 8 << 30  # of a bundle, unpacked
MOST_FILES = 100_000
SEED = 0  # which runs are a sample


class Verified(NamedTuple):
    """What came of running a sample of a bundle's runs again."""

    runs: int  # that the bundle has
    tried: int
    different: list[str]  # keys of those that are not the same to the last bit


def verify(bundle: Path, sample: int, *, trust: bool = False, say: Say = silent) -> Verified:
    """Check the files of a bundle, and run so many of its runs again; 0: all.

    A bundle is data, and may come from anybody: Python files that come with it are run only if
    ``trust`` is given. ``say`` is told of each difference, and of what has changed since.

    Raises:
        BadInput: it is no bundle, it is damaged, or it needs code that is not trusted.
    """
    with unpacked(bundle) as folder:
        with reading(folder) as ledger:
            keys = ledger.done_by(PLAY)
        if not keys:
            raise bad("BUNDLE", f"{shown(str(bundle))} holds no run of a scenario that is done")
        chosen = _chosen(keys, sample)
        files = folder / FILES
        files.mkdir(exist_ok=True)
        different: list[str] = []
        changed: dict[str, None] = {}
        for key in chosen:
            try:
                kept = kept_run(folder, key, trust=trust, named_from=files)
            except BadInput as error:
                raise BadInput([("BUNDLE", said) for _, said in error.problems]) from error
            differences = kept.differences(kept.play())
            for difference in differences:
                say(f"run {key[:SHORT]}: {difference}")
            different += [key] if differences else []
            changed |= dict.fromkeys(kept.changes())
        for change in changed:
            say(change)
    return Verified(len(keys), len(chosen), different)


def _chosen(keys: list[str], sample: int) -> list[str]:
    """A sample of the runs, the same each time, in the order of the study."""
    if not 0 < sample < len(keys):
        return keys
    drawn = np.random.default_rng(SEED).choice(len(keys), sample, replace=False)
    return [keys[place] for place in sorted(drawn.tolist())]


@contextmanager
def unpacked(bundle: Path) -> Iterator[Path]:
    """A folder with what is in a bundle, each file held against its checksum.

    Raises:
        BadInput: it is no bundle, or it is damaged.
    """
    with TemporaryDirectory(prefix="fleet-") as scratch:
        folder = Path(scratch).resolve()
        try:
            with zipfile.ZipFile(bundle) as file:
                _measure(bundle, file)
                file.extractall(folder)
        except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError) as error:
            raise bad("BUNDLE", f"{shown(str(bundle))} is no bundle: {error}") from error
        except OSError as error:
            said = error.strerror or error
            raise bad("BUNDLE", f"{shown(str(bundle))} cannot be read: {said}") from error
        _hold(bundle, folder)
        yield folder


def _measure(bundle: Path, file: zipfile.ZipFile) -> None:
    """See that it does not unpack to more than a study is."""
    entries = file.infolist()
    if METADATA not in {entry.filename for entry in entries}:
        raise bad("BUNDLE", f"{shown(str(bundle))} is no bundle: it has no {METADATA}")
    size = sum(entry.file_size for entry in entries)
    if len(entries) > MOST_FILES or size > MOST_BYTES:
        raise bad(
            "BUNDLE",
            f"{shown(str(bundle))} unpacks to {len(entries)} files of {size / 2**30:.1f} GiB;"
            f" expected {MOST_FILES} and {MOST_BYTES >> 30} GiB at most",
        )


def _hold(bundle: Path, folder: Path) -> None:
    """See that it is a crate of ours, and that its files are those that it tells of."""
    told = {entity["@id"]: entity["sha256"] for entity in _told(bundle, folder)}
    there = {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and path.name != METADATA
    }
    for name in sorted(there ^ told.keys()):
        what = "is not told of in its metadata" if name in there else "is told of and not there"
        raise bad("BUNDLE", f"{shown(str(bundle))} is damaged: {shown(name)} {what}")
    for name, sha in told.items():
        if sha256_of(folder / name) != sha:
            raise bad("BUNDLE", f"{shown(str(bundle))} is damaged: {shown(name)} is not as written")
    if NAME not in there:
        raise bad("BUNDLE", f"{shown(str(bundle))} is no bundle of a study: it has no {NAME}")


def _told(bundle: Path, folder: Path) -> list[dict[str, Any]]:
    """The files that the metadata tells of."""
    try:
        graph = json.loads((folder / METADATA).read_text("utf-8"))["@graph"]
        about = next(entity for entity in graph if entity["@id"] == METADATA)
        files = [entity for entity in graph if entity["@type"] == "File"]
        crate = about["conformsTo"]["@id"] == PROFILE
        named = all(
            isinstance(entity["sha256"], str) and not PurePosixPath(entity["@id"]).is_absolute()
            for entity in files
        )
    except (ValueError, KeyError, TypeError, StopIteration, OSError, RecursionError):
        crate = named = False
        files = []
    if not (crate and named):
        raise bad("BUNDLE", f"{shown(str(bundle))} is no bundle: {METADATA} is no RO-Crate of ours")
    return files
