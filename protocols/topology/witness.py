"""When a third robot keeps two from being linked: the one rule of the Gabriel graph.

It is written once, for arrays as NumPy takes them and for numbers as compiled loops do.
"""

from __future__ import annotations

from typing import Any

RIGHT_ANGLE = 1e-9  # [rad] how near to a right angle counts as one,
BESIDE = 1e-16  # but not for robots so much nearer to one end (squared): both would yield


def between(u: Any, v: Any, w: Any, to_u: Any, to_v: Any) -> Any:
    """Whether ``w`` keeps ``u`` and ``v`` apart: it is in the closed disc over them.

    ``to_u``, ``to_v``: pairs of x and y, from w to u and to v [m]; NaN: there is nobody. Ids and
    coordinates are numbers, or arrays that broadcast. ``w`` is neither of the two. Of robots in
    one place, the one with the lowest id stands for all.
    """
    (ux, uy), (vx, vy) = to_u, to_v
    uw, vw = ux * ux + uy * uy, vx * vx + vy * vy
    dot = ux * vx + uy * vy
    near_right = dot * dot <= RIGHT_ANGLE * RIGHT_ANGLE * uw * vw
    inside = (dot <= 0.0) | (near_right & (uw > BESIDE * vw) & (vw > BESIDE * uw))
    apart_u, apart_v = uw != 0.0, vw != 0.0
    lower = (apart_u | (w < u)) & (apart_v | (w < v))
    return (apart_u & apart_v & inside) | (((uw == 0.0) | (vw == 0.0)) & lower)
