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
from study.mechanism.angles import angle_of, fifth_root, norm, sine_cosine
from study.mechanism.free_impact import impact_depth
from study.mechanism.response import ALL_COLUMNS
from study.mechanism.rigid import COSINE, DEPTH, JOINT, NORMAL, NORMAL_RATE, RATE, SINE, SLIDING
from study.mechanism.rosenbrock import (
    STAGES,
    begin_stage,
    cofactors,
    end_stage,
    end_stage_of_three,
    triangles,
)
from study.mechanism.scene import Scene

REACH = 0
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


def _move(y, pieces, p, laws, jacobian, f, k):
    """Accelerations, powers and what else is found, of the mechanism with these joints."""
    raise TypeError("in compiled code only")


@overload(_move, inline="always")
def _move_compiled(y, pieces, p, laws, jacobian, f, k):
    if len(pieces) == 1:
        return lambda y, pieces, p, laws, jacobian, f, k: rigid.motion(
            y, pieces[0], p, laws[0], jacobian, f, k
        )
    return lambda y, pieces, p, laws, jacobian, f, k: two_joints.motion(
        y, pieces, p, laws, jacobian, f, k
    )


@compiled
def accelerate(y, joints, p, laws, f, k):
    """Fill ``f`` at a state, without derivatives."""
    _move(y, _pieces(joints, laws), p, laws, False, f, k)


def _record(row, y, pieces, f, p, laws):
    """Fill a row of output, which has its time already."""
    raise TypeError("in compiled code only")


@overload(_record, inline="always")
def _record_compiled(row, y, pieces, f, p, laws):
    if len(pieces) == 1:
        return lambda row, y, pieces, f, p, laws: rigid.record(row, y, pieces[0][0], f, p, laws[0])
    return lambda row, y, pieces, f, p, laws: two_joints.record(row, y, pieces, f, p, laws)


def _pieces(joints, laws):
    """(In contact?, friction branch, approach speed) of each joint."""
    raise TypeError("in compiled code only")


@compiled
def _piece(one):
    return one[CONTACT] > 0, int(one[BRANCH]), one[APPROACH]


@overload(_pieces, inline="always")
def _pieces_compiled(joints, laws):
    if len(laws) == 1:
        return lambda joints, laws: (_piece(joints[0]),)
    return lambda joints, laws: (_piece(joints[0]), _piece(joints[1]))


def _step(smooth, h, new):
    """One step of Rodas5P; fills ``new`` and leaves the error estimate in the scratch."""
    raise TypeError("in compiled code only")


@overload(_step, inline="always")
def _step_compiled(smooth, h, new):
    if len(smooth[1]) == 1:
        return lambda smooth, h, new: _step_one(smooth, h, new)
    return lambda smooth, h, new: _step_two(smooth, h, new)


@compiled
def _step_one(smooth, h, new):
    y, pieces, p, laws, (f0, k), (u, work, f), integrals = smooth
    factors, rate, piece, law = cofactors(k, h), 1 / h, pieces[0], laws[0]
    for i in range(STAGES):
        begin_stage(i, y, rate, u, work, new, 6 + len(integrals))
        if i == 0:
            f[:] = f0
        else:
            rigid.motion(new, piece, p, law, False, f, k)
        end_stage_of_three(i, new, f, k, factors, u, work, integrals)
    for n in range(6 + len(integrals)):
        new[n] += u[STAGES - 1, n]


@compiled
def _step_two(smooth, h, new):
    y, pieces, p, laws, (f0, k), (u, work, f), _ = smooth
    factors, rate = triangles(k, h, 5), 1 / h
    for i in range(STAGES):
        begin_stage(i, y, rate, u, work, new, len(y))
        if i == 0:
            f[:] = f0
        else:
            two_joints.motion(new, pieces, p, laws, False, f, k)
        end_stage(i, new, f, k, factors, u, work)
    for n in range(len(y)):
        new[n] += u[STAGES - 1, n]


@compiled
def _error(u, y, pieces, joints, seen, reach, tolerance, p, laws):
    """Largest local error over what ``tolerance`` allows.

    Places count by the clearance, a depth by the deepest that this impact's approach speed can
    bring, speeds by a tenth of what the drive gives over the clearance (found by measuring).
    """
    n = 1 + 2 * len(pieces)
    turned, turning = p.l1 * abs(u[7, 0]), p.l1 * abs(u[7, n])
    speed = 0.1 * tolerance * reach + ROUNDOFF * p.l1 * abs(y[n])
    error = turned / (tolerance * laws[0][1] + ROUNDOFF * p.l1 * abs(y[0]))
    error = max(error, turning / speed)
    for j in range(len(pieces)):
        clearance, contact, at = laws[j][1], pieces[j][0], 1 + 2 * j
        place = tolerance * clearance
        deep = tolerance * max(joints[j, DEEP], seen[DEPTH + JOINT * j]) if contact else place
        across = clearance if contact else 1.0
        error = max(error, abs(u[7, at]) / deep, abs(u[7, at + 1]) * across / place)
        error = max(error, abs(u[7, n + at]) / speed, abs(u[7, n + at + 1]) * across / speed)
    return error


@compiled
def _event(which, j, pieces, seen, p):
    """Event functions of joint ``j``, negative before and positive after."""
    contact, at = pieces[j][0], JOINT * j
    if which == SURFACES:
        return -seen[DEPTH + at] if contact else seen[DEPTH + at]
    if not contact:
        return -1.0
    if which == FORCE_PEAK:
        return -seen[NORMAL_RATE + at]
    if which == DEPTH_PEAK:
        return -seen[RATE + at]
    branch, bounds = pieces[j][1], (-inf, -p.v1, -p.v0, p.v0, p.v1, inf)
    if which == UPWARDS:
        return seen[SLIDING + at] - bounds[branch + 3]
    return bounds[branch + 2] - seen[SLIDING + at]


@compiled
def _try(which, j, smooth, h, new):
    """Step by ``h`` and tell an event function at its end; the scratch keeps what is seen."""
    _, pieces, p, laws, (_, k), (_, _, f), _ = smooth
    _step(smooth, h, new)
    _move(new, pieces, p, laws, False, f, k)
    return _event(which, j, pieces, f, p)


@compiled
def _locate(which, j, before, after, smooth, t, h, new):
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
        value = _try(which, j, smooth, middle, new)
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
    """Which event of which joint ends a step of ``h`` with ``seen`` at its end, and when.

    The event is -1 for none.
    """
    _, pieces, p, _, here, _, _ = smooth
    first, of = -1, 0
    for j in range(len(pieces)):
        for which in (SURFACES, UPWARDS, DOWNWARDS):
            after = (
                _try(which, j, smooth, h, new) if first >= 0 else _event(which, j, pieces, seen, p)
            )
            if after >= 0:
                before = _event(which, j, pieces, here[0], p)
                h = _locate(which, j, before, after, smooth, t, h, new)
                first, of = which, j
    return first, of, h


@compiled
def _passes_peak(j, start, seen):
    """Whether force or depth of a joint has a peak in a step with these ends."""
    force, depth = NORMAL_RATE + JOINT * j, RATE + JOINT * j
    return start[force] > 0 >= seen[force] or start[depth] > 0 >= seen[depth]


@compiled
def _measure_peaks(j, impact, row, smooth, seen, t, h, new):
    """Locate peaks of force and depth inside a step of ``h`` with ``seen`` at its end.

    ``row`` is that of output at the peak of the force.
    """
    _, pieces, p, laws, (start, _), (_, _, f), _ = smooth
    peaks = (FORCE_PEAK, stepping.PEAK_FORCE, NORMAL), (DEPTH_PEAK, stepping.PEAK_DEPTH, DEPTH)
    for which, column, quantity in peaks:
        before, after = _event(which, j, pieces, start, p), _event(which, j, pieces, seen, p)
        at = quantity + JOINT * j
        if before < 0 <= after and start[at] - before * h > impact[column]:
            length = _locate(which, j, before, after, smooth, t, h, new)
            _try(which, j, smooth, length, new)
            if f[at] > impact[column]:
                impact[column] = f[at]
                if which == FORCE_PEAK:
                    row[0] = t + length
                    _record(row, new, pieces, f, p, laws)


@compiled
def advance(state, y, joints, p, laws, integrals, tolerance, rows, impacts, events):
    """Step to the time of each row and fill it; return the number of rows filled and the ending."""
    t, h, pieces = state[stepping.TIME], state[stepping.STEP], _pieces(joints, laws)
    here, there = rigid.new_slopes(len(laws)), rigid.new_slopes(len(laws))
    new, trial = np.zeros(len(y)), np.zeros(len(y))
    scratch = np.zeros((STAGES, len(y))), np.zeros(len(y)), np.zeros(len(here[0]))
    known, idle, done = False, 0, 0
    while done < len(rows):
        if int(state[stepping.IMPACTS]) == len(impacts):
            return done, stepping.FULL
        if not known:
            _move(y, pieces, p, laws, True, here[0], here[1])
            known = True
        if t >= rows[done, 0]:
            _record(rows[done], y, pieces, here[0], p, laws)
            done += 1
            continue
        smooth = y, pieces, p, laws, here, scratch, integrals
        landing = t + h * 1.000001 >= rows[done, 0]
        length = rows[done, 0] - t if landing else h
        _step(smooth, length, new)
        state[stepping.STEPS] += 1
        error = _error(scratch[0], y, pieces, joints, here[0], state[REACH], tolerance, p, laws)
        if not error <= 1.0:
            h = length * (max(0.2, 0.9 / fifth_root(error)) if error < inf else 0.1)
            if h > 1e-15 * t:
                continue
            return done, stepping.FAILED
        _move(new, pieces, p, laws, True, there[0], there[1])
        grown = length * min(5.0, 0.9 / fifth_root(max(error, 1e-12)))
        h = max(h, grown) if landing else grown
        event, of, length = _first_event(smooth, there[0], t, length, trial)
        if event >= 0:
            landing, known = False, False
            _step(smooth, length, new)
            _move(new, pieces, p, laws, False, there[0], there[1])
            idle = idle + 1 if length <= 1e-14 * t else 0
            if idle > 100:
                return done, stepping.FAILED
        seen = there[0]
        for j in range(len(pieces)):
            if pieces[j][0]:
                if seen[DEPTH + JOINT * j] > laws[j][1]:
                    state[stepping.LIMIT] = laws[j][1]
                    return done, stepping.TOO_DEEP
                if _passes_peak(j, here[0], seen):
                    at = int(joints[j, NUMBER])
                    row = events[at, stepping.PEAK]
                    _measure_peaks(j, impacts[at], row, smooth, seen, t, length, trial)
        t = state[stepping.TIME] = rows[done, 0] if landing else t + length
        y[:] = new
        for j in range(len(pieces)):
            if pieces[j][0]:
                at = JOINT * j
                _attend(j, state, y, joints)
                if stepping.follow_impact(impacts, state, seen[NORMAL + at], seen[DEPTH + at]):
                    row = stepping.event_row(events, state, stepping.PEAK)
                    _record(row, y, pieces, seen, p, laws)
        if event >= 0:
            h = _turn(event, of, seen, state, y, joints, h, p, laws, (impacts, events))
            pieces = _pieces(joints, laws)
        here, there = there, here
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
    if seen[RATE + JOINT * j] <= 0:  # it grazes, and goes on in flight
        return h
    r = norm(z[0], z[1])
    nx, ny, wx, wy = z[0] / r, z[1] / r, rates[0], rates[1]
    z[0], z[1] = 0.0, angle_of(ny, nx)
    rates[0], rates[1] = nx * wx + ny * wy, (nx * wy - ny * wx) / law[1]
    one[CONTACT], one[APPROACH], one[NUMBER] = 1.0, rates[0], state[stepping.IMPACTS]
    one[BRANCH] = friction_branch(seen[SLIDING + JOINT * j], p.v0, p.v1)
    stepping.begin_impact(impacts, state, state[stepping.TIME], rates[0])
    impacts[int(one[NUMBER]), stepping.JOINT] = j
    row = stepping.event_row(events, state, stepping.START)
    _record(row, y, _pieces(joints, laws), seen, p, laws)
    (ny, nx), phi = sine_cosine(z[1]), (seen[SINE], seen[COSINE])
    one[DEEP] = impact_depth(j, y[0], phi, nx, ny, rates[0], p, laws)
    return min(h, 0.1 * one[DEEP] / rates[0])


def stepper(
    scene: Scene, laws: Laws, horizon: float, tolerance: float
) -> tuple[NDArray[np.float64], Callable]:
    """State at t = 0, and the loop that steps it, for ``advance_in_blocks``; ``horizon`` in s."""
    p, clearances = scene.constants(), (scene.clearance, scene.crank_clearance or 0.0)[: len(laws)]
    integrals = (0,) * (2 * len(laws) + (scene.crank_speed is not None))
    unknowns = 1 + 2 * len(laws)
    state, joints = np.zeros(stepping.STATE), np.zeros((len(laws), 5))
    y, (f, k) = np.zeros(2 * unknowns + len(integrals)), rigid.new_slopes(len(laws))
    y[0], y[unknowns] = scene.initial_crank_angle, scene.starting_speed
    y[1:3] = scene.initial_eccentricity
    accelerate(y, joints, p, laws, f, k)
    for j, clearance in enumerate(clearances):
        joints[j, DEEP] = clearance
        reach = sqrt(norm(f[1 + 2 * j], f[2 + 2 * j]) * clearance)
        state[REACH] = max(state[REACH], reach, clearance / horizon)
    state[stepping.STEP] = min(1e-3 * scene.clearance / state[REACH], horizon)
    return state, partial(advance, state, y, joints, p, laws, integrals, tolerance)


def blocks(
    scene: Scene, laws: Laws, times: list[NDArray[np.float64]], tolerance: float
) -> Iterator[stepping.Block]:
    """Blocks of output rows at ``times`` of the scene with its clearance joints and packed laws."""
    state, loop = stepper(scene, laws, times[-1][-1], tolerance)
    failure, columns = f"no step is small enough for tolerance {tolerance:g}", len(ALL_COLUMNS)
    return stepping.advance_in_blocks(loop, times, state, failure, columns)
