"""Equations of motion for one clearance joint (`rigid`) or two (`two_joints`).

The compiler knows the number of laws, and leaves out the branch for the other number: no function
is slower for serving both. The state of a joint while it is stepped is here too.
"""

import numpy as np

from study.compiled import compiled, inlined
from study.mechanism import rigid, two_joints
from study.mechanism.joints import ContactState
from study.mechanism.stepping import CRANK, SLIDER

JOINT = np.dtype(
    [
        ("closed", bool),
        ("regime", np.int64),
        ("approach", float),
        ("deep", float),
        ("impact", np.int64),
    ],
    align=True,
)
"""State of a joint: its `ContactState`, the depth to which the approach speed can lead, and the
number of the impact."""
Laws = tuple[np.record, ...]
"""A packed law for each clearance joint, slider's and crank's. The compiler knows their number, and
makes loops for each."""


@inlined
def move(y, contacts, p, laws):
    """Motion of the mechanism with joints in these contact states, and what `derive` needs."""
    if len(laws) == 1:
        return rigid.motion(y, contacts[SLIDER], p, laws[SLIDER])
    return two_joints.motion(y, contacts, p, laws)


@inlined
def derive(y, contacts, p, motion, parts, k):
    """Fill ``k`` with the derivatives of the accelerations that `move` returned."""
    if len(contacts) == 1:
        rigid.derive(y, contacts[SLIDER], p, motion, parts, k)
    else:
        two_joints.derive(y, contacts, p, motion, parts, k)


@inlined
def write_output(row, y, motion, parts, p, laws):
    """Fill a row of output, which has its time already."""
    if len(laws) == 1:
        rigid.write_output(row, y, motion, parts, p)
    else:
        two_joints.write_output(row, y, motion, parts, p)


@inlined
def _contact_state(joint):
    return ContactState(joint.closed, joint.regime, joint.approach)


@inlined
def contact_states(joints, laws):
    """`ContactState` of each joint."""
    if len(laws) == 1:
        return (_contact_state(joints[SLIDER]),)
    return _contact_state(joints[SLIDER]), _contact_state(joints[CRANK])


@compiled
def current(work, p, laws):
    """Contact states and motion now; ``k`` gets the derivatives of the accelerations."""
    contacts = contact_states(work.joints, laws)
    motion, parts = move(work.y, contacts, p, laws)
    derive(work.y, contacts, p, motion, parts, work.k)
    return contacts, motion
