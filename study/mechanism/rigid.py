"""Rigid links with a clearance joint: equations of motion, and a stepper that locates impacts.

Three degrees of freedom: the crank's angle theta and the place of the ball's centre in the
socket, in flight as (e_x, e_y), in contact as (depth, direction). The depth is then a variable
of its own: nothing cancels, and the stiff direction is a coordinate, which lets steps grow.
Coupler and slider follow from the geometry, the coupler pointing to +x.

Between impacts, and between the kinks of the friction law, the equations are smooth. Each
piece is integrated by the stiffly accurate Rosenbrock method Rodas5P of order 5 with the
analytic Jacobian; its end is located by repeating the last step with another length until the
event function vanishes. What the flexible models need is not here.
"""

from math import inf, sqrt

import numpy as np

from study.compiled import compiled
from study.contact.forces import elastic_force, joint_forces, stored_energy
from study.contact.friction import friction_branch
from study.mechanism.angles import angle_of, fifth_root, norm, sine_cosine
from study.mechanism.response import (
    CONTACT,
    FAILED,
    FINE,
    FULL,
    IMPACTS,
    TOO_DEEP,
    advance_in_blocks,
)

# Rodas5P in the form that needs no product with the Jacobian: (I/(gamma h) - J) u_i =
# f(y + sum_j A_ij u_j) + sum_j C_ij u_j / h. Coefficients: Steinebach, BIT 63 (2023), 27.
GAMMA = 0.21193756319429014
_A = np.zeros((8, 8))
_A[1, :1] = 3.0
_A[2, :2] = 2.849394379747939, 0.45842242204463923
_A[3, :3] = -6.954028509809101, 2.489845061869568, -10.358996098473584
_A[4, :4] = 2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641
_A[5, :5] = (
    -7.502846399306121,
    2.561846144803919,
    -11.627539656261098,
    -0.18268767659942256,
    0.030198172008377946,
)
_A[6], _A[7] = _A[5], _A[5]
_A[6, 5] = _A[7, 5] = _A[7, 6] = 1.0
_C = np.zeros((8, 8))
_C[1, :1] = -14.155112264123755
_C[2, :2] = -17.97296035885952, -2.859693295451294
_C[3, :3] = 147.12150275711716, -1.41221402718213, 71.68940251302358
_C[4, :4] = 165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306
_C[5, :5] = (
    24.854864614690072,
    -3.0009227002832186,
    47.4931110020768,
    5.5814197821558125,
    -0.6610691825249471,
)
_C[6, :6] = (
    30.91273214028599,
    -3.1208243349937974,
    77.79954646070892,
    34.28646028294783,
    -19.097331116725623,
    -28.087943162872662,
)
_C[7, :7] = (
    37.80277123390563,
    -3.2571969029072276,
    112.26918849496327,
    66.9347231244047,
    -40.06618937091002,
    -54.66780262877968,
    -9.48861652309627,
)

# Places in the array of numbers that describes the scene
L1, L2, A11, A22, A12, M3, MOMENT, G1, G2, R1, DAMPING, FRICTION, V0, V1 = range(14)
# ... in the state of the stepper, after z, z' and the energies lost to damping and friction
BRANCH, APPROACH, TIME, STEP, DEEP, REACH = range(8, 14)
# ... in what `motion` tells besides z'' and the powers lost
DEPTH, RATE, SLIDING, NORMAL, TANGENTIAL, NORMAL_RATE, SINE, COSINE, PSI, SLIDER = range(10)
ROUNDING = 1e-16
_UNIT = np.eye(6)


def describe(scene):
    """Numbers of a scene for the compiled functions, in the order of ``L1, L2, ...``."""
    i1, i2 = scene.inertias
    m1, m2, l1, l2 = scene.crank_mass, scene.coupler_mass, scene.crank_length, scene.coupler_length
    return np.array(
        [
            l1,
            l2,
            i1 + m1 * l1**2 / 4 + m2 * l1**2,
            i2 + m2 * l2**2 / 4,
            m2 * l1 * l2 / 2,
            scene.slider_mass,
            scene.driving_moment,
            (m1 / 2 + m2) * scene.gravity * l1,
            m2 * scene.gravity * l2 / 2,
            scene.ball_radius,
            scene.damping_factor,
            scene.friction,
            scene.slow_speed,
            scene.full_speed,
        ]
    )


@compiled
def motion(y, piece, p, law, jacobian, f, seen, k):
    """Accelerations z'' and powers lost ``f``, what is ``seen``, and their derivatives ``k``.

    ``y`` is (z, z', ...) with z = (theta, e_x, e_y) in flight and (theta, depth, direction) in
    contact; ``piece`` is (in contact?, friction branch, approach speed). ``k`` has a row for
    each of ``f`` and a column for each of (z, z'); it is filled where ``jacobian`` is set.
    """
    contact, branch, approach = piece
    l1, l2 = p[L1], p[L2]
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
    sliding = r * spin + p[R1] * psi

    normal = normal_d = normal_r = elastic = elastic_d = 0.0
    tangential = tangential_n = tangential_s = 0.0
    if contact and y[1] > 0:
        normal, normal_d, normal_r, elastic, elastic_d, tangential, tangential_n, tangential_s = (
            joint_forces(
                law, y[1], rate, sliding, branch, approach, p[DAMPING], p[FRICTION], p[V0], p[V1]
            )
        )
    fx, fy = -normal * nx - tangential * ny, -normal * ny + tangential * nx  # on the ball

    # [A11 C; C A22] (theta'', phi'') = (q1, q2): crank and coupler as a double pendulum
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    cross, coupling = p[A12] * sd, p[A12] * cd
    q1 = p[MOMENT] - cross * psi * psi + l1 * (ct * fy - st * fx) - p[G1] * ct
    q2 = cross * omega * omega + l2 * (cp * fy - sp * fx) + p[R1] * tangential - p[G2] * cp
    determinant = p[A11] * p[A22] - coupling * coupling
    alpha = (p[A22] * q1 - coupling * q2) / determinant
    beta = (p[A11] * q2 - coupling * q1) / determinant
    slider = -fx / p[M3]
    ax = -l1 * (st * alpha + ct * omega * omega) - l2 * (sp * beta + cp * psi * psi) - slider
    ay = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi)
    growth = nx * ax + ny * ay + r * spin * spin
    f[0] = alpha
    if contact:
        f[1], f[2] = growth, (nx * ay - ny * ax - 2 * rate * spin) / r
    else:
        f[1], f[2] = ax, ay
    f[3], f[4] = (normal - elastic) * rate, -tangential * sliding
    seen[DEPTH], seen[RATE], seen[SLIDING] = y[1] if contact else r - law[1], rate, sliding
    seen[NORMAL], seen[TANGENTIAL] = normal, tangential
    seen[NORMAL_RATE] = normal_d * rate + normal_r * growth
    seen[SINE], seen[COSINE], seen[PSI], seen[SLIDER] = sp, cp, psi, slider + 0.0
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
        dsliding = dr * spin + r * dspin + p[R1] * dpsi
        dnormal = normal_d * dr + normal_r * drate
        dtangential = tangential_n * dnormal + tangential_s * dsliding
        dfx = -dnormal * nx - dtangential * ny + (normal * ny - tangential * nx) * db
        dfy = -dnormal * ny + dtangential * nx - (normal * nx + tangential * ny) * db
        dcross, dcoupling = coupling * (dt - dp), -cross * (dt - dp)
        dq1 = (
            -dcross * psi * psi
            - 2 * cross * psi * dpsi
            + l1 * (ct * dfy - st * dfx - (st * fy + ct * fx) * dt)
            + p[G1] * st * dt
            - dcoupling * beta
        )
        dq2 = (
            dcross * omega * omega
            + 2 * cross * omega * do
            + l2 * (cp * dfy - sp * dfx - (sp * fy + cp * fx) * dp)
            + p[R1] * dtangential
            + p[G2] * sp * dp
            - dcoupling * alpha
        )
        dalpha = (p[A22] * dq1 - coupling * dq2) / determinant
        dbeta = (p[A11] * dq2 - coupling * dq1) / determinant
        dax = (
            -l1 * (st * dalpha + ct * (alpha * dt + 2 * omega * do) - st * omega * omega * dt)
            - l2 * (sp * dbeta + cp * (beta * dp + 2 * psi * dpsi) - sp * psi * psi * dp)
            + dfx / p[M3]
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
        k[3, j] = (dnormal - elastic_d * dr) * rate + (normal - elastic) * drate
        k[4, j] = -dtangential * sliding - tangential * dsliding


@compiled
def _step(y, h, piece, p, law, f0, k, scratch, new):
    """One step of Rodas5P from ``y`` with slopes ``f0`` and derivatives ``k``; fills ``new``.

    Leaves the error estimate in the last row of ``scratch[0]``. The 6 unknowns of a stage are
    reduced to 3, as the first half of the system is the definition of z'.
    """
    u, work, f, seen = scratch
    g, rate = GAMMA * h, 1 / h
    # W = I/g - df/dz' - g df/dz, inverted by cofactors
    w00, w01, w02 = 1 / g - k[0, 3] - g * k[0, 0], -k[0, 4] - g * k[0, 1], -k[0, 5] - g * k[0, 2]
    w10, w11, w12 = -k[1, 3] - g * k[1, 0], 1 / g - k[1, 4] - g * k[1, 1], -k[1, 5] - g * k[1, 2]
    w20, w21, w22 = -k[2, 3] - g * k[2, 0], -k[2, 4] - g * k[2, 1], 1 / g - k[2, 5] - g * k[2, 2]
    c00, c01, c02 = w11 * w22 - w12 * w21, w02 * w21 - w01 * w22, w01 * w12 - w02 * w11
    c10, c11, c12 = w12 * w20 - w10 * w22, w00 * w22 - w02 * w20, w02 * w10 - w00 * w12
    c20, c21, c22 = w10 * w21 - w11 * w20, w01 * w20 - w00 * w21, w00 * w11 - w01 * w10
    d = 1 / (w00 * c00 + w01 * c10 + w02 * c20)
    for i in range(8):
        for n in range(8):
            new[n] = y[n]
            work[n] = 0.0
        for j in range(i):
            a, c = _A[i, j], _C[i, j] * rate
            for n in range(8):
                new[n] += a * u[j, n]
                work[n] += c * u[j, n]
        if i == 0:
            f[:] = f0
        else:
            motion(new, piece, p, law, False, f, seen, k)
        r0, r1, r2 = work[0] + new[3], work[1] + new[4], work[2] + new[5]
        b0 = work[3] + f[0] + g * (k[0, 0] * r0 + k[0, 1] * r1 + k[0, 2] * r2)
        b1 = work[4] + f[1] + g * (k[1, 0] * r0 + k[1, 1] * r1 + k[1, 2] * r2)
        b2 = work[5] + f[2] + g * (k[2, 0] * r0 + k[2, 1] * r1 + k[2, 2] * r2)
        u[i, 3] = (c00 * b0 + c01 * b1 + c02 * b2) * d
        u[i, 4] = (c10 * b0 + c11 * b1 + c12 * b2) * d
        u[i, 5] = (c20 * b0 + c21 * b1 + c22 * b2) * d
        u[i, 0], u[i, 1], u[i, 2] = g * (r0 + u[i, 3]), g * (r1 + u[i, 4]), g * (r2 + u[i, 5])
        for n in range(2):  # the energies lost, which nothing depends on
            power = f[3 + n] + work[6 + n]
            for j in range(6):
                power += k[3 + n, j] * u[i, j]
            u[i, 6 + n] = g * power
    for n in range(8):
        new[n] += u[7, n]


@compiled
def _error(u, state, contact, depth, tolerance, p, clearance):
    """Largest local error over what ``tolerance`` allows.

    Places relative to the clearance, the depth relative to the deepest that this impact's
    approach speed can bring; speeds relative to a tenth of that which the drive gives over the
    clearance (weights found by measuring time over accuracy).
    """
    place = tolerance * clearance
    speed = 0.1 * tolerance * state[REACH] + ROUNDING * p[L1] * abs(state[3])
    deep = tolerance * max(state[DEEP], depth) if contact else place
    across = clearance if contact else 1.0
    return max(
        p[L1] * abs(u[7, 0]) / (place + ROUNDING * p[L1] * abs(state[0])),
        abs(u[7, 1]) / deep,
        abs(u[7, 2]) * across / place,
        p[L1] * abs(u[7, 3]) / speed,
        abs(u[7, 4]) / speed,
        abs(u[7, 5]) * across / speed,
    )


@compiled
def _event(which, piece, seen, p):
    """Event functions, negative before and positive after.

    0: the surfaces meet or part; 1, 2: the sliding speed leaves the friction branch upwards or
    downwards; 3, 4: normal force and depth have passed a peak.
    """
    contact, branch, _ = piece
    if which == 0:
        return -seen[DEPTH] if contact else seen[DEPTH]
    if not contact:
        return -1.0
    if which >= 3:
        return -seen[NORMAL_RATE] if which == 3 else -seen[RATE]
    bounds = (-inf, -p[V1], -p[V0], p[V0], p[V1], inf)
    if which == 1:
        return seen[SLIDING] - bounds[branch + 3]
    return bounds[branch + 2] - seen[SLIDING]


@compiled
def _try(which, y, h, piece, p, law, f0, k, scratch, new):
    """Step by ``h`` and tell an event function at its end; ``scratch`` keeps what is seen."""
    _step(y, h, piece, p, law, f0, k, scratch, new)
    motion(new, piece, p, law, False, scratch[2], scratch[3], k)
    return _event(which, piece, scratch[3], p)


@compiled
def _locate(which, before, after, y, t, h, piece, p, law, f0, k, scratch, new):
    """Length of the step, at most ``h``, that ends where an event function turns positive.

    ``before`` and ``after`` are its values at 0 and ``h``; false position with halving of a
    value that stays (Illinois), each value from a step of its own.
    """
    low, high, side = 0.0, h, 0
    if before > -1e-9 * after:  # the piece begins on the event, and has left it at once
        before = -after
    while high - low > 1e-15 * t + 1e-14 * high:
        middle = (low * after - high * before) / (after - before)
        if not low < middle < high:
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
        value = _try(which, y, middle, piece, p, law, f0, k, scratch, new)
        if value < 0:
            low, before = middle, value
            after = after / 2 if side < 0 else after
            side = -1
        else:
            high, after = middle, value
            before = before / 2 if side > 0 else before
            side = 1
            if value == 0:
                break
    return high


@compiled
def compliance(theta, ey, dx, dy, arm, p):
    """Inverse mass of the ball against the socket along (dx, dy), in 1/kg.

    ``arm`` is that of the force about the ball's centre, which turns the coupler.
    """
    st, ct = sine_cosine(theta)
    sp = (ey - p[L1] * st) / p[L2]
    cp = sqrt(1 - sp * sp)
    d1, d2 = p[L1] * (ct * dy - st * dx), p[L2] * (cp * dy - sp * dx) + arm
    coupling = p[A12] * (ct * cp + st * sp)
    determinant = p[A11] * p[A22] - coupling * coupling
    links = (p[A22] * d1 * d1 - 2 * coupling * d1 * d2 + p[A11] * d2 * d2) / determinant
    return links + dx * dx / p[M3]


@compiled
def impact_depth(y, rate, p, law):
    """Depth at which the contact has stored the energy of an approach speed, in m.

    With the mechanism's effective mass along the normal; ``y`` in the coordinates of contact.
    """
    ny, nx = sine_cosine(y[2])
    energy = rate * rate / (2 * compliance(y[0], law[1] * ny, nx, ny, 0.0, p))
    depth = law[1]
    for _ in range(200):  # Newton's method on a convex function
        change = (stored_energy(law, depth) - energy) / elastic_force(law, depth)[0]
        depth -= change
        if abs(change) <= 1e-6 * depth:
            break
    return depth


@compiled
def _touch(y, law):
    """Turn flight's coordinates into those of contact, at depth 0."""
    r = norm(y[1], y[2])
    nx, ny, wx, wy = y[1] / r, y[2] / r, y[4], y[5]
    y[1], y[2], y[4], y[5] = 0.0, angle_of(ny, nx), nx * wx + ny * wy, (nx * wy - ny * wx) / law[1]


@compiled
def _part(y, law):
    """Turn contact's coordinates into those of flight, at depth 0."""
    ny, nx = sine_cosine(y[2])
    rate, across = y[4], law[1] * y[5]
    y[1], y[2] = law[1] * nx, law[1] * ny
    y[4], y[5] = rate * nx - across * ny, rate * ny + across * nx


@compiled
def _record(row, t, y, f, seen, contact, p, law):
    """Fill a row of output with what there is at time ``t``."""
    st, ct = sine_cosine(y[0])
    sp, cp, psi = seen[SINE], seen[COSINE], seen[PSI]
    ex, ey, wx, nx, ny = y[1], y[2], y[4], 0.0, 0.0
    if contact:
        ny, nx = sine_cosine(y[2])
        r = law[1] + y[1]
        ex, ey, wx = r * nx, r * ny, y[4] * nx - y[5] * r * ny
    row[0], row[1], row[2] = t, y[0], p[L1] * ct + p[L2] * cp - ex
    row[3], row[4] = y[3], -p[L1] * st * y[3] - p[L2] * sp * psi - wx
    row[5], row[6], row[7], row[8] = f[0], seen[SLIDER], angle_of(sp, cp), psi
    row[9], row[10], row[11] = ex, ey, seen[DEPTH]
    row[12], row[13] = seen[NORMAL], seen[TANGENTIAL]
    row[14] = seen[NORMAL] * nx + seen[TANGENTIAL] * ny
    row[15] = seen[NORMAL] * ny - seen[TANGENTIAL] * nx
    row[16] = p[MOMENT] * y[0] - p[G1] * st - p[G2] * sp
    row[17] = 0.5 * (p[A11] * y[3] * y[3] + p[A22] * psi * psi + p[M3] * row[4] * row[4])
    row[17] += p[A12] * (ct * cp + st * sp) * y[3] * psi
    row[18] = stored_energy(law, seen[DEPTH])
    row[19], row[20] = y[6], y[7]


@compiled
def advance(state, p, law, tolerance, times, rows, impacts, deepest):
    """Integrate to each of ``times`` and fill ``rows``; ``state`` and ``impacts`` go on.

    Returns the number of rows filled, how it ended, and the number of steps tried.
    """
    f0, f1, seen, seen1 = np.zeros(5), np.zeros(5), np.zeros(10), np.zeros(10)
    k, k1, new, trial = np.zeros((5, 6)), np.zeros((5, 6)), np.zeros(8), np.zeros(8)
    scratch = (np.zeros((8, 8)), np.zeros(8), np.zeros(5), np.zeros(10))
    y = state[:8]
    piece = (state[CONTACT] > 0, int(state[BRANCH]), state[APPROACH])
    t, h, steps, done, idle = state[TIME], state[STEP], 0, 0, 0
    known = False  # f0, seen and k belong to y
    while done < len(times):
        if int(state[IMPACTS]) == len(impacts):
            return done, FULL, steps
        if not known:
            motion(y, piece, p, law, True, f0, seen, k)
            known = True
        if t >= times[done]:
            _record(rows[done], t, y, f0, seen, piece[0], p, law)
            done += 1
            continue
        landing = t + h * 1.000001 >= times[done]
        length = times[done] - t if landing else h
        _step(y, length, piece, p, law, f0, k, scratch, new)
        steps += 1
        error = _error(scratch[0], state, piece[0], seen[DEPTH], tolerance, p, law[1])
        if not error <= 1.0:
            h = length * (max(0.2, 0.9 / fifth_root(error)) if error < inf else 0.1)
            if h > 1e-15 * t:
                continue
            return done, FAILED, steps
        motion(new, piece, p, law, True, f1, seen1, k1)
        grown = length * min(5.0, 0.9 / fifth_root(max(error, 1e-12)))
        h = max(h, grown) if landing else grown

        first, ahead = -1, length  # the first event in the step ends it
        for which in range(3):
            after = _event(which, piece, seen1, p)
            if first >= 0:
                after = _try(which, y, ahead, piece, p, law, f0, k, scratch, trial)
            if after >= 0:
                before = _event(which, piece, seen, p)
                ahead = _locate(
                    which, before, after, y, t, ahead, piece, p, law, f0, k, scratch, trial
                )
                first = which
        if first >= 0:
            landing = False
            _step(y, ahead, piece, p, law, f0, k, scratch, new)
            motion(new, piece, p, law, False, f1, seen1, k)
            idle = idle + 1 if ahead <= 1e-14 * t else 0
            if idle > 100:
                return done, FAILED, steps
        count = int(state[IMPACTS])
        if piece[0]:
            if seen1[DEPTH] > deepest:
                return done, TOO_DEEP, steps
            impact = impacts[count - 1]
            for which, column, quantity in ((3, 2, NORMAL), (4, 3, DEPTH)):  # peaks inside
                before, after = _event(which, piece, seen, p), _event(which, piece, seen1, p)
                if before < 0 <= after and seen[quantity] - before * ahead > impact[column]:
                    peak = _locate(
                        which, before, after, y, t, ahead, piece, p, law, f0, k, scratch, trial
                    )
                    _try(which, y, peak, piece, p, law, f0, k, scratch, trial)
                    impact[column] = max(impact[column], scratch[3][quantity])
            impact[2], impact[3] = max(impact[2], seen1[NORMAL]), max(impact[3], seen1[DEPTH])
        t = times[done] if landing else t + ahead
        y[:] = new
        known = first < 0
        state[TIME] = t
        if piece[0]:
            impact = impacts[count - 1]
            impact[4], impact[6] = t, y[6] + y[7] - impact[7]
            if first == 0:
                impact[5] = -y[4]
                _part(y, law)
                piece = (False, 0, piece[2])
            elif first > 0:
                piece = (True, piece[1] + (1 if first == 1 else -1), piece[2])
        elif first == 0 and seen1[RATE] > 0:  # else it grazes, and goes on in flight
            _touch(y, law)
            state[DEEP] = impact_depth(y, y[4], p, law)
            h = min(h, 0.1 * state[DEEP] / y[4])
            impacts[count] = t, y[4], 0.0, 0.0, t, 0.0, 0.0, y[6] + y[7]
            state[IMPACTS] = count + 1
            piece = (True, friction_branch(seen1[SLIDING], p[V0], p[V1]), y[4])
        if known:
            f0, f1, seen, seen1, k, k1 = f1, f0, seen1, seen, k1, k
        state[CONTACT], state[BRANCH], state[APPROACH] = piece[0], piece[1], piece[2]
        state[STEP] = h
    return done, FINE, steps


def blocks(scene, law, times, tolerance):
    """Yield blocks of output rows of the scene with its clearance joint.

    Parameters
    ----------
    scene : study.mechanism.scene.Scene
    law : ndarray
        From ``study.contact.forces.pack``.
    times : list of ndarray
        Outputs, in blocks.
    tolerance : float
        Of the local error, see `_error`.

    Returns
    -------
    iterator
        Of what `advance_in_blocks` yields.

    Raises
    ------
    MechanismError
        If the ball goes deeper than one clearance, or no step is small enough.
    """
    p = describe(scene)
    state = np.zeros(16)
    state[1:3] = scene.initial_eccentricity
    f = np.zeros(5)
    motion(state[:8], (False, 0, 1.0), p, law, False, f, np.zeros(10), np.zeros((5, 6)))
    horizon = times[-1][-1]
    reach = sqrt(norm(f[1], f[2]) * scene.clearance)
    state[REACH] = max(reach, scene.clearance / horizon)
    state[STEP] = min(1e-3 * scene.clearance / state[REACH], horizon)
    state[DEEP] = scene.clearance
    return advance_in_blocks(
        lambda *block: advance(state, p, law, tolerance, *block, scene.clearance),
        times,
        state,
        scene,
        lambda: (state[TIME], state[STEP]),
        lambda steps: f"no step is small enough for tolerance {tolerance:g}",
    )
