"""Opening recordings: side by side, in a browser, live."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import textwrap
import urllib.request

import pytest

from fleet.replay import scheme
from fleet.replay.comparison import arrange
from fleet.replay.readback import Recording
from fleet.replay.viewer import serve, view


def test_recordings_side_by_side(rounds, stream, tmp_path):
    out = tmp_path / "both.rrd"
    arrange([rounds.path, stream.path], out)
    both = Recording(out)
    for root, run in (("a/", rounds), ("b/", stream)):
        said = both.rows(f"{root}{scheme.LOG}", "TextLog:level").values
        assert sum(level == ["TRACE"] for level in said) == run.summary.messages
        inside = {path.removeprefix(root) for path in both.entities if path.startswith(root)}
        inside = {path for path in inside if not path.startswith("compared/")}
        assert inside == {p for p in run.recording.entities if not p.startswith("__properties")}


def test_too_many_side_by_side(rounds, tmp_path):
    with pytest.raises(ValueError, match="7 recordings to compare; expected 1 to 6"):
        arrange([rounds.path] * 7, tmp_path / "many.rrd")


@pytest.mark.parametrize(
    ("content", "complaint"), [(None, "No such file"), (b"hello there", "not a Rerun recording")]
)
def test_files_that_cannot_be_viewed(tmp_path, content, complaint):
    path = tmp_path / "x.rrd"
    if content:
        path.write_bytes(content)
    with pytest.raises(ValueError, match=complaint):
        view([path])


@pytest.mark.skipif(
    "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ or sys.platform != "linux",
    reason="there is a screen here: a window would open",
)
def test_no_window_can_be_opened_without_a_screen(rounds):
    with pytest.raises(ValueError, match="cannot open a window here"):
        view([rounds.path])


def test_the_web_viewer_is_served_on_loopback_only(rounds):
    with serve(rounds.path) as address:
        assert address.startswith("http://127.0.0.1:")
        with urllib.request.urlopen(address) as page:
            assert b"<html" in page.read().lower()
        port = int(address.split(":")[2].split("/")[0])
        for other in own_addresses():
            assert not listens(other, port)
    assert not listens("127.0.0.1", port)


def listens(address, port):
    """Whether anybody answers there."""
    try:
        with socket.create_connection((address, port), timeout=1.0):
            return True
    except OSError:
        return False


def own_addresses():
    """Addresses of this machine other than loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # nothing is sent
        except OSError:
            return []
        address = probe.getsockname()[0]
    return [] if address.startswith("127.") else [address]


def test_ctrl_c_ends_the_web_viewer(rounds):
    code = f"""
        from pathlib import Path
        from fleet.replay.viewer import view
        view([Path({str(rounds.path)!r})], web=True, tell=lambda url: print(url, flush=True))
        print("over")
    """
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    with process:
        address = process.stdout.readline().strip()
        process.send_signal(signal.SIGINT)
        try:
            said, complained = process.communicate(timeout=20)
        finally:
            process.kill()
    assert process.returncode == 0
    assert said == "over\n"
    assert complained == ""
    port = int(address.split(":")[2].split("/")[0])
    assert not listens("127.0.0.1", port)
