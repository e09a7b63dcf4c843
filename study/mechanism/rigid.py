"""Rigid links: the equations of motion of the crank-slider, its clearance joint, and its loads.

There are three degrees of freedom: the crank's angle theta, and the place of the ball's centre in
the socket, (e_x, e_y) in flight and (depth, direction) in contact. With the depth as a variable
nothing cancels, and the stiff direction is a coordinate, which allows longer steps. Coupler and
slider follow from the geometry; the coupler points to +x. Crank and coupler are a double pendulum
with an ideal joint between them.

`study.mechanism.events` steps the equations. Links with an ideal joint (`study.mechanism.ideal`)
have the same loads.
"""

from collections import namedtuple
from functools import partial
from math import sqrt

import numpy as np
from numba.extending import register_jitable

from study.compiled import compiled, inlined, inner
from study.contact.forces import (
    NODES,
    WEIGHTS,
    JointForces,
    elastic_force,
    joint_forces,
    stored_energy,
)
from study.mechanism import stepping
from study.mechanism.angles import angle_of, direction, norm, sine_cosine
from study.mechanism.stepping import JointOutput

UNKNOWNS = 3
THETA, FIRST, SECOND, OMEGA, FIRST_RATE, SECOND_RATE = range(2 * UNKNOWNS)
"""Places in a state: the crank's angle, the joint's two coordinates, and their rates."""
LOST_DAMPING, LOST_FRICTION, DRIVEN = range(2 * UNKNOWNS, 3 * UNKNOWNS)
"""Places of the integrals: energies lost to damping and friction, and the drive's work."""
_UNIT = np.eye(2 * UNKNOWNS)
NO_FORCES = JointForces(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""What `joint_forces` would return in flight."""
_NUMBERS = [("approach", float), ("deep", float), ("regime", np.int64), ("impact", np.int64)]
JOINT = np.dtype([*_NUMBERS, ("closed", bool)], align=True)
"""State of the joint: its `ContactState`, the depth to which the approach speed can lead, and the
number of the impact."""
NOW, BEFORE = range(2)
"""Places of the joint's records: now, and at the start of the step."""
ContactState = namedtuple("ContactState", "closed regime approach")
"""Discrete state of the joint: whether it is in contact, its friction regime, and the approach
speed of the contact. While the state stays, the equations of motion are smooth."""
Eccentricity = namedtuple("Eccentricity", "nx ny length rate spin x y x_rate y_rate")
"""Vector from the centre of the socket to that of the ball, and its rate. (nx, ny) is its
direction, the normal of the surfaces; ``rate`` and ``spin`` are rates of length and direction."""
EccentricityChange = namedtuple(
    "EccentricityChange", "length direction rate spin x y x_rate y_rate"
)
"""Derivatives of parts of an `Eccentricity`; of length and direction in contact only."""
JointMotion = namedtuple("JointMotion", "depth rate sliding normal tangential normal_rate")
"""Depth of the joint, its rate, sliding speed, normal and tangential force, rate of the first."""
Coupler = namedtuple("Coupler", "sine cosine rate acceleration")
"""Sine and cosine of the coupler's angle, its rate and its acceleration."""
Motion = namedtuple("Motion", "accelerations powers joint moment coupler slider")
"""Motion and forces at a state (z, z', ...): accelerations z''; powers lost to damping and
friction, and that of the drive; `JointMotion`; moment of the drive; `Coupler`; acceleration of the
slider."""
Parts = namedtuple("Parts", "pose cross coupling acceleration eccentricity forces speed")
"""What `derive` and `write_output` need of a motion; the acceleration is the eccentricity's, the
speed the slider's."""
Pose = namedtuple("Pose", "st ct sp cp slider")
"""Sines and cosines of the angles of crank and coupler, and the position of the slider."""
Loads = namedtuple("Loads", "drive crank coupler fall")
"""Applied loads, or their derivatives: moment of the drive on the crank, unless its speed is given;
other moments about the crank's axis; moment on the coupler about the crank's end; acceleration of
the coupler's centre along y by its weight."""


@register_jitable
def loads(p, pose):
    """Loads on the links in a pose."""
    return Loads(p.moment, -(p.g1 * pose.ct), -(p.g2 * pose.cp), -p.gravity)


@register_jitable
def loads_change(p, pose, dtheta, dphi):
    """Derivatives of the loads by something that turns crank and coupler."""
    return Loads(0.0, p.g1 * pose.st * dtheta, p.g2 * pose.sp * dphi, 0.0)


@register_jitable
def work_of_loads(p, pose, driven):
    """Work of the loads but for a constant; ``driven`` is that of the drive."""
    return driven - p.g1 * pose.st - p.g2 * pose.sp


@inlined
def eccentricity_of(y, closed, clearance):
    """Eccentricity of the joint in a state."""
    a, b, va, vb = y[FIRST], y[SECOND], y[FIRST_RATE], y[SECOND_RATE]
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
def _eccentricity_change(dy, e, closed):
    """Derivatives of the eccentricity, by those of the state."""
    da, db, dva, dvb = dy[FIRST], dy[SECOND], dy[FIRST_RATE], dy[SECOND_RATE]
    if not closed:
        return EccentricityChange(0.0, 0.0, 0.0, 0.0, da, db, dva, dvb)
    dx, dy = da * e.nx - e.length * e.ny * db, da * e.ny + e.length * e.nx * db
    dwx = dva * e.nx - (da * e.spin + e.length * dvb) * e.ny - e.y_rate * db
    dwy = dva * e.ny + (da * e.spin + e.length * dvb) * e.nx + e.x_rate * db
    return EccentricityChange(da, db, dva, dvb, dx, dy, dwx, dwy)


@inlined
def _on_ball(e, forces):
    """Force on the ball along x and y."""
    normal, tangential = forces.normal, forces.tangential
    return -normal * e.nx - tangential * e.ny, -normal * e.ny + tangential * e.nx


@inlined
def _on_ball_change(e, forces, change, dsliding):
    """Derivatives of the tangential force, and of the force on the ball along x and y."""
    nx, ny, normal, tangential = e.nx, e.ny, forces.normal, forces.tangential
    dnormal = forces.normal_by_depth * change.length + forces.normal_by_rate * change.rate
    dtangential = forces.tangential_by_normal * dnormal + forces.tangential_by_sliding * dsliding
    turned_x, turned_y = normal * ny - tangential * nx, -normal * nx - tangential * ny
    dfx = -dnormal * nx - dtangential * ny + turned_x * change.direction
    dfy = -dnormal * ny + dtangential * nx + turned_y * change.direction
    return dtangential, dfx, dfy


@partial(compiled, forceinline=True)  # to pass its tuples takes longer than to compute them
def motion(y, contact, p, law):
    """`Motion` at y = (z, z', ...), and its `Parts`, with the joint in a `ContactState`."""
    l1, l2, per_l2, per_m3 = p.l1, p.l2, 1 / p.l2, 1 / p.m3  # first: all else waits for them
    (st, ct), omega, closed = sine_cosine(y[THETA]), y[OMEGA], contact.closed
    e = eccentricity_of(y, closed, law.clearance)
    sp = (e.y - l1 * st) * per_l2
    cp = sqrt(1 - sp * sp)
    psi = (e.y_rate - l1 * ct * omega) * per_l2 / cp
    sliding = e.length * e.spin + p.r1 * psi
    forces = NO_FORCES
    if closed and y[FIRST] > 0:
        speeds = e.rate, sliding, contact.regime, contact.approach
        forces = joint_forces(law, y[FIRST], *speeds, p.damping, p.friction, p.v0, p.v1)
    fx, fy = _on_ball(e, forces)
    pose = Pose(st, ct, sp, cp, l1 * ct + l2 * cp - e.x)
    speed = -l1 * st * omega - l2 * sp * psi - e.x_rate
    load = loads(p, pose)

    # [A11 C; C A22] (theta'', phi'') = (q1, q2): crank and coupler as a double pendulum
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    cross, coupling = p.a12 * sd, p.a12 * cd
    q1 = load.drive - cross * psi * psi + l1 * (ct * fy - st * fx) + load.crank
    q2 = cross * omega * omega + l2 * (cp * fy - sp * fx) + p.r1 * forces.tangential + load.coupler
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    alpha = (p.a22 * q1 - coupling * q2) * inverse
    beta = (p.a11 * q2 - coupling * q1) * inverse
    moment = load.drive
    if p.steady > 0:
        alpha, beta = 0.0, q2 / p.a22
        moment = coupling * beta - q1
    slider = -fx * per_m3
    ax = -l1 * (st * alpha + ct * omega * omega) - l2 * (sp * beta + cp * psi * psi) - slider
    ay = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi)
    # accelerations of the joint's coordinates, in contact the second times r
    growth = e.nx * ax + e.ny * ay + e.length * e.spin * e.spin
    first, second = ax, ay
    if closed:
        first, second = growth, e.nx * ay - e.ny * ax - 2 * e.rate * e.spin
    depth = y[FIRST] if closed else e.length - law.clearance
    normal_rate = forces.normal_by_depth * e.rate + forces.normal_by_rate * growth
    lost = (forces.normal - forces.elastic) * e.rate, -forces.tangential * sliding
    joint = JointMotion(depth, e.rate, sliding, forces.normal, forces.tangential, normal_rate)
    accelerations = alpha, first, second * (1 / e.length if closed else 1.0)
    powers, coupler = (*lost, moment * omega), Coupler(sp, cp, psi, beta)
    result = Motion(accelerations, powers, joint, moment, coupler, slider + 0.0)
    return result, Parts(pose, cross, coupling, (ax, ay), e, forces, speed)


@compiled
def derive(y, contact, p, state, parts, k):
    """Fill ``k`` with the derivatives of z'', a column for each of (z, z')."""
    l1, l2, omega, closed = p.l1, p.l2, y[OMEGA], contact.closed
    pose, cross, coupling, e = parts.pose, parts.cross, parts.coupling, parts.eccentricity
    st, ct, sp, cp = pose.st, pose.ct, pose.sp, pose.cp
    alpha, _, turning = state.accelerations
    psi, beta = state.coupler.rate, state.coupler.acceleration
    fx, fy = _on_ball(e, parts.forces)
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    per_reach, per_mass = 1 / (l2 * cp), 1 / p.m3
    lean, per_radius = psi * l2 * sp * per_reach, 1 / e.length if closed else 1.0
    for j in range(2 * UNKNOWNS):
        unit = _UNIT[j]
        dt, do = unit[THETA], unit[OMEGA]
        de = _eccentricity_change(unit, e, closed)
        dp = (de.y - l1 * ct * dt) * per_reach
        dpsi = (de.y_rate + l1 * (st * omega * dt - ct * do)) * per_reach + lean * dp
        dsliding = de.length * e.spin + e.length * de.spin + p.r1 * dpsi
        dtangential, dfx, dfy = _on_ball_change(e, parts.forces, de, dsliding)
        load = loads_change(p, pose, dt, dp)
        dcross, dcoupling = coupling * (dt - dp), -cross * (dt - dp)
        dq1 = (
            -dcross * psi * psi
            - 2 * cross * psi * dpsi
            + l1 * (ct * dfy - st * dfx - (st * fy + ct * fx) * dt)
            + load.crank
            - dcoupling * beta
        )
        dq2 = (
            dcross * omega * omega
            + 2 * cross * omega * do
            + l2 * (cp * dfy - sp * dfx - (sp * fy + cp * fx) * dp)
            + p.r1 * dtangential
            + load.coupler
            - dcoupling * alpha
        )
        dalpha = (p.a22 * dq1 - coupling * dq2) * inverse
        dbeta = (p.a11 * dq2 - coupling * dq1) * inverse
        if p.steady > 0:
            dalpha, dbeta = 0.0, dq2 / p.a22
        dax = (
            -l1 * (st * dalpha + ct * (alpha * dt + 2 * omega * do) - st * omega * omega * dt)
            - l2 * (sp * dbeta + cp * (beta * dp + 2 * psi * dpsi) - sp * psi * psi * dp)
            + dfx * per_mass
        )
        day = l1 * (ct * dalpha - st * (alpha * dt + 2 * omega * do) - ct * omega * omega * dt)
        day += l2 * (cp * dbeta - sp * (beta * dp + 2 * psi * dpsi) - cp * psi * psi * dp)
        first, second = dax, day
        if closed:  # in contact the second coordinate's is times r
            ax, ay = parts.acceleration
            first = (e.nx * ay - e.ny * ax) * de.direction + e.nx * dax + e.ny * day
            first += de.length * e.spin * e.spin + 2 * e.length * e.spin * de.spin
            second = e.nx * day - e.ny * dax - (e.nx * ax + e.ny * ay) * de.direction
            second -= 2 * (de.rate * e.spin + e.rate * de.spin) + turning * de.length
        k[THETA, j], k[FIRST, j], k[SECOND, j] = dalpha, first, second * per_radius


@inlined
def contact_state(joint):
    """`ContactState` of the joint's record."""
    return ContactState(joint.closed, joint.regime, joint.approach)


@compiled
def current(work, p, law):
    """Contact state and motion now; ``k`` gets the derivatives of the accelerations."""
    contact = contact_state(work.joints[NOW])
    state, parts = motion(work.y, contact, p, law)
    derive(work.y, contact, p, state, parts, work.k)
    return contact, state


@compiled
def inverse_effective_mass(theta, ey, dx, dy, arm, p):
    """Inverse effective mass of the ball against the socket along (dx, dy), in 1/kg.

    ``arm`` is the lever arm of the force about the ball's centre, which turns the coupler.
    """
    st, ct = sine_cosine(theta)
    sp = (ey - p.l1 * st) / p.l2
    cp = sqrt(1 - sp * sp)
    d1, d2 = p.l1 * (ct * dy - st * dx), p.l2 * (cp * dy - sp * dx) + arm
    coupling = p.a12 * (ct * cp + st * sp)
    determinant = p.a11 * p.a22 - coupling * coupling
    if p.steady > 0:
        return d2 * d2 / p.a22 + dx * dx / p.m3
    links = (p.a22 * d1 * d1 - 2 * coupling * d1 * d2 + p.a11 * d2 * d2) / determinant
    return links + dx * dx / p.m3


@inner
def write_output(row, y, state, parts, p):
    """Fill a row of output, which has its time already, from a `Motion` and its `Parts`."""
    pose, coupler, e = parts.pose, state.coupler, parts.eccentricity
    omega, alpha = y[OMEGA], state.accelerations[THETA]
    st, ct, sp, cp = pose.st, pose.ct, pose.sp, pose.cp
    psi, beta = coupler.rate, coupler.acceleration
    speed = parts.speed
    kinetic = 0.5 * (p.a11 * omega * omega + p.a22 * psi * psi + p.m3 * speed * speed)
    kinetic += p.a12 * (ct * cp + st * sp) * omega * psi
    row.crank_angle, row.crank_speed = y[THETA], omega
    row.crank_acceleration, row.driving_moment = alpha, state.moment
    row.slider_position, row.slider_velocity = pose.slider, speed
    row.slider_acceleration = state.slider
    row.coupler_angle, row.coupler_speed = angle_of(coupler.sine, coupler.cosine), psi
    row.work, row.kinetic = work_of_loads(p, pose, y[DRIVEN]), kinetic
    row.elastic = 0.0  # that of the joint is added at the end
    row.lost_damping, row.lost_friction = y[LOST_DAMPING], y[LOST_FRICTION]
    normal, tangential = state.joint.normal, state.joint.tangential
    fx, fy = normal * e.nx + tangential * e.ny, normal * e.ny - tangential * e.nx
    depth = state.joint.depth
    stepping.write_joint(row, JointOutput(e.x, e.y, depth, normal, tangential, fx, fy))
    # the coupler's centre is accelerated by the forces on its two ends
    ax = -p.l1 * (st * alpha + ct * omega * omega) - 0.5 * p.l2 * (sp * beta + cp * psi * psi)
    ay = p.l1 * (ct * alpha - st * omega * omega) + 0.5 * p.l2 * (cp * beta - sp * psi * psi)
    row.crank_joint_force_x = p.m2 * ax + fx
    row.crank_joint_force_y = p.m2 * (ay - loads(p, pose).fall) + fy
    row.crank_joint_normal_force = norm(row.crank_joint_force_x, row.crank_joint_force_y)


@compiled
def impact_depth(theta, ey, nx, ny, rate, p, law):
    """Depth at which the contact has stored the energy of an approach speed, in m.

    The bodies meet along the normal (nx, ny), where the eccentricity along y is ``ey``.
    """
    energy = rate * rate / (2 * inverse_effective_mass(theta, ey, nx, ny, 0.0, p))
    depth = law.clearance
    for _ in range(200):  # Newton's method on a convex function, from above: it always converges
        force, _ = elastic_force(law, depth)
        change = (stored_energy(law, depth) - energy) / force
        depth -= change
        if abs(change) <= 1e-6 * depth:  # the next change would be of the order of its square
            break
    return depth


@compiled
def add_free_durations(starts, impacts, p, law):
    """Fill in the durations of free elastic impacts with the approach speeds of ``impacts``, in s.

    ``starts`` are their first rows of output. A duration is twice the integral of 1/speed from 0 to
    the largest depth, where the speed vanishes. With depth = deepest (1 - x^2) the integrand is
    smooth, and d(depth) = -2 deepest x dx: hence the factor 4 x of a node x.
    """
    for i in range(len(impacts)):
        impact, row, duration = impacts[i], starts[i], 0.0
        speed = impact.approach_speed
        ny, nx = sine_cosine(direction(row.eccentricity_y, row.eccentricity_x))
        deep = impact_depth(row.crank_angle, law.clearance * ny, nx, ny, speed, p, law)
        energy = stored_energy(law, deep)
        for node, weight in zip(NODES, WEIGHTS):  # noqa: B905 (compiled code has no strict)
            left = 1 - stored_energy(law, deep * (1 - node * node)) / energy
            duration += weight * 4 * node * deep / (speed * sqrt(left))
        impact.free_duration = duration
