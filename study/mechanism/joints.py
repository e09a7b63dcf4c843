"""A clearance joint of rigid links, the same for `rigid` and `two_joints`.

Where its ball is in the socket, the forces, and the derivatives of both. The two coordinates of a
joint are the eccentricity (e_x, e_y) in flight, and (depth, direction) in contact.
"""

from collections import namedtuple
from math import sqrt

from study.compiled import inlined
from study.contact.forces import JointForces, joint_forces
from study.mechanism.angles import sine_cosine
from study.mechanism.stepping import JointOutput

NO_FORCES = JointForces(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""What `joint_forces` would return in flight."""
ContactState = namedtuple("ContactState", "closed regime approach")
"""Discrete state of a joint: whether it is in contact, its friction regime, and the approach speed
of the contact. While the state stays, the equations of motion are smooth."""
Eccentricity = namedtuple("Eccentricity", "nx ny length rate spin x y x_rate y_rate")
"""Vector from the centre of a joint's socket to that of its ball, and its rate. (nx, ny) is its
direction, the normal of the surfaces; ``rate`` and ``spin`` are rates of length and direction."""
EccentricityChange = namedtuple("EccentricityChange", "length direction rate spin x y y_rate")
"""Derivatives of parts of an `Eccentricity`; of length and direction in contact only."""
JointMotion = namedtuple("JointMotion", "depth rate sliding normal tangential normal_rate")
"""Depth of a joint, its rate, sliding speed, normal and tangential force, rate of the first."""
Coupler = namedtuple("Coupler", "sine cosine rate acceleration")
"""Sine and cosine of the coupler's angle, its rate and its acceleration."""
Motion = namedtuple("Motion", "accelerations powers joints moment coupler slider")
"""Motion and forces of a mechanism at a state (z, z', ...): accelerations z''; powers lost to
damping and friction, joint by joint, and that of the drive; a `JointMotion` for each joint; moment
of the drive; `Coupler`; acceleration of the slider."""


@inlined
def _coordinates(y, j, unknowns):
    """Two coordinates of a joint in a state (z, z', ...), and their rates."""
    first = 1 + 2 * j
    return y[first], y[first + 1], y[unknowns + first], y[unknowns + first + 1]


@inlined
def eccentricity_of(y, j, unknowns, closed, clearance):
    """Eccentricity of joint ``j`` in a state."""
    a, b, va, vb = _coordinates(y, j, unknowns)
    if closed:
        ny, nx = sine_cosine(b)
        r = clearance + a
        wx, wy = va * nx - r * vb * ny, va * ny + r * vb * nx
        return Eccentricity(nx, ny, r, va, vb, r * nx, r * ny, wx, wy)
    r = sqrt(a * a + b * b)
    nx, ny = (a / r, b / r) if r > 0 else (1.0, 0.0)
    spin = (vb * nx - va * ny) / r if r > 0 else 0.0
    return Eccentricity(nx, ny, r, va * nx + vb * ny, spin, a, b, va, vb)


@inlined
def eccentricity_change(dy, j, unknowns, e, closed):
    """Derivatives of the eccentricity of joint ``j``, by those of the state."""
    da, db, dva, dvb = _coordinates(dy, j, unknowns)
    if not closed:
        return EccentricityChange(0.0, 0.0, 0.0, 0.0, da, db, dvb)
    dx, dy = da * e.nx - e.length * e.ny * db, da * e.ny + e.length * e.nx * db
    dwy = dva * e.ny + (da * e.spin + e.length * dvb) * e.nx + e.x_rate * db
    return EccentricityChange(da, db, dva, dvb, dx, dy, dwy)


@inlined
def forces_of(depth, e, sliding, contact, p, law):
    """What `joint_forces` finds in a joint, zeros in flight; ``depth`` is its first coordinate."""
    if contact.closed and depth > 0:
        speeds = e.rate, sliding, contact.regime, contact.approach
        return joint_forces(law, depth, *speeds, p.damping, p.friction, p.v0, p.v1)
    return NO_FORCES


@inlined
def on_ball(e, forces):
    """Force on the ball along x and y."""
    normal, tangential = forces.normal, forces.tangential
    return -normal * e.nx - tangential * e.ny, -normal * e.ny + tangential * e.nx


@inlined
def on_ball_change(e, forces, change, dsliding):
    """Derivatives of a joint's tangential force, and of the force on its ball along x and y."""
    nx, ny, normal, tangential = e.nx, e.ny, forces.normal, forces.tangential
    dnormal = forces.normal_by_depth * change.length + forces.normal_by_rate * change.rate
    dtangential = forces.tangential_by_normal * dnormal + forces.tangential_by_sliding * dsliding
    turned_x, turned_y = normal * ny - tangential * nx, -normal * nx - tangential * ny
    dfx = -dnormal * nx - dtangential * ny + turned_x * change.direction
    dfy = -dnormal * ny + dtangential * nx + turned_y * change.direction
    return dtangential, dfx, dfy


@inlined
def motion_of(first, closed, e, a, sliding, forces, clearance):
    """Accelerations of a joint's coordinates, in contact the second times r; lost powers; motion.

    ``a`` accelerates the eccentricity, and ``first`` is the first coordinate.
    """
    ax, ay = a
    growth = e.nx * ax + e.ny * ay + e.length * e.spin * e.spin
    if closed:
        ax, ay = growth, e.nx * ay - e.ny * ax - 2 * e.rate * e.spin
    depth = first if closed else e.length - clearance
    normal_rate = forces.normal_by_depth * e.rate + forces.normal_by_rate * growth
    lost = (forces.normal - forces.elastic) * e.rate, -forces.tangential * sliding
    motion = JointMotion(depth, e.rate, sliding, forces.normal, forces.tangential, normal_rate)
    return (ax, ay), lost, motion


@inlined
def acceleration_changes(e, closed, a, da, change, turning):
    """Derivatives of the accelerations of the coordinates, in contact the second times r.

    ``a`` accelerates the eccentricity, ``da`` are its derivatives, and ``turning`` accelerates the
    second coordinate.
    """
    (ax, ay), (dax, day) = a, da
    if not closed:
        return dax, day
    grown = (e.nx * ay - e.ny * ax) * change.direction + e.nx * dax + e.ny * day
    grown += change.length * e.spin * e.spin + 2 * e.length * e.spin * change.spin
    turned = e.nx * day - e.ny * dax - (e.nx * ax + e.ny * ay) * change.direction
    turned -= 2 * (change.rate * e.spin + e.rate * change.spin) + turning * change.length
    return grown, turned


@inlined
def output_of(joint, e):
    """What a row of output has of a joint."""
    normal, tangential = joint.normal, joint.tangential
    on_socket = normal * e.nx + tangential * e.ny, normal * e.ny - tangential * e.nx
    return JointOutput(e.x, e.y, joint.depth, normal, tangential, *on_socket)
