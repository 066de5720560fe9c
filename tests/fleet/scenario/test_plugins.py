"""The user's own files: their siblings, where they are looked for, and when they never end."""

from __future__ import annotations

import os
import sys
from time import monotonic

import pytest

import fleet
from fleet.scenario import watchdog
from fleet.scenario.errors import BadInput
from fleet.scenario.loading import load_scenario
from fleet.scenario.plugins import files_of, load_object
from fleet.scenario.trial import trial

SIBLING = """\
from protocols.auctions import keep
from helper import measure

def mine(view, event, source):
    yield from ()
    return keep(view, source, event, measure)
"""
HELPER = "def measure(robot, site):\n    return {}.0\n"


@pytest.fixture
def folders(tmp_path):
    """Two folders of files with the same names."""
    made = []
    for n, name in enumerate(("a", "b")):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "mine.py").write_text(SIBLING)
        (folder / "helper.py").write_text(HELPER.format(n))
        made.append(folder)
    return made


def test_a_module_beside_the_file_is_its_own(folders):
    before = set(sys.modules)
    for n, folder in enumerate(folders):
        protocol = load_object(f"{folder / 'mine.py'}:mine", "protocol")
        assert protocol.__globals__["measure"](None, None) == float(n)
    assert "helper" not in set(sys.modules) - before


def test_all_files_that_a_protocol_is_made_of_are_known(folders):
    files = files_of(f"{folders[0] / 'mine.py'}:mine", "protocol")
    assert [file.name for file in files] == ["helper.py", "mine.py"]


def test_a_helper_that_was_edited_is_read_again(folders):
    reference = f"{folders[0] / 'mine.py'}:mine"
    load_object(reference, "protocol")
    (folders[0] / "helper.py").write_text(HELPER.format(77) + "# another length\n")
    os.utime(folders[0] / "helper.py", ns=(1, 1))
    assert load_object(reference, "protocol").__globals__["measure"](None, None) == 77.0


def test_paths_are_relative_to_the_file_that_names_them(folders, monkeypatch, tmp_path):
    (folders[0] / "one.toml").write_text(
        'protocol = "mine.py:mine"\nmotion = "straight"\nrounds = 2\n'
        '[world]\nname = "placed"\npositions = "here/places.csv"\n'
    )
    (folders[0] / "here").mkdir()
    (folders[0] / "here" / "places.csv").write_text("x,y\n1,1\n2,2\n")
    monkeypatch.chdir(tmp_path)
    scenario = load_scenario(folders[0] / "one.toml")
    assert fleet.run(scenario).robots == 2
    over = load_scenario(folders[0] / "one.toml", {}, [f"protocol={folders[1]}/mine.py:mine"])
    assert over.protocol.name == f"{folders[1]}/mine.py:mine"
    with pytest.raises(BadInput, match=r"--protocol: 'mine.py' is not a file"):
        load_scenario(None, {"protocol": "mine.py:mine"})  # an option's: from where we are


def test_a_file_that_a_users_protocol_is_given_is_beside_the_scenario_too(tmp_path):
    (tmp_path / "weights.dat").write_text("1 2 3\n")
    (tmp_path / "mine.py").write_text(
        "from pathlib import Path\n"
        "from protocols.messages import Award\n"
        "def mine(view, event, source, *, weights, mood):\n"
        "    assert mood == 'v1.0' and Path(weights).read_text() == '1 2 3\\n'\n"
        "    yield from ()\n"
        "    return Award(source, source)\n"
    )
    (tmp_path / "one.toml").write_text(
        '[protocol]\nname = "mine.py:mine"\nweights = "weights.dat"\nmood = "v1.0"\n'
    )
    parameters = load_scenario(tmp_path / "one.toml").protocol.parameters
    assert parameters == {"weights": str(tmp_path / "weights.dat"), "mood": "v1.0"}


LATER = """\
from protocols.messages import Award

def fails(view, event, source):
    yield from ()
    if len(view) > 2:
        missing = {}
        return missing[event.id]
    return Award(source, source)

def leaves(view, event, source):
    yield from ()
    if len(view) > 2:
        raise SystemExit(0)
    return Award(source, source)

def yields(view, event, source):
    if len(view) > 2:
        yield "hello"
    yield from ()
    return Award(source, source)

def returns(view, event, source):
    yield from ()
    return Award(source, source) if len(view) == 2 else "me"

def hangs(view, event, source):
    yield from ()
    while len(view) > 2:
        try:
            view[0].position
        except Exception:
            pass
    return Award(source, source)

def metric(robot, site):
    return 1.0 if robot.id < 2 and site[0] == 1.5 else 1.0 / (robot.id - robot.id)
"""


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("fails", "fails in line 7 of later.py: KeyError: 0"),
        ("leaves", "fails in line 13 of later.py: SystemExit: 0"),
        ("yields", "yields 'hello'; expected a Transmission"),
        ("returns", "ends with 'me'; expected an Award"),
        ("hangs", "of later.py: it does not come to an end within"),
    ],
)
def test_what_goes_wrong_after_the_rehearsal_is_one_sentence(tmp_path, monkeypatch, name, said):
    monkeypatch.setattr(watchdog, "PATIENCE", 0.5)
    (tmp_path / "later.py").write_text(LATER)
    keys = {"protocol": f"{tmp_path / 'later.py'}:{name}", "motion": "straight", "robots": 20}
    started = monotonic()
    with pytest.raises(BadInput) as refusal:
        fleet.run(fleet.Scenario.of(**keys, range=4.0, rounds=3))
    assert said in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert monotonic() - started < 20.0


def test_a_metric_that_fails_in_a_run_is_one_sentence(tmp_path):
    (tmp_path / "later.py").write_text(LATER)
    chosen = {"name": "rfta2", "metric": f"{tmp_path / 'later.py'}:metric"}
    with pytest.raises(BadInput, match=r"fails in line 36 of later.py: ZeroDivisionError"):
        fleet.run(fleet.Scenario.of(protocol=chosen, motion="straight", robots=20, range=4.0))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("while True: pass\n", "does not import in line 1 of later.py: it does not come to an end"),
        ("raise SystemExit(0)\n", "does not import in line 1 of later.py: SystemExit: 0"),
        ("import helper_that_is_not_there\n", "ModuleNotFoundError: No module named 'helper_"),
        ("x = 1\n", "has no 'mine', and no function at all"),
    ],
)
def test_files_that_do_not_import(tmp_path, monkeypatch, text, said):
    monkeypatch.setattr(watchdog, "PATIENCE", 0.5)
    (tmp_path / "later.py").write_text(text)
    with pytest.raises(BadInput) as refusal:
        load_object(f"{tmp_path / 'later.py'}:mine", "protocol")
    assert said in str(refusal.value)


def test_time_in_a_library_that_is_imported_does_not_count(tmp_path, monkeypatch):
    monkeypatch.setattr(watchdog, "PATIENCE", 0.3)
    (tmp_path / "slow_library.py").write_text("import time\ntime.sleep(1.0)\nx = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    home = tmp_path / "home"
    home.mkdir()
    (home / "own.py").write_text("from slow_library import x\n\ndef mine():\n    return x\n")
    assert load_object(f"{home / 'own.py'}:mine", "protocol")() == 1


UNTYPED = """
from protocols.auctions import AuctionRules, auction
from protocols.routing import find

class Own:
    pass

def mine(view, event, source, *, search, metric, share=0.5, own: Own = None):
    assert share in (0.5, "much")
    found = yield from find(view, source, event, search)
    return (yield from auction(view, found, event, metric, AuctionRules()))

def typed(view, event, source, *, own: "Nowhere" = None):
    yield from ()
"""


def test_parameters_without_types_take_what_a_file_holds(tmp_path):
    """And ``search`` and ``metric`` are what they are in all protocols."""
    (tmp_path / "own.py").write_text(UNTYPED)
    table = {"name": f"{tmp_path / 'own.py'}:mine", "metric": "energy-left", "share": "much"}
    own = fleet.run(fleet.Scenario.of(protocol=table, motion="straight", rounds=5))
    ours = fleet.run(fleet.Scenario.of(protocol="rfta2", motion="straight", rounds=5))
    assert (own.messages, own.energy_drained) == (ours.messages, ours.energy_drained)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("mine", "protocol.own: is to be of type 'Own', which no file can hold"),
        ("typed", "cannot be read: NameError: name 'Nowhere' is not defined"),
    ],
)
def test_types_that_no_file_can_hold_are_one_sentence(tmp_path, name, said):
    (tmp_path / "own.py").write_text(UNTYPED)
    table = {"name": f"{tmp_path / 'own.py'}:{name}", "metric": "energy-left", "own": 3}
    with pytest.raises(BadInput) as refusal:
        fleet.run(fleet.Scenario.of(protocol=table, motion="straight", rounds=5))
    assert said in str(refusal.value)


CLASSES = """
class Raises:
    def __init__(self): {}["x"]

class Hangs:
    def __init__(self):
        while True: pass

class Leaves:
    def __init__(self): raise SystemExit(3)

class Mute:
    pass

class Refuses:
    def __init__(self): raise ValueError("no mood for that")
"""


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Raises", "fails in line 3 of classes.py: KeyError: 'x'"),
        ("Hangs", "of classes.py: it does not come to an end within 0.5 s"),
        ("Leaves", "fails in line 10 of classes.py: SystemExit: 3"),
        ("Mute", "makes what cannot be called; expected a class with __call__"),
        ("Refuses", "no mood for that"),
    ],
)
@pytest.mark.parametrize("part", ["protocol", "metric"])
def test_classes_that_do_not_come_into_being(tmp_path, monkeypatch, part, name, said):
    monkeypatch.setattr(watchdog, "PATIENCE", 0.5)
    (tmp_path / "classes.py").write_text(CLASSES)
    reference = f"{tmp_path / 'classes.py'}:{name}"
    table = {"name": reference} if part == "protocol" else {"name": "rfta2", "metric": reference}
    with pytest.raises(BadInput) as refusal:
        fleet.run(fleet.Scenario.of(protocol=table, motion="straight", rounds=1))
    assert str(refusal.value).startswith("protocol")
    assert said in str(refusal.value)
    with pytest.raises(BadInput) as refusal:
        trial(reference)
    assert said in str(refusal.value)


def test_a_metric_that_does_not_end_is_told_by_its_trial(tmp_path, monkeypatch):
    monkeypatch.setattr(watchdog, "PATIENCE", 0.5)
    (tmp_path / "own.py").write_text("def slow(robot, site):\n    while True: pass\n")
    (verdict,) = trial(f"{tmp_path / 'own.py'}:slow")
    assert "line 2 of own.py: it does not come to an end" in verdict.problem
