"""Finite elements, the paper's comparison: geometrically exact beams, stepped implicitly.

Elements are Reissner's plane beam with two nodes and one integration point. Places and rotations
are interpolated linearly in the fixed frame, so that the consistent mass is constant and rigid
motion is free of strain. The shear compliance includes the residual bending flexibility (MacNeal
1978), with which the nodal stiffness of a straight element is exact. Time is stepped by the
generalised-alpha method (Chung & Hulbert 1993), with Newton's method on a banded matrix.
"""

from collections import namedtuple
from collections.abc import Iterator
from functools import partial
from math import inf
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from study.compiled import compiled
from study.contact.forces import joint_forces
from study.contact.friction import friction_branch
from study.mechanism import stepping
from study.mechanism.angles import direction, norm, sine_cosine
from study.mechanism.frame import straight_links
from study.mechanism.scene import Body, Scene

SPECTRAL_RADIUS = 0.8
"""At infinite frequency: the share that a step leaves of motions that it cannot follow."""
ALPHA_M = (2 * SPECTRAL_RADIUS - 1) / (SPECTRAL_RADIUS + 1)
ALPHA_F = SPECTRAL_RADIUS / (SPECTRAL_RADIUS + 1)
NEWTON_TOLERANCE = 1e-9
"""Change at which Newton's method stops, relative to the clearance."""
BAND = 6  # unknowns of neighbouring nodes are at most this far apart
NO_TANGENT = (0.0, 0.0)
ANY = np.int64(3)  # friction branch: that of the sliding speed; from NumPy, as in `locating`
# Places in a joint's state, which `_contact` fills
DEPTH, NORMAL, TANGENTIAL, ELASTIC, RATE, SLIDING, FORCE_X, FORCE_Y, EX, EY = range(10)
DRIVE_WORK, DRIVE_MOMENT = range(2)  # places in the state, before those of all models
CRANK = 2  # number of the rotation at the crank's fixed end
System = namedtuple("System", "sections unknowns ball pin held mass load initial rates ideal")
"""Elements of both links on +x, their unknowns numbered along the chain, mass and load.

A row of ``sections`` has length, axial, shear and bending stiffness, mass and rotary inertia per
length; one of ``unknowns`` the numbers of (x, y, rotation) at both ends. ``ball`` has the numbers
of its x, y and rotation and of the slider's x, ``pin`` that of its x, ``held`` those of unknowns
whose rate is given. In the consistent ``mass``, a band, column BAND is the diagonal. ``initial``
and ``rates`` are the places and rotations at t = 0, and their rates.
"""


def assemble(scene: Scene, elements: tuple[int, int], ideal: bool) -> System:
    """System with numbers of elements of crank and coupler; an ideal joint fixes ball to slider."""
    places, rates, turns, spins, slide = straight_links(scene, elements, ideal)
    pin, nodes = elements[0], np.arange(len(places))
    x = 3 * nodes + (nodes > pin)  # x, y and rotation of each node, and a second one of the pin
    rotations = np.insert(x + 2, pin + 1, x[pin] + 3)
    near = x[:-1], x[:-1] + 1, np.delete(rotations, [pin, -1])
    far = x[1:], x[1:] + 1, np.delete(rotations, [0, pin + 1])
    ball = x[-1] + np.array([0, 1, 2, 0 if ideal else 3])
    initial, speeds = np.zeros(max(ball) + 1), np.zeros(max(ball) + 1)
    for values, of_nodes, angles in ((initial, places, turns), (speeds, rates, spins)):
        values[x], values[x + 1], values[rotations] = *of_nodes.T, angles
    initial[ball[3]], speeds[ball[3]] = slide
    held = [0, 1, ball[1]] if ideal else [0, 1]
    initial[held] = speeds[held] = 0.0
    if scene.crank_speed is not None:
        held.append(CRANK)
    sections = []
    for body, n in zip(get_args(Body), elements, strict=True):
        link = scene.link(body)
        length = link.length / n
        shear = 1 / (1 / link.shear + length**2 / (12 * link.bending))
        sections += [(length, link.axial, shear, link.bending, *link[1:3])] * n
    unknowns = np.column_stack([*near, *far])
    mass, load = _mass_and_weight(sections, unknowns, len(initial), scene.gravity)
    mass[ball[3], BAND] += scene.slider_mass
    load[CRANK] = 0.0 if scene.crank_speed is not None else scene.driving_moment
    numbers = unknowns, ball, x[pin], np.array(held)
    return System(np.array(sections), *numbers, mass, load, initial, speeds, ideal)


def _mass_and_weight(sections, unknowns, size, gravity):
    """Consistent mass of the elements, a band, and their weights as loads on the nodes."""
    mass, load = np.zeros((size, 2 * BAND + 1)), np.zeros(size)
    for (length, _, _, _, per_length, rotary), at in zip(sections, unknowns, strict=True):
        for i in range(6):
            density = rotary if i % 3 == 2 else per_length
            for j in range(i % 3, 6, 3):
                share = (2 if i == j else 1) * density * length / 6
                mass[at[i], BAND + at[j] - at[i]] += share
        load[at[[1, 4]]] -= gravity * length * per_length / 2
    return mass, load


@compiled
def _internal(q, sections, unknowns, force, matrix, factor):
    """Add the forces, and ``factor`` times their tangent to ``matrix``; return the energy."""
    energy = 0.0
    b, d = np.zeros((3, 6)), np.zeros(6)
    for e in range(len(sections)):
        length, axial, shear, bending = sections[e, :4]
        at = unknowns[e]
        for i in range(6):
            d[i] = q[at[i]]
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
            force[at[i]] += length * (n * b[0, i] + v * b[1, i] + m * b[2, i])
            if factor == 0:
                continue
            for j in range(6):
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
def _contact(q, v, ball, contact, approach, branch, p, law, joint):
    """Fill ``joint`` with the contact's state and its forces on the slider.

    Returns the derivatives of the forces on the ball and of the moment on the coupler, by
    eccentricity and rotation and by their rates: two 3x3 blocks.
    """
    stiff, damp = np.zeros((3, 3)), np.zeros((3, 3))
    ex, ey = q[ball[0]] - q[ball[3]], q[ball[1]]
    wx, wy, spin = v[ball[0]] - v[ball[3]], v[ball[1]], v[ball[2]]
    r = norm(ex, ey)
    joint[:] = 0.0
    joint[DEPTH], joint[EX], joint[EY] = r - law.clearance, ex, ey
    nx, ny = (ex / r, ey / r) if r > 0 else (1.0, 0.0)
    tx, ty = -ny, nx
    rate, across = wx * nx + wy * ny, wx * tx + wy * ty
    sliding = across + p.r1 * spin
    joint[RATE], joint[SLIDING] = rate, sliding
    if not contact or joint[DEPTH] <= 0:
        return stiff, damp
    if branch == ANY:
        branch = friction_branch(sliding, p.v0, p.v1)
    normal, normal_d, normal_r, elastic, _, tangential, tangential_n, tangential_s = joint_forces(
        law, r - law.clearance, rate, sliding, branch, approach, p.damping, p.friction, p.v0, p.v1
    )
    joint[NORMAL], joint[TANGENTIAL], joint[ELASTIC] = normal, tangential, elastic
    joint[FORCE_X] = normal * nx - tangential * tx
    joint[FORCE_Y] = normal * ny - tangential * ty
    for j in range(2):  # eccentricity x, y
        n_j, t_j = (nx, tx) if j == 0 else (ny, ty)
        bend = t_j / r  # dn = bend t, dt = -bend n
        dnormal = normal_d * n_j + normal_r * across * bend
        dtangential = tangential_n * dnormal - tangential_s * rate * bend
        dn, dt = -dnormal - tangential * bend, dtangential - normal * bend
        stiff[0, j], stiff[1, j] = dn * nx + dt * tx, dn * ny + dt * ty
        stiff[2, j] = p.r1 * dtangential
        dnormal = normal_r * n_j
        dtangential = tangential_n * dnormal + tangential_s * t_j
        damp[0, j] = -dnormal * nx + dtangential * tx
        damp[1, j] = -dnormal * ny + dtangential * ty
        damp[2, j] = p.r1 * dtangential
    dtangential = tangential_s * p.r1
    damp[0, 2], damp[1, 2], damp[2, 2] = dtangential * tx, dtangential * ty, p.r1 * dtangential
    return stiff, damp


@compiled
def _hold(unknowns, matrix, right):
    """Make a banded system leave some unknowns at 0."""
    for i in unknowns:
        right[i], matrix[i], matrix[i, BAND] = 0.0, 0.0, 1.0


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
def _forces(q, v, system, state, branch, p, law, joint, force, matrix, tangent):
    """Fill ``force`` with internal, contact and load forces, and return the strain energy.

    Derivatives by places and rates, times the factors ``tangent``, are added to ``matrix``.
    """
    ball, (by_q, by_v) = system.ball, tangent
    for i in range(len(force)):
        force[i] = -system.load[i]
    energy = _internal(q, system.sections, system.unknowns, force, matrix, by_q)
    if system.ideal:
        return energy
    contact, approach = state[stepping.CONTACT] > 0, state[stepping.APPROACH]
    stiff, damp = _contact(q, v, ball, contact, approach, branch, p, law, joint)
    if joint[NORMAL] != 0 or joint[ELASTIC] != 0:
        force[ball[0]] += joint[FORCE_X]
        force[ball[1]] += joint[FORCE_Y]
        force[ball[2]] -= p.r1 * joint[TANGENTIAL]
        force[ball[3]] -= joint[FORCE_X]
        for i in range(4 if by_q != 0 else 0):
            for j in range(4):
                row, column = (0 if i == 3 else i), (0 if j == 3 else j)
                sign = (-1.0 if i == 3 else 1.0) * (-1.0 if j == 3 else 1.0)
                value = by_q * stiff[row, column] + by_v * damp[row, column]
                matrix[ball[i], BAND + ball[j] - ball[i]] -= sign * value
    return energy


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
def _newton(motion, new, system, state, sliding, p, law, h, tolerance, old, work):
    """Fill ``new`` with places, rates and accelerations after a step; False for no balance.

    ``old`` are the forces before. An iteration takes one linear piece of the friction law, and the
    next one that piece or a neighbour: free to jump, it would alternate between the law's ends.
    """
    (force, right, matrix, joint), size, ball = work, motion.shape[1], system.ball
    q, v, a, q1, v1, a1 = motion[0], motion[1], motion[2], new[0], new[1], new[2]
    gamma = 0.5 - ALPHA_M + ALPHA_F
    beta = 0.25 * (1 - ALPHA_M + ALPHA_F) ** 2
    by_a = (1 - ALPHA_M) / (beta * h * h)
    by_q, by_v = 1 - ALPHA_F, (1 - ALPHA_F) * gamma / (beta * h)
    for i in range(size):
        a1[i] = a[i]
        v1[i] = v[i] + h * a[i]
        q1[i] = q[i] + h * v[i] + 0.5 * h * h * a[i]
    branch = 0 if system.ideal else friction_branch(sliding, p.v0, p.v1)
    for _ in range(60):
        for i in range(size):
            for j in range(2 * BAND + 1):
                matrix[i, j] = by_a * system.mass[i, j]
        _forces(q1, v1, system, state, branch, p, law, joint, force, matrix, (by_q, by_v))
        for i in range(size):
            right[i] = -(1 - ALPHA_F) * force[i] - ALPHA_F * old[i]
            for j in range(max(0, i - BAND), min(size, i + BAND + 1)):
                share = (1 - ALPHA_M) * a1[j] + ALPHA_M * a[j]
                right[i] -= system.mass[i, BAND + j - i] * share
        _hold(system.held, matrix, right)
        _solve(matrix, right)
        change = 0.0
        for i in range(size):
            change = max(change, abs(right[i]))
            q1[i] += right[i]
            v1[i] += gamma / (beta * h) * right[i]
            a1[i] += right[i] / (beta * h * h)
        if not change < inf:
            return False
        away = 0
        if state[stepping.CONTACT] > 0:
            ex, ey = q1[ball[0]] - q1[ball[3]], q1[ball[1]]
            across = (v1[ball[1]] * ex - (v1[ball[0]] - v1[ball[3]]) * ey) / norm(ex, ey)
            away = friction_branch(across + p.r1 * v1[ball[2]], p.v0, p.v1) - branch
        if change <= tolerance and abs(away) <= 1:
            return True
        branch += min(max(away, -1), 1)
    return False


@compiled
def _copy(source, target):
    """Copy numbers one by one: an assignment of arrays takes seconds to compile."""
    for i in range(len(source)):
        target[i] = source[i]


@compiled
def _follow_contact(state, impacts, before, after, h):
    """Add what a step in contact loses; say if its force is the largest so far, and if it ended."""
    for joint in (before, after):
        damping = (joint[NORMAL] - joint[ELASTIC]) * joint[RATE]
        state[stepping.LOST_DAMPING] += 0.5 * h * damping
        state[stepping.LOST_FRICTION] -= 0.5 * h * joint[TANGENTIAL] * joint[SLIDING]
    largest = stepping.follow_impact(impacts, state, after[NORMAL], after[DEPTH])
    ended = after[DEPTH] <= 0
    if ended:
        stepping.end_impact(impacts, state, -after[RATE])
    return largest, ended


@compiled
def advance(state, motion, system, p, law, h, strides, rows, impacts, events):
    """Fill ``rows``, ``strides`` steps apart; return the number of rows filled and the ending.

    ``motion`` has the rows places, rates, the method's accelerations, and those one step before.
    """
    size, done = motion.shape[1], 0
    new, old, force, right = np.zeros((3, size)), np.zeros(size), np.zeros(size), np.zeros(size)
    matrix, joint, new_joint = np.zeros((size, 2 * BAND + 1)), np.zeros(10), np.zeros(10)
    work = force, right, matrix, new_joint
    strain = _forces(
        motion[0], motion[1], system, state, ANY, p, law, joint, old, matrix, NO_TANGENT
    )
    if p.steady and state[stepping.STEPS] == 0:
        _drive(state, _reaction(CRANK, old, motion, system.mass), motion[1, CRANK], 0.0)
    far = abs(system.initial[system.ball[3]])  # of the start: a loop may begin anew at any step
    tolerance = NEWTON_TOLERANCE * law.clearance + 1e-13 * far
    while True:
        if int(state[stepping.IMPACTS]) == len(impacts):
            return done, stepping.FULL
        t = state[stepping.TIME] = state[stepping.STEPS] * h
        if int(state[stepping.STEPS]) % strides == 0:
            _record(rows[done], state, motion, old, system, joint, strain, p)
            done += 1
        begun = largest = ended = False
        while True:  # twice if the surfaces meet in this step
            sliding = joint[SLIDING]
            if not _newton(motion, new, system, state, sliding, p, law, h, tolerance, old, work):
                return done, stepping.FAILED
            strain = _forces(
                new[0], new[1], system, state, ANY, p, law, new_joint, force, matrix, NO_TANGENT
            )
            if system.ideal or state[stepping.CONTACT] > 0 or new_joint[DEPTH] <= 0:
                break
            after, approach = _meet(joint[DEPTH], joint[RATE], new_joint[DEPTH], new_joint[RATE], h)
            stepping.begin_impact(impacts, state, t + after, approach)
            begun = True
        state[stepping.STEPS] += 1
        state[stepping.TIME] = state[stepping.STEPS] * h
        if state[stepping.CONTACT] > 0:
            if new_joint[DEPTH] > p.clearance:
                state[stepping.LIMIT] = p.clearance
                return done, stepping.TOO_DEEP
            largest, ended = _follow_contact(state, impacts, joint, new_joint, h)
        _copy(motion[2], motion[3])
        for row in range(3):
            _copy(new[row], motion[row])
        _copy(force, old)
        _copy(new_joint, joint)
        if p.steady:
            _drive(state, _reaction(CRANK, old, motion, system.mass), motion[1, CRANK], h)
        for event, happened in enumerate((begun, largest, ended)):
            if happened:
                row = stepping.event_row(events, state, event)
                _record(row, state, motion, old, system, joint, strain, p)
        if done == len(rows) or state[stepping.STEPS] >= state[stepping.UNTIL]:
            return done, stepping.FINE


@compiled
def _true_acceleration(motion, i):
    """Acceleration now: the method's belong to a time (alpha_f - alpha_m) h before."""
    late = (1 - SPECTRAL_RADIUS) / (SPECTRAL_RADIUS + 1)
    return motion[2, i] + late * (motion[2, i] - motion[3, i])


@compiled
def _reaction(i, force, motion, mass):
    """Force or moment that holds an unknown, against inertia and other forces."""
    total = force[i]
    for j in range(max(0, i - BAND), min(len(force), i + BAND + 1)):
        total += mass[i, BAND + j - i] * _true_acceleration(motion, j)
    return total


@compiled
def _drive(state, moment, speed, h):
    """Keep the moment that holds the crank's speed, and add its work in a step."""
    state[DRIVE_WORK] += 0.5 * h * (state[DRIVE_MOMENT] + moment) * speed
    state[DRIVE_MOMENT] = moment


@compiled
def _record(row, state, motion, force, system, joint, strain, p):
    """Fill a row of output from motion and contact at the state's time."""
    q, v, ball, pin = motion[0], motion[1], system.ball, system.pin
    size, turning = len(q), _true_acceleration(motion, CRANK)
    kinetic, work, drive = 0.0, state[DRIVE_WORK], p.moment + state[DRIVE_MOMENT]
    for i in range(size):
        work += system.load[i] * q[i]
        for j in range(max(0, i - BAND), min(size, i + BAND + 1)):
            kinetic += 0.5 * v[i] * system.mass[i, BAND + j - i] * v[j]
    place = joint[EX], joint[EY], joint[DEPTH]
    forces = joint[NORMAL], joint[TANGENTIAL], joint[FORCE_X], joint[FORCE_Y]
    if system.ideal:
        fx = p.m3 * _true_acceleration(motion, ball[0])
        fy = -_reaction(ball[1], force, motion, system.mass)
        forces = norm(fx, fy), 0.0, fx, fy
    crank, slider = (q[CRANK], v[CRANK], turning, drive), (q[ball[3]], v[ball[3]], forces[2] / p.m3)
    coupler = direction(q[ball[1]] - q[pin + 1], q[ball[0]] - q[pin]), v[ball[2]]
    lost = state[stepping.LOST_DAMPING], state[stepping.LOST_FRICTION]
    energies = work, kinetic, strain, *lost
    stepping.record(row, crank, slider, coupler, place, forces, energies)


def _start(system):
    """Places, rates and accelerations at t = 0, in the rows of ``advance``'s ``motion``.

    Rotations without inertia follow the load at once, unless held.
    """
    sections, unknowns, _, _, held, mass, load, initial, rates, _ = system
    motion = np.array([initial, rates, 0 * load, 0 * load])
    force, stiffness = -load, np.zeros_like(mass)
    _internal(motion[0], sections, unknowns, force, stiffness, 1.0)
    light = mass[:, BAND] == 0
    if light.any():
        motion[0] -= _solution(stiffness, force, [*held, *np.flatnonzero(~light)])
        force = -load
        _internal(motion[0], sections, unknowns, force, stiffness, 0.0)
    motion[2:] = _solution(mass, -force, [*held, *np.flatnonzero(light)])
    return motion


def _solution(matrix, right, held):
    """Solution of a banded system, 0 for the unknowns ``held``."""
    matrix, right = matrix.copy(), right.copy()
    _hold(np.array(held), matrix, right)
    _solve(matrix, right)
    return right


def blocks(
    scene: Scene,
    law: np.record,
    times: NDArray[np.float64],
    ideal: bool,
    step: float,
    elements: tuple[int, int],
) -> Iterator[stepping.Block]:
    """Blocks of output rows of the scene with links of beam elements, as for particles."""
    system, p, state = assemble(scene, elements, ideal), scene.constants(), stepping.new_state()
    strides, h = stepping.divide(times, step)
    motion, state[stepping.STEP] = _start(system), h
    loop = partial(advance, state, motion, system, p, law, h, strides)
    return stepping.advance_in_blocks(loop, times, state, "Newton's method found no balance")
