"""Files and folders into grounds: one file is a run, a folder is a ground."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fleet.logs.asking import FILE, LogSettings, beside, over
from fleet.logs.cleaning import Cleaned, runs_of
from fleet.logs.electrics import standstill_offsets
from fleet.logs.grounds import LoggedRun, LogGround
from fleet.logs.signals import Signals, signals_of
from fleet.logs.sniffing import read_sheet
from fleet.scenario.errors import bad

TABLES = (".csv", ".txt", ".tsv", ".dat", ".log")
BAGS = (".bag", ".mcap", ".db3")


def gather(paths: Sequence[Path], settings: LogSettings | None = None) -> list[LogGround]:
    """The grounds of these files and folders; ``settings`` go before those of a ``log.toml``.

    Files that are named one by one are one ground. A folder is one; if it only holds folders with
    logs, each of these is.

    Raises:
        BadInput: something is not there, is no log, or cannot be made sense of.
    """
    settings = settings or LogSettings()
    grounds, loose = [], []
    for path in paths:
        if not path.exists():
            raise bad("--log", f"{str(path)!r} does not exist; expected a log, or a folder of logs")
        if not path.is_dir() or is_bag(path):
            loose.append(path)
            continue
        found = [(path, logs_in(path))] if logs_in(path) else [
            (inner, logs_in(inner)) for inner in sorted(path.iterdir()) if inner.is_dir()
        ]  # fmt: skip
        found = [(folder, logs) for folder, logs in found if logs]
        if not found:
            raise bad(
                "--log",
                f"{str(path)!r} holds no logs; expected files of {', '.join(TABLES + BAGS)}",
            )
        grounds += [
            _ground(folder.name, logs, over(settings, beside(folder))) for folder, logs in found
        ]
    if loose:
        name = loose[0].resolve().parent.name if len(loose) > 1 else loose[0].stem
        grounds.insert(0, _ground(name, loose, over(settings, beside(loose[0].parent))))
    return grounds


def is_bag(path: Path) -> bool:
    """Whether it is a ROS bag: a file of one, or a folder that ROS 2 wrote."""
    return path.suffix in BAGS or (path / "metadata.yaml").is_file()


def logs_in(folder: Path) -> list[Path]:
    """The logs right in a folder, by name."""
    return sorted(
        path
        for path in folder.iterdir()
        if not path.name.startswith(".")
        and path.name != FILE
        and ((path.is_file() and path.suffix.lower() in TABLES) or is_bag(path))
    )


def _ground(name: str, logs: Sequence[Path], settings: LogSettings) -> LogGround:
    ground = LogGround(name, [], settings)
    read = [_signals(path, settings) for path in logs]
    _tell_apart(read)
    offsets = standstill_offsets(read)
    cleaned = [runs_of(signals, settings, offsets) for signals in read]
    _told(ground, read, cleaned)
    for one in cleaned:
        ground.runs += one.runs
    ground.turns = any(one.turns for one in cleaned)
    ground.drive_only = any(one.drive_only for one in cleaned)
    return ground


def _signals(path: Path, settings: LogSettings) -> Signals:
    if is_bag(path):
        from fleet.logs.bags import read_bag

        return read_bag(path, settings.columns)
    return signals_of(read_sheet(path), settings.columns)


def _tell_apart(read: Sequence[Signals]) -> None:
    """Files of one name in different folders are different runs."""
    seen: dict[str, int] = {}
    for signals in read:
        seen[signals.name] = seen.get(signals.name, 0) + 1
        if seen[signals.name] > 1:
            signals.name = f"{signals.name} ({seen[signals.name]})"


def _told(ground: LogGround, read: Sequence[Signals], cleaned: Sequence[Cleaned]) -> None:
    """What was done to each file; what is true of all of them is said once."""
    count: dict[str, list[str]] = {}
    for signals, one in zip(read, cleaned, strict=True):
        for note in dict.fromkeys(one.notes):
            count.setdefault(note, []).append(signals.name)
    for note, names in count.items():
        if len(names) == len(read):
            ground.notes.append(note)
        elif len(names) > 2:
            ground.notes.append(f"{len(names)} of {len(read)} files: {note}")
        else:
            ground.notes += [f"{name}: {note}" for name in names]


def as_runs(name: str, runs: Sequence[LoggedRun], settings: LogSettings) -> LogGround:
    """Runs from arrays as a ground."""
    return LogGround(name, list(runs), settings)
