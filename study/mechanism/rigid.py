"""Rigid links with a clearance joint between coupler and slider: equations of motion.

Three degrees of freedom: the crank's angle theta and the place of the ball's centre in the
socket, in flight as (e_x, e_y), in contact as (depth, direction). The depth is then a variable
of its own: nothing cancels, and the stiff direction is a coordinate, which lets steps grow.
Coupler and slider follow from the geometry, the coupler pointing to +x.

They are stepped in `study.mechanism.events`; those of two clearance joints are in `two_joints`.
"""

from math import sqrt

import numpy as np

from study.compiled import compiled
from study.contact.forces import joint_forces
from study.mechanism import stepping
from study.mechanism.angles import angle_of, norm, sine_cosine
from study.mechanism.collocation import POWERS

# Places in what `motion` finds, after the accelerations and the powers: of the joint (a second one
# has its own `JOINT` places later), then of the mechanism
DEPTH, RATE, SLIDING, NORMAL, TANGENTIAL, NORMAL_RATE = range(10, 16)
JOINT = 6
MOMENT, SINE, COSINE, PSI, SLIDER, BETA = range(22, 28)
_UNIT = np.eye(6)


@compiled
def new_slopes(joints=1):
    """Room for what `motion` fills, with one or two clearance joints."""
    return np.zeros(28), np.zeros((POWERS + 5, 2 + 4 * joints))


@compiled
def motion(y, piece, p, law, jacobian, f, k):
    """Fill ``f`` with accelerations z'', powers and what else is found, at y = (z, z', ...).

    ``piece`` is (in contact?, friction branch, approach speed). The powers are those lost to
    damping and friction and, at constant crank speed, that of the drive. With ``jacobian`` the
    derivatives ``k`` are filled, a row for each of z'' and the powers, a column for each of
    (z, z').
    """
    contact, branch, approach = piece
    l1, l2 = p.l1, p.l2
    (st, ct), omega = sine_cosine(y[0]), y[3]
    if contact:
        ny, nx = sine_cosine(y[2])
        r, rate, spin = law[1] + y[1], y[4], y[5]
        ey, wx, wy = r * ny, rate * nx - r * spin * ny, rate * ny + r * spin * nx
    else:
        ey, wx, wy = y[2], y[4], y[5]
        r = sqrt(y[1] * y[1] + ey * ey)
        nx, ny = (y[1] / r, ey / r) if r > 0 else (1.0, 0.0)
        rate, spin = wx * nx + wy * ny, (wy * nx - wx * ny) / r if r > 0 else 0.0
    sp = (ey - l1 * st) / l2
    cp = sqrt(1 - sp * sp)
    psi = (wy - l1 * ct * omega) / (l2 * cp)
    sliding = r * spin + p.r1 * psi

    normal = normal_d = normal_r = elastic = elastic_d = 0.0
    tangential = tangential_n = tangential_s = 0.0
    if contact and y[1] > 0:
        normal, normal_d, normal_r, elastic, elastic_d, tangential, tangential_n, tangential_s = (
            joint_forces(
                law, y[1], rate, sliding, branch, approach, p.damping, p.friction, p.v0, p.v1
            )
        )
    fx, fy = -normal * nx - tangential * ny, -normal * ny + tangential * nx  # on the ball

    # [A11 C; C A22] (theta'', phi'') = (q1, q2): crank and coupler as a double pendulum
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    cross, coupling = p.a12 * sd, p.a12 * cd
    q1 = p.moment - cross * psi * psi + l1 * (ct * fy - st * fx) - p.g1 * ct
    q2 = cross * omega * omega + l2 * (cp * fy - sp * fx) + p.r1 * tangential - p.g2 * cp
    determinant = p.a11 * p.a22 - coupling * coupling
    alpha = (p.a22 * q1 - coupling * q2) / determinant
    beta = (p.a11 * q2 - coupling * q1) / determinant
    moment = p.moment
    if p.steady > 0:
        alpha, beta = 0.0, q2 / p.a22
        moment = coupling * beta - q1
    slider = -fx / p.m3
    ax = -l1 * (st * alpha + ct * omega * omega) - l2 * (sp * beta + cp * psi * psi) - slider
    ay = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi)
    growth = nx * ax + ny * ay + r * spin * spin
    f[0] = alpha
    if contact:
        f[1], f[2] = growth, (nx * ay - ny * ax - 2 * rate * spin) / r
    else:
        f[1], f[2] = ax, ay
    f[POWERS], f[POWERS + 1] = (normal - elastic) * rate, -tangential * sliding
    f[POWERS + 2] = moment * omega
    f[DEPTH], f[RATE], f[SLIDING] = y[1] if contact else r - law[1], rate, sliding
    f[NORMAL], f[TANGENTIAL] = normal, tangential
    f[NORMAL_RATE] = normal_d * rate + normal_r * growth
    f[MOMENT] = moment
    f[SINE], f[COSINE], f[PSI], f[SLIDER] = sp, cp, psi, slider + 0.0
    f[BETA] = beta
    if not jacobian:
        return
    for j in range(6):  # derivatives along each of (z, z')
        dt, do = _UNIT[j, 0], _UNIT[j, 3]
        dr = db = drate = dspin = 0.0
        if contact:
            dr, db, drate, dspin = _UNIT[j, 1], _UNIT[j, 2], _UNIT[j, 4], _UNIT[j, 5]
            dey = dr * ny + r * nx * db
            dwy = drate * ny + (dr * spin + r * dspin) * nx + wx * db
        else:
            dey, dwy = _UNIT[j, 2], _UNIT[j, 5]
        dp = (dey - l1 * ct * dt) / (l2 * cp)
        dpsi = (dwy + l1 * (st * omega * dt - ct * do)) / (l2 * cp) + psi * sp / cp * dp
        dsliding = dr * spin + r * dspin + p.r1 * dpsi
        dnormal = normal_d * dr + normal_r * drate
        dtangential = tangential_n * dnormal + tangential_s * dsliding
        dfx = -dnormal * nx - dtangential * ny + (normal * ny - tangential * nx) * db
        dfy = -dnormal * ny + dtangential * nx - (normal * nx + tangential * ny) * db
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
        dalpha = (p.a22 * dq1 - coupling * dq2) / determinant
        dbeta = (p.a11 * dq2 - coupling * dq1) / determinant
        if p.steady > 0:
            dalpha, dbeta = 0.0, dq2 / p.a22
            k[POWERS + 2, j] = (coupling * dbeta - dq1) * omega + moment * do
        dax = (
            -l1 * (st * dalpha + ct * (alpha * dt + 2 * omega * do) - st * omega * omega * dt)
            - l2 * (sp * dbeta + cp * (beta * dp + 2 * psi * dpsi) - sp * psi * psi * dp)
            + dfx / p.m3
        )
        day = l1 * (ct * dalpha - st * (alpha * dt + 2 * omega * do) - ct * omega * omega * dt)
        day += l2 * (cp * dbeta - sp * (beta * dp + 2 * psi * dpsi) - cp * psi * psi * dp)
        k[0, j] = dalpha
        if contact:
            k[1, j] = (nx * ay - ny * ax) * db + nx * dax + ny * day
            k[1, j] += dr * spin * spin + 2 * r * spin * dspin
            turn = nx * day - ny * dax - (nx * ax + ny * ay) * db
            k[2, j] = (turn - 2 * (drate * spin + rate * dspin) - f[2] * dr) / r
        else:
            k[1, j], k[2, j] = dax, day
        k[POWERS, j] = (dnormal - elastic_d * dr) * rate + (normal - elastic) * drate
        k[POWERS + 1, j] = -dtangential * sliding - tangential * dsliding


@compiled
def compliance(theta, ey, dx, dy, arm, p):
    """Inverse mass of the ball against the socket along (dx, dy), in 1/kg.

    ``arm`` is that of the force about the ball's centre, which turns the coupler.
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
def record(row, y, contact, f, p, law):
    """Fill a row of output from (z, z', energies lost) and what `motion` found there."""
    st, ct = sine_cosine(y[0])
    sp, cp, psi = f[SINE], f[COSINE], f[PSI]
    ex, ey, wx, nx, ny = y[1], y[2], y[4], 0.0, 0.0
    if contact:
        ny, nx = sine_cosine(y[2])
        r = law[1] + y[1]
        ex, ey, wx = r * nx, r * ny, y[4] * nx - y[5] * r * ny
    crank = y[0], y[3], f[0], f[MOMENT]
    speed = -p.l1 * st * y[3] - p.l2 * sp * psi - wx
    slider = p.l1 * ct + p.l2 * cp - ex, speed, f[SLIDER]
    normal, tangential = f[NORMAL], f[TANGENTIAL]
    forces = normal, tangential, normal * nx + tangential * ny, normal * ny - tangential * nx
    kinetic = 0.5 * (p.a11 * y[3] * y[3] + p.a22 * psi * psi + p.m3 * speed * speed)
    kinetic += p.a12 * (ct * cp + st * sp) * y[3] * psi
    drive = y[8] if p.steady > 0 else p.moment * y[0]
    energies = drive - p.g1 * st - p.g2 * sp, kinetic, 0.0, y[6], y[7]
    coupler, place = (angle_of(sp, cp), psi), (ex, ey, f[DEPTH])
    stepping.record(row, crank, slider, coupler, place, forces, energies)
    # the coupler's centre is accelerated by the forces on its two ends
    beta, alpha, omega = f[BETA], f[0], y[3]
    ax = -p.l1 * (st * alpha + ct * omega * omega) - 0.5 * p.l2 * (sp * beta + cp * psi * psi)
    ay = p.l1 * (ct * alpha - st * omega * omega) + 0.5 * p.l2 * (cp * beta - sp * psi * psi)
    pull = p.m2 * ax + forces[2], p.m2 * (ay + p.gravity) + forces[3]
    stepping.record_crank_joint(row, (0.0, 0.0, 0.0), (norm(pull[0], pull[1]), 0.0, *pull))
