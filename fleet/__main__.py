"""The command ``fleet``, and ``python -m fleet``: interrupted at any moment, it exits with 130."""

from __future__ import annotations

import sys


def main() -> None:
    """Load the command line and run it. Ctrl-C is looked after before anything is imported."""
    try:
        from fleet.cli import main as command_line

        command_line()
    except KeyboardInterrupt:
        sys.stderr.write("fleet: interrupted\n")
        leave()
    except SystemExit as end:
        if end.code == 130:
            leave()
        import signal

        signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done; what is left is Python's own
        raise


def leave() -> None:
    """Exit with 130. Left to itself, Python may end by the signal, or say where it was."""
    import atexit
    import os
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    atexit._run_exitfuncs()
    sys.stdout.flush()
    os._exit(130)


if __name__ == "__main__":
    main()
