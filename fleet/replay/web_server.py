"""The web viewer, served so that it conversations to this machine only.

The page in the rerun wheel tells its makers that it is being used, and asks for fonts and news.
It is handed on with a policy that browsers enforce: it may reach nobody but its own server.
"""

from __future__ import annotations

import io
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import BoundedSemaphore, Thread
from typing import IO, Any, NamedTuple
from urllib.parse import quote, urlsplit
from urllib.request import urlopen

from typing_extensions import override

LOOPBACK = "127.0.0.1"
PARTS = ("/", "/re_viewer.js", "/re_viewer_bg.wasm", "/sw.js", "/favicon.ico")
RECORDING = "/recording.rrd"
THREADS = 16  # that answer at a time
SILENCE = 30.0  # [s] after which who asks for nothing is let go
ELSEWHERE = re.compile(rb"<link[^>]*https://[^>]*>")  # servers that a browser greets beforehand
POLICY = (
    "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; connect-src 'self' data: blob:"
)


class Part(NamedTuple):
    """A file of the web viewer."""

    kind: str  # its media type
    content: bytes


def parts_of(port: int) -> dict[str, Part]:
    """The web viewer by path, as the program that listens at ``port`` serves it."""
    found = {}
    for path in PARTS:
        with urlopen(f"http://{LOOPBACK}:{port}{path}") as answer:
            content = answer.read()
            found[path] = Part(answer.headers["Content-Type"], ELSEWHERE.sub(b"", content))
    return found


class BoundedServer(ThreadingHTTPServer):
    """Answers a few at a time, each in a thread; others wait, and who says nothing is let go."""

    daemon_threads = True

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._free = BoundedSemaphore(THREADS)

    @override
    def process_request(self, request: Any, client_address: Any) -> None:
        """Take it on when a thread is free."""
        request.settimeout(SILENCE)
        self._free.acquire()
        super().process_request(request, client_address)

    @override
    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer it."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    @override
    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that goes away in the middle is no error."""


@contextmanager
def serving(parts: Mapping[str, Part], recording: Path) -> Iterator[str]:
    """The address of a page that shows ``recording``; it is served, on loopback, until the end."""

    class PageHandler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            path = urlsplit(self.path).path
            if not self._from_here():
                self.send_error(HTTPStatus.FORBIDDEN, "only pages of this machine may ask")
            elif path == RECORDING:
                self._send_recording()
            elif path in parts:
                part = parts[path]
                self._send(part.kind, io.BytesIO(part.content), len(part.content))
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

        def _from_here(self) -> bool:
            """Whether the browser asks this server by its own name, and for a page of its own.

            A name of somebody else's that leads here (DNS rebinding), or a page of somebody
            else's, would read the recording otherwise.
            """
            here = f"{LOOPBACK}:{self.server.server_address[1]}"  # type: ignore[index]
            return self.headers.get("Host") == here and self.headers.get("Origin") in (
                None,
                f"http://{here}",
            )

        def _send_recording(self) -> None:
            try:
                file = recording.open("rb")
            except OSError as error:
                reason = f"cannot open {recording.name}: {error.strerror}"
                self.send_error(HTTPStatus.GONE, reason)
                return
            with file:
                self._send("application/octet-stream", file, os.fstat(file.fileno()).st_size)

        def _send(self, kind: str, content: IO[bytes], size: int) -> None:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(size))
            self.send_header("rerun-final-length", str(size))  # for its progress bar
            self.send_header("Content-Security-Policy", POLICY)
            self.end_headers()
            shutil.copyfileobj(content, self.wfile)

        def log_message(self, *_: Any) -> None:
            """Nobody needs to read who got which file."""

    with BoundedServer((LOOPBACK, 0), PageHandler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        here = f"http://{LOOPBACK}:{server.server_address[1]}"
        try:
            yield f"{here}/?renderer=webgl&url={quote(here + RECORDING, safe='')}"
        finally:
            server.shutdown()
