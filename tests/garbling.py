"""What happens to files on their way, and an input of a fuzz test with the files it reads."""

from __future__ import annotations

import random
from dataclasses import dataclass, field


@dataclass
class Input:
    """A command, the files it reads, and the keys that were tampered with."""

    arguments: list[str]
    files: dict[str, bytes] = field(default_factory=dict)
    touched: list[tuple[str, str]] = field(default_factory=list)  # and what they were set to


def garbled(rng: random.Random, content: bytes) -> bytes:
    """Content with something done to it that happens to files."""
    what = rng.randrange(10)
    at, to = sorted((rng.randrange(len(content) + 1), rng.randrange(len(content) + 1)))
    if what == 0:
        return b"\xef\xbb\xbf" + content
    if what == 1:
        return content.replace(b"\n", b"\r\n")
    if what == 2:
        return content.decode("utf-8", "replace").encode("utf-16")
    if what == 3:
        return content[:at] + content[to:]
    if what == 4:
        return content[:at] + content[at:to] * 2 + content[to:]
    if what == 5:
        return content[:at] + rng.randbytes(rng.randrange(1, 9)) + content[at:]
    if what == 6:
        return content[:at]
    if what == 7:
        return content[:at] + rng.choice(b"[]{}=\"'#.,;\n\t\\\x00").to_bytes() + content[at:]
    if what == 8:
        return b"" if rng.random() < 0.5 else content * 50
    lines = content.split(b"\n")
    rng.shuffle(lines)
    return b"\n".join(lines)
