"""A clearance joint of rigid links, the same for `rigid` and `two_joints`.

Where its ball is in the socket, the forces, and the derivatives of both. A place is the normal
(n_x, n_y), the reach r from centre to centre and its rate, the normal's spin, and the eccentricity
(e_x, e_y) with its rates (w_x, w_y).
"""

from math import sqrt
from typing import NamedTuple

from study.compiled import inlined
from study.contact.forces import joint_forces
from study.mechanism.angles import sine_cosine

NO_FORCES = (0.0,) * 8
"""What `joint_forces` would return in flight."""


class Contact(NamedTuple):
    """State of a joint: depth, its rate, sliding speed, and forces."""

    depth: float
    rate: float
    sliding: float
    normal: float
    tangential: float
    normal_rate: float
    """Rate of the normal force."""


class Motion(NamedTuple):
    """Motion and forces of a mechanism at a state (z, z', ...)."""

    accelerations: tuple[float, ...]
    """z''."""
    powers: tuple[float, ...]
    """Powers lost to damping and friction, joint by joint, and the power of the drive."""
    joints: tuple[Contact, ...]
    moment: float
    """Moment of the drive."""
    coupler: tuple[float, float, float, float]
    """Sine and cosine of the coupler's angle, its rate and its acceleration."""
    slider: float
    """Acceleration of the slider."""


@inlined
def place_of(a, b, va, vb, contact, clearance):
    """Place of a ball from a joint's two coordinates and their rates."""
    if contact:
        ny, nx = sine_cosine(b)
        r = clearance + a
        return nx, ny, r, va, vb, r * nx, r * ny, va * nx - r * vb * ny, va * ny + r * vb * nx
    r = sqrt(a * a + b * b)
    nx, ny = (a / r, b / r) if r > 0 else (1.0, 0.0)
    spin = (vb * nx - va * ny) / r if r > 0 else 0.0
    return nx, ny, r, va * nx + vb * ny, spin, a, b, va, vb


@inlined
def place_change(da, db, dva, dvb, place, contact):
    """Derivatives of reach, direction, their rates, e_y and w_y, by those of the coordinates."""
    nx, ny, r, _, spin, _, _, wx, _ = place
    if not contact:
        return 0.0, 0.0, 0.0, 0.0, db, dvb
    return da, db, dva, dvb, da * ny + r * nx * db, dva * ny + (da * spin + r * dvb) * nx + wx * db


@inlined
def forces_of(depth, place, sliding, mode, p, law):
    """What `joint_forces` finds in a joint, zeros in flight; ``depth`` is its first coordinate."""
    contact, branch, approach = mode
    if contact and depth > 0:
        state = depth, place[3], sliding, branch, approach
        return joint_forces(law, *state, p.damping, p.friction, p.v0, p.v1)
    return NO_FORCES


@inlined
def on_ball(place, forces):
    """Force on the ball along x and y."""
    nx, ny, normal, tangential = place[0], place[1], forces[0], forces[5]
    return -normal * nx - tangential * ny, -normal * ny + tangential * nx


@inlined
def on_ball_change(place, forces, change, dsliding):
    """Derivatives of a joint's tangential force, and of the force on its ball along x and y."""
    nx, ny = place[0], place[1]
    normal, by_depth, by_rate, _, _, tangential, by_normal, by_sliding = forces
    dnormal = by_depth * change[0] + by_rate * change[2]
    dtangential = by_normal * dnormal + by_sliding * dsliding
    turned_x, turned_y = normal * ny - tangential * nx, -normal * nx - tangential * ny
    dfx = -dnormal * nx - dtangential * ny + turned_x * change[1]
    dfy = -dnormal * ny + dtangential * nx + turned_y * change[1]
    return dtangential, dfx, dfy


@inlined
def motion_of(first, contact, place, a, sliding, forces, clearance):
    """Accelerations of a joint's coordinates, in contact the second times r; lost powers; state.

    ``a`` accelerates the eccentricity, and ``first`` is the first coordinate.
    """
    (nx, ny, r, rate, spin, _, _, _, _), (ax, ay) = place, a
    normal, by_depth, by_rate, elastic, _, tangential, _, _ = forces
    growth = nx * ax + ny * ay + r * spin * spin
    if contact:
        ax, ay = growth, nx * ay - ny * ax - 2 * rate * spin
    depth = first if contact else r - clearance
    state = Contact(depth, rate, sliding, normal, tangential, by_depth * rate + by_rate * growth)
    return (ax, ay), ((normal - elastic) * rate, -tangential * sliding), state


@inlined
def acceleration_changes(place, contact, a, da, change, turning):
    """Derivatives of the accelerations of the coordinates, in contact the second times r.

    ``a`` accelerates the eccentricity, ``da`` are its derivatives, and ``turning`` accelerates the
    second coordinate.
    """
    (nx, ny, r, rate, spin, _, _, _, _), (ax, ay), (dax, day) = place, a, da
    dr, db, drate, dspin, _, _ = change
    if not contact:
        return dax, day
    grown = (nx * ay - ny * ax) * db + nx * dax + ny * day
    grown += dr * spin * spin + 2 * r * spin * dspin
    turned = nx * day - ny * dax - (nx * ax + ny * ay) * db
    turned -= 2 * (drate * spin + rate * dspin) + turning * dr
    return grown, turned


@inlined
def columns_of(joint, place):
    """Columns of output: eccentricity and depth of a joint, its forces, those on its socket."""
    nx, ny, normal, tangential = place[0], place[1], joint.normal, joint.tangential
    on_socket = normal * nx + tangential * ny, normal * ny - tangential * nx
    return (place[5], place[6], joint.depth), (normal, tangential, *on_socket)
