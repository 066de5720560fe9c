"""All benchmarks, one after another, or those that are named.

make bench, or: python benchmarks/run.py lifetimes live

The machines that this runs on are shared and noisy: what is compared is measured in one run,
and given as a ratio.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
ALL = ("lifetimes", "motion", "live", "delivery", "replay", "scrubbing", "study")


def main() -> None:
    wanted = sys.argv[1:] or ALL
    unknown = [name for name in wanted if name not in ALL]
    if unknown:
        sys.exit(f"unknown benchmark {unknown[0]!r}; expected {', '.join(ALL)}")
    failed = [name for name in wanted if not passed(name)]
    sys.exit(f"failed: {', '.join(failed)}" if failed else 0)


def passed(name: str) -> bool:
    print(f"\n== {name} " + "=" * (76 - len(name)), flush=True)
    return subprocess.run([sys.executable, str(HERE / f"{name}.py")], check=False).returncode == 0


if __name__ == "__main__":
    main()
