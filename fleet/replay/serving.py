"""The web viewer, served so that it talks to this machine only.

The page in the rerun wheel tells its makers that it is being used, and asks for fonts and news.
It is handed on with a policy that browsers enforce: it may reach nobody but its own server.
"""

from __future__ import annotations

import io
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import IO, Any
from urllib.error import HTTPError
from urllib.request import urlopen

LOOPBACK = "127.0.0.1"
ELSEWHERE = re.compile(rb"<link[^>]*https://[^>]*>")  # servers that a browser greets beforehand


@contextmanager
def confined(page: int, data: int) -> Iterator[int]:
    """The port of a server that hands on what port ``page`` serves; ``data`` may be reached too."""
    policy = (
        "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:;"
        f" connect-src 'self' data: blob: http://{LOOPBACK}:{data}"
    )

    class Relay(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            try:
                answer = urlopen(f"http://{LOOPBACK}:{page}{self.path}")
            except HTTPError as error:
                self.send_error(error.code)
                return
            with answer:
                kind = answer.headers["Content-Type"]
                content: IO[bytes] = answer
                size = answer.headers["Content-Length"]
                if kind == "text/html":
                    text = ELSEWHERE.sub(b"", answer.read())
                    content, size = io.BytesIO(text), str(len(text))
                self.send_response(HTTPStatus.OK)
                self.send_header("Content-Type", kind)
                self.send_header("Content-Length", size)
                self.send_header("rerun-final-length", size)  # for its progress bar
                self.send_header("Content-Security-Policy", policy)
                self.end_headers()
                shutil.copyfileobj(content, self.wfile)

        def log_message(self, *_: Any) -> None:
            """Nobody needs to read who got which file."""

    with ThreadingHTTPServer((LOOPBACK, 0), Relay) as server:
        server.daemon_threads = True
        Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield server.server_address[1]
        finally:
            server.shutdown()
