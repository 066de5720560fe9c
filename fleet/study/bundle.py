"""A study as one file for a reviewer: an RO-Crate of what was run, with what, and what came of it.

RO-Crate 1.1 (https://w3id.org/ro/crate/1.1): a ZIP file whose ``ro-crate-metadata.json`` says what
the others are. ``fleet verify`` runs a sample of its runs again.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
import zipfile
from collections.abc import Iterator
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from fleet import __version__
from fleet.scenario.errors import bad
from fleet.study.atomic import replacing
from fleet.study.inputs import digest
from fleet.study.ledger import NAME, reading
from fleet.study.result import StudyResult

METADATA = "ro-crate-metadata.json"
PROFILE = "https://w3id.org/ro/crate/1.1"
FILES = "files"  # folder of the files that scenarios name
KINDS = {
    ".csv": "text/csv",
    ".html": "text/html",
    ".parquet": "application/vnd.apache.parquet",
    ".sqlite": "application/vnd.sqlite3",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".toml": "application/toml",
    ".txt": "text/plain",
    ".py": "text/x-python",
}
SAYS = {
    NAME: "The record: every run's scenario, key and figures, with checksums",
    "study.toml": "The study, as it was written",
    "versions.txt": "What made the runs: versions of this program and of its libraries",
    "keys.csv": "The key of each run, and what it belongs to",
    "report.html": "The report, to be read in a browser",
}
CHUNK = 1 << 20


class Bundled(NamedTuple):
    """A bundle that was written."""

    path: Path
    parts: int  # files in it
    missing: list[str]  # files that scenarios name and that could not come along


def write_bundle(folder: Path, out: Path) -> Bundled:
    """Put the study of a folder into the ZIP file ``out``, with its tables and its report.

    Files that scenarios name come along if they are named by a path below the folder that the
    study was started in, and are as they were then.

    Raises:
        BadInput: the folder holds no study, or the bundle cannot be written.
    """
    with reading(folder) as ledger:
        meta, counts = ledger.meta(), ledger.counts()
        named = _named_files(ledger.origins())
        keys = "key,cell\n" + "".join(f'{key},"{cell}"\n' for key, cell in ledger.places())
    StudyResult(folder).write()
    texts = {
        "versions.txt": _versions(meta.get("made_by", {})),
        "keys.csv": keys,
        **({"study.toml": meta["source"]} if meta.get("source") else {}),
    }
    carried, missing = _carried(named, Path(meta.get("folder", ".")))
    try:
        with TemporaryDirectory(prefix="fleet-") as scratch:
            parts = list(_parts(folder, Path(scratch), texts, carried))
            told = _metadata(parts, meta, counts.done)
            with replacing(out) as draft, zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED) as file:
                file.writestr(METADATA, json.dumps(told, indent=2, ensure_ascii=False))
                for name, path in parts:
                    file.write(path, name)
    except OSError as error:
        raise bad(
            "--bundle", f"{str(out)!r} cannot be written: {error.strerror or error}"
        ) from error
    return Bundled(out, len(parts) + 1, missing)


def _parts(
    folder: Path, scratch: Path, texts: dict[str, str], carried: dict[str, Path]
) -> Iterator[tuple[str, Path]]:
    """The files of a bundle: names in it, and where they are now."""
    record = scratch / NAME
    source = f"{(folder / NAME).resolve().as_uri()}?mode=ro"
    with (
        closing(sqlite3.connect(source, uri=True)) as database,
        closing(sqlite3.connect(record)) as copy,
    ):
        database.backup(copy)
        copy.execute("PRAGMA journal_mode = DELETE")
    yield NAME, record
    for name, text in texts.items():
        path = scratch / name
        path.write_text(text, "utf-8")
        yield name, path
    for path in sorted(folder.glob("*.parquet")):
        yield path.name, path
    for beside in ("report.html", "report", "figures"):
        for path in sorted([folder / beside, *(folder / beside).rglob("*")]):
            if path.is_file() and not path.name.startswith("."):
                yield path.relative_to(folder).as_posix(), path
    for path in sorted(folder.glob("*.csv")):
        yield path.name, path
    for name, path in carried.items():
        yield f"{FILES}/{name}", path


def _named_files(origins: list[dict[str, Any]]) -> dict[str, str]:
    """The files that decide runs, as scenarios name them, with the sha256 of each."""
    return {name: sha for origin in origins for name, sha in origin.get("files", {}).items()}


def _carried(named: dict[str, str], started_in: Path) -> tuple[dict[str, Path], list[str]]:
    """Which of the named files can come along, and which cannot."""
    carried, missing = {}, []
    for name, sha in named.items():
        inside = PurePosixPath(Path(name).as_posix())
        path = started_in / name
        if (
            inside.is_absolute()
            or ".." in inside.parts
            or not path.is_file()
            or digest(path) != sha
        ):
            missing.append(name)
        else:
            carried[inside.as_posix()] = path
    return carried, missing


def _versions(made_by: dict[str, str]) -> str:
    """The lock: what pip can install as it was, and what it cannot as a remark."""
    lines = [f"# talking-fleet {made_by.get('fleet', __version__)}"]
    for name, version in made_by.items():
        if name in ("python", "platform"):
            lines.append(f"# {name} {version}")
        elif name != "fleet":
            lines.append(f"{name}=={version}")
    return "\n".join(lines) + "\n"


def _metadata(parts: list[tuple[str, Path]], meta: dict[str, Any], done: int) -> dict[str, Any]:
    """What the crate says of itself."""
    title = meta.get("study", {}).get("title") or "A study of robot fleets that talk"
    newest = max(path.stat().st_mtime for _, path in parts)
    made_by = meta.get("made_by", {})
    names = [name for name, _ in parts]
    tool = {
        "@id": "#talking-fleet",
        "@type": "SoftwareApplication",
        "name": "talking-fleet",
        "version": made_by.get("fleet", __version__),
        "softwareRequirements": [f"{n} {v}" for n, v in made_by.items() if n != "fleet"],
    }
    action = {
        "@id": "#runs",
        "@type": "CreateAction",
        "name": meta.get("command") or "fleet sweep",
        "instrument": {"@id": "#talking-fleet"},
        "object": [{"@id": name} for name in names if name == "study.toml"],
        "result": [{"@id": name} for name in names if name.endswith((".parquet", ".sqlite"))],
    }
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": title,
        "description": f"{done} runs, with their keys, tables and report."
        " `fleet verify` runs a sample again.",
        "datePublished": datetime.fromtimestamp(newest, UTC).date().isoformat(),
        "license": "Whoever made the study has stated none.",
        "hasPart": [{"@id": name} for name in names],
        "mentions": [{"@id": "#runs"}],
    }
    descriptor = {
        "@id": METADATA,
        "@type": "CreativeWork",
        "conformsTo": {"@id": PROFILE},
        "about": {"@id": "./"},
    }
    graph = [descriptor, root, tool, action, *(_entity(name, path) for name, path in parts)]
    return {"@context": f"{PROFILE}/context", "@graph": graph}


def _entity(name: str, path: Path) -> dict[str, Any]:
    """What the crate says of one file."""
    said = {
        "@id": name,
        "@type": "File",
        "name": SAYS.get(name, PurePosixPath(name).name),
        "contentSize": str(path.stat().st_size),
        "sha256": sha256_of(path),
    }
    kind = KINDS.get(path.suffix)
    return said | ({"encodingFormat": kind} if kind else {})


def sha256_of(path: Path) -> str:
    """The sha256 of a file's bytes, whatever was there before."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
