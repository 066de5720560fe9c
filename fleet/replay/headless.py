"""The native viewer without a window: it opens a recording and takes pictures of itself.

It needs a Vulkan driver; a software one will do (Debian: mesa-vulkan-drivers and libvulkan1).
Rerun's client for this is experimental: nothing else uses it.
"""

from __future__ import annotations

import io
import subprocess
import tempfile
import time
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from fleet.replay.viewer import free_port, viewer_binary, viewer_environment

if TYPE_CHECKING:
    from PIL.Image import Image
    from rerun.experimental import ViewerClient, ViewerState


class NoViewer(RuntimeError):
    """The viewer does not start here; the message says why."""


class HeadlessViewer:
    """A viewer process, to be used in a ``with`` block.

    Raises:
        NoViewer: it did not start, for want of a graphics driver as a rule.
    """

    def __init__(self, width: int = 1600, height: int = 900, patience: float = 60.0) -> None:
        self._patience = patience  # [s]
        self._said: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed by close()
        port = free_port()
        self.url = f"rerun+http://127.0.0.1:{port}/proxy"
        self._process = subprocess.Popen(  # noqa: S603 - the program inside the wheel
            [
                str(viewer_binary()), "--headless", "--bind", "127.0.0.1", "--port", str(port),
                "--window-size", f"{width}x{height}", "--hide-welcome-screen",
            ],
            env=viewer_environment(),
            stdout=subprocess.DEVNULL,
            stderr=self._said,
        )  # fmt: skip
        self._client = self._connect()

    def __enter__(self) -> HeadlessViewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the process."""
        if self._process.poll() is None:
            self._process.terminate()
            self._process.wait(10)
        self._said.close()

    def open(self, path: Path) -> None:
        """Load a recording."""
        self._client.open(str(path.absolute()))
        deadline = time.monotonic() + self._patience
        while (state := self._client.get_state()).loading or not any(
            recording.timelines for recording in state.recordings
        ):
            failures = [e.message for e in self._client.get_logs() if e.level == "ERROR"]
            if failures or time.monotonic() > deadline:
                raise RuntimeError(f"the viewer did not load {path}: {failures}")
            time.sleep(0.05)

    def go(self, timeline: str, **when: Any) -> None:
        """Move the cursor, with ``sequence=`` or ``duration=`` [s], and wait for the picture."""
        self._client.set_time(timeline, play_state="paused", **when)
        self.settle()

    def scrub(self, timeline: str, **when: Any) -> None:
        """Move the cursor as :meth:`go` does, and wait for the next picture only."""
        self._client.set_time(timeline, play_state="paused", **when)
        self._client.take_screenshot(max_size=480)

    def settle(self) -> None:
        """Wait until the picture no longer changes: chunks are fetched as they are needed."""
        deadline = time.monotonic() + self._patience
        before = b""
        time.sleep(0.15)
        while (now := self._client.take_screenshot(max_size=480)) != before:
            if time.monotonic() > deadline:
                raise TimeoutError("the picture does not come to rest")
            before = now
            time.sleep(0.25)

    def front(self, name: str) -> None:
        """Bring a tab to the front, by the name of its view or container.

        Raises:
            KeyError: no tab has that name.
        """
        layout = self._client.get_blueprint(of="recording").blueprint
        named = {
            path.strip("/")
            for path, parts in layout.items()
            for part in ("ContainerBlueprint", "ViewBlueprint")
            if parts.get(part, {}).get("display_name") == name
        }
        found = False
        for parts in layout.values():
            container = parts.get("ContainerBlueprint", {})
            for content in container.get("contents", ()):
                if container["container_kind"] == "Tabs" and content.strip("/") in named:
                    container["active_tab"] = content
                    found = True
        if not found:
            raise KeyError(name)
        self._client.set_blueprint(layout, of="recording")

    def picture(self, view: str | None = None) -> Image:
        """The whole window, or one view by its name.

        Raises:
            KeyError: no such view is shown.
        """
        from PIL import Image

        ids = [shown.view_id for shown in self.state().views if shown.name == view]
        for id_ in ids if view is not None else [None]:
            try:
                dots = self._client.take_screenshot(view_id=id_)
            except ConnectionError:  # it is in a tab behind others
                continue
            return Image.open(io.BytesIO(dots)).convert("RGB")
        raise KeyError(view)

    def state(self) -> ViewerState:
        """What is loaded and shown."""
        return self._client.get_state()

    def problems(self) -> list[str]:
        """What views report and the log warns of."""
        found = [
            f"{view.name}: {report.severity}: {report.summary}"
            for view in self.state().views
            for report in view.reports
        ]
        found += [
            f"log: {entry.level}: {entry.message}"
            for entry in self._client.get_logs()
            if entry.level in ("WARN", "ERROR") and "oftware rasterizer" not in entry.message
        ]
        return found

    def _connect(self) -> ViewerClient:
        from rerun.experimental import ViewerClient

        deadline = time.monotonic() + self._patience
        while True:
            if self._process.poll() is not None:
                self._said.seek(0)
                reason = self._said.read().decode(errors="replace").strip()
                raise NoViewer(reason[-400:] or f"it ended with code {self._process.returncode}")
            try:
                client = ViewerClient.connect(self.url)
                client.get_state()
            except Exception as error:  # whatever a server that is not up yet makes of it
                if time.monotonic() > deadline:
                    self.close()
                    raise NoViewer(f"it did not answer: {error}") from error
                time.sleep(0.1)
            else:
                return client
