"""One name, one thing: no two files of ``fleet`` are called the same, and no two classes."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parent.parent
PACKAGES = ("fleet", "protocols", "worlds")


def test_no_two_files_of_fleet_share_a_name():
    assert shared(files()) == {}


def test_no_two_classes_share_a_name():
    assert shared(classes()) == {}


def files():
    """The Python files of ``fleet`` by name, with the places where they stand."""
    found = defaultdict(list)
    for path in (ROOT / "fleet").rglob("*.py"):
        if path.name != "__init__.py":
            found[path.name].append(path)
    return found


def classes():
    """All classes by name, nested ones too, with the files that define them."""
    found = defaultdict(list)
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ClassDef):
                    found[node.name].append(path)
    return found


def shared(found):
    """The names that stand for more than one thing, and where."""
    return {name: places for name, places in found.items() if len(places) > 1}
