"""One study at a time in one folder."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from fleet.study.endings import busy

if sys.platform == "win32":
    import msvcrt

    def _seize(file: IO[str]) -> None:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _seize(file: IO[str]) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


NAME = "study.lock"


@contextmanager
def sole(folder: Path) -> Iterator[None]:
    """Hold the folder. The system lets it go when the process ends, however it ends.

    Raises:
        BadInput: another process holds it.
    """
    with (folder / NAME).open("a+", encoding="utf-8") as file:
        try:
            _seize(file)
        except OSError:
            file.seek(0)
            raise busy(folder, file.read().strip()) from None
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}")
        file.flush()
        yield
