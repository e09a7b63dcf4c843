"""Stepping rigid links: smooth pieces between located events.

Between impacts, separations and kinks of the friction law the equations of one clearance joint
(`rigid`) or two (`two_joints`) are smooth. Such a piece is integrated by Rodas5P with the exact
Jacobian; its end is located by repeating the last step with another length until the event
function vanishes.

A state is (theta, two coordinates of each joint), their rates, the energies lost to damping and
friction in each joint, and at constant crank speed the drive's work. The slider's joint comes
first, the crank's second.
"""

from collections.abc import Callable, Iterator
from functools import partial
from math import inf, sqrt

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from study.compiled import compiled
from study.contact.friction import friction_branch
from study.mechanism import rigid, stepping, two_joints
from study.mechanism.angles import angle_of, norm, sixth_root, sine_cosine
from study.mechanism.free_impact import impact_depth
from study.mechanism.response import ALL_COLUMNS
from study.mechanism.collocation import (
    ORDER,
    PAIRS,
    PLACE,
    POINTS,
    RATE as RATE_WEIGHTS,
    STAGES,
    estimate,
    extrapolate,
    factorise,
    finish,
    improve,
    inside,
    polynomials,
    stage,
)
from study.mechanism.scene import Scene

REACH, BEGAN, LENGTH, SMOOTH = range(4)
END = stepping.STATE
ITERATIONS, EXACT_ENOUGH = 10, 0.02
"""Place in the state, before those of all models, of the speed that the drive gives."""
SURFACES, UPWARDS, DOWNWARDS, FORCE_PEAK, DEPTH_PEAK = range(5)
"""Events: the surfaces meet or part, the sliding speed leaves the friction branch, peaks."""
CONTACT, BRANCH, APPROACH, DEEP, NUMBER = range(5)
"""What is known of a joint: in contact or not, friction branch, approach speed, the depth that this
can bring, and the number of the impact."""
ROUNDOFF = 1e-16
Laws = tuple[NDArray[np.float64], ...]
"""A packed law for each clearance joint, slider's and crank's. How many there are is known to the
compiler, so that each number has loops of its own."""


def _move(y, pieces, p, laws):
    """Accelerations, powers and forces of the mechanism with these joints."""
    raise TypeError("in compiled code only")


@overload(_move)
def _move_compiled(y, pieces, p, laws):
    if len(pieces) == 1:
        return lambda y, pieces, p, laws: rigid.motion(y, pieces[0], p, laws[0])
    return lambda y, pieces, p, laws: two_joints.motion(y, pieces, p, laws)


def _derive(y, pieces, p, found, parts, k):
    """Fill ``k`` with the derivatives of the accelerations that `_move` found."""
    raise TypeError("in compiled code only")


@overload(_derive)
def _derive_compiled(y, pieces, p, found, parts, k):
    if len(pieces) == 1:
        return lambda y, pieces, p, found, parts, k: rigid.derive(y, pieces[0], p, found, parts, k)
    return lambda y, pieces, p, found, parts, k: two_joints.derive(y, pieces, p, found, parts, k)


def _record(row, y, pieces, found, p, laws):
    """Fill a row of output, which has its time already."""
    raise TypeError("in compiled code only")


@overload(_record)
def _record_compiled(row, y, pieces, found, p, laws):
    if len(pieces) == 1:
        return lambda row, y, pieces, found, p, laws: rigid.record(
            row, y, pieces[0][0], found, p, laws[0]
        )
    return lambda row, y, pieces, found, p, laws: two_joints.record(
        row, y, pieces, found, p, laws
    )


def _pieces(joints, laws):
    """(In contact?, friction branch, approach speed) of each joint."""
    raise TypeError("in compiled code only")


@compiled
def _piece(one):
    return one[CONTACT] > 0, int(one[BRANCH]), one[APPROACH]


@overload(_pieces)
def _pieces_compiled(joints, laws):
    if len(laws) == 1:
        return lambda joints, laws: (_piece(joints[0]),)
    return lambda joints, laws: (_piece(joints[0]), _piece(joints[1]))


@compiled
def motion(y, joints, p, laws, k):
    """Accelerations, powers and forces at a state; fill ``k`` with the accelerations' derivatives."""
    pieces = _pieces(joints, laws)
    found, parts = _move(y, pieces, p, laws)
    _derive(y, pieces, p, found, parts, k)
    return found


@compiled
def _size(error, y, pieces, joints, seen, reach, tolerance, p, laws):
    """Largest of some errors of z and z' over what ``tolerance`` allows.

    Places count by the clearance, a depth by the deepest that this impact's approach speed can
    bring, speeds by a tenth of what the drive gives over the clearance (found by measuring).
    """
    n = 1 + 2 * len(pieces)
    turned, turning = p.l1 * abs(error[0]), p.l1 * abs(error[n])
    speed = 0.1 * tolerance * reach + ROUNDOFF * p.l1 * abs(y[n])
    size = turned / (tolerance * laws[0][1] + ROUNDOFF * p.l1 * abs(y[0]))
    size = max(size, turning / speed)
    for j in range(len(pieces)):
        clearance, contact, at = laws[j][1], pieces[j][0], 1 + 2 * j
        place = tolerance * clearance
        deep = tolerance * max(joints[j, DEEP], seen[j].depth) if contact else place
        across = clearance if contact else 1.0
        size = max(size, abs(error[at]) / deep, abs(error[at + 1]) * across / place)
        size = max(size, abs(error[n + at]) / speed, abs(error[n + at + 1]) * across / speed)
    return size if size == size else inf


@compiled
def _collocate(h, y, pieces, joints, seen, room, reach, tolerance, p, laws):
    """Find the accelerations at the points of a step by Newton's method; whether it converged."""
    n = 1 + 2 * len(pieces)
    rates, residuals, marks, k, real, pairs, x, z, new, error = room
    factorise(k, h, n, real, pairs)
    before = inf
    for _ in range(ITERATIONS):
        for i in range(STAGES):
            stage(i, y, h, rates, n, new)
            found, _ = _move(new, pieces, p, laws)
            for m in range(n):
                residuals[i, m] = found.accelerations[m] - rates[1 + i, m]
            for m in range(n):
                rates[1 + i, n + m] = found.powers[m]
            _mark(i, found.joints, marks)
        improve(residuals, rates, n, real, pairs, x, z)
        for m in range(n):
            place = speed = 0.0
            for j in range(STAGES):
                place += abs(PLACE[STAGES - 1, j] * residuals[j, m])
                speed += abs(RATE_WEIGHTS[STAGES - 1, j] * residuals[j, m])
            error[m], error[n + m] = h * h * place, h * speed
        size = _size(error, y, pieces, joints, seen, reach, tolerance, p, laws)
        if not size < before:
            return size < EXACT_ENOUGH
        left = size * size / (before - size) if before < inf else size
        if left < EXACT_ENOUGH:
            return True
        before = size
    return False


@compiled
def _mark(i, joints, marks):
    """Keep what tells events at point ``i`` of a step."""
    for j in range(len(joints)):
        marks[i, j, 0], marks[i, j, 1] = joints[j].depth, joints[j].rate
        marks[i, j, 2], marks[i, j, 3] = joints[j].sliding, joints[j].normal_rate


@compiled
def _event(which, piece, depth, rate, sliding, normal_rate, p):
    """Event functions of a joint, negative before and positive after."""
    contact, branch, _ = piece
    if which == SURFACES:
        return -depth if contact else depth
    if not contact:
        return -1.0
    if which == FORCE_PEAK:
        return -normal_rate
    if which == DEPTH_PEAK:
        return -rate
    bounds = (-inf, -p.v1, -p.v0, p.v0, p.v1, inf)
    if which == UPWARDS:
        return sliding - bounds[branch + 3]
    return bounds[branch + 2] - sliding


@compiled
def _look(x, smooth, new):
    """Fill ``new`` with the state at the share ``x`` of a step, and tell what is found there."""
    y, h, found, pieces, p, laws = smooth
    inside(y, h, found, x, 1 + 2 * len(pieces), new)
    return _move(new, pieces, p, laws)[0]


@compiled
def _value(which, j, x, smooth, new):
    """Event function of a joint at the share ``x`` of a step."""
    _, _, _, pieces, p, _ = smooth
    joint = _look(x, smooth, new).joints[j]
    return _event(which, pieces[j], joint.depth, joint.rate, joint.sliding, joint.normal_rate, p)


@compiled
def _locate(which, j, low, high, smooth, new):
    """Share of a step, between two, at which an event function turns positive.

    By false position with halving of a value that stays (Illinois), on the step's polynomials.
    """
    before, after = _value(which, j, low, smooth, new), _value(which, j, high, smooth, new)
    side = 0
    if before > -1e-9 * after:  # the piece begins on the event, and has left it at once
        before = -after
    while high - low > 1e-12 + 1e-9 * high:
        middle = (low * after - high * before) / (after - before)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        value = _value(which, j, middle, smooth, new)
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
def _first_event(smooth, marks, new, p):
    """Which event of which joint comes first in a step, -1 for none, and at which share of it."""
    pieces, first, of, share = smooth[3], -1, 0, inf
    for j in range(len(pieces)):
        for which in (SURFACES, UPWARDS, DOWNWARDS):
            low = 0.0
            for i in range(STAGES):
                m = marks[i, j, 0], marks[i, j, 1], marks[i, j, 2], marks[i, j, 3]
                if low < share and _event(which, pieces[j], *m, p) >= 0:
                    at = _locate(which, j, low, POINTS[i], smooth, new)
                    if at < share:
                        first, of, share = which, j, at
                    break
                low = POINTS[i]
    return first, of, share


@compiled
def _nearer(which, j, smooth, new):
    """Share of a step that ends close to an event at which it would end on it."""
    end, before = _value(which, j, 1.0, smooth, new), _value(which, j, 0.999, smooth, new)
    share = 1 - 0.001 * end / (end - before)
    return share if abs(share - 1) < 0.1 else 1.0


@compiled
def _measure_peaks(j, impact, row, smooth, t, start, marks, new):
    """Locate peaks of force and depth inside a step that begins at ``t`` with ``start``.

    ``row`` is that of output at the peak of the force.
    """
    _, h, _, pieces, p, laws = smooth
    for which in (FORCE_PEAK, DEPTH_PEAK):
        mark = 3 if which == FORCE_PEAK else 1
        low, rising = 0.0, (start.normal_rate if which == FORCE_PEAK else start.rate) > 0
        for i in range(STAGES):
            if rising and marks[i, j, mark] <= 0:
                share = _locate(which, j, low, POINTS[i], smooth, new)
                found = _look(share, smooth, new)
                impact[stepping.PEAK_DEPTH] = max(
                    impact[stepping.PEAK_DEPTH], found.joints[j].depth
                )
                if found.joints[j].normal > impact[stepping.PEAK_FORCE]:
                    impact[stepping.PEAK_FORCE] = found.joints[j].normal
                    row[0] = t + share * h
                    _record(row, new, pieces, found, p, laws)
            low, rising = POINTS[i], marks[i, j, mark] > 0


@compiled
def advance(state, y, joints, kept, p, laws, tolerance, rows, impacts, events):
    """Step beyond the time of each row and fill it; return the rows filled and the ending."""
    t, h, pieces = state[stepping.TIME], state[stepping.STEP], _pieces(joints, laws)
    start, was, polynomial, (rates, marks) = kept
    n, reach = 1 + 2 * len(pieces), state[REACH]
    new, trial, k, next_k = np.zeros(3 * n), np.zeros(3 * n), np.zeros((n, 2 * n)), np.zeros((n, 2 * n))
    found = motion(y, joints, p, laws, k)
    real, error = np.zeros((n, n)), np.zeros(2 * n)
    idle, done = 0, 0
    room = (
        rates, np.zeros((STAGES, n)), marks, k, real,
        np.zeros((PAIRS, n, n), np.complex128), np.zeros(n), np.zeros((PAIRS, n), np.complex128),
        trial, error,
    )
    while done < len(rows):
        if rows[done, 0] <= t:
            earlier, length = _pieces(was, laws), state[LENGTH]
            smooth = start, length, polynomial, earlier, p, laws
            at = _look((rows[done, 0] - state[BEGAN]) / length, smooth, trial)
            _record(rows[done], trial, earlier, at, p, laws)
            done += 1
            continue
        if int(state[stepping.IMPACTS]) == len(impacts):
            return done, stepping.FULL
        landing = t + h * 1.000001 >= state[END]
        length = state[END] - t if landing else h
        for m in range(n):
            rates[0, m], rates[0, n + m] = found.accelerations[m], found.powers[m]
        if state[SMOOTH] > 0:
            extrapolate(polynomial, 1.0, length / state[LENGTH], n, rates)
        else:
            for i in range(STAGES):
                for m in range(n):
                    rates[1 + i, m] = rates[0, m]
        state[stepping.STEPS] += 1
        size = inf
        if _collocate(length, y, pieces, joints, found.joints, room, reach, tolerance, p, laws):
            estimate(y, length, rates, k, n, real, error)
            size = _size(error, y, pieces, joints, found.joints, reach, tolerance, p, laws)
        if not size <= 1.0:
            h = length * (max(0.2, 0.9 / sixth_root(size)) if size < inf else 0.3)
            if h > 1e-15 * t:
                continue
            return done, stepping.FAILED
        finish(y, length, rates, n, new)
        seen, parts = _move(new, pieces, p, laws)
        _mark(STAGES - 1, seen.joints, marks)
        polynomials(rates, 2 * n, polynomial)
        grown = length * min(4.0, 0.9 / sixth_root(max(size, 1e-9)))
        h = max(h, grown) if landing else grown
        smooth = y, length, polynomial, pieces, p, laws
        event, of, share = _first_event(smooth, marks, trial, p)
        if event >= 0:
            landing = False
            for again in range(2):
                extrapolate(polynomial, 0.0, share, n, rates)
                length *= share
                _collocate(length, y, pieces, joints, found.joints, room, reach, tolerance, p, laws)
                polynomials(rates, 2 * n, polynomial)
                smooth = y, length, polynomial, pieces, p, laws
                if again == 0:
                    share = _nearer(event, of, smooth, trial)
            finish(y, length, rates, n, new)
            seen, parts = _move(new, pieces, p, laws)
            _mark(STAGES - 1, seen.joints, marks)
            idle = idle + 1 if length <= 1e-14 * t else 0
            if idle > 100:
                return done, stepping.FAILED
        else:
            _derive(new, pieces, p, seen, parts, next_k)
            k[:] = next_k
        for j in range(len(pieces)):
            if pieces[j][0]:
                if seen.joints[j].depth > laws[j][1]:
                    state[stepping.LIMIT] = laws[j][1]
                    return done, stepping.TOO_DEEP
                at_hand = int(joints[j, NUMBER])
                row = events[at_hand, stepping.PEAK]
                _measure_peaks(j, impacts[at_hand], row, smooth, t, found.joints[j], marks, trial)
        start[:], was[:] = y, joints
        state[BEGAN], state[LENGTH], state[SMOOTH] = t, length, 1.0 if event < 0 else 0.0
        t = state[stepping.TIME] = state[END] if landing else t + length
        y[:] = new
        for j in range(len(pieces)):
            if pieces[j][0]:
                _attend(j, state, y, joints)
                joint = seen.joints[j]
                if stepping.follow_impact(impacts, state, joint.normal, joint.depth):
                    row = stepping.event_row(events, state, stepping.PEAK)
                    _record(row, y, pieces, seen, p, laws)
        found = seen
        if event >= 0:
            h = _turn(event, of, seen, state, y, joints, h, p, laws, (impacts, events))
            pieces = _pieces(joints, laws)
            found = motion(y, joints, p, laws, k)
        state[stepping.STEP] = h
    return done, stepping.FINE


@compiled
def _attend(j, state, y, joints):
    """Make a joint's impact the one at hand, with the energy lost in that joint."""
    lost = 2 + 4 * len(joints) + 2 * j
    state[stepping.LOST_DAMPING], state[stepping.LOST_FRICTION] = y[lost], y[lost + 1]
    state[stepping.AT_HAND] = joints[j, NUMBER]


@compiled
def _turn(event, j, seen, state, y, joints, h, p, laws, table):
    """Begin the smooth piece that follows an event, in its coordinates; return its first step.

    ``table`` has the impacts and their rows of output.
    """
    (impacts, events), one, law, at = table, joints[j], laws[j], 2 + 2 * len(laws) + 2 * j
    z, rates = y[1 + 2 * j : 3 + 2 * j], y[at : at + 2]
    if event != SURFACES:
        one[BRANCH] += 1 if event == UPWARDS else -1
        return h
    _attend(j, state, y, joints)
    if one[CONTACT] > 0:
        stepping.end_impact(impacts, state, -rates[0])
        row = stepping.event_row(events, state, stepping.END)
        _record(row, y, _pieces(joints, laws), seen, p, laws)
        ny, nx = sine_cosine(z[1])
        rate, across = rates[0], law[1] * rates[1]
        z[0], z[1] = law[1] * nx, law[1] * ny
        rates[0], rates[1] = rate * nx - across * ny, rate * ny + across * nx
        one[CONTACT], one[BRANCH] = 0.0, 0.0
        return h
    if seen.joints[j].rate <= 0:  # it grazes, and goes on in flight
        return h
    r = norm(z[0], z[1])
    nx, ny, wx, wy = z[0] / r, z[1] / r, rates[0], rates[1]
    z[0], z[1] = 0.0, angle_of(ny, nx)
    rates[0], rates[1] = nx * wx + ny * wy, (nx * wy - ny * wx) / law[1]
    one[CONTACT], one[APPROACH], one[NUMBER] = 1.0, rates[0], state[stepping.IMPACTS]
    one[BRANCH] = friction_branch(seen.joints[j].sliding, p.v0, p.v1)
    stepping.begin_impact(impacts, state, state[stepping.TIME], rates[0])
    impacts[int(one[NUMBER]), stepping.JOINT] = j
    row = stepping.event_row(events, state, stepping.START)
    _record(row, y, _pieces(joints, laws), seen, p, laws)
    (ny, nx), phi = sine_cosine(z[1]), (seen.coupler[0], seen.coupler[1])
    one[DEEP] = impact_depth(j, y[0], phi, nx, ny, rates[0], p, laws)
    return min(h, 0.1 * one[DEEP] / rates[0])


def stepper(
    scene: Scene, laws: Laws, horizon: float, tolerance: float
) -> tuple[NDArray[np.float64], Callable]:
    """State at t = 0, and the loop that steps it, for ``advance_in_blocks``; ``horizon`` in s."""
    p, clearances = scene.constants(), (scene.clearance, scene.crank_clearance or 0.0)[: len(laws)]
    unknowns = 1 + 2 * len(laws)  # and as many integrals
    state, joints = np.zeros(stepping.STATE + 1), np.zeros((len(laws), 5))
    y = np.zeros(3 * unknowns)
    y[0], y[unknowns] = scene.initial_crank_angle, scene.starting_speed
    y[1:3] = scene.initial_eccentricity
    accelerations = motion(y, joints, p, laws, np.zeros((unknowns, 2 * unknowns))).accelerations
    for j, clearance in enumerate(clearances):
        joints[j, DEEP] = clearance
        reach = sqrt(norm(*accelerations[1 + 2 * j : 3 + 2 * j]) * clearance)
        state[REACH] = max(state[REACH], reach, clearance / horizon)
    state[stepping.STEP] = min(1e-3 * scene.clearance / state[REACH], horizon)
    state[LENGTH], state[END] = 1.0, horizon
    rates = np.zeros((ORDER, 2 * unknowns))
    memory = y.copy(), joints.copy(), np.zeros_like(rates), (rates, np.zeros((STAGES, len(laws), 4)))
    return state, partial(advance, state, y, joints, memory, p, laws, tolerance)


def blocks(
    scene: Scene, laws: Laws, times: list[NDArray[np.float64]], tolerance: float
) -> Iterator[stepping.Block]:
    """Blocks of output rows at ``times`` of the scene with its clearance joints and packed laws."""
    state, loop = stepper(scene, laws, times[-1][-1], tolerance)
    failure, columns = f"no step is small enough for tolerance {tolerance:g}", len(ALL_COLUMNS)
    return stepping.advance_in_blocks(loop, times, state, failure, columns)
