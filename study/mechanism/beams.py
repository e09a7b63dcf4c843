"""Finite elements, the paper's comparison: geometrically exact beams, stepped implicitly.

Two-node elements of Reissner's plane beam with one integration point, places and rotations
interpolated linearly in the fixed frame: the consistent mass is constant and rigid motion is
free of strain. The shear compliance holds the residual bending flexibility (MacNeal 1978),
with which a straight element's nodal stiffness is exact. Time is stepped by the
generalised-alpha method (Chung & Hulbert 1993) with Newton's method on a banded matrix. Only
the scene and the contact law are shared with `particles`.
"""

from math import inf

import numpy as np

from study.compiled import compiled
from study.contact.forces import joint_forces, stored_energy
from study.contact.friction import friction_branch
from study.mechanism.angles import arcsine, direction, norm, sine_cosine
from study.mechanism.response import (
    CONTACT,
    FAILED,
    FINE,
    FULL,
    IMPACTS,
    TOO_DEEP,
    advance_in_blocks,
    divide,
)

SPECTRAL_RADIUS = 0.8
"""At infinite frequency: what the steps leave of the motions that they cannot follow."""
NEWTON_TOLERANCE = 1e-9
"""Change of a Newton iteration, relative to the clearance, at which it stops."""
BAND = 6  # unknowns of neighbouring nodes are at most this far apart

# Places in the array of numbers that describes the scene
M3, R1, DAMPING, FRICTION, V0, V1, GRAVITY = range(7)
# ... in the state of the stepper
APPROACH, STEPS, LOST_DAMPING, LOST_FRICTION = range(4)
ANY = 3  # friction branch: that of the sliding speed found
# ... in what `_contact` finds
DEPTH, NORMAL, TANGENTIAL, ELASTIC, RATE, SLIDING, FORCE_X, FORCE_Y, EX, EY = range(10)


class Mesh:
    """Elements of both links on +x, and the numbering of their unknowns along the chain.

    Parameters
    ----------
    scene : study.mechanism.scene.Scene
    elements : tuple of int
        Number of elements of crank and coupler.
    ideal : bool
        Whether the ball is fixed to the slider, else the slider has an unknown of its own.

    Attributes
    ----------
    sections : ndarray, shape (n, 6)
        Length; axial, shear and bending stiffness; mass and rotary inertia per length.
    unknowns : ndarray of int, shape (n, 6)
        Numbers of (x, y, rotation) at both ends of each element; -1 where held.
    ball : ndarray of int, shape (4,)
        Numbers of the ball's x, y and rotation, and of the slider's x.
    initial : ndarray
        Places and rotations at t = 0.
    """

    def __init__(self, scene, elements, ideal):
        sections, unknowns, initial = [], [], []

        def number(value):
            initial.append(value)
            return len(initial) - 1

        near = [-1, -1, number(0.0)]
        x = y = angle = 0.0
        for body, n in zip(("crank", "coupler"), elements, strict=True):
            link = scene.link(body)
            length = link.length / n
            shear = 1 / (1 / link.shear + length**2 / (12 * link.bending))
            section = length, link.axial, shear, link.bending
            section += link.mass_per_length, link.rotary_per_length
            if body == "coupler":  # at the pin: the same place, a rotation of its own
                angle = 0.0 if ideal else arcsine(scene.initial_eccentricity[1] / link.length)
                near = [*near[:2], number(angle)]
            sine, cosine = sine_cosine(angle)
            for e in range(n):
                x, y = x + length * cosine, y + length * sine
                held = ideal and body == "coupler" and e == n - 1
                far = [number(x), -1 if held else number(y), number(angle)]
                sections.append(section)
                unknowns.append(near + far)
                near = far
        slider = near[0] if ideal else number(x - scene.initial_eccentricity[0])
        self.sections, self.unknowns = np.array(sections), np.array(unknowns)
        self.ball, self.initial = np.array([*near, slider]), np.array(initial)

    def mass(self, slider_mass):
        """Consistent mass as a band, shape (unknowns, 2 BAND + 1): column BAND is the diagonal."""
        band = np.zeros((len(self.initial), 2 * BAND + 1))
        for (length, _, _, _, mass, rotary), at in zip(self.sections, self.unknowns, strict=True):
            for i in range(6):
                for j in range(6):
                    if i % 3 == j % 3 and at[i] >= 0 and at[j] >= 0:
                        density = rotary if i % 3 == 2 else mass
                        share = (2 if i == j else 1) * density * length / 6
                        band[at[i], BAND + at[j] - at[i]] += share
        band[self.ball[3], BAND] += slider_mass
        return band


@compiled
def _internal(q, sections, unknowns, force, matrix, factor):
    """Add the beams' forces to ``force`` and ``factor`` times their tangent to ``matrix``.

    Returns the strain energy.
    """
    energy = 0.0
    b, d = np.zeros((3, 6)), np.zeros(6)
    for e in range(len(sections)):
        length, axial, shear, bending = sections[e, :4]
        at = unknowns[e]
        for i in range(6):
            d[i] = q[at[i]] if at[i] >= 0 else 0.0
        dx, dy = (d[3] - d[0]) / length, (d[4] - d[1]) / length
        turn = 0.5 * (d[2] + d[5])
        s, c = sine_cosine(turn)
        along, across = c * dx + s * dy, c * dy - s * dx
        stretch, slide, bend = along - 1, across, (d[5] - d[2]) / length
        n, v, m = axial * stretch, shear * slide, bending * bend
        energy += 0.5 * length * (n * stretch + v * slide + m * bend)
        b[0] = -c / length, -s / length, 0.5 * across, c / length, s / length, 0.5 * across
        b[1] = s / length, -c / length, -0.5 * along, -s / length, c / length, -0.5 * along
        b[2] = 0.0, 0.0, -1 / length, 0.0, 0.0, 1 / length
        for i in range(6):
            if at[i] < 0:
                continue
            force[at[i]] += length * (n * b[0, i] + v * b[1, i] + m * b[2, i])
            if factor == 0:
                continue
            for j in range(6):
                if at[j] < 0:
                    continue
                value = axial * b[0, i] * b[0, j] + shear * b[1, i] * b[1, j]
                value += bending * b[2, i] * b[2, j]
                # second derivatives of the strains: places with rotations, and rotations
                if i % 3 == 2 and j % 3 == 2:
                    value -= 0.25 * (n * along + v * across)
                elif i % 3 == 2:
                    value += 0.5 * (n * b[1, j] - v * b[0, j])
                elif j % 3 == 2:
                    value += 0.5 * (n * b[1, i] - v * b[0, i])
                matrix[at[i], BAND + at[j] - at[i]] += factor * length * value
    return energy


@compiled
def _sliding(q, v, ball, p):
    """Sliding speed of the ball's surface on the socket's."""
    ex, ey = q[ball[0]] - q[ball[3]], q[ball[1]]
    across = (v[ball[1]] * ex - (v[ball[0]] - v[ball[3]]) * ey) / norm(ex, ey)
    return across + p[R1] * v[ball[2]]


@compiled
def _contact(q, v, ball, contact, approach, branch, p, law, found):
    """Contact forces on the slider and their derivatives to (x, y, spin; rates) of the joint.

    Returns two 3x3 blocks: of force x, force y on the ball and moment on the coupler, to the
    eccentricity and rotation, and to their rates.
    """
    stiff, damp = np.zeros((3, 3)), np.zeros((3, 3))
    ex, ey = q[ball[0]] - q[ball[3]], q[ball[1]]
    wx, wy, spin = v[ball[0]] - v[ball[3]], v[ball[1]], v[ball[2]]
    r = norm(ex, ey)
    found[:] = 0.0
    found[DEPTH], found[EX], found[EY] = r - law[1], ex, ey
    nx, ny = (ex / r, ey / r) if r > 0 else (1.0, 0.0)
    tx, ty = -ny, nx
    rate, across = wx * nx + wy * ny, wx * tx + wy * ty
    sliding = across + p[R1] * spin
    found[RATE], found[SLIDING] = rate, sliding
    if not contact or found[DEPTH] <= 0:
        return stiff, damp
    if branch == ANY:
        branch = friction_branch(sliding, p[V0], p[V1])
    normal, normal_d, normal_r, elastic, _, tangential, tangential_n, tangential_s = joint_forces(
        law, r - law[1], rate, sliding, branch, approach, p[DAMPING], p[FRICTION], p[V0], p[V1]
    )
    found[NORMAL], found[TANGENTIAL], found[ELASTIC] = normal, tangential, elastic
    found[FORCE_X] = normal * nx - tangential * tx
    found[FORCE_Y] = normal * ny - tangential * ty
    for j in range(2):  # eccentricity x, y
        n_j, t_j = (nx, tx) if j == 0 else (ny, ty)
        bend = t_j / r  # dn = bend t, dt = -bend n
        dnormal = normal_d * n_j + normal_r * across * bend
        dtangential = tangential_n * dnormal - tangential_s * rate * bend
        dn, dt = -dnormal - tangential * bend, dtangential - normal * bend
        stiff[0, j], stiff[1, j] = dn * nx + dt * tx, dn * ny + dt * ty
        stiff[2, j] = p[R1] * dtangential
        dnormal = normal_r * n_j
        dtangential = tangential_n * dnormal + tangential_s * t_j
        damp[0, j] = -dnormal * nx + dtangential * tx
        damp[1, j] = -dnormal * ny + dtangential * ty
        damp[2, j] = p[R1] * dtangential
    dtangential = tangential_s * p[R1]
    damp[0, 2], damp[1, 2], damp[2, 2] = dtangential * tx, dtangential * ty, p[R1] * dtangential
    return stiff, damp


@compiled
def _solve(matrix, right):
    """Solve a banded system in place by elimination along the chain, without pivoting."""
    size = len(right)
    for i in range(size):
        pivot = matrix[i, BAND]
        for k in range(1, min(BAND, size - 1 - i) + 1):
            ratio = matrix[i + k, BAND - k] / pivot
            if ratio != 0:
                for j in range(1, min(BAND, size - 1 - i) + 1):
                    matrix[i + k, BAND - k + j] -= ratio * matrix[i, BAND + j]
                right[i + k] -= ratio * right[i]
    for i in range(size - 1, -1, -1):
        for j in range(1, min(BAND, size - 1 - i) + 1):
            right[i] -= matrix[i, BAND + j] * right[i + j]
        right[i] /= matrix[i, BAND]


@compiled
def _forces(q, v, load, mesh, contact, approach, branch, p, law, found, force, matrix, by_q, by_v):
    """Forces that resist (internal, contact, load), tangent times ``by_q``, and strain energy."""
    sections, unknowns, ball, ideal, _ = mesh
    force[:] = -load
    energy = _internal(q, sections, unknowns, force, matrix, by_q)
    if not ideal:
        stiff, damp = _contact(q, v, ball, contact, approach, branch, p, law, found)
        if found[NORMAL] != 0 or found[ELASTIC] != 0:
            force[ball[0]] += found[FORCE_X]
            force[ball[1]] += found[FORCE_Y]
            force[ball[2]] -= p[R1] * found[TANGENTIAL]
            force[ball[3]] -= found[FORCE_X]
            if by_q != 0:
                for i in range(4):
                    for j in range(4):
                        row, column = (0 if i == 3 else i), (0 if j == 3 else j)
                        sign = (-1.0 if i == 3 else 1.0) * (-1.0 if j == 3 else 1.0)
                        value = by_q * stiff[row, column] + by_v * damp[row, column]
                        matrix[ball[i], BAND + ball[j] - ball[i]] -= sign * value
    return energy


@compiled
def _reaction(q, a, mesh, gravity):
    """Force along y that holds the ball of an ideal joint on the slide."""
    sections, unknowns = mesh[0][-1:], mesh[1][-1:].copy()
    at, free = unknowns[0], np.zeros(6)
    local = np.zeros(6)
    for i in range(6):
        local[i] = q[at[i]] if at[i] >= 0 else 0.0
    whole = np.arange(6).reshape(1, 6)
    _internal(local, sections, whole, free, np.zeros((6, 2 * BAND + 1)), 0.0)
    half = sections[0, 4] * sections[0, 0] / 2
    return free[4] + half * (a[at[1]] / 3 + gravity)


@compiled
def _meet(gap0, rate0, gap1, rate1, h):
    """Instant in a step at which a cubic gap function vanishes, and its rate there."""
    low, high = 0.0, 1.0
    for _ in range(60):
        s = 0.5 * (low + high)
        gap = (1 + 2 * s) * (1 - s) ** 2 * gap0 + s * (1 - s) ** 2 * h * rate0
        gap += s * s * (3 - 2 * s) * gap1 + s * s * (s - 1) * h * rate1
        if gap < 0:
            low = s
        else:
            high = s
    slope = 6 * s * (1 - s) * (gap1 - gap0) / h
    slope += (1 - s) * (1 - 3 * s) * rate0 + s * (3 * s - 2) * rate1
    return s * h, slope if slope > 0 else (gap1 - gap0) / h


@compiled
def advance(state, motion, mesh, mass, load, p, law, h, strides, rows, impacts, deepest):
    """Step to each output, ``strides`` steps apart, and fill ``rows``; all else goes on.

    ``motion`` has the rows places, rates, the method's own accelerations, and those one step
    before. Returns the number of rows filled, how it ended, and 0.
    """
    size, ideal = motion.shape[1], mesh[3]
    q, v, a, before = motion[0], motion[1], motion[2], motion[3]
    alpha_m = (2 * SPECTRAL_RADIUS - 1) / (SPECTRAL_RADIUS + 1)
    alpha_f = SPECTRAL_RADIUS / (SPECTRAL_RADIUS + 1)
    gamma = 0.5 - alpha_m + alpha_f
    beta = 0.25 * (1 - alpha_m + alpha_f) ** 2
    by_a = (1 - alpha_m) / (beta * h * h)
    by_q, by_v = 1 - alpha_f, (1 - alpha_f) * gamma / (beta * h)
    force, old, right = np.zeros(size), np.zeros(size), np.zeros(size)
    matrix = np.zeros_like(mass)
    found, now = np.zeros(10), np.zeros(10)
    q1, v1, a1 = np.zeros(size), np.zeros(size), np.zeros(size)
    contact, approach = state[CONTACT] > 0, state[APPROACH]
    strain = _forces(q, v, load, mesh, contact, approach, ANY, p, law, now, old, matrix, 0.0, 0.0)
    done, rounding = 0, 1e-13 * abs(q[mesh[2][3]])
    while True:
        if int(state[IMPACTS]) == len(impacts):
            return done, FULL, 0.0
        steps = int(state[STEPS])
        if steps % strides == 0:
            _record(rows[done], steps * h, motion, mesh, mass, load, now, strain, state, p, law)
            done += 1
        lasting = False
        while True:  # a second time if the surfaces meet in this step
            for i in range(size):
                a1[i] = a[i]
                v1[i] = v[i] + h * a[i]
                q1[i] = q[i] + h * v[i] + 0.5 * h * h * a[i]
            settled = False
            # Newton's method on one linear piece of the friction law, which then moves by one:
            # free to jump, it would go to and fro between the law's ends
            branch = 0 if ideal else friction_branch(now[SLIDING], p[V0], p[V1])
            for _ in range(60):
                matrix[:] = by_a * mass
                strain = _forces(
                    q1,
                    v1,
                    load,
                    mesh,
                    contact,
                    approach,
                    branch,
                    p,
                    law,
                    found,
                    force,
                    matrix,
                    by_q,
                    by_v,
                )
                for i in range(size):
                    right[i] = -(1 - alpha_f) * force[i] - alpha_f * old[i]
                    for j in range(max(0, i - BAND), min(size, i + BAND + 1)):
                        share = (1 - alpha_m) * a1[j] + alpha_m * a[j]
                        right[i] -= mass[i, BAND + j - i] * share
                _solve(matrix, right)
                change = 0.0
                for i in range(size):
                    change = max(change, abs(right[i]))
                    q1[i] += right[i]
                    v1[i] += gamma / (beta * h) * right[i]
                    a1[i] += right[i] / (beta * h * h)
                if not change < inf:
                    break
                away = 0
                if contact:
                    speed = _sliding(q1, v1, mesh[2], p)
                    away = friction_branch(speed, p[V0], p[V1]) - branch
                if change <= NEWTON_TOLERANCE * law[1] + rounding and abs(away) <= 1:
                    settled = True
                    break
                branch += min(max(away, -1), 1)
            if not settled:
                return done, FAILED, 0.0
            strain = _forces(
                q1, v1, load, mesh, contact, approach, ANY, p, law, found, force, matrix, 0.0, 0.0
            )
            if ideal or contact or lasting or found[DEPTH] <= 0:
                break
            count = int(state[IMPACTS])
            after, approach = _meet(now[DEPTH], now[RATE], found[DEPTH], found[RATE], h)
            contact, lasting = True, True
            lost = state[LOST_DAMPING] + state[LOST_FRICTION]
            impacts[count] = steps * h + after, approach, 0.0, 0.0, 0.0, 0.0, 0.0, lost
            state[IMPACTS] = count + 1
        state[STEPS] = steps + 1
        if contact:
            if found[DEPTH] > deepest:
                return done, TOO_DEEP, 0.0
            for which in (now, found):
                damping = (which[NORMAL] - which[ELASTIC]) * which[RATE]
                state[LOST_DAMPING] += 0.5 * h * damping
                state[LOST_FRICTION] -= 0.5 * h * which[TANGENTIAL] * which[SLIDING]
            impact = impacts[int(state[IMPACTS]) - 1]
            impact[2] = max(impact[2], found[NORMAL])
            impact[3] = max(impact[3], found[DEPTH])
            lost = state[LOST_DAMPING] + state[LOST_FRICTION]
            impact[4], impact[6] = (steps + 1) * h, lost - impact[7]
            if found[DEPTH] <= 0:
                impact[5] = -found[RATE]
                contact = False
        state[CONTACT], state[APPROACH] = contact, approach
        before[:], q[:], v[:], a[:] = a, q1, v1, a1
        old[:], now[:] = force, found
        if done == len(rows):
            return done, FINE, 0.0


@compiled
def _record(row, t, motion, mesh, mass, load, now, strain, state, p, law):
    """Fill a row of output with what there is at time ``t``."""
    q, v = motion[0], motion[1]
    ball, ideal, pin = mesh[2], mesh[3], mesh[4]
    # the method's accelerations belong to a time (alpha_f - alpha_m) h before
    late = (1 - SPECTRAL_RADIUS) / (SPECTRAL_RADIUS + 1)
    a = motion[2] + late * (motion[2] - motion[3])
    kinetic, work, size = 0.0, 0.0, len(q)
    for i in range(size):
        work += load[i] * q[i]
        for j in range(max(0, i - BAND), min(size, i + BAND + 1)):
            kinetic += 0.5 * v[i] * mass[i, BAND + j - i] * v[j]
    fx, fy = now[FORCE_X], now[FORCE_Y]
    if ideal:
        fx, fy = p[M3] * a[ball[0]], -_reaction(q, a, mesh, p[GRAVITY])
    y = 0.0 if ideal else q[ball[1]]
    row[0], row[1], row[2] = t, q[0], q[ball[3]]
    row[3], row[4], row[5], row[6] = v[0], v[ball[3]], a[0], fx / p[M3]
    row[7] = direction(y - q[pin + 1], q[ball[0]] - q[pin])
    row[8] = v[ball[2]]
    row[12] = norm(fx, fy)
    if not ideal:
        row[9], row[10], row[11] = now[EX], now[EY], now[DEPTH]
        row[12], row[13] = now[NORMAL], now[TANGENTIAL]
    row[14], row[15], row[16], row[17] = fx, fy, work, kinetic
    row[18] = strain + stored_energy(law, row[11])
    row[19], row[20] = state[LOST_DAMPING], state[LOST_FRICTION]


def _start(mesh, arrays, mass, load):
    """Places and accelerations at t = 0, in the rows of ``advance``'s ``motion``.

    Rotations without inertia follow the load at once: they balance it before anything moves.
    """
    size = len(load)
    motion = np.zeros((4, size))
    motion[0] = mesh.initial
    force, stiffness = -load, np.zeros_like(mass)
    _internal(motion[0], arrays[0], arrays[1], force, stiffness, 1.0)
    light = mass[:, BAND] == 0
    if light.any():
        motion[0] -= _solve_for(light, stiffness, force)
        force = -load
        _internal(motion[0], arrays[0], arrays[1], force, stiffness, 0.0)
    motion[2] = _solve_for(~light, mass, -force)
    motion[3] = motion[2]
    return motion


def _solve_for(some, matrix, right):
    """Solve a banded system for some unknowns, the others zero."""
    matrix, right = matrix.copy(), np.where(some, right, 0.0)
    size = len(right)
    for i in range(size):
        for j in range(max(0, i - BAND), min(size, i + BAND + 1)):
            if not (some[i] and some[j]):
                matrix[i, BAND + j - i] = float(i == j)
    _solve(matrix, right)
    return right


def blocks(scene, law, times, ideal, step, elements):
    """Yield blocks of output rows of the scene with flexible links made of beam elements.

    Parameters
    ----------
    scene, law, times, ideal, elements
        As for ``study.mechanism.particles.blocks``.
    step : float
        Largest step, in s, shortened to divide the outputs' distance.

    Returns
    -------
    iterator
        Of what `advance_in_blocks` yields.

    Raises
    ------
    MechanismError
        If Newton's method finds no balance, or the ball goes deeper than one clearance.
    """
    mesh = Mesh(scene, elements, ideal)
    strides, h = divide(times, step)
    p = np.array(
        [
            scene.slider_mass,
            scene.ball_radius,
            scene.damping_factor,
            scene.friction,
            scene.slow_speed,
            scene.full_speed,
            scene.gravity,
        ]
    )
    load = np.zeros(len(mesh.initial))
    load[0] = scene.driving_moment
    for section, at in zip(mesh.sections, mesh.unknowns, strict=True):
        for y in (at[1], at[4]):
            if y >= 0:
                load[y] -= scene.gravity * section[0] * section[4] / 2
    pin = mesh.unknowns[elements[0] - 1, 3]
    arrays = (mesh.sections, mesh.unknowns, mesh.ball, ideal, pin)
    mass = mesh.mass(scene.slider_mass)
    motion = _start(mesh, arrays, mass, load)
    state = np.zeros(6)
    return advance_in_blocks(
        lambda _, *block: advance(
            state, motion, arrays, mass, load, p, law, h, strides, *block, scene.clearance
        ),
        times,
        state,
        scene,
        lambda: (state[STEPS] * h, h),
        lambda _: "Newton's method found no balance",
    )
