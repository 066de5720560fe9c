"""The web viewer, served so that it conversations to this machine only.

The page in the rerun wheel tells its makers that it is being used, and asks for fonts and news.
It is handed on with a policy that browsers enforce: it may reach nobody but its own server.
"""

from __future__ import annotations

import io
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import IO, Any, NamedTuple
from urllib.parse import quote, urlsplit
from urllib.request import urlopen

LOOPBACK = "127.0.0.1"
PARTS = ("/", "/re_viewer.js", "/re_viewer_bg.wasm", "/sw.js", "/favicon.ico")
RECORDING = "/recording.rrd"
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


@contextmanager
def serving(parts: Mapping[str, Part], recording: Path) -> Iterator[str]:
    """The address of a page that shows ``recording``; it is served, on loopback, until the end."""

    class PageHandler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            path = urlsplit(self.path).path
            if path == RECORDING:
                with recording.open("rb") as file:
                    self._send("application/octet-stream", file, recording.stat().st_size)
            elif path in parts:
                part = parts[path]
                self._send(part.kind, io.BytesIO(part.content), len(part.content))
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

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

    with ThreadingHTTPServer((LOOPBACK, 0), PageHandler) as server:
        server.daemon_threads = True
        Thread(target=server.serve_forever, daemon=True).start()
        here = f"http://{LOOPBACK}:{server.server_address[1]}"
        try:
            yield f"{here}/?renderer=webgl&url={quote(here + RECORDING, safe='')}"
        finally:
            server.shutdown()
