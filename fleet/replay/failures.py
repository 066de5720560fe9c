"""What can go wrong with a recording, and is nobody's mistake."""

from __future__ import annotations


class CannotRecord(RuntimeError):
    """The machine does not let a recording be written; the message says why."""
