"""Rigid links with a clearance joint between coupler and slider: equations of motion.

Three degrees of freedom: the crank's angle theta, and the place of the ball's centre in the socket,
(e_x, e_y) in flight and (depth, direction) in contact. With the depth as a variable nothing
cancels, and the stiff direction is a coordinate, which allows longer steps. Coupler and slider
follow from the geometry; the coupler points to +x.

`study.mechanism.events` steps the equations; those of two clearance joints are in `two_joints`.
"""

from math import sqrt

import numpy as np

from study.compiled import compiled
from study.mechanism import joints, stepping
from study.mechanism.angles import angle_of, norm, sine_cosine

UNKNOWNS = 3
_UNIT = np.eye(2 * UNKNOWNS)


@compiled
def motion(y, mode, p, law):
    """Accelerations, powers and forces at y = (z, z', ...), and what `derive` needs.

    ``mode`` is (in contact?, friction branch, approach speed).
    """
    contact = mode[0]
    l1, l2, per_l2, per_m3 = p.l1, p.l2, 1 / p.l2, 1 / p.m3  # first: all else waits for them
    (st, ct), omega = sine_cosine(y[0]), y[3]
    place = joints.place_of(y[1], y[2], y[4], y[5], contact, law.clearance)
    r, spin, ey, wy = place[2], place[4], place[6], place[8]
    sp = (ey - l1 * st) * per_l2
    cp = sqrt(1 - sp * sp)
    psi = (wy - l1 * ct * omega) * per_l2 / cp
    sliding = r * spin + p.r1 * psi
    forces = joints.forces_of(y[1], place, sliding, mode, p, law)
    tangential, (fx, fy) = forces[5], joints.on_ball(place, forces)

    # [A11 C; C A22] (theta'', phi'') = (q1, q2): crank and coupler as a double pendulum
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    cross, coupling = p.a12 * sd, p.a12 * cd
    q1 = p.moment - cross * psi * psi + l1 * (ct * fy - st * fx) - p.g1 * ct
    q2 = cross * omega * omega + l2 * (cp * fy - sp * fx) + p.r1 * tangential - p.g2 * cp
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    alpha = (p.a22 * q1 - coupling * q2) * inverse
    beta = (p.a11 * q2 - coupling * q1) * inverse
    moment = p.moment
    if p.steady > 0:
        alpha, beta = 0.0, q2 / p.a22
        moment = coupling * beta - q1
    slider = -fx * per_m3
    ax = -l1 * (st * alpha + ct * omega * omega) - l2 * (sp * beta + cp * psi * psi) - slider
    ay = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi)
    own = y[1], contact, place, (ax, ay), sliding, forces, law.clearance
    (first, second), lost, joint = joints.motion_of(*own)
    accelerations = alpha, first, second * (1 / r if contact else 1.0)
    powers, coupler = (*lost, moment * omega), (sp, cp, psi, beta)
    result = joints.Motion(accelerations, powers, (joint,), moment, coupler, slider + 0.0)
    return result, ((st, ct), (cross, coupling), (ax, ay), place, forces)


@compiled
def derive(y, mode, p, motion, parts, k):
    """Fill ``k`` with the derivatives of z'', a column for each of (z, z')."""
    contact = mode[0]
    l1, l2, omega = p.l1, p.l2, y[3]
    (st, ct), (cross, coupling), (ax, ay), place, forces = parts
    r, spin = place[2], place[4]
    alpha, (sp, cp, psi, beta) = motion.accelerations[0], motion.coupler
    fx, fy = joints.on_ball(place, forces)
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    per_reach, per_mass = 1 / (l2 * cp), 1 / p.m3
    lean, per_radius = psi * l2 * sp * per_reach, 1 / r if contact else 1.0
    for j in range(2 * UNKNOWNS):
        dt, do = _UNIT[j, 0], _UNIT[j, 3]
        of_joint = _UNIT[j, 1], _UNIT[j, 2], _UNIT[j, 4], _UNIT[j, 5]
        change = joints.place_change(*of_joint, place, contact)
        dr, _, _, dspin, dey, dwy = change
        dp = (dey - l1 * ct * dt) * per_reach
        dpsi = (dwy + l1 * (st * omega * dt - ct * do)) * per_reach + lean * dp
        dsliding = dr * spin + r * dspin + p.r1 * dpsi
        dtangential, dfx, dfy = joints.on_ball_change(place, forces, change, dsliding)
        dcross, dcoupling = coupling * (dt - dp), -cross * (dt - dp)
        dq1 = (
            -dcross * psi * psi
            - 2 * cross * psi * dpsi
            + l1 * (ct * dfy - st * dfx - (st * fy + ct * fx) * dt)
            + p.g1 * st * dt
            - dcoupling * beta
        )
        dq2 = (
            dcross * omega * omega
            + 2 * cross * omega * do
            + l2 * (cp * dfy - sp * dfx - (sp * fy + cp * fx) * dp)
            + p.r1 * dtangential
            + p.g2 * sp * dp
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
        both = (ax, ay), (dax, day), change, motion.accelerations[2]
        first, second = joints.acceleration_changes(place, contact, *both)
        k[0, j], k[1, j], k[2, j] = dalpha, first, second * per_radius


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
def record(row, y, motion, parts, p):
    """Fill a row of output from (z, z', losses, work) and what `motion` returned."""
    (st, ct), _, _, ball, _ = parts
    (sp, cp, psi, beta), alpha, omega = motion.coupler, motion.accelerations[0], y[3]
    place, forces = joints.columns_of(motion.joints[0], ball)
    crank = y[0], omega, alpha, motion.moment
    speed = -p.l1 * st * omega - p.l2 * sp * psi - ball[7]
    slider = p.l1 * ct + p.l2 * cp - place[0], speed, motion.slider
    kinetic = 0.5 * (p.a11 * omega * omega + p.a22 * psi * psi + p.m3 * speed * speed)
    kinetic += p.a12 * (ct * cp + st * sp) * omega * psi
    energies = y[8] - p.g1 * st - p.g2 * sp, kinetic, 0.0, y[6], y[7]
    stepping.record(row, crank, slider, (angle_of(sp, cp), psi), place, forces, energies)
    # the coupler's centre is accelerated by the forces on its two ends
    ax = -p.l1 * (st * alpha + ct * omega * omega) - 0.5 * p.l2 * (sp * beta + cp * psi * psi)
    ay = p.l1 * (ct * alpha - st * omega * omega) + 0.5 * p.l2 * (cp * beta - sp * psi * psi)
    pull = p.m2 * ax + forces[2], p.m2 * (ay + p.gravity) + forces[3]
    stepping.record_crank_joint(row, (0.0, 0.0, 0.0), (norm(pull[0], pull[1]), 0.0, *pull))
