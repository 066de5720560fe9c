"""The tutorials do what they say: files are written, commands run, outputs compared.

In a page, a block of ``python`` or ``toml`` that begins with a comment ``# NAME`` is that file; in
a block of ``console`` a line after ``$`` is a command, and what follows is its output. ``...``
stands for anything; numbers may differ by a tenth, as the last bits of another processor may.
"""

from __future__ import annotations

import os
import re
import shlex
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"
PAGES = sorted((DOCS / "tutorials").glob("*.md"))
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FRAME = str.maketrans(dict.fromkeys("│┌┐└┘├┤─┬┴┼", " "))
NEAR = 0.1  # numbers, as a share
NUMBER = re.compile(r"[-−]?\d+(?:\.\d+)?")


def steps(page):
    """Files and commands of a page, in its order: (name, text) or (command, expected output)."""
    for kind, text in BLOCK.findall(page):
        named = re.match(r"# ([\w.-]+)\n", text)
        if kind in {"python", "toml"} and named:
            yield "file", named[1], text
        elif kind == "console":
            for said in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
                command, _, expected = said.partition("\n")
                yield "command", command, expected


def agrees(expected, said):
    """Whether an output is what the page says: word by word, numbers nearly, ``...`` anything."""
    words = re.split(r"\s+", expected.translate(FRAME).strip())
    got = re.split(r"\s+", said.translate(FRAME).strip())
    return matches(words, got)


def matches(words, got):
    """Greedy is not enough: after ``...`` each place is tried, from the last found ones on."""
    alive = {0}  # how many of `got` are used up
    for word in words:
        if word == "...":
            alive = set(range(min(alive), len(got) + 1)) if alive else set()
        else:
            alive = {n + 1 for n in alive if n < len(got) and alike(word, got[n])}
    return len(got) in alive


def alike(word, other):
    if word == other:
        return True
    if NUMBER.sub("#", word) != NUMBER.sub("#", other):
        return False
    pairs = zip(NUMBER.findall(word), NUMBER.findall(other), strict=True)
    return all(near(*(float(n.replace("−", "-")) for n in pair)) for pair in pairs)


def near(a, b):
    return abs(a - b) <= NEAR * max(abs(a), abs(b))


@pytest.mark.parametrize(
    ("expected", "said", "same"),
    [
        ("a 10 b", "│ a │ 10.5 b", True),
        ("a 10 b", "a 12 b", False),
        ("a ... c", "a b b c", True),
        ("a ... c", "a b b", False),
        ("... a b", "a a b", True),
        ("a", "a b", False),
        ("12 served", "12 failed", False),
    ],
)
def test_outputs_are_compared(expected, said, same):
    assert agrees(expected, said) is same


def test_there_are_commands_in_every_tutorial():
    for page in PAGES:
        found = [what for what, *_ in steps(page.read_text(encoding="utf-8"))]
        assert found.count("command") >= 2, page.name


@pytest.fixture
def environment(tmp_path):
    """The commands of this environment first on the path; a state of its own."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return os.environ | {"PATH": path, "XDG_STATE_HOME": str(tmp_path / "state"), "COLUMNS": "100"}


@pytest.fixture
def port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_a_tutorial_says_what_happens(page, tmp_path, environment, port):
    folder = tmp_path / "work"
    folder.mkdir()
    started = []
    try:
        for what, name, text in steps(page.read_text(encoding="utf-8").replace("8786", str(port))):
            if what == "file":
                (folder / name).write_text(text, encoding="utf-8")
            elif name.endswith("&"):
                started.append(in_background(name.rstrip("& "), folder, environment))
            else:
                done = subprocess.run(
                    shlex.split(name), cwd=folder, env=environment, capture_output=True, text=True,
                    check=False,
                )  # fmt: skip
                assert done.returncode == 0, f"{name}\n{done.stdout}\n{done.stderr}"
                assert agrees(text, done.stdout), f"{name}\n{done.stdout}"
    finally:
        for process in started:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()


def in_background(command, folder, environment):
    return subprocess.Popen(
        shlex.split(command), cwd=folder, env=environment, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip


@pytest.mark.slow
def test_a_run_is_stopped_and_forked_as_the_page_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = (DOCS / "how-to" / "what-if.md").read_text(encoding="utf-8")
    exec("".join(text for kind, text in BLOCK.findall(page) if kind == "python"), {})
    moment, look, ends = capsys.readouterr().out.splitlines()
    assert "10 events, 10 served" in moment
    assert look.endswith(" 10")
    was, another = map(int, ends.split())
    assert was > another
    assert {path.name for path in tmp_path.glob("*.rrd")} == {"was.rrd", "fork.rrd"}
