"""Equations of motion and free impacts for one clearance joint (`rigid`) or two (`two_joints`).

The compiler knows the number of laws, and leaves out the branch for the other number: no function
is slower for serving both. The state of a joint while it is stepped is here too.
"""

from math import sqrt

import numpy as np

from study.compiled import compiled, inlined, inner
from study.contact.forces import NODES, WEIGHTS, elastic_force, stored_energy
from study.mechanism import loads, rigid, two_joints
from study.mechanism.angles import angle_of, direction, sine_cosine
from study.mechanism.joints import ContactState
from study.mechanism.stepping import CRANK, SLIDER

THETA = 0
"""Place of the crank's angle in a state; its rate is behind all coordinates."""
_NUMBERS = [("approach", float), ("deep", float), ("regime", np.int64), ("impact", np.int64)]
JOINT = np.dtype([*_NUMBERS, ("closed", bool)], align=True)
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


@inner
def write_output(row, y, motion, parts, p, laws):
    """Fill a row of output, which has its time already."""
    n, pose, coupler = 1 + 2 * len(laws), parts.pose, motion.coupler
    row.crank_angle, row.crank_speed = y[THETA], y[n]
    row.crank_acceleration, row.driving_moment = motion.accelerations[THETA], motion.moment
    row.slider_position, row.slider_acceleration = pose.slider, motion.slider
    row.coupler_angle, row.coupler_speed = angle_of(coupler.sine, coupler.cosine), coupler.rate
    row.work, row.elastic = loads.work(p, pose, y[3 * n - 1], len(laws) == 1), 0.0
    row.lost_damping, row.lost_friction = y[2 * n], y[2 * n + 1]
    if len(laws) == 1:
        rigid.write_output(row, y, motion, parts, p)
    else:
        row.lost_damping += y[2 * n + 2]
        row.lost_friction += y[2 * n + 3]
        two_joints.write_output(row, y, motion, parts, p)


@inlined
def contact_states(joints, laws):
    """`ContactState` of each joint."""
    joint = joints[SLIDER]
    of_slider = ContactState(joint.closed, joint.regime, joint.approach)
    if len(laws) == 1:
        return (of_slider,)
    joint = joints[CRANK]
    return of_slider, ContactState(joint.closed, joint.regime, joint.approach)


@compiled
def current(work, p, laws):
    """Contact states and motion now; ``k`` gets the derivatives of the accelerations."""
    contacts = contact_states(work.joints, laws)
    motion, parts = move(work.y, contacts, p, laws)
    derive(work.y, contacts, p, motion, parts, work.k)
    return contacts, motion


@inlined
def _inverse_mass(j, theta, phi, nx, ny, p, laws):
    """Inverse effective mass of ball against socket along the normal; other joints are free."""
    if len(laws) == 1:
        return rigid.inverse_effective_mass(theta, laws[SLIDER].clearance * ny, nx, ny, 0.0, p)
    return two_joints.inverse_effective_mass(j, theta, phi, nx, ny, p)


@compiled
def impact_depth(j, theta, phi, nx, ny, rate, p, laws):
    """Depth at which a joint's contact has stored the energy of an approach speed, in m.

    The bodies meet along the normal (nx, ny); ``phi`` is the sine and cosine of the coupler's
    angle.
    """
    law = laws[j]
    energy = rate * rate / (2 * _inverse_mass(j, theta, phi, nx, ny, p, laws))
    depth = law.clearance
    for _ in range(200):  # Newton's method on a convex function, from above: it always converges
        force, _ = elastic_force(law, depth)
        change = (stored_energy(law, depth) - energy) / force
        depth -= change
        if abs(change) <= 1e-6 * depth:  # the next change would be of the order of its square
            break
    return depth


@compiled
def add_free_durations(starts, impacts, p, laws):
    """Fill in the durations of free elastic impacts with the approach speeds of ``impacts``, in s.

    ``starts`` are their first rows of output. A duration is twice the integral of 1/speed from 0 to
    the largest depth, where the speed vanishes. With depth = deepest (1 - x^2) the integrand is
    smooth, and d(depth) = -2 deepest x dx: hence the factor 4 x of a node x.
    """
    for i in range(len(impacts)):
        impact, row, duration = impacts[i], starts[i], 0.0
        j, speed = impact.joint, impact.approach_speed
        ex, ey = row.eccentricity_x, row.eccentricity_y
        if j == CRANK:
            ex, ey = row.crank_joint_eccentricity_x, row.crank_joint_eccentricity_y
        ny, nx = sine_cosine(direction(ey, ex))
        phi = sine_cosine(row.coupler_angle)
        deep = impact_depth(j, row.crank_angle, phi, nx, ny, speed, p, laws)
        energy = stored_energy(laws[j], deep)
        for node, weight in zip(NODES, WEIGHTS):  # noqa: B905 (compiled code has no strict)
            left = 1 - stored_energy(laws[j], deep * (1 - node * node)) / energy
            duration += weight * 4 * node * deep / (speed * sqrt(left))
        impact.free_duration = duration
