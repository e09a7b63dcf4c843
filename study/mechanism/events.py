"""Stepping rigid links: smooth pieces between located events.

Between impacts, separations and kinks of the friction law the equations of one clearance joint
(`rigid`) or two (`two_joints`) are smooth. Such a piece is integrated by `collocation` with the
exact Jacobian. Its end is looked for on the last step's polynomial, and the step is then repeated
with that length. Rows of output are read from the polynomial too, so that they change no step.

A state is (theta, two coordinates of each joint), their rates, the energies lost to damping and
friction in each joint, and the drive's work. The slider's joint comes first, the crank's second.
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
from study.mechanism.angles import angle_of, norm, sine_cosine, sixth_root
from study.mechanism.collocation import (
    POINTS,
    STAGES,
    estimate,
    factorise,
    fields,
    finish,
    guess,
    improve,
    inside,
    largest,
    stage,
)
from study.mechanism.free_impact import impact_depth
from study.mechanism.response import ALL_COLUMNS
from study.mechanism.scene import Scene

DRIVEN, BEGAN, LENGTH, SIZE = range(4)
"""Places in the state, before those of all models: of the speed that the drive gives, of the last
step's start and length, and the size of its error, 0 if that was in another piece."""
GROWTH, FAR = 3.0, 1.8
"""Of one step over the last, at most; and from where on the last one tells nothing of this one."""
ITERATIONS = 10
"""Of Newton's method, at most."""
EXACT_ENOUGH = 0.001
"""Error that Newton's method may leave, over what the tolerance allows (found by measuring)."""
SURFACES, UPWARDS, DOWNWARDS, FORCE_PEAK, DEPTH_PEAK = range(5)
"""Events: the surfaces meet or part, the sliding speed leaves the friction branch, peaks."""
UNSOLVED = -2
"""An event that no step up to it was found for; -1 is none."""
OF_DEPTH, OF_RATE, OF_SLIDING, OF_NORMAL_RATE = range(4)
"""Places of what tells events at a point of a step."""
CONTACT, BRANCH, APPROACH, DEEP, NUMBER = range(5)
"""What is known of a joint: in contact or not, friction branch, approach speed, the depth that this
can bring, and the number of the impact."""
ROUNDOFF = 1e-16
Laws = tuple[np.record, ...]
"""A packed law for each clearance joint, slider's and crank's. How many there are is known to the
compiler, so that each number has loops of its own."""


def _move(y, pieces, p, laws):
    """Accelerations, powers and forces of the mechanism with these joints."""
    raise TypeError("in compiled code only")


@overload(_move, inline="always")
def _move_compiled(y, pieces, p, laws):
    if len(pieces) == 1:
        return lambda y, pieces, p, laws: rigid.motion(y, pieces[0], p, laws[0])
    return lambda y, pieces, p, laws: two_joints.motion(y, pieces, p, laws)


def _derive(y, pieces, p, found, parts, k):
    """Fill ``k`` with the derivatives of the accelerations that `_move` found."""
    raise TypeError("in compiled code only")


@overload(_derive, inline="always")
def _derive_compiled(y, pieces, p, found, parts, k):
    if len(pieces) == 1:
        return lambda y, pieces, p, found, parts, k: rigid.derive(y, pieces[0], p, found, parts, k)
    return lambda y, pieces, p, found, parts, k: two_joints.derive(y, pieces, p, found, parts, k)


def _record(row, y, pieces, found, parts, p):
    """Fill a row of output, which has its time already."""
    raise TypeError("in compiled code only")


@overload(_record, inline="always")
def _record_compiled(row, y, pieces, found, parts, p):
    if len(pieces) == 1:
        return lambda row, y, pieces, found, parts, p: rigid.record(
            row, y, pieces[0][0], found, parts, p
        )
    return lambda row, y, pieces, found, parts, p: two_joints.record(row, y, found, parts, p)


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


@compiled
def motion(work, p, laws):
    """Accelerations, powers and forces at the state at hand, with the derivatives in ``k``."""
    pieces = _pieces(work.joints, laws)
    found, parts = _move(work.y, pieces, p, laws)
    _derive(work.y, pieces, p, found, parts, work.k)
    return found


@compiled
def _weigh(work, pieces, seen, driven, tolerance, p, laws):
    """Fill ``weights`` with the inverses of the errors of z and z' that ``tolerance`` allows.

    Places count by the clearance, a depth by the deepest that this impact's approach speed can
    bring, speeds by a tenth of what the drive gives over the clearance (found by measuring).
    """
    y, weights, n = work.start, work.weights, 1 + 2 * len(pieces)
    speed = 1 / (0.1 * tolerance * driven + ROUNDOFF * p.l1 * abs(y[n]))
    weights[0] = p.l1 / (tolerance * laws[0].clearance + ROUNDOFF * p.l1 * abs(y[0]))
    weights[n] = p.l1 * speed
    for j in range(len(pieces)):
        clearance, at = laws[j].clearance, 1 + 2 * j
        place = 1 / (tolerance * clearance)
        weights[at], weights[at + 1] = place, place
        weights[n + at], weights[n + at + 1] = speed, speed
        if pieces[j][0]:
            weights[at] = 1 / (tolerance * max(work.joints[j, DEEP], seen[j].depth))
            weights[at + 1], weights[n + at + 1] = 1 / tolerance, clearance * speed


@compiled
def _collocate(work, h, pieces, p, laws):
    """Find the accelerations at the points of a step by Newton's method; whether it converged."""
    n, before = 1 + 2 * len(pieces), inf
    factorise(work, h)
    for _ in range(ITERATIONS):
        for i in range(STAGES):
            stage(i, work, h)
            found, _ = _move(work.trial, pieces, p, laws)
            for m in range(n):
                work.residuals[i, m] = found.accelerations[m] - work.rates[1 + i, m]
                work.rates[1 + i, n + m] = found.powers[m]
            _mark(i, found.joints, work)
        improve(work, h)
        size = largest(work)
        if not size < before:
            return size < EXACT_ENOUGH
        left = size * size / (before - size) if before < inf else size
        if left < EXACT_ENOUGH:
            return True
        before = size
    return False


@compiled
def _mark(i, joints, work):
    """Keep what tells events at point ``i`` of a step."""
    for j in range(len(joints)):
        one = work.marks[i, j]
        one[OF_DEPTH], one[OF_RATE] = joints[j].depth, joints[j].rate
        one[OF_SLIDING], one[OF_NORMAL_RATE] = joints[j].sliding, joints[j].normal_rate


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
def _told(which, piece, mark, p):
    """Event function at a point of a step."""
    return _event(
        which, piece, mark[OF_DEPTH], mark[OF_RATE], mark[OF_SLIDING], mark[OF_NORMAL_RATE], p
    )


@compiled
def _look(work, h, x, pieces, p, laws):
    """What is found at the share ``x`` of a step, where ``trial`` is the state."""
    inside(work, h, x)
    return _move(work.trial, pieces, p, laws)


@compiled
def _locate(which, j, low, high, work, h, pieces, p, laws):
    """Share of a step, between two, at which an event function turns positive.

    By false position with halving of a value that stays (Illinois), on the step's polynomial.
    """
    before = after = 0.0
    middle, side, known = low, 0, 0
    while known < 2 or high - low > 1e-12 + 1e-9 * high:
        joint = _look(work, h, middle, pieces, p, laws)[0].joints[j]
        value = _event(
            which, pieces[j], joint.depth, joint.rate, joint.sliding, joint.normal_rate, p
        )
        if known == 0:
            before, middle, known = value, high, 1
            continue
        if known == 1:
            after, known = value, 2
            if before > -1e-9 * after:  # the piece begins on the event, and has left it at once
                before = -after
        elif value < 0:
            after = after / 2 if side < 0 else after
            low, before, side = middle, value, -1
        else:
            before = before / 2 if side > 0 else before
            high, after, side = middle, value, 1
            if value == 0:
                break
        middle = (low * after - high * before) / (after - before)
        if not low < middle < high:
            middle = 0.5 * (low + high)
    return high


@compiled
def _first_event(work, h, pieces, p, laws):
    """Which event of which joint comes first in a step, -1 for none, and at which share of it."""
    first, of, share = -1, 0, inf
    for j in range(len(pieces)):
        for which in (SURFACES, UPWARDS, DOWNWARDS):
            low = 0.0
            for i in range(STAGES):
                if low < share and _told(which, pieces[j], work.marks[i, j], p) >= 0:
                    at = _locate(which, j, low, POINTS[i], work, h, pieces, p, laws)
                    if at < share:
                        first, of, share = which, j, at
                    break
                low = POINTS[i]
    return first, of, share


@compiled
def _measure_peaks(j, impact, row, work, t, h, start, pieces, p, laws):
    """Locate peaks of force and depth inside a step that begins at ``t`` with ``start``.

    ``row`` is that of output at the peak of the force.
    """
    for which in (FORCE_PEAK, DEPTH_PEAK):
        force = which == FORCE_PEAK
        mark = OF_NORMAL_RATE if force else OF_RATE
        rate = start.normal_rate if force else start.rate
        low, rising = 0.0, rate > 0
        for i in range(STAGES):
            if rising and work.marks[i, j, mark] <= 0:
                share = _locate(which, j, low, POINTS[i], work, h, pieces, p, laws)
                found, parts = _look(work, h, share, pieces, p, laws)
                depth, normal = found.joints[j].depth, found.joints[j].normal
                impact[stepping.PEAK_DEPTH] = max(impact[stepping.PEAK_DEPTH], depth)
                if normal > impact[stepping.PEAK_FORCE]:
                    impact[stepping.PEAK_FORCE] = normal
                    row[0] = t + share * h
                    _record(row, work.trial, pieces, found, parts, p)
            low, rising = POINTS[i], work.marks[i, j, mark] > 0


@compiled
def _end_step(work, h, pieces, p, laws):
    """End a step of ``h`` at its first event, or as it is.

    Returns which event it was (-1 for none, `UNSOLVED` if Newton's method found no shorter step)
    and whose, the step's length, and what `_move` finds at its end.
    """
    event, of = -1, 0
    for again in range(3):  # the whole step, to near its first event, to the event
        finish(work, h)
        seen, parts = _move(work.y, pieces, p, laws)
        _mark(STAGES - 1, seen.joints, work)
        if again == 0:
            event, of, share = _first_event(work, h, pieces, p, laws)
        elif again == 1:
            share = _nearer(event, of, work, h, pieces, p, laws)
        if event < 0 or again == 2:
            break
        guess(work, 0.0, share)
        h *= share
        if not _collocate(work, h, pieces, p, laws):
            event = UNSOLVED
            break
    return event, of, h, seen, parts


@compiled
def advance(state, work, p, laws, tolerance, horizon, rows, impacts, events):
    """Step to the time of each row and fill it; return the number of rows filled and the ending.

    Rows are filled from the polynomial of the step that they are in; the last step ends at the
    ``horizon``.
    """
    t, h, pieces = state[stepping.TIME], state[stepping.STEP], _pieces(work.joints, laws)
    found, done = motion(work, p, laws), 0
    while done < len(rows):
        if rows[done, 0] <= t:
            earlier, length = _pieces(work.was, laws), state[LENGTH]
            share = (rows[done, 0] - state[BEGAN]) / length
            seen, parts = _look(work, length, share, earlier, p, laws)
            _record(rows[done], work.trial, earlier, seen, parts, p)
            done += 1
            continue
        if int(state[stepping.IMPACTS]) == len(impacts):
            return done, stepping.FULL
        landing = t + h * 1.000001 >= horizon
        length = horizon - t if landing else h
        _begin(
            work, found, state[SIZE] > 0 and length < FAR * state[LENGTH], length / state[LENGTH]
        )
        _weigh(work, pieces, found.joints, state[DRIVEN], tolerance, p, laws)
        state[stepping.STEPS] += 1
        size = inf
        if _collocate(work, length, pieces, p, laws):
            estimate(work, length)
            size = largest(work)
        if not size <= 1.0:
            h = length * (max(0.2, 0.9 / sixth_root(size)) if size < inf else 0.5)
            work.most = 1.0
            state[stepping.STEP] = h
            if h > 1e-15 * t:
                continue
            return done, stepping.FAILED
        size = max(size, 1e-6)
        growth = 0.9 / sixth_root(size)
        if state[SIZE] > 0:  # what the last two steps foretell (Hairer and Wanner, sec. IV.8)
            foretold = length / state[LENGTH] * sixth_root(state[SIZE] / size)
            growth = min(growth, growth * foretold)
        h, work.most = length * min(growth, work.most), GROWTH
        event, of, length, seen, parts = _end_step(work, length, pieces, p, laws)
        if event == UNSOLVED:  # once more, by a step that ends before the event
            for m in range(len(work.y)):
                work.y[m] = work.start[m]
            state[SIZE], h, work.most = 0.0, 0.5 * length, 1.0
            state[stepping.STEP] = h
            if h > 1e-15 * t:
                continue
            return done, stepping.FAILED
        if event >= 0:
            landing = False
            work.idle = work.idle + 1 if length <= 1e-14 * t else 0.0
            if work.idle > 100:
                return done, stepping.FAILED
        for j in range(len(pieces)):
            if pieces[j][0]:
                at = int(work.joints[j, NUMBER])
                row, start = events[at, stepping.PEAK], found.joints[j]
                _measure_peaks(j, impacts[at], row, work, t, length, start, pieces, p, laws)
                deepest = max(seen.joints[j].depth, impacts[at, stepping.PEAK_DEPTH])
                if deepest > laws[j].clearance:
                    state[stepping.LIMIT] = laws[j].clearance
                    return done, stepping.TOO_DEEP
        state[BEGAN], state[LENGTH], state[SIZE] = t, length, size if event < 0 else 0.0
        t = state[stepping.TIME] = horizon if landing else t + length
        for j in range(len(pieces)):
            if pieces[j][0]:
                _attend(j, state, work)
                joint = seen.joints[j]
                if stepping.follow_impact(impacts, state, joint.normal, joint.depth):
                    row = stepping.event_row(events, state, stepping.PEAK)
                    _record(row, work.y, pieces, seen, parts, p)
        if event < 0:
            _derive(work.y, pieces, p, seen, parts, work.k)
            found = seen
        else:
            h = _turn(event, of, seen, parts, state, work, h, p, laws, (impacts, events))
            pieces = _pieces(work.joints, laws)
            found = motion(work, p, laws)
        state[stepping.STEP] = h
    return done, stepping.FINE


@compiled
def _begin(work, found, smooth, ratio):
    """Begin a step at the state at hand, with guesses of the accelerations at its points."""
    n = len(work.x)
    for m in range(len(work.y)):
        work.start[m] = work.y[m]
    for j in range(len(work.joints)):
        for m in range(NUMBER + 1):
            work.was[j, m] = work.joints[j, m]
    for m in range(n):
        work.rates[0, m], work.rates[0, n + m] = found.accelerations[m], found.powers[m]
    if smooth:
        guess(work, 1.0, ratio)
    else:
        for i in range(STAGES):
            for m in range(n):
                work.rates[1 + i, m] = work.rates[0, m]


@compiled
def _nearer(which, j, work, h, pieces, p, laws):
    """Share of a step that ends close to an event at which it would end on it."""
    at, end = _look(work, h, 0.999, pieces, p, laws)[0].joints[j], work.marks[STAGES - 1, j]
    before = _event(which, pieces[j], at.depth, at.rate, at.sliding, at.normal_rate, p)
    after = _told(which, pieces[j], end, p)
    share = 1 - 0.001 * after / (after - before)
    return share if abs(share - 1) < 0.1 else 1.0


@compiled
def _attend(j, state, work):
    """Make a joint's impact the one at hand, with the energy lost in that joint."""
    y, lost = work.y, 2 * len(work.x) + 2 * j
    state[stepping.LOST_DAMPING], state[stepping.LOST_FRICTION] = y[lost], y[lost + 1]
    state[stepping.AT_HAND] = work.joints[j, NUMBER]


@compiled
def _turn(event, j, seen, parts, state, work, h, p, laws, table):
    """Begin the smooth piece that follows an event, in its coordinates; return its first step.

    ``table`` has the impacts and their rows of output.
    """
    (impacts, events), y, one, law = table, work.y, work.joints[j], laws[j]
    at = 2 + 2 * len(laws) + 2 * j
    z, rates = y[1 + 2 * j : 3 + 2 * j], y[at : at + 2]
    if event != SURFACES:
        one[BRANCH] += 1 if event == UPWARDS else -1
        return h
    _attend(j, state, work)
    if one[CONTACT] > 0:
        stepping.end_impact(impacts, state, -rates[0])
        row = stepping.event_row(events, state, stepping.END)
        _record(row, y, _pieces(work.joints, laws), seen, parts, p)
        ny, nx = sine_cosine(z[1])
        rate, across = rates[0], law.clearance * rates[1]
        z[0], z[1] = law.clearance * nx, law.clearance * ny
        rates[0], rates[1] = rate * nx - across * ny, rate * ny + across * nx
        one[CONTACT], one[BRANCH] = 0.0, 0.0
        return h
    if seen.joints[j].rate <= 0:  # it grazes, and goes on in flight
        return h
    r = norm(z[0], z[1])
    nx, ny, wx, wy = z[0] / r, z[1] / r, rates[0], rates[1]
    z[0], z[1] = 0.0, angle_of(ny, nx)
    rates[0], rates[1] = nx * wx + ny * wy, (nx * wy - ny * wx) / law.clearance
    one[CONTACT], one[APPROACH], one[NUMBER] = 1.0, rates[0], state[stepping.IMPACTS]
    one[BRANCH] = friction_branch(seen.joints[j].sliding, p.v0, p.v1)
    stepping.begin_impact(impacts, state, state[stepping.TIME], rates[0])
    impacts[int(one[NUMBER]), stepping.JOINT] = j
    row = stepping.event_row(events, state, stepping.START)
    _record(row, y, _pieces(work.joints, laws), seen, parts, p)
    (ny, nx), phi = sine_cosine(z[1]), (seen.coupler[0], seen.coupler[1])
    one[DEEP] = impact_depth(j, y[0], phi, nx, ny, rates[0], p, laws)
    return min(h, 0.1 * one[DEEP] / rates[0])


def stepper(
    scene: Scene, laws: Laws, horizon: float, tolerance: float
) -> tuple[NDArray[np.float64], Callable]:
    """State at t = 0, and the loop that steps it, for ``advance_in_blocks``; ``horizon`` in s."""
    p, clearances = scene.constants(), (scene.clearance, scene.crank_clearance or 0.0)[: len(laws)]
    unknowns, state = 1 + 2 * len(laws), np.zeros(stepping.STATE)
    own = (
        *((name, float, (len(laws), 5)) for name in ("joints", "was")),
        ("most", float),
        ("idle", float),
    )
    marks = "marks", float, (STAGES, len(laws), 4)
    work = np.zeros(1, [*fields(unknowns), *own, marks]).view(np.recarray)[0]
    work.y[0], work.y[unknowns] = scene.initial_crank_angle, scene.starting_speed
    work.y[1:3] = scene.initial_eccentricity
    accelerations = motion(work, p, laws).accelerations
    for j, clearance in enumerate(clearances):
        work.joints[j, DEEP] = clearance
        driven = sqrt(norm(*accelerations[1 + 2 * j : 3 + 2 * j]) * clearance)
        state[DRIVEN] = max(state[DRIVEN], driven, clearance / horizon)
    state[stepping.STEP] = min(1e-3 * scene.clearance / state[DRIVEN], horizon)
    work.start[:], work.was[:], state[LENGTH], work.most = work.y, work.joints, 1.0, GROWTH
    return state, partial(advance, state, work, p, laws, tolerance, horizon)


def blocks(
    scene: Scene, laws: Laws, times: NDArray[np.float64], tolerance: float
) -> Iterator[stepping.Block]:
    """Blocks of output rows at ``times`` of the scene with its clearance joints and packed laws."""
    state, loop = stepper(scene, laws, times[-1], tolerance)
    failure, columns = f"no step is small enough for tolerance {tolerance:g}", len(ALL_COLUMNS)
    return stepping.advance_in_blocks(loop, times, state, failure, columns)
