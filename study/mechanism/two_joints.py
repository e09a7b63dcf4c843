"""Rigid links with two clearance joints, crank-coupler and coupler-slider: equations of motion.

Five degrees of freedom: the crank's angle theta, and in each joint the two coordinates of
`study.mechanism.joints`. The ball of the crank's joint is on the crank's end, its socket in the
coupler, which turns. Crank, coupler and slider are free bodies under the joints' forces.
Eccentricities are differences of their places, so that no mass matrix is solved.

The slider's joint comes first (index 0), the crank's second.
"""

from collections import namedtuple
from math import sqrt

import numpy as np

from study.compiled import compiled
from study.mechanism import joints, loads, stepping
from study.mechanism.angles import sine_cosine
from study.mechanism.stepping import CRANK, SLIDER

UNKNOWNS = 5
THETA, FIRST0, SECOND0, FIRST1, SECOND1, OMEGA = range(UNKNOWNS + 1)
"""Places in a state: the crank's angle, coordinates of slider's and crank's joint, and the rate of
the angle."""
_UNIT = np.eye(2 * UNKNOWNS)


Parts = namedtuple("Parts", "pose forces_x forces_y accelerations eccentricities forces")
"""What `derive` and `write_output` need of a motion. (forces_x, forces_y) acts on both balls
together; the rest are pairs, slider's and crank's joint; accelerations are the eccentricities'."""


@compiled
def motion(y, contacts, p, laws):
    """`Motion` at y = (z, z', ...), and its `Parts`, with each joint in a `ContactState`."""
    (st, ct), omega, half = sine_cosine(y[THETA]), y[OMEGA], 0.5 * p.l2
    law0, law1, contact0, contact1 = laws[SLIDER], laws[CRANK], contacts[SLIDER], contacts[CRANK]
    e0 = joints.eccentricity_of(y, SLIDER, UNKNOWNS, contact0.closed, law0.clearance)
    e1 = joints.eccentricity_of(y, CRANK, UNKNOWNS, contact1.closed, law1.clearance)
    sp = (e0.y + e1.y - p.l1 * st) / p.l2
    cp = sqrt(1 - sp * sp)
    psi = (e0.y_rate + e1.y_rate - p.l1 * ct * omega) / (p.l2 * cp)
    arm = e1.length + p.crank_r1
    sliding0 = e0.length * e0.spin + p.r1 * psi
    sliding1 = e1.length * e1.spin + p.crank_r1 * omega - arm * psi
    forces0 = joints.forces_of(y[FIRST0], e0, sliding0, contact0, p, law0)
    forces1 = joints.forces_of(y[FIRST1], e1, sliding1, contact1, p, law1)
    t0, t1 = forces0.tangential, forces1.tangential
    fx0, fy0 = joints.on_ball(e0, forces0)
    fx1, fy1 = joints.on_ball(e1, forces1)
    start_x, start_y = p.l1 * ct - e1.x, p.l1 * st - e1.y  # the coupler's socket
    pose = loads.Pose(st, ct, sp, cp, start_x + p.l2 * cp - e0.x, start_y)
    load = loads.applied(p, pose, False)

    push = p.l1 * (ct * fy1 - st * fx1) + p.crank_r1 * t1 + load.crank
    moment, alpha = (-push, 0.0) if p.steady > 0 else (load.drive, (load.drive + push) / p.j1)
    sx, sy = fx0 + fx1, fy0 + fy1
    beta = (half * (cp * sy - sp * sx) + p.r1 * t0 - arm * t1 + load.coupler) / p.i2
    turn_x, turn_y = -half * (sp * beta + cp * psi * psi), half * (cp * beta - sp * psi * psi)
    middle_x, middle_y = (fx0 - fx1) / p.m2, (fy0 - fy1) / p.m2 + load.fall
    end_x = -p.l1 * (st * alpha + ct * omega * omega)
    end_y = p.l1 * (ct * alpha - st * omega * omega)
    slider = (load.slider - fx0) / p.m3
    a0 = middle_x + turn_x - slider, middle_y + turn_y
    a1 = end_x - middle_x + turn_x, end_y - middle_y + turn_y
    own = y[FIRST0], contact0.closed, e0, a0, sliding0, forces0, law0.clearance
    (first0, second0), lost0, joint0 = joints.motion_of(*own)
    own = y[FIRST1], contact1.closed, e1, a1, sliding1, forces1, law1.clearance
    (first1, second1), lost1, joint1 = joints.motion_of(*own)
    r0, r1 = e0.length if contact0.closed else 1.0, e1.length if contact1.closed else 1.0
    accelerations = alpha, first0, second0 / r0, first1, second1 / r1
    powers, coupler = (*lost0, *lost1, moment * omega), joints.Coupler(sp, cp, psi, beta)
    states = joint0, joint1
    result = joints.Motion(accelerations, powers, states, moment, coupler, slider + 0.0)
    return result, Parts(pose, sx, sy, (a0, a1), (e0, e1), (forces0, forces1))


@compiled
def derive(y, contacts, p, motion, parts, k):
    """Fill ``k`` with the derivatives of z'', a column for each of (z, z')."""
    pose, (e0, e1), (forces0, forces1) = parts.pose, parts.eccentricities, parts.forces
    st, ct, sp, cp, sx, sy = pose.st, pose.ct, pose.sp, pose.cp, parts.forces_x, parts.forces_y
    psi, beta = motion.coupler.rate, motion.coupler.acceleration
    alpha, _, turning0, _, turning1 = motion.accelerations
    a0, a1 = parts.accelerations
    closed0, closed1 = contacts[SLIDER].closed, contacts[CRANK].closed
    r0, r1 = e0.length if closed0 else 1.0, e1.length if closed1 else 1.0
    omega, half = y[OMEGA], 0.5 * p.l2
    arm = e1.length + p.crank_r1
    fx1, fy1 = joints.on_ball(e1, forces1)
    for i in range(2 * UNKNOWNS):
        u = _UNIT[i]
        dt, do = u[THETA], u[OMEGA]
        de0 = joints.eccentricity_change(u, SLIDER, UNKNOWNS, e0, closed0)
        de1 = joints.eccentricity_change(u, CRANK, UNKNOWNS, e1, closed1)
        dp = (de0.y + de1.y - p.l1 * ct * dt) / (p.l2 * cp)
        dwy = de0.y_rate + de1.y_rate + p.l1 * (st * omega * dt - ct * do)
        dpsi = dwy / (p.l2 * cp) + psi * sp / cp * dp
        dsliding0 = de0.length * e0.spin + e0.length * de0.spin + p.r1 * dpsi
        dsliding1 = de1.length * (e1.spin - psi) + e1.length * de1.spin + p.crank_r1 * do
        dsliding1 -= arm * dpsi
        dt0, dfx0, dfy0 = joints.on_ball_change(e0, forces0, de0, dsliding0)
        dt1, dfx1, dfy1 = joints.on_ball_change(e1, forces1, de1, dsliding1)
        dslider = -p.l1 * st * dt - de1.x - p.l2 * sp * dp - de0.x
        load = loads.change(p, pose, dt, dp, dslider, False)
        dpush = p.l1 * (ct * dfy1 - st * dfx1 - (st * fy1 + ct * fx1) * dt)
        dpush += p.crank_r1 * dt1 + load.crank
        dalpha = 0.0 if p.steady > 0 else dpush / p.j1
        dbeta = half * (cp * (dfy0 + dfy1) - sp * (dfx0 + dfx1) - (sp * sy + cp * sx) * dp)
        dbeta = dbeta + p.r1 * dt0 - arm * dt1 - de1.length * forces1.tangential + load.coupler
        dbeta /= p.i2
        dturn_x = -half * (sp * dbeta + cp * (beta * dp + 2 * psi * dpsi) - sp * psi * psi * dp)
        dturn_y = half * (cp * dbeta - sp * (beta * dp + 2 * psi * dpsi) - cp * psi * psi * dp)
        dmiddle_x, dmiddle_y = (dfx0 - dfx1) / p.m2, (dfy0 - dfy1) / p.m2 + load.fall
        turned = alpha * dt + 2 * omega * do
        dend_x = -p.l1 * (st * dalpha + ct * turned - st * omega * omega * dt)
        dend_y = p.l1 * (ct * dalpha - st * turned - ct * omega * omega * dt)
        da0 = dmiddle_x + dturn_x + (dfx0 - load.slider) / p.m3, dmiddle_y + dturn_y
        da1 = dend_x - dmiddle_x + dturn_x, dend_y - dmiddle_y + dturn_y
        first0, second0 = joints.acceleration_changes(e0, closed0, a0, da0, de0, turning0)
        first1, second1 = joints.acceleration_changes(e1, closed1, a1, da1, de1, turning1)
        k[THETA, i], k[FIRST0, i], k[SECOND0, i] = dalpha, first0, second0 / r0
        k[FIRST1, i], k[SECOND1, i] = first1, second1 / r1


@compiled
def inverse_effective_mass(j, theta, phi, dx, dy, p):
    """Inverse effective mass of a joint's ball against its socket along (dx, dy), in 1/kg.

    The other joint is free. ``phi`` is the sine and cosine of the coupler's angle.
    """
    (st, ct), (sp, cp) = sine_cosine(theta), phi
    turn = 0.5 * p.l2 * (cp * dy - sp * dx)
    inverse_mass = (dx * dx + dy * dy) / p.m2 + turn * turn / p.i2
    if j == SLIDER:
        return inverse_mass + dx * dx / p.m3
    if p.steady > 0:
        return inverse_mass
    lever = p.l1 * (ct * dy - st * dx)
    return inverse_mass + lever * lever / p.j1


@compiled
def write_output(row, y, motion, parts, p):
    """Fill in what a row of output has of the slider's speed, kinetic energy and the joints."""
    pose, (e0, e1), omega, psi = parts.pose, parts.eccentricities, y[OMEGA], motion.coupler.rate
    st, ct, sp, cp = pose.st, pose.ct, pose.sp, pose.cp
    wx, wy = -p.l1 * st * omega - e1.x_rate, p.l1 * ct * omega - e1.y_rate
    speed = wx - p.l2 * sp * psi - e0.x_rate
    vx, vy = wx - 0.5 * p.l2 * sp * psi, wy + 0.5 * p.l2 * cp * psi
    kinetic = 0.5 * (p.j1 * omega * omega + p.i2 * psi * psi + p.m3 * speed * speed)
    kinetic += 0.5 * p.m2 * (vx * vx + vy * vy)
    row.slider_velocity, row.kinetic = speed, kinetic
    stepping.write_joint(row, joints.output_of(motion.joints[SLIDER], e0))
    stepping.write_crank_joint(row, joints.output_of(motion.joints[CRANK], e1))
