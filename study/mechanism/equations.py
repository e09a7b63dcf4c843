"""Equations of motion for one clearance joint (`rigid`) or two (`two_joints`).

The compiler picks them by the number of laws, so that the number of unknowns is known to it. The
state of a joint while it is stepped is here too.
"""

from typing import Any

import numpy as np
from numba.extending import overload

from study.compiled import compiled
from study.mechanism import rigid, two_joints

CONTACT, BRANCH, APPROACH, DEEP, NUMBER = range(5)
"""State of a joint: in contact or not, friction branch, approach speed, the depth to which this
speed can lead, and the number of the impact. The first three are its mode: while they stay, the
equations are smooth."""
Laws = tuple[np.record, ...]
"""A packed law for each clearance joint, slider's and crank's. The compiler knows their number, and
makes loops for each."""


def move(y: Any, modes: Any, p: Any, laws: Any) -> Any:
    """Motion of the mechanism with joints in these modes, and what `derive` needs."""
    raise TypeError("in compiled code only")


@overload(move, inline="always")
def _move_compiled(y, modes, p, laws):
    if len(modes) == 1:
        return lambda y, modes, p, laws: rigid.motion(y, modes[0], p, laws[0])
    return lambda y, modes, p, laws: two_joints.motion(y, modes, p, laws)


def derive(y: Any, modes: Any, p: Any, motion: Any, parts: Any, k: Any) -> None:
    """Fill ``k`` with the derivatives of the accelerations that `move` returned."""
    raise TypeError("in compiled code only")


@overload(derive, inline="always")
def _derive_compiled(y, modes, p, motion, parts, k):
    if len(modes) == 1:
        return lambda y, modes, p, motion, parts, k: rigid.derive(y, modes[0], p, motion, parts, k)
    return lambda y, modes, p, motion, parts, k: two_joints.derive(y, modes, p, motion, parts, k)


def record(row: Any, y: Any, modes: Any, motion: Any, parts: Any, p: Any) -> None:
    """Fill a row of output, which has its time already."""
    raise TypeError("in compiled code only")


@overload(record, inline="always")
def _record_compiled(row, y, modes, motion, parts, p):
    if len(modes) == 1:
        return lambda row, y, modes, motion, parts, p: rigid.record(
            row, y, modes[0][0], motion, parts, p
        )
    return lambda row, y, modes, motion, parts, p: two_joints.record(row, y, motion, parts, p)


def modes_of(joints: Any, laws: Any) -> Any:
    """(In contact?, friction branch, approach speed) of each joint."""
    raise TypeError("in compiled code only")


@compiled
def _mode(joint):
    return joint[CONTACT] > 0, int(joint[BRANCH]), joint[APPROACH]


@overload(modes_of, inline="always")
def _modes_compiled(joints, laws):
    if len(laws) == 1:
        return lambda joints, laws: (_mode(joints[0]),)
    return lambda joints, laws: (_mode(joints[0]), _mode(joints[1]))


@compiled
def current_motion(work, p, laws):
    """Motion at the current state, with the derivatives of its accelerations in ``k``."""
    modes = modes_of(work.joints, laws)
    motion, parts = move(work.y, modes, p, laws)
    derive(work.y, modes, p, motion, parts, work.k)
    return motion
