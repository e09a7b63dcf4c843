"""Free impacts of rigid links: their depth and their duration, without other forces.

A stepper's tolerance needs the depth. A contact that lasts much longer is not an impact.
"""

from math import sqrt

from study.compiled import compiled, inlined
from study.contact.forces import NODES, WEIGHTS, elastic_force, stored_energy
from study.mechanism import rigid, two_joints
from study.mechanism.angles import direction, sine_cosine
from study.mechanism.stepping import CRANK, SLIDER


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
