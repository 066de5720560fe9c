"""Looking at recordings: in the native viewer, in a browser, or as they are made.

The viewer is the program inside the rerun wheel. It listens on this machine's loopback only,
and sends nothing anywhere else.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from threading import current_thread, main_thread

from fleet.replay.web_server import LOOPBACK, Part, parts_of, serving

PATIENCE = 30.0  # [s] for a viewer to start
SETTLING = 0.5  # [s] in which it finds out that it cannot


def view(
    recordings: Sequence[Path],
    *,
    web: bool = False,
    timeline: str | None = None,
    event: int | None = None,
    robot: int | None = None,
    tell: Callable[[str], object] = print,
) -> None:
    """Show recordings until the window is closed, or Ctrl-C.

    Args:
        recordings: .rrd files; several are shown side by side.
        web: serve them to a browser on this machine instead of opening a window.
        timeline: the one to scrub by at first; None: the story, or for several the round.
        event: frame this one, as it is numbered in the picture, and play it.
        robot: likewise the first event that this robot drove to.
        tell: is given the address to open in a browser.

    Raises:
        ValueError: a file cannot be read, or no window can be opened here.
    """
    if current_thread() is main_thread():  # shells have what they start behind ignore Ctrl-C
        signal.signal(signal.SIGINT, signal.default_int_handler)
    with _ready(recordings, timeline, event, robot) as ready:
        try:
            if web:
                with serve(ready) as address:
                    tell(address)
                    while True:
                        time.sleep(3600.0)
            else:
                _open_window(ready)
        except KeyboardInterrupt:
            pass


@contextmanager
def serve(recording: Path) -> Iterator[str]:
    """The address of a web viewer that shows a recording; it works without a network.

    Raises:
        ValueError: the server does not start.
    """
    with serving(_web_viewer(), recording) as address:
        yield address


def _web_viewer() -> dict[str, Part]:
    """The web viewer, as its program serves it. That is ended again: it is never idle."""
    page, data = free_port(), free_port()
    with tempfile.TemporaryFile() as said:
        server = subprocess.Popen(  # noqa: S603 - the program inside the wheel
            [
                str(viewer_binary()), "--serve-web", "--bind", LOOPBACK,
                "--web-viewer-port", str(page), "--port", str(data),
            ],
            env=viewer_environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
        )  # fmt: skip
        try:
            if not _answers(page, server):
                said.seek(0)
                reason = said.read().decode(errors="replace").strip()
                raise ValueError(f"the web viewer did not start: {reason[-300:]}")
            return parts_of(page)
        finally:
            server.terminate()
            server.wait()


def spawn_viewer() -> str:
    """Open a viewer that outlives this process; returns the address to stream to.

    Raises:
        ValueError: no window can be opened here.
    """
    port = free_port()
    viewer = subprocess.Popen(  # noqa: S603 - the program inside the wheel
        [
            str(viewer_binary()), "--bind", LOOPBACK, "--port", str(port),
            "--hide-welcome-screen",
        ],
        env=viewer_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )  # fmt: skip
    if not (_answers(port, viewer) and _stays(viewer)):
        raise ValueError("the viewer cannot open a window here; record to a file instead")
    viewer.returncode = 0  # it is on its own now: nobody waits for it
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def viewer_binary() -> Path:
    """The viewer inside the rerun wheel; the ``rerun`` script on the path only forks it."""
    spec = find_spec("rerun_cli")
    assert spec is not None
    assert spec.submodule_search_locations
    folder = Path(spec.submodule_search_locations[0])
    return folder / ("rerun.exe" if os.name == "nt" else "rerun")


def viewer_environment() -> dict[str, str]:
    """Surroundings in which the viewer sends nothing home."""
    return {**os.environ, "CI": "1", "RUST_LOG": "error"}


def free_port() -> int:
    """A TCP port of this machine that nobody uses."""
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        port: int = probe.getsockname()[1]
        return port


@contextmanager
def _ready(
    recordings: Sequence[Path], timeline: str | None, event: int | None, robot: int | None
) -> Iterator[Path]:
    """One file to show: the only recording as it is, or several arranged in one."""
    for path in recordings:
        _check(path)
    if len(recordings) == 1 and {timeline, event, robot} == {None}:
        yield recordings[0]
        return
    from fleet.replay.comparison import Aim, arrange

    with tempfile.TemporaryDirectory() as folder:
        arranged = Path(folder) / "arranged.rrd"
        arrange(recordings, arranged, timeline, Aim(event, robot))
        yield arranged


def _check(path: Path) -> None:
    """Raises ValueError unless the file begins as a recording does."""
    try:
        with path.open("rb") as file:
            magic = file.read(4)
    except OSError as error:
        raise ValueError(f"cannot open {path}: {error.strerror}") from error
    if not magic.startswith(b"RRF"):
        raise ValueError(f"{path}: not a Rerun recording")


def _open_window(recording: Path) -> None:
    with tempfile.TemporaryFile() as said:
        viewer = subprocess.Popen(  # noqa: S603 - the program inside the wheel
            [
                str(viewer_binary()), "--bind", LOOPBACK, "--port", str(free_port()),
                str(recording),
            ],
            env=viewer_environment(),
            stdout=subprocess.DEVNULL,
            stderr=said,
        )  # fmt: skip
        try:
            code = viewer.wait()
        finally:
            viewer.terminate()
            viewer.wait()
        if code != 0:
            said.seek(0)
            lines = said.read().decode(errors="replace").strip().splitlines()
            reason = lines[0] if lines else f"exit code {code}"
            if "DISPLAY" in reason:
                reason = "there is no screen"
            raise ValueError(
                f"the viewer cannot open a window here: {reason}; try --web, or fleet picture"
            )


def _stays(process: subprocess.Popen[bytes]) -> bool:
    """Whether it is still there in a moment: it listens before it looks for a screen."""
    try:
        process.wait(SETTLING)
    except subprocess.TimeoutExpired:
        return True
    return False


def _answers(port: int, process: subprocess.Popen[bytes]) -> bool:
    """Wait for a port to be listened on; False: the process has ended, or takes too long."""
    deadline = time.monotonic() + PATIENCE
    while process.poll() is None and time.monotonic() < deadline:
        try:
            with socket.create_connection((LOOPBACK, port), timeout=1.0):
                return True
        except OSError:
            time.sleep(0.05)
    return False
