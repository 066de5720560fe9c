"""Inputs that nobody would type on purpose, and many that somebody would: for the fuzz tests.

Everything is drawn from one ``random.Random``, so that an input is found again by its seed.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from inspect import signature
from pathlib import Path
from typing import Any

from garbling import Input, garbled
from nasty_logs import recorded_log, robot_file

from fleet.catalogue import takers
from fleet.scenario.binding import field_types, keywords
from fleet.scenario.choices import TABLES as PLAIN_TABLES
from fleet.scenario.model import Scenario

CATALOGUES = {
    kind: takers(kind) for kind in ("protocol", "world", "motion", "time", "radio", "events")
}

NUMBERS = (
    *("0", "-0.0", "1", "2", "-1", "3.5", "1e-320", "1e-9", "1e9", "1e15", "1e154", "1e308"),
    *("-1e308", "inf", "-inf", "nan", "9223372036854775807", "9223372036854775808", "0x7f"),
    *("1_000", "1" + 30 * "0", 5000 * "7", "0.30000000000000004", "4294967296", "65535"),
)  # fmt: skip
TEXTS = (
    *('""', '"x"', '"rfta2"', '"RFTA2"', '"distance"', '"a.py:b"', '"a.py"', '".py:"', '":"'),
    *(r'"\u0000"', r'"a\nb"', '"é😀"', f'"{10_000 * "y"}"', '"/dev/zero"', '"/dev/null"', '"/"'),
    *('"."', '"../.."', '"nowhere.csv"', '"%s %d {0}"', r'"\u001b[31m"', '"None"', '"inf"'),
)  # fmt: skip
OTHERS = (
    *("true", "false", "[]", "[[]]", "[1, 2]", "[[1, 2]]", "[[1, 2], [3]]", "[nan]", "{}"),
    *("{x = 1}", '{name = ""}', "{name = 1}", '{name = "rfta2"}', "[{}]", '["a", 1, true]'),
    *("1979-05-27", "07:32:00", "1979-05-27T07:32:00Z", 200 * "[" + 200 * "]"),
    *("[[0, 0], [0, 0], [0, 0]]", "[[1, 1], [4, 2], [2, 5]]", "[0.1, -0.1]", "[{time = 1}]"),
    "{a = {b = {c = {d = 1}}}}",
)  # fmt: skip
BROKEN = (
    *("", "=", "# no", "[", '"', "1 2", "x y z", "\\", "\x00", 2000 * "[", 3 * "'", "=1", "1,5"),
)  # fmt: skip
NASTY = (*NUMBERS, *TEXTS, *OTHERS)

BIG = {"robots", "rounds", "time.duration", "time.rate", "time.offers", "sensors.count"}
"""Keys whose large values mean long work, and not a hang."""


def literal(rng: random.Random, key: str, default: Any = None) -> str:
    """A value as TOML has it: near the default as a rule, or any other."""
    if rng.random() < 0.6:
        return near(rng, default)
    value = rng.choice(NASTY if rng.random() < 0.95 else BROKEN)
    big = key in BIG and value[:1].isdigit() and value not in ("0", "1", "2", "3.5", "1e-9")
    return "7" if big else value


def near(rng: random.Random, default: Any) -> str:
    """A value of the kind of the default, as a rule one that is taken."""
    if isinstance(default, bool):
        return rng.choice(("true", "false"))
    if isinstance(default, int):
        return str(max(0, default + rng.randrange(-2, 3)))
    if isinstance(default, float):
        return repr(round(rng.choice((default or 1.0, 0.3)) * rng.uniform(0.2, 2.0), 4))
    if isinstance(default, str):
        return f'"{default}"'
    return rng.choice(("1", "0.5", "2.0", '"distance"', "{}", "[]"))


def settings(rng: random.Random) -> dict[str, str]:
    """A scenario as dotted keys and literals: names that exist, a few keys with any value."""
    given = {
        choice: rng.choice(sorted(set(catalogue) - {"trace", "map", "placed"}))
        for choice, catalogue in CATALOGUES.items()
        if rng.random() < 0.4
    }
    given["motion"] = rng.choice(("straight",) * 9 + ("path",))
    chosen = {f"{choice}.name": f'"{name}"' for choice, name in given.items()}
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        key, default = any_key(rng, given)
        for other in [other for other in chosen if other.startswith(f"{key}.")]:
            del chosen[other]
        chosen[key] = literal(rng, key, default)
    return chosen


def any_key(rng: random.Random, given: dict[str, str]) -> tuple[str, Any]:
    """A dotted key of a scenario with its default, of the tables that were chosen as a rule."""
    kind = rng.random()
    if kind < 0.4:
        choice = rng.choice(sorted(CATALOGUES))
        catalogue = CATALOGUES[choice]
        name = given.get(choice, getattr(Scenario(), choice).name)
        function = catalogue[name if kind < 0.35 else rng.choice(sorted(catalogue))]
        keys = sorted(keywords(function))
        key = rng.choice(keys) if keys else ""
        return (f"{choice}.{key}", default_of(function, key)) if key else (choice, name)
    if kind < 0.7:
        table = rng.choice(sorted(PLAIN_TABLES))
        key = rng.choice(sorted(field_types(PLAIN_TABLES[table])))
        return f"{table}.{key}", default_of(PLAIN_TABLES[table], key)
    if kind < 0.95:
        key = rng.choice(sorted(Scenario.__dataclass_fields__))
        return key, default_of(Scenario, key)
    odd = ("protocol.search.stop", "protocol.search.radius", "x", "a.b.c.d", "robot.x")
    return rng.choice(odd), "edge"


def default_of(function: Callable[..., Any], key: str) -> Any:
    """The default of a parameter."""
    return signature(function).parameters[key].default


def as_file(rng: random.Random, chosen: dict[str, str]) -> str:
    """The same as a TOML file."""
    top = [f"{key} = {value}" for key, value in chosen.items() if "." not in key]
    tables: dict[str, list[str]] = {}
    for key, value in chosen.items():
        if "." in key:
            table, _, name = key.rpartition(".")
            tables.setdefault(table, []).append(f"{name} = {value}")
    for table, lines in tables.items():
        top += [f"[{table}]", *lines]
    return "\n".join(top) + "\n"


def scenario(rng: random.Random) -> Input:
    """``fleet run`` with a file, with options, or with both."""
    chosen = settings(rng)
    by_option = {key for key in chosen if rng.random() < 0.3}
    text = as_file(rng, {key: value for key, value in chosen.items() if key not in by_option})
    content = text.encode()
    touched = [item for item in chosen.items() if not item[0].endswith(".name")]
    if rng.random() < 0.3:
        content, touched = garbled(rng, content), []
    arguments = ["run", "scenario.toml"]
    for key in by_option:
        arguments += ["--set", f"{key}={chosen[key]}"]
    return Input(arguments + ending(rng), {"scenario.toml": content}, touched)


def ending(rng: random.Random) -> list[str]:
    """Only looked at, as a rule; or run, for a few small rounds."""
    if rng.random() < 0.15:
        return ["--dump"]
    if rng.random() < 0.5:
        return ["--dry"]
    return ["--robots", "20", "--set", "rounds=2", "--set", "connected=false", "--json"]


OPTIONS = (
    *("--protocol", "--world", "--motion", "--robots", "--range", "--search-radius", "--rounds"),
    *("--seed", "--set", "--rrd", "--json", "--dry", "--dump", "--at", "--from", "--out", "-o"),
    *("--workers", "--quick", "--fps", "--by", "--theme", "--help", "--scheduler", "-x", "--", "-"),
)  # fmt: skip
COMMANDS = ("run", "run", "run", "report", "replay", "picture", "view", "sweep", "list", "nothing")


def options(rng: random.Random) -> Input:
    """Any command with any options."""
    command = rng.choice(COMMANDS)
    arguments = [command]
    for _ in range(rng.randrange(4)):
        arguments.append(rng.choice(OPTIONS))
        if rng.random() < 0.7:
            value = (
                rng.choice((*NASTY, *BROKEN))
                .strip("\"'")
                .replace("\x00", "")
                .replace(r"\u0000", "")
            )
            arguments.append(value[:3000])
    if rng.random() < 0.3:
        arguments.append(rng.choice(("scenario.toml", "nowhere", "", ".", "/dev/null")))
    return Input([*arguments, *(["--dry"] if command == "run" else [])])


def study(rng: random.Random) -> Input:
    """A study file, to be checked and not run."""
    chosen = settings(rng)
    seeds = rng.choice(("", "seeds = 2", "seeds = [1, 2]", f"seeds = {literal(rng, '', 3)}"))
    wrong = rng.choice(("title", "tables", "report", "scenario", "axes", "paired", "cases"))
    top = [f"{wrong} = {literal(rng, '')}"] if rng.random() < 0.3 else []
    base = {f"scenario.{key}": value for key, value in chosen.items() if rng.random() < 0.6}
    text = "\n".join([seeds, *top]) + "\n" + as_file(rng, base)
    where = rng.choice(("axes", "axes", "[paired]", "[cases]"))
    text += f"[{where}]\n"
    for key in [key for key in chosen if f"scenario.{key}" not in base] or ["search_radius"]:
        value = chosen.get(key, "1.5")
        others = [literal(rng, key, 1.0) for _ in range(rng.choice((0, 0, 1, 2)))]
        text += rng.choice((key, repr(key)))
        text += f" = {value}\n" if where == "[cases]" else f" = [{', '.join([value, *others])}]\n"
    if rng.random() < 0.2:
        part = rng.choice(("x", "series", "baseline", "measures", "y"))
        text += f"[report]\n{part} = {literal(rng, '', 'protocol')}\n"
    content = text.encode()
    if rng.random() < 0.25:
        content = garbled(rng, content)
    return Input(["check-study", "study.toml"], {"study.toml": content})


CELLS = (
    *("1", "2.5", "9.9", "-1", "1e400", "nan", "inf", "", " ", "x", '"', '"1"', "1,5", "0x1", "é"),
    *("1_000", "1e5", "-0", "٣", "=1+1", "\x00", "1" * 200, "True", "0,5", "'"),
)  # fmt: skip


def table(rng: random.Random) -> Input:
    """A CSV file: places, or a trace of events."""
    places = rng.random() < 0.5
    names = ["x", "y"] if places else ["time", "x", "y", "service", "deadline"]
    width = 2 if places else rng.randrange(3, 6)
    between = rng.choice((",", ",", ",", ";", "\t", " ", "|"))
    rows = []
    if rng.random() < 0.5:
        rows.append(between.join(names[:width]))
    for n in range(rng.randrange(1, 8)):
        row = [f"{n}.0", *(f"{9 * rng.random():.2f}" for _ in range(width - 1))]
        if rng.random() < 0.2:
            row[rng.randrange(width)] = rng.choice(CELLS)
        if rng.random() < 0.1:
            row = row[: rng.randrange(width + 1)] + rng.choices(CELLS, k=rng.randrange(3))
        rows.append(between.join(row))
    content = (rng.choice(("\n", "\n", "\r\n", "\r")).join(rows) + "\n").encode()
    if rng.random() < 0.3:
        content = garbled(rng, content)
    arguments = ["run", "--motion", "straight", "--set", "connected=false", "--set", "rounds=2"]
    if places:
        arguments += ["--world", "placed", "--set", "world.positions=table.csv"]
    else:
        arguments += ["--set", "events.name=trace", "--set", "events.occurrences=table.csv"]
        arguments += ["--robots", "20", *rng.choice(((), ("--set", "time.name=stream")))]
    return Input(arguments, {"table.csv": content})


MAP = {
    "image": "floor.pgm",
    "resolution": "0.5",
    "origin": "[0.0, 0.0, 0.0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
YAML = (
    *("", "~", "x", "-1", "0", "nan", "inf", "1e308", "[]", "{}", "[1, 2]", "[a, b, c]", "!!x y"),
    *("*a", "&a [*a, *a]", "floor.png", "/dev/zero", "../floor.pgm", "[0, 0, 1.57]", '"', "- - -"),
    *("[-3, 4, 0]", "[1e9, 0, 0]", "1e-300", "0x10", "true", "scale", 3000 * "[", 3000 * "9"),
)  # fmt: skip
BOMB = b"a: &a [x]\n" + b"".join(
    b"%c: &%c [%s]\n" % (98 + n, 98 + n, b", ".join([b"*%c" % (97 + n)] * 9)) for n in range(12)
)


def floor_map(rng: random.Random) -> Input:
    """A map: a YAML file and a picture."""
    keys = dict(MAP)
    if rng.random() < 0.6:
        keys[rng.choice((*MAP, "mode", "x"))] = rng.choice(YAML)
    if rng.random() < 0.1:
        del keys[rng.choice(sorted(keys))]
    text = "".join(f"{key}: {value}\n" for key, value in keys.items()).encode()
    text = rng.choice((BOMB, BOMB + text)) if rng.random() < 0.02 else text
    width, height = rng.choice(((12, 9), (12, 9), (1, 1), (0, 5), (30, 2), (99999, 99999)))
    size = width * height if width < 99 else 40
    pixels = bytes(rng.choice((254, 254, 254, 254, 0, 205)) for _ in range(size))
    header = rng.choice((b"P5\n%d %d\n255\n",) * 9 + (b"P2\n%d %d\n255\n", b"P5 %d %d 70000 "))
    image = header % (width, height) + pixels
    which = rng.random()
    text = garbled(rng, text) if which < 0.2 else text
    image = garbled(rng, image) if 0.2 < which < 0.4 else image
    arguments = ["run", "--world", "map", "--set", "world.file=floor.yaml", "--motion", "straight"]
    arguments += ["--robots", "3", "--set", "connected=false", "--rounds", "1"]
    return Input(arguments, {"floor.yaml": text, "floor.pgm": image})


PROTOCOL_LINES = """\
    pass
    yield
    yield 1
    return 1
    raise ValueError('x' * 999)
    1 / 0
    yield Transmission('call', source, None)
    yield Transmission('x', 0, 1)
    yield Transmission('bid', source, 5)
    return Award(source, source)
  x
    return Award(-1, source)
    return Award(99, 99)
    view[99]
    exit()
    return Award('a', None)
    view[0].x
    raise SystemExit(3)
import nowhere
    yield Transmission('call', 99, None)
    yield from view
    event.id = 3
    return Award(None, source, (1, 2))
    from helper import x
    while False: pass
    yield Transmission('call', 'a', None)
    yield Transmission(1, source, source)
""".splitlines()


def own_protocol(rng: random.Random) -> Input:
    """A protocol of the user's, right for two robots or not."""
    lines = ["from protocols.messages import Award, Transmission", ""]
    head = rng.choice(("def mine(view, event, source):",) * 8 + (
        "def mine(view, event, source, *, n: int = 1):", "def mine():", "class mine:", "mine = 3",
        "def mine(*args):", "async def mine(view, event, source):", "mine = lambda *a: iter(())",
    ))  # fmt: skip
    if rng.random() < 0.5:
        lines += [head, "    if len(view) > 2:", *("    " + x for x in rng.choices(PROTOCOL_LINES))]
        lines += ["    yield from ()", "    return Award(source, source)", ""]
    else:
        lines += [
            head,
            *rng.choices(PROTOCOL_LINES, k=rng.randrange(1, 4)),
            "    yield from ()",
            "",
        ]
    content = "\n".join(lines).encode()
    if rng.random() < 0.2:
        content = garbled(rng, content)
    name = rng.choice(("mine",) * 9 + ("min", ""))
    arguments = ["run", "--protocol", f"own.py:{name}", "--motion", "straight", "--robots", "20"]
    arguments += ["--set", "connected=false", "--rounds", "2"]
    return Input(arguments, {"own.py": content})


KINDS = {
    "scenario": scenario,
    "options": options,
    "study": study,
    "table": table,
    "map": floor_map,
    "protocol": own_protocol,
    "log": recorded_log,
    "robot": robot_file,
}


def draw(kind: str, seed: int) -> Input:
    """The input of that kind and seed."""
    return KINDS[kind](random.Random(f"{kind} {seed}"))


def write(made: Input, folder: Path) -> None:
    """Put its files there."""
    for name, content in made.files.items():
        (folder / name).write_bytes(content)
