"""The process that draws a recording, from the side of the run.

It takes half a second to load what it draws with. So it is started first of all, and gets ready
while the run does.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from contextlib import suppress
from types import TracebackType
from typing import IO, Any

from fleet.replay.failures import CannotRecord
from fleet.replay.journal import send

OUTSIDE = re.compile(r"[^:]*\(os error \d+\)|no viewer listens at \S+")
"""What the writer says when it is the machine that stops it: a full disk, a viewer that is gone."""
PIPE = 1 << 20  # [bytes] that it may lag behind before the run waits


class WriterProcess:
    """A running :mod:`fleet.replay.writer`. It outlives an interrupted run while it has work.

    As a context it is sent away at the end, if it has not finished: no run has begun.
    """

    def __init__(self) -> None:
        self.name = "of the run"  # what it draws, for errors
        self._finished = False
        self._complaints: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed by finish()
        search = os.pathsep.join(path or "." for path in sys.path)
        self.process = subprocess.Popen(
            [sys.executable, "-m", "fleet.replay.writer"],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=self._complaints,
            env={**os.environ, "PYTHONPATH": search},
            pipesize=PIPE,
            start_new_session=True,  # Ctrl-C is for the run; the writer finishes the file
        )
        assert self.process.stdin is not None
        self._pipe = self.process.stdin

    def __enter__(self) -> WriterProcess:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        where: TracebackType | None,
    ) -> None:  # fmt: skip
        if not self._finished:
            self.process.kill()
            self.process.wait()
            self._pipe.close()
            self._complaints.close()

    def tell(self, tag: str, *content: Any) -> None:
        """Hand a frame over.

        Raises:
            CannotRecord: the machine does not let it go on.
            RuntimeError: it has died.
        """
        try:
            send(self._pipe, tag, *content)
        except BrokenPipeError:
            self.process.wait()
            raise self._failure() from None  # finish() is still to come

    @property
    def alive(self) -> bool:
        """Whether it takes notes."""
        return self.process.poll() is None

    def finish(self) -> None:
        """That was all: wait until the recording is complete.

        Raises:
            CannotRecord: the machine did not let it be written.
            RuntimeError: it could not be written.
        """
        self._finished = True
        with suppress(BrokenPipeError):  # it has ended already; why is told below
            self._pipe.close()
        with self._complaints:
            if self.process.wait() != 0:
                raise self._failure()

    def _failure(self) -> RuntimeError:
        """What it died of; all that it said is a note of the error.

        Only what Rerun or the network raised can be the machine's fault: any other error is ours,
        whatever was said of the machine before.
        """
        self._complaints.seek(0)
        said = self._complaints.read().decode(errors="replace").strip()
        reason = said.splitlines()[-1] if said else f"exit code {self.process.returncode}"
        kind, outside = RuntimeError, OUTSIDE.search(said)
        if outside and reason.startswith(("RuntimeError:", "ConnectionError:")):
            kind, reason = CannotRecord, outside[0].strip()
        error = kind(f"the recording {self.name} broke off: {reason}")
        error.add_note(said)
        return error
