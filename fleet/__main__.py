"""The command ``fleet``, and ``python -m fleet``: interrupted at any moment, it exits with 130."""

from __future__ import annotations

import signal
import sys


def main() -> None:
    """Load the command line and run it. Nothing is imported before Ctrl-C is looked after."""
    try:
        from fleet.cli import main as command_line

        command_line()
    except KeyboardInterrupt:
        sys.stderr.write("fleet: interrupted\n")
        sys.exit(130)
    finally:  # what is left to do is Python's own: nothing to be told of it
        signal.signal(signal.SIGINT, signal.SIG_DFL)


if __name__ == "__main__":
    main()
