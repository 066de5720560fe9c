"""Ctrl-C at any moment: one line, exit code 130, no traceback."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time

import pytest

LONG = "time={name='stream',rate=2.0,duration=20000.0}"
COMMANDS = {
    "run": ["run", "--motion", "straight", "--set", LONG],
    "path": ["run", "--motion", "path", "--rounds", "40"],
    "list": ["list"],
    "dump": ["run", "--dump"],
}
STARTED = 0.4  # [s] before that the interpreter itself may be starting, and looks after nothing

WAITING = """
import sys, builtins
loaded = builtins.__import__
def importing(name, *rest):
    if name.startswith({name!r}):
        raise KeyboardInterrupt  # as if it came at this very moment
    return loaded(name, *rest)
builtins.__import__ = importing
sys.argv = ["fleet", *{arguments!r}]
from fleet.__main__ import main
main()
"""


def check(code, said, *, may_be_done=False):
    assert "Traceback" not in said
    assert code == 130 or (may_be_done and code == 0), (code, said)
    assert code == 0 or said.strip().endswith("fleet: interrupted")


@pytest.mark.parametrize(
    "name",
    ["click", "fleet.cli", "fleet.cli.exits", "fleet.assembly", "pydantic", "rich"],
)
def test_while_something_is_imported(name):
    code = WAITING.format(name=name, arguments=["run", "--motion", "straight", "--rounds", "3"])
    done = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    check(done.returncode, done.stderr)


def test_a_run_that_is_interrupted_says_so():
    check(*interrupted("run", 6.0))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(24))
def test_at_any_moment(seed):
    rng = random.Random(seed)
    check(*interrupted(rng.choice(sorted(COMMANDS)), rng.uniform(STARTED, 4.0)), may_be_done=True)


def interrupted(command, after):
    """Start the command, interrupt it after so many seconds; its exit code and what it said."""
    process = subprocess.Popen(
        [sys.executable, "-m", "fleet", *COMMANDS[command]],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    time.sleep(after)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    return process.returncode, said
