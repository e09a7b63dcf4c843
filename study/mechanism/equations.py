"""Equations of motion for one clearance joint (`rigid`) or two (`two_joints`).

The compiler picks them by the number of laws. The state of a joint while it is stepped is here too.
"""

from typing import Any

import numpy as np
from numba.extending import overload

from study.compiled import compiled
from study.mechanism import rigid, two_joints

CONTACT, BRANCH, APPROACH, DEEP, NUMBER = range(5)
"""State of a joint: in contact or not, friction branch, approach speed, the depth to which this
speed can lead, and the number of the impact."""
Laws = tuple[np.record, ...]
"""A packed law for each clearance joint, slider's and crank's. The compiler knows their number, and
makes loops for each."""


def move(y: Any, pieces: Any, p: Any, laws: Any) -> Any:
    """Accelerations, powers and forces of the mechanism with these joints."""
    raise TypeError("in compiled code only")


@overload(move, inline="always")
def _move_compiled(y, pieces, p, laws):
    if len(pieces) == 1:
        return lambda y, pieces, p, laws: rigid.motion(y, pieces[0], p, laws[0])
    return lambda y, pieces, p, laws: two_joints.motion(y, pieces, p, laws)


def derive(y: Any, pieces: Any, p: Any, found: Any, parts: Any, k: Any) -> None:
    """Fill ``k`` with the derivatives of the accelerations that `move` found."""
    raise TypeError("in compiled code only")


@overload(derive, inline="always")
def _derive_compiled(y, pieces, p, found, parts, k):
    if len(pieces) == 1:
        return lambda y, pieces, p, found, parts, k: rigid.derive(y, pieces[0], p, found, parts, k)
    return lambda y, pieces, p, found, parts, k: two_joints.derive(y, pieces, p, found, parts, k)


def record(row: Any, y: Any, pieces: Any, found: Any, parts: Any, p: Any) -> None:
    """Fill a row of output, which has its time already."""
    raise TypeError("in compiled code only")


@overload(record, inline="always")
def _record_compiled(row, y, pieces, found, parts, p):
    if len(pieces) == 1:
        return lambda row, y, pieces, found, parts, p: rigid.record(
            row, y, pieces[0][0], found, parts, p
        )
    return lambda row, y, pieces, found, parts, p: two_joints.record(row, y, found, parts, p)


def pieces_of(joints: Any, laws: Any) -> Any:
    """(In contact?, friction branch, approach speed) of each joint."""
    raise TypeError("in compiled code only")


@compiled
def _piece(one):
    return one[CONTACT] > 0, int(one[BRANCH]), one[APPROACH]


@overload(pieces_of, inline="always")
def _pieces_compiled(joints, laws):
    if len(laws) == 1:
        return lambda joints, laws: (_piece(joints[0]),)
    return lambda joints, laws: (_piece(joints[0]), _piece(joints[1]))


@compiled
def motion(work, p, laws):
    """Accelerations, powers and forces at the current state, with the derivatives in ``k``."""
    pieces = pieces_of(work.joints, laws)
    found, parts = move(work.y, pieces, p, laws)
    derive(work.y, pieces, p, found, parts, work.k)
    return found
