"""Which local files a Python file runs: what it imports, and what that imports. Nothing is run."""

from __future__ import annotations

import ast
import sys
import sysconfig
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import NamedTuple

OURS = frozenset({"fleet", "protocols", "worlds"})
INSTALLED = ("site-packages", "dist-packages")


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] in OURS


class Import(NamedTuple):
    """What an import statement asks for."""

    module: str  # dotted; relative ones begin with dots
    names: tuple[str, ...]  # which may be modules too


class Code(NamedTuple):
    """What a file runs besides the standard library and this program."""

    files: tuple[Path, ...]  # local ones, the file itself first
    packages: tuple[str, ...]  # top-level names of what is installed


def code_of(path: Path, package: str = "", known: Callable[[str], bool] = _is_ours) -> Code:
    """The local files that running ``path`` may run, and the installed packages it imports.

    Imports are read from the source, inside functions too; modules are looked for beside the
    file, then where Python looks. One that is imported under a name made at run time is not seen.
    ``package`` is the one around the file; modules whose dotted name is ``known`` are left out.
    """
    first = path.resolve()
    folders = [str(first.parent), *(entry for entry in sys.path if entry)]
    files: dict[Path, None] = {}
    packages: dict[str, None] = {}
    waiting = [(first, package)]
    while waiting:
        file, around = waiting.pop()
        if file in files:
            continue
        files[file] = None
        for module in _modules(file, around):
            top = module.partition(".")[0]
            if top in sys.stdlib_module_names or known(module):
                continue
            for spec in _specs(module, folders):
                if known(spec.name):
                    continue
                if _is_installed(spec):
                    packages[top] = None
                elif spec.has_location and spec.origin:
                    inner = spec.name if spec.submodule_search_locations else spec.parent
                    waiting.append((Path(spec.origin).resolve(), inner or ""))
    return Code(tuple(files), tuple(sorted(packages)))


def _modules(file: Path, package: str) -> Iterator[str]:
    """The dotted names that a file may import, of modules or of things in them."""
    stat = file.stat()
    for module, names in _imports(file, stat.st_mtime_ns, stat.st_size):
        dots = len(module) - len(module.lstrip("."))
        base = module
        if dots:
            parts = package.split(".") if package else []
            kept = parts[: len(parts) - dots + 1]
            base = ".".join([*kept, *filter(None, [module[dots:]])])
        if base:
            yield base
        yield from (f"{base}.{name}" if base else name for name in names)


@cache
def _imports(file: Path, _modified: int, _size: int) -> tuple[Import, ...]:
    if file.suffix != ".py":
        return ()
    try:
        tree = ast.parse(file.read_bytes())
    except (SyntaxError, ValueError):  # it will not run, and its reader says so
        return ()
    found: list[Import] = []
    for node in _walk(tree):
        if isinstance(node, ast.Import):
            found += [Import(name.name, ()) for name in node.names]
        elif isinstance(node, ast.ImportFrom):
            module = "." * node.level + (node.module or "")
            found.append(Import(module, tuple(n.name for n in node.names if n.name != "*")))
        elif isinstance(node, ast.Call) and _is_importing(node.func) and node.args:
            named = node.args[0]
            if isinstance(named, ast.Constant) and isinstance(named.value, str):
                found.append(Import(named.value, ()))
    return tuple(found)


def _walk(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes but those that only type checkers read."""
    yield node
    if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
        children: Iterable[ast.AST] = node.orelse
    else:
        children = ast.iter_child_nodes(node)
    for child in children:
        yield from _walk(child)


def _is_importing(function: ast.expr) -> bool:
    name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    return name in {"import_module", "__import__"}


def _specs(module: str, folders: Sequence[str]) -> Iterator[ModuleSpec]:
    """Where a module and the packages around it are, as far as they are there."""
    search: Sequence[str] = folders
    parts = module.split(".")
    for length in range(1, len(parts) + 1):
        spec = PathFinder.find_spec(".".join(parts[:length]), list(search))
        if spec is None:
            return
        yield spec
        if spec.submodule_search_locations is None:
            return
        search = list(spec.submodule_search_locations)


@cache
def _standard() -> tuple[str, ...]:
    paths = sysconfig.get_paths()
    return tuple({str(Path(paths[name]).resolve()) for name in ("stdlib", "platstdlib")})


def _is_installed(spec: ModuleSpec) -> bool:
    """Whether a package manager, not the user, put it there."""
    places = [spec.origin or "", *(spec.submodule_search_locations or ())]
    return any(
        part in Path(place).parts or place.startswith(_standard())
        for place in places
        if place
        for part in INSTALLED
    )
