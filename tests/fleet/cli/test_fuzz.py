"""Whatever is typed or read: exit code 0 or 2, no traceback, no hang, one short message.

``FUZZ=N`` tries N inputs of each kind, from the one after those of the slow test on.
"""

from __future__ import annotations

import os
import signal
from contextlib import contextmanager
from pathlib import Path
from shutil import rmtree

import nasty
import pytest
from click.testing import CliRunner

from fleet.cli import main
from fleet.cli.exits import told
from fleet.scenario.errors import BadInput
from fleet.study.study_file import load_study

MOST_SECONDS = 5.0  # of CPU time
MOST_SAID = 500  # characters
SLOW = {
    "scenario": 9000,
    "options": 3000,
    "study": 3000,
    "table": 3000,
    "map": 1000,
    "protocol": 1000,
    "log": 500,
    "robot": 500,
}
CHUNK = 500


class TooLong(BaseException):
    """It hangs."""


@contextmanager
def limited(seconds):
    """So much CPU time and no more."""

    def ring(*_):
        raise TooLong

    signal.signal(signal.SIGPROF, ring)
    signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, 20 * seconds)  # it waits for something
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 0.0)


@pytest.fixture(scope="session", autouse=True)
def compiled():
    """Machine code is made once, outside of the time that an input is given."""
    for keys in (["--motion", "path"], ["--motion", "physics", "--set", 'radio.name="csma"']):
        done = CliRunner().invoke(main, ["run", "--rounds", "2", "--robots", "30", *keys])
        assert done.exit_code in (0, 2), done.output
    for radio in ("lossy", "csma"):
        time = 'time={name="stream",duration=5.0}'
        args = ["run", "--motion", "straight", "--set", f'radio.name="{radio}"', "--set", time]
        assert CliRunner().invoke(main, args).exit_code == 0


def finding(kind, seed, folder):
    """What is wrong with how the input of that kind and seed was met; nothing, as it should be."""
    made = nasty.draw(kind, seed)
    for old in folder.iterdir():
        rmtree(old) if old.is_dir() else old.unlink()
    nasty.write(made, folder)
    with limited(MOST_SECONDS):
        try:
            if made.arguments[0] == "check-study":
                code, said = checked(folder / made.arguments[1])
            else:
                result = CliRunner().invoke(main, made.arguments)
                code, said = result.exit_code, result.stderr
                if result.exception and not isinstance(result.exception, SystemExit):
                    return f"raised {result.exception!r}"
        except TooLong:
            return "took too long"
    if code not in (0, 2):
        return f"exit code {code}: {said}"
    if len(said) > MOST_SAID:
        return f"{len(said)} characters: {said}"
    if code == 2 and len(made.touched) == 1 and not names(said, *made.touched[0]):
        return f"does not name {made.touched[0]}: {said}"
    return None


def checked(path):
    """A study looked at, as ``fleet sweep`` does before it runs anything."""
    try:
        load_study(path)
    except BadInput as error:
        return 2, "\n".join(told(str(error).splitlines()))
    return 0, ""


def names(said, key, value):
    """Whether the message names the key, or a part of it, or where the fault is otherwise."""
    table, _, name = key.rpartition(".")
    parts = [name, value.strip('"'), *([f"{table}:"] if "." in table else [])]
    return any(part in said for part in [*parts, "TOML", "is missing"])


def look(kind, seeds, folder, monkeypatch):
    monkeypatch.chdir(folder)
    monkeypatch.setenv("COLUMNS", "200")
    found = {seed: what for seed in seeds if (what := finding(kind, seed, folder))}
    said = []
    for seed, what in list(found.items())[:5]:
        made = nasty.draw(kind, seed)
        said.append(f"{kind} {seed}: {what[:600]}\n  {made.arguments}\n  {made.files}"[:3000])
    assert not found, f"{len(found)} of {len(seeds)}\n" + "\n".join(said)


@pytest.mark.parametrize("kind", nasty.KINDS)
def test_a_few_inputs_of_every_kind(kind, tmp_path, monkeypatch):
    look(kind, range(60), tmp_path, monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "start"),
    [(kind, start) for kind, count in SLOW.items() for start in range(0, count, CHUNK)],
)
def test_twenty_thousand_inputs(kind, start, tmp_path, monkeypatch):
    look(kind, range(start, start + CHUNK), tmp_path, monkeypatch)


@pytest.mark.slow
@pytest.mark.skipif("FUZZ" not in os.environ, reason="FUZZ=N tries N further inputs of each kind")
@pytest.mark.parametrize("kind", nasty.KINDS)
def test_further_inputs(kind, tmp_path, monkeypatch):
    look(kind, range(SLOW[kind], SLOW[kind] + int(os.environ["FUZZ"])), tmp_path, monkeypatch)


def test_there_are_twenty_thousand():
    assert sum(SLOW.values()) >= 20_000
    assert set(SLOW) == set(nasty.KINDS)
    assert Path(nasty.__file__).name == "nasty.py"
