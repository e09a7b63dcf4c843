"""Equations of motion for one clearance joint (`rigid`) or two (`two_joints`).

The compiler knows the number of laws, and leaves out the branch for the other number: no function
is slower for serving both. The state of a joint while it is stepped is here too.
"""

import numpy as np

from study.compiled import compiled, inlined
from study.mechanism import rigid, two_joints

CONTACT, BRANCH, APPROACH, DEEP, NUMBER = range(5)
"""State of a joint: in contact or not, friction branch, approach speed, the depth to which this
speed can lead, and the number of the impact. The first three are its mode: while they stay, the
equations are smooth."""
Laws = tuple[np.record, ...]
"""A packed law for each clearance joint, slider's and crank's. The compiler knows their number, and
makes loops for each."""


@inlined
def move(y, modes, p, laws):
    """Motion of the mechanism with joints in these modes, and what `derive` needs."""
    if len(laws) == 1:
        return rigid.motion(y, modes[0], p, laws[0])
    return two_joints.motion(y, modes, p, laws)


@inlined
def derive(y, modes, p, motion, parts, k):
    """Fill ``k`` with the derivatives of the accelerations that `move` returned."""
    if len(modes) == 1:
        rigid.derive(y, modes[0], p, motion, parts, k)
    else:
        two_joints.derive(y, modes, p, motion, parts, k)


@inlined
def record(row, y, motion, parts, p, laws):
    """Fill a row of output, which has its time already."""
    if len(laws) == 1:
        rigid.record(row, y, motion, parts, p)
    else:
        two_joints.record(row, y, motion, parts, p)


@inlined
def _mode(joint):
    return joint[CONTACT] > 0, int(joint[BRANCH]), joint[APPROACH]


@inlined
def modes_of(joints, laws):
    """(In contact?, friction branch, approach speed) of each joint."""
    if len(laws) == 1:
        return (_mode(joints[0]),)
    return _mode(joints[0]), _mode(joints[1])


@compiled
def current(work, p, laws):
    """Modes and motion at the current state; ``k`` gets the derivatives of the accelerations."""
    modes = modes_of(work.joints, laws)
    motion, parts = move(work.y, modes, p, laws)
    derive(work.y, modes, p, motion, parts, work.k)
    return modes, motion
