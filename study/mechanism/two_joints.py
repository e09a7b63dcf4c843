"""Rigid links with two clearance joints, crank-coupler and coupler-slider: equations of motion.

Five degrees of freedom: the crank's angle theta, and in each joint the place of the ball's centre
in the socket, as in `study.mechanism.rigid`. The ball of the crank's joint is on the crank's end,
its socket in the coupler, which turns. Crank, coupler and slider are free bodies under the joints'
forces. Eccentricities are differences of their places, so that no mass matrix is solved.

The slider's joint comes first (index 0), the crank's second.
"""

from math import sqrt

import numpy as np

from study.compiled import compiled
from study.mechanism import joints, stepping
from study.mechanism.angles import angle_of, sine_cosine

UNKNOWNS = 5
_UNIT = np.eye(2 * UNKNOWNS)


@compiled
def motion(y, modes, p, laws):
    """Accelerations, powers and forces at y = (z, z', ...), and what `derive` needs.

    As `study.mechanism.rigid.motion`, with a mode and a law for each joint.
    """
    (st, ct), omega, half = sine_cosine(y[0]), y[5], 0.5 * p.l2
    contacts = modes[0][0], modes[1][0]
    places = (
        joints.place_of(y[1], y[2], y[6], y[7], contacts[0], laws[0].clearance),
        joints.place_of(y[3], y[4], y[8], y[9], contacts[1], laws[1].clearance),
    )
    sp = (places[0][6] + places[1][6] - p.l1 * st) / p.l2
    cp = sqrt(1 - sp * sp)
    psi = (places[0][8] + places[1][8] - p.l1 * ct * omega) / (p.l2 * cp)
    reach, arm = places[1][2], places[1][2] + p.crank_r1
    slidings = (
        places[0][2] * places[0][4] + p.r1 * psi,
        reach * places[1][4] + p.crank_r1 * omega - arm * psi,
    )
    forces = (
        joints.forces_of(y[1], places[0], slidings[0], modes[0], p, laws[0]),
        joints.forces_of(y[3], places[1], slidings[1], modes[1], p, laws[1]),
    )
    t0, t1 = forces[0][5], forces[1][5]
    fx0, fy0 = joints.on_ball(places[0], forces[0])
    fx1, fy1 = joints.on_ball(places[1], forces[1])

    push = p.l1 * (ct * fy1 - st * fx1) + p.crank_r1 * t1 - p.own_g1 * ct
    moment, alpha = (-push, 0.0) if p.steady > 0 else (p.moment, (p.moment + push) / p.j1)
    sx, sy = fx0 + fx1, fy0 + fy1
    beta = (half * (cp * sy - sp * sx) + p.r1 * t0 - arm * t1) / p.i2
    turn = -half * (sp * beta + cp * psi * psi), half * (cp * beta - sp * psi * psi)
    middle = (fx0 - fx1) / p.m2, (fy0 - fy1) / p.m2 - p.gravity
    end = -p.l1 * (st * alpha + ct * omega * omega), p.l1 * (ct * alpha - st * omega * omega)
    slider = -fx0 / p.m3
    grown = (
        (middle[0] + turn[0] - slider, middle[1] + turn[1]),
        (end[0] - middle[0] + turn[0], end[1] - middle[1] + turn[1]),
    )
    own = y[1], contacts[0], places[0], grown[0], slidings[0], forces[0], laws[0].clearance
    (first0, second0), lost0, joint0 = joints.motion_of(*own)
    own = y[3], contacts[1], places[1], grown[1], slidings[1], forces[1], laws[1].clearance
    (first1, second1), lost1, joint1 = joints.motion_of(*own)
    r0, r1 = places[0][2] if contacts[0] else 1.0, places[1][2] if contacts[1] else 1.0
    accelerations = alpha, first0, second0 / r0, first1, second1 / r1
    powers, coupler = (*lost0, *lost1, moment * omega), (sp, cp, psi, beta)
    states = joint0, joint1
    result = joints.Motion(accelerations, powers, states, moment, coupler, slider + 0.0)
    return result, ((st, ct), (sx, sy), grown, places, forces)


@compiled
def derive(y, modes, p, motion, parts, k):
    """Fill ``k`` with the derivatives of z'', a column for each of (z, z')."""
    (st, ct), (sx, sy), grown, places, forces = parts
    (sp, cp, psi, beta), alpha = motion.coupler, motion.accelerations[0]
    contacts = modes[0][0], modes[1][0]
    omega, half = y[5], 0.5 * p.l2
    arm = places[1][2] + p.crank_r1
    fx1, fy1 = joints.on_ball(places[1], forces[1])
    for i in range(2 * UNKNOWNS):
        dt, do, u = _UNIT[i, 0], _UNIT[i, 5], _UNIT[i]
        changes = (
            joints.place_change(u[1], u[2], u[6], u[7], places[0], contacts[0]),
            joints.place_change(u[3], u[4], u[8], u[9], places[1], contacts[1]),
        )
        dp = (changes[0][4] + changes[1][4] - p.l1 * ct * dt) / (p.l2 * cp)
        dwy = changes[0][5] + changes[1][5] + p.l1 * (st * omega * dt - ct * do)
        dpsi = dwy / (p.l2 * cp) + psi * sp / cp * dp
        dreach, dspin, spin = changes[1][0], changes[1][3], places[1][4]
        dslidings = (
            changes[0][0] * places[0][4] + places[0][2] * changes[0][3] + p.r1 * dpsi,
            dreach * (spin - psi) + places[1][2] * dspin + p.crank_r1 * do - arm * dpsi,
        )
        dt0, dfx0, dfy0 = joints.on_ball_change(places[0], forces[0], changes[0], dslidings[0])
        dt1, dfx1, dfy1 = joints.on_ball_change(places[1], forces[1], changes[1], dslidings[1])
        dpush = p.l1 * (ct * dfy1 - st * dfx1 - (st * fy1 + ct * fx1) * dt)
        dpush += p.crank_r1 * dt1 + p.own_g1 * st * dt
        dalpha = 0.0 if p.steady > 0 else dpush / p.j1
        dbeta = half * (cp * (dfy0 + dfy1) - sp * (dfx0 + dfx1) - (sp * sy + cp * sx) * dp)
        dbeta = (dbeta + p.r1 * dt0 - arm * dt1 - dreach * forces[1][5]) / p.i2
        dturn = (
            -half * (sp * dbeta + cp * (beta * dp + 2 * psi * dpsi) - sp * psi * psi * dp),
            half * (cp * dbeta - sp * (beta * dp + 2 * psi * dpsi) - cp * psi * psi * dp),
        )
        dmiddle = (dfx0 - dfx1) / p.m2, (dfy0 - dfy1) / p.m2
        dend = (
            -p.l1 * (st * dalpha + ct * (alpha * dt + 2 * omega * do) - st * omega * omega * dt),
            p.l1 * (ct * dalpha - st * (alpha * dt + 2 * omega * do) - ct * omega * omega * dt),
        )
        dgrown = (
            (dmiddle[0] + dturn[0] + dfx0 / p.m3, dmiddle[1] + dturn[1]),
            (dend[0] - dmiddle[0] + dturn[0], dend[1] - dmiddle[1] + dturn[1]),
        )
        k[0, i] = dalpha
        for j in range(2):
            both = grown[j], dgrown[j], changes[j], motion.accelerations[2 + 2 * j]
            first, second = joints.acceleration_changes(places[j], contacts[j], *both)
            r = places[j][2] if contacts[j] else 1.0
            k[1 + 2 * j, i], k[2 + 2 * j, i] = first, second / r


@compiled
def inverse_effective_mass(j, theta, phi, dx, dy, p):
    """Inverse effective mass of a joint's ball against its socket along (dx, dy), in 1/kg.

    The other joint is free. ``phi`` is the sine and cosine of the coupler's angle.
    """
    (st, ct), (sp, cp) = sine_cosine(theta), phi
    turn = 0.5 * p.l2 * (cp * dy - sp * dx)
    inverse_mass = (dx * dx + dy * dy) / p.m2 + turn * turn / p.i2
    if j == 0:
        return inverse_mass + dx * dx / p.m3
    if p.steady > 0:
        return inverse_mass
    lever = p.l1 * (ct * dy - st * dx)
    return inverse_mass + lever * lever / p.j1


@compiled
def record(row, y, motion, parts, p):
    """Fill a row of output from (z, z', losses, work) and what `motion` returned."""
    (st, ct), omega, places = parts[0], y[5], parts[3]
    sp, cp, psi, _ = motion.coupler
    x = p.l1 * ct - places[1][5], p.l1 * st - places[1][6]  # the coupler's socket
    wx, wy = -p.l1 * st * omega - places[1][7], p.l1 * ct * omega - places[1][8]
    speed = wx - p.l2 * sp * psi - places[0][7]
    crank = y[0], omega, motion.accelerations[0], motion.moment
    slider = x[0] + p.l2 * cp - places[0][5], speed, motion.slider
    middle = wx - 0.5 * p.l2 * sp * psi, wy + 0.5 * p.l2 * cp * psi
    kinetic = 0.5 * (p.j1 * omega * omega + p.i2 * psi * psi + p.m3 * speed * speed)
    kinetic += 0.5 * p.m2 * (middle[0] * middle[0] + middle[1] * middle[1])
    fall = p.own_g1 * st + p.m2 * p.gravity * (x[1] + 0.5 * p.l2 * sp)
    energies = y[14] - fall, kinetic, 0.0, y[10] + y[12], y[11] + y[13]
    place, forces = joints.columns_of(motion.joints[0], places[0])
    stepping.record(row, crank, slider, (angle_of(sp, cp), psi), place, forces, energies)
    stepping.record_crank_joint(row, *joints.columns_of(motion.joints[1], places[1]))
