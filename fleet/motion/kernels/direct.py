"""Calling a kernel without asking again what types its arguments have.

For the tuples of record arrays that kernels work on, numba takes longer to find that out than
the shorter kernels take.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


def direct(kernel: F) -> F:
    """The machine code of ``kernel``, if it has been called in this process, and always with
    arguments of the same types; otherwise, and if nothing is compiled, ``kernel`` itself.

    Numbers are converted; arrays must be what they were, contiguous ones too.
    """
    overloads = getattr(kernel, "overloads", {})
    if len(overloads) != 1:
        return kernel
    (compiled,) = overloads.values()
    entry_point: F = compiled.entry_point
    return entry_point
