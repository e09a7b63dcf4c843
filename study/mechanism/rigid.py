"""Rigid links with a clearance joint between coupler and slider: equations of motion.

Three degrees of freedom: the crank's angle theta, and the place of the ball's centre in the socket,
(e_x, e_y) in flight and (depth, direction) in contact. With the depth as a variable nothing
cancels, and the stiff direction is a coordinate, which allows longer steps. Coupler and slider
follow from the geometry; the coupler points to +x.

`study.mechanism.events` steps the equations; those of two clearance joints are in `two_joints`.
"""

from collections import namedtuple
from math import sqrt

import numpy as np

from study.compiled import compiled
from study.mechanism import joints, loads, stepping
from study.mechanism.angles import norm, sine_cosine

UNKNOWNS = 3
THETA, FIRST, SECOND, OMEGA, FIRST_RATE, SECOND_RATE = range(2 * UNKNOWNS)
"""Places in a state: the crank's angle, the joint's two coordinates, and their rates."""
_UNIT = np.eye(2 * UNKNOWNS)


Parts = namedtuple("Parts", "pose cross coupling acceleration eccentricity forces")
"""What `derive` and `write_output` need of a motion; the acceleration is the eccentricity's."""


@compiled
def motion(y, contact, p, law):
    """`Motion` at y = (z, z', ...), and its `Parts`, with the joint in a `ContactState`."""
    l1, l2, per_l2, per_m3 = p.l1, p.l2, 1 / p.l2, 1 / p.m3  # first: all else waits for them
    (st, ct), omega, closed = sine_cosine(y[THETA]), y[OMEGA], contact.closed
    e = joints.eccentricity_of(y, stepping.SLIDER, UNKNOWNS, closed, law.clearance)
    sp = (e.y - l1 * st) * per_l2
    cp = sqrt(1 - sp * sp)
    psi = (e.y_rate - l1 * ct * omega) * per_l2 / cp
    sliding = e.length * e.spin + p.r1 * psi
    forces = joints.forces_of(y[FIRST], e, sliding, contact, p, law)
    fx, fy = joints.on_ball(e, forces)
    pose = loads.Pose(st, ct, sp, cp, l1 * ct + l2 * cp - e.x, l1 * st)
    load = loads.applied(p, pose, True)

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
    slider = (load.slider - fx) * per_m3
    ax = -l1 * (st * alpha + ct * omega * omega) - l2 * (sp * beta + cp * psi * psi) - slider
    ay = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi)
    own = y[FIRST], closed, e, (ax, ay), sliding, forces, law.clearance
    (first, second), lost, joint = joints.motion_of(*own)
    accelerations = alpha, first, second * (1 / e.length if closed else 1.0)
    powers, coupler = (*lost, moment * omega), joints.Coupler(sp, cp, psi, beta)
    result = joints.Motion(accelerations, powers, (joint,), moment, coupler, slider + 0.0)
    return result, Parts(pose, cross, coupling, (ax, ay), e, forces)


@compiled
def derive(y, contact, p, motion, parts, k):
    """Fill ``k`` with the derivatives of z'', a column for each of (z, z')."""
    l1, l2, omega, closed = p.l1, p.l2, y[OMEGA], contact.closed
    pose, cross, coupling, e = parts.pose, parts.cross, parts.coupling, parts.eccentricity
    st, ct, sp, cp = pose.st, pose.ct, pose.sp, pose.cp
    alpha, _, turning = motion.accelerations
    psi, beta = motion.coupler.rate, motion.coupler.acceleration
    fx, fy = joints.on_ball(e, parts.forces)
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    per_reach, per_mass = 1 / (l2 * cp), 1 / p.m3
    lean, per_radius = psi * l2 * sp * per_reach, 1 / e.length if closed else 1.0
    for j in range(2 * UNKNOWNS):
        unit = _UNIT[j]
        dt, do = unit[THETA], unit[OMEGA]
        de = joints.eccentricity_change(unit, stepping.SLIDER, UNKNOWNS, e, closed)
        dp = (de.y - l1 * ct * dt) * per_reach
        dpsi = (de.y_rate + l1 * (st * omega * dt - ct * do)) * per_reach + lean * dp
        dsliding = de.length * e.spin + e.length * de.spin + p.r1 * dpsi
        dtangential, dfx, dfy = joints.on_ball_change(e, parts.forces, de, dsliding)
        dslider = -l1 * st * dt - l2 * sp * dp - de.x
        load = loads.change(p, pose, dt, dp, dslider, True)
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
            + (dfx - load.slider) * per_mass
        )
        day = l1 * (ct * dalpha - st * (alpha * dt + 2 * omega * do) - ct * omega * omega * dt)
        day += l2 * (cp * dbeta - sp * (beta * dp + 2 * psi * dpsi) - cp * psi * psi * dp)
        both = parts.acceleration, (dax, day), de, turning
        first, second = joints.acceleration_changes(e, closed, *both)
        k[THETA, j], k[FIRST, j], k[SECOND, j] = dalpha, first, second * per_radius


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


@compiled
def write_output(row, y, motion, parts, p):
    """Fill in what a row of output has of the slider's speed, kinetic energy and the joints."""
    pose, e, omega, alpha = parts.pose, parts.eccentricity, y[OMEGA], motion.accelerations[THETA]
    st, ct, sp, cp = pose.st, pose.ct, pose.sp, pose.cp
    psi, beta = motion.coupler.rate, motion.coupler.acceleration
    joint = joints.output_of(motion.joints[stepping.SLIDER], e)
    speed = -p.l1 * st * omega - p.l2 * sp * psi - e.x_rate
    kinetic = 0.5 * (p.a11 * omega * omega + p.a22 * psi * psi + p.m3 * speed * speed)
    kinetic += p.a12 * (ct * cp + st * sp) * omega * psi
    row.slider_velocity, row.kinetic = speed, kinetic
    stepping.write_joint(row, joint)
    # the coupler's centre is accelerated by the forces on its two ends
    ax = -p.l1 * (st * alpha + ct * omega * omega) - 0.5 * p.l2 * (sp * beta + cp * psi * psi)
    ay = p.l1 * (ct * alpha - st * omega * omega) + 0.5 * p.l2 * (cp * beta - sp * psi * psi)
    fall = loads.applied(p, pose, True).fall
    fx, fy = p.m2 * ax + joint.force_x, p.m2 * (ay - fall) + joint.force_y
    stepping.write_crank_joint(row, stepping.JointOutput(0.0, 0.0, 0.0, norm(fx, fy), 0.0, fx, fy))
