"""Rigid links with a clearance joint: equations of motion, and a stepper that locates impacts.

Three degrees of freedom: the crank's angle theta and the place of the ball's centre in the
socket, in flight as (e_x, e_y), in contact as (depth, direction). The depth is then a variable
of its own: nothing cancels, and the stiff direction is a coordinate, which lets steps grow.
Coupler and slider follow from the geometry, the coupler pointing to +x.

Between impacts and kinks of the friction law the equations are smooth. Such a piece is integrated
by Rodas5P with the analytic Jacobian; its end is located by repeating the last step with another
length until the event function vanishes.
"""

from collections.abc import Iterator
from functools import partial
from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from study.compiled import compiled
from study.contact.forces import NODES, WEIGHTS, elastic_force, joint_forces, stored_energy
from study.contact.friction import friction_branch
from study.mechanism import stepping
from study.mechanism.angles import angle_of, direction, fifth_root, norm, sine_cosine
from study.mechanism.rosenbrock import STAGES, begin_stage, end_stage, factorise
from study.mechanism.scene import Scene

# Places in the state, after (z, z', energies lost) and what all models have
BRANCH, DEEP, REACH = range(15, 18)
# ... in what `motion` finds, after the accelerations and the powers lost
DEPTH, RATE, SLIDING, NORMAL, TANGENTIAL, NORMAL_RATE, SINE, COSINE, PSI, SLIDER = range(5, 15)
SURFACES, UPWARDS, DOWNWARDS, FORCE_PEAK, DEPTH_PEAK = range(5)
"""Events: the surfaces meet or part, the sliding speed leaves the friction branch, peaks."""
ROUNDOFF = 1e-16
_UNIT = np.eye(6)


@compiled
def new_slopes():
    """Room for what `motion` fills."""
    return np.zeros(15), np.zeros((5, 6))


@compiled
def motion(y, piece, p, law, jacobian, f, k):
    """Fill ``f`` with accelerations z'', powers lost and what else is found, at y = (z, z', ...).

    ``piece`` is (in contact?, friction branch, approach speed). With ``jacobian`` the derivatives
    ``k`` are filled, a row for each of z'' and the powers, a column for each of (z, z').
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
    slider = -fx / p.m3
    ax = -l1 * (st * alpha + ct * omega * omega) - l2 * (sp * beta + cp * psi * psi) - slider
    ay = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi)
    growth = nx * ax + ny * ay + r * spin * spin
    f[0] = alpha
    if contact:
        f[1], f[2] = growth, (nx * ay - ny * ax - 2 * rate * spin) / r
    else:
        f[1], f[2] = ax, ay
    f[3], f[4] = (normal - elastic) * rate, -tangential * sliding
    f[DEPTH], f[RATE], f[SLIDING] = y[1] if contact else r - law[1], rate, sliding
    f[NORMAL], f[TANGENTIAL] = normal, tangential
    f[NORMAL_RATE] = normal_d * rate + normal_r * growth
    f[SINE], f[COSINE], f[PSI], f[SLIDER] = sp, cp, psi, slider + 0.0
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
        k[3, j] = (dnormal - elastic_d * dr) * rate + (normal - elastic) * drate
        k[4, j] = -dtangential * sliding - tangential * dsliding


@compiled
def _step(smooth, h, new):
    """One step of Rodas5P; fills ``new`` and leaves the error estimate in the scratch."""
    y, piece, p, law, (f0, k), (u, work, f) = smooth
    factors, rate = factorise(k, h), 1 / h
    for i in range(STAGES):
        begin_stage(i, y, rate, u, work, new)
        if i == 0:
            f[:] = f0
        else:
            motion(new, piece, p, law, False, f, k)
        end_stage(i, new, f, k, factors, u, work)
    for n in range(8):
        new[n] += u[STAGES - 1, n]


@compiled
def _error(u, state, depth, tolerance, p, clearance):
    """Largest local error over what ``tolerance`` allows.

    Places count by the clearance, the depth by the deepest that this impact's approach speed can
    bring, speeds by a tenth of what the drive gives over the clearance (found by measuring).
    """
    place = tolerance * clearance
    speed = 0.1 * tolerance * state[REACH] + ROUNDOFF * p.l1 * abs(state[3])
    contact = state[stepping.CONTACT] > 0
    deep = tolerance * max(state[DEEP], depth) if contact else place
    across = clearance if contact else 1.0
    return max(
        p.l1 * abs(u[7, 0]) / (place + ROUNDOFF * p.l1 * abs(state[0])),
        abs(u[7, 1]) / deep,
        abs(u[7, 2]) * across / place,
        p.l1 * abs(u[7, 3]) / speed,
        abs(u[7, 4]) / speed,
        abs(u[7, 5]) * across / speed,
    )


@compiled
def _event(which, piece, seen, p):
    """Event functions, negative before and positive after."""
    contact, branch, _ = piece
    if which == SURFACES:
        return -seen[DEPTH] if contact else seen[DEPTH]
    if not contact:
        return -1.0
    if which == FORCE_PEAK:
        return -seen[NORMAL_RATE]
    if which == DEPTH_PEAK:
        return -seen[RATE]
    bounds = (-inf, -p.v1, -p.v0, p.v0, p.v1, inf)
    if which == UPWARDS:
        return seen[SLIDING] - bounds[branch + 3]
    return bounds[branch + 2] - seen[SLIDING]


@compiled
def _try(which, smooth, h, new):
    """Step by ``h`` and tell an event function at its end; the scratch keeps what is seen."""
    _, piece, p, law, (_, k), (_, _, f) = smooth
    _step(smooth, h, new)
    motion(new, piece, p, law, False, f, k)
    return _event(which, piece, f, p)


@compiled
def _locate(which, before, after, smooth, t, h, new):
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
        value = _try(which, smooth, middle, new)
        if value < 0:
            after = after / 2 if side < 0 else after
            low, before, side = middle, value, -1
        else:
            before = before / 2 if side > 0 else before
            high, after, side = middle, value, 1
            if value == 0:
                break
    return high


@compiled
def _first_event(smooth, seen, t, h, new):
    """Which event ends a step of ``h`` with ``seen`` at its end, -1 for none, and when it does."""
    _, piece, p, _, here, _ = smooth
    first = -1
    for which in (SURFACES, UPWARDS, DOWNWARDS):
        after = _try(which, smooth, h, new) if first >= 0 else _event(which, piece, seen, p)
        if after >= 0:
            h = _locate(which, _event(which, piece, here[0], p), after, smooth, t, h, new)
            first = which
    return first, h


@compiled
def _measure_peaks(impact, row, smooth, seen, t, h, new):
    """Locate peaks of force and depth inside a step of ``h`` with ``seen`` at its end.

    ``row`` is that of output at the peak of the force.
    """
    _, piece, p, law, (start, _), (_, _, f) = smooth
    peaks = (FORCE_PEAK, stepping.PEAK_FORCE, NORMAL), (DEPTH_PEAK, stepping.PEAK_DEPTH, DEPTH)
    for which, column, quantity in peaks:
        before, after = _event(which, piece, start, p), _event(which, piece, seen, p)
        if before < 0 <= after and start[quantity] - before * h > impact[column]:
            length = _locate(which, before, after, smooth, t, h, new)
            _try(which, smooth, length, new)
            if f[quantity] > impact[column]:
                impact[column] = f[quantity]
                if which == FORCE_PEAK:
                    row[0] = t + length
                    _record(row, new, True, f, p, law)


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
    links = (p.a22 * d1 * d1 - 2 * coupling * d1 * d2 + p.a11 * d2 * d2) / determinant
    return links + dx * dx / p.m3


@compiled
def impact_depth(y, rate, p, law):
    """Depth at which the contact has stored the energy of an approach speed, in m."""
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
def free_durations(starts, speeds, p, law):
    """Durations of free elastic impacts with approach ``speeds`` at rows of output, in s."""
    y, durations = np.zeros(3), np.zeros(len(speeds))
    for i, (row, speed) in enumerate(zip(starts, speeds)):  # noqa: B905 (compiled code)
        y[0], y[2] = row[1], direction(row[10], row[9])
        deep = impact_depth(y, speed, p, law)
        energy = stored_energy(law, deep)
        for node, weight in zip(NODES, WEIGHTS):  # noqa: B905 (compiled code)
            left = 1 - stored_energy(law, deep * (1 - node * node)) / energy
            durations[i] += weight * 4 * node * deep / (speed * sqrt(left))
    return durations


@compiled
def _record(row, y, contact, f, p, law):
    """Fill a row of output from (z, z', energies lost) and what `motion` found there."""
    st, ct = sine_cosine(y[0])
    sp, cp, psi = f[SINE], f[COSINE], f[PSI]
    ex, ey, wx, nx, ny = y[1], y[2], y[4], 0.0, 0.0
    if contact:
        ny, nx = sine_cosine(y[2])
        r = law[1] + y[1]
        ex, ey, wx = r * nx, r * ny, y[4] * nx - y[5] * r * ny
    crank = y[0], y[3], f[0], p.moment
    speed = -p.l1 * st * y[3] - p.l2 * sp * psi - wx
    slider = p.l1 * ct + p.l2 * cp - ex, speed, f[SLIDER]
    normal, tangential = f[NORMAL], f[TANGENTIAL]
    forces = normal, tangential, normal * nx + tangential * ny, normal * ny - tangential * nx
    kinetic = 0.5 * (p.a11 * y[3] * y[3] + p.a22 * psi * psi + p.m3 * speed * speed)
    kinetic += p.a12 * (ct * cp + st * sp) * y[3] * psi
    energies = p.moment * y[0] - p.g1 * st - p.g2 * sp, kinetic, 0.0, y[6], y[7]
    coupler, place = (angle_of(sp, cp), psi), (ex, ey, f[DEPTH])
    stepping.record(row, crank, slider, coupler, place, forces, energies)


@compiled
def advance(state, p, law, tolerance, rows, impacts, events):
    """Step to the time of each row and fill it; return the number of rows filled and the ending."""
    y, t, h = state[:8], state[stepping.TIME], state[stepping.STEP]
    piece = state[stepping.CONTACT] > 0, int(state[BRANCH]), state[stepping.APPROACH]
    here, there = new_slopes(), new_slopes()
    new, trial = np.zeros(8), np.zeros(8)
    scratch = np.zeros((STAGES, 8)), np.zeros(8), np.zeros(15)
    known, idle, done = False, 0, 0
    while done < len(rows):
        if int(state[stepping.IMPACTS]) == len(impacts):
            return done, stepping.FULL
        if not known:
            motion(y, piece, p, law, True, here[0], here[1])
            known = True
        if t >= rows[done, 0]:
            _record(rows[done], y, piece[0], here[0], p, law)
            done += 1
            continue
        smooth = y, piece, p, law, here, scratch
        landing = t + h * 1.000001 >= rows[done, 0]
        length = rows[done, 0] - t if landing else h
        _step(smooth, length, new)
        state[stepping.STEPS] += 1
        error = _error(scratch[0], state, here[0][DEPTH], tolerance, p, law[1])
        if not error <= 1.0:
            h = length * (max(0.2, 0.9 / fifth_root(error)) if error < inf else 0.1)
            if h > 1e-15 * t:
                continue
            return done, stepping.FAILED
        motion(new, piece, p, law, True, there[0], there[1])
        grown = length * min(5.0, 0.9 / fifth_root(max(error, 1e-12)))
        h = max(h, grown) if landing else grown
        event, length = _first_event(smooth, there[0], t, length, trial)
        if event >= 0:
            landing, known = False, False
            _step(smooth, length, new)
            motion(new, piece, p, law, False, there[0], there[1])
            idle = idle + 1 if length <= 1e-14 * t else 0
            if idle > 100:
                return done, stepping.FAILED
        seen = there[0]
        if piece[0]:
            if seen[DEPTH] > p.clearance:
                return done, stepping.TOO_DEEP
            last = int(state[stepping.IMPACTS]) - 1
            peak = events[last, stepping.PEAK]
            _measure_peaks(impacts[last], peak, smooth, seen, t, length, trial)
        t = state[stepping.TIME] = rows[done, 0] if landing else t + length
        y[:] = new
        if piece[0] and stepping.follow_impact(impacts, state, seen[NORMAL], seen[DEPTH]):
            row = stepping.event_row(events, state, stepping.PEAK)
            _record(row, y, True, seen, p, law)
        if event >= 0:
            piece, h = _turn(event, piece, seen, state, h, p, law, impacts, events)
        here, there = there, here
        state[BRANCH], state[stepping.STEP] = piece[1], h
    return done, stepping.FINE


@compiled
def _turn(event, piece, seen, state, h, p, law, impacts, events):
    """The smooth piece that follows an event, in its coordinates, and the step to begin it."""
    y, t = state[:8], state[stepping.TIME]
    contact, branch, approach = piece
    if event != SURFACES:
        return (contact, branch + (1 if event == UPWARDS else -1), approach), h
    if contact:
        stepping.end_impact(impacts, state, -y[4])
        _record(stepping.event_row(events, state, stepping.END), y, True, seen, p, law)
        ny, nx = sine_cosine(y[2])
        rate, across = y[4], law[1] * y[5]
        y[1:3] = law[1] * nx, law[1] * ny
        y[4:6] = rate * nx - across * ny, rate * ny + across * nx
        return (False, 0, approach), h
    if seen[RATE] > 0:  # else it grazes, and goes on in flight
        r = norm(y[1], y[2])
        nx, ny, wx, wy = y[1] / r, y[2] / r, y[4], y[5]
        y[1:3] = 0.0, angle_of(ny, nx)
        y[4:6] = nx * wx + ny * wy, (nx * wy - ny * wx) / law[1]
        stepping.begin_impact(impacts, state, t, y[4])
        _record(stepping.event_row(events, state, stepping.START), y, True, seen, p, law)
        state[DEEP] = impact_depth(y, y[4], p, law)
        branch = friction_branch(seen[SLIDING], p.v0, p.v1)
        return (True, branch, y[4]), min(h, 0.1 * state[DEEP] / y[4])
    return piece, h


def start(scene: Scene, law: NDArray[np.float64], horizon: float) -> NDArray[np.float64]:
    """State of `advance` at rest at t = 0, with the law packed; ``horizon`` in s."""
    state, (f, k) = np.zeros(stepping.STATE), new_slopes()
    state[1:3] = scene.initial_eccentricity
    motion(state[:8], (False, 0, 1.0), scene.constants(), law, False, f, k)
    reach = sqrt(norm(f[1], f[2]) * scene.clearance)
    state[REACH] = max(reach, scene.clearance / horizon)
    state[stepping.STEP] = min(1e-3 * scene.clearance / state[REACH], horizon)
    state[DEEP] = scene.clearance
    return state


def blocks(
    scene: Scene, law: NDArray[np.float64], times: list[NDArray[np.float64]], tolerance: float
) -> Iterator[stepping.Block]:
    """Blocks of output rows at ``times`` of the scene with its clearance joint and a packed law."""
    state = start(scene, law, times[-1][-1])
    loop = partial(advance, state, scene.constants(), law, tolerance)
    failure = f"no step is small enough for tolerance {tolerance:g}"
    return stepping.advance_in_blocks(loop, times, state, scene, failure)
