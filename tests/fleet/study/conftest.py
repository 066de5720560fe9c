"""What the tests of studies share."""

from __future__ import annotations

from pathlib import Path

import pytest

from fleet.study import Job


@pytest.fixture(autouse=True)
def deeds_are_found(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parent)


@pytest.fixture(autouse=True)
def notes_of_their_own(monkeypatch, tmp_path_factory):
    """Which code was swept with is noted in the user's home, but not by tests."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))


@pytest.fixture
def log(tmp_path):
    """Where the work functions note that they were called."""
    return tmp_path / "calls.log"


@pytest.fixture
def make_tasks(log):
    """Make ``count`` jobs of a work function in deeds.py."""

    def make(count, function="note", **scenario):
        return [
            Job.of(
                {"n": n, "log": str(log), **scenario},
                cell=f"n={n}",
                labels={"label": n % 3},
                function=f"deeds:{function}",
            )
            for n in range(count)
        ]

    return make


@pytest.fixture
def calls(log):
    """What the work functions noted: the n of each call."""

    def read():
        if not log.exists():
            return []
        return [int(line.split()[0]) for line in log.read_text().splitlines()]

    return read
