"""Stepping rigid links: smooth motion between located events.

The joint is in flight or in contact, and a contact is in one of five friction regimes, -2 to 2.
This contact state changes at events, where an event function turns positive::

    state    event                              event function    next state
    flight   the surfaces meet                  depth             contact, if depth' > 0
    contact  the surfaces part                  -depth            flight
    contact  the sliding speed v leaves the     v - upper bound   next higher regime
             friction regime                    lower bound - v   next lower regime

The bounds between the regimes are -v1, -v0, v0 and v1. In contact, peaks of the force and of the
depth are located too, by -(normal force)' and -depth'; they do not change the contact state.

Between events the equations (`rigid`) are smooth, and `collocation` integrates them with the exact
Jacobian. An event is located on the polynomial of the step that contains it. The step is then
repeated with that length, so that an event is as exact as the end of a step. Signs of the event
functions at the points of a step show whether there is an event between two of them: two events of
one kind there, such as a touch shorter than a fifth of a step, are not seen. Rows of output are
read from the polynomial too, so that they change no step.
"""

from collections.abc import Callable, Iterator
from functools import partial
from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from study.compiled import compiled, inner
from study.contact.forces import friction_regime
from study.mechanism import collocation, rigid, stepping
from study.mechanism.angles import angle_of, norm, sine_cosine, sixth_root
from study.mechanism.collocation import AT_START, POINTS, STAGES
from study.mechanism.rigid import FIRST, FIRST_RATE, OMEGA, SECOND, SECOND_RATE, THETA
from study.mechanism.scene import Scene

# From NumPy, since numba compiles a function again for each of Python's own whole numbers.
SURFACES, UPWARDS, DOWNWARDS, FORCE_PEAK, DEPTH_PEAK = np.arange(5)
"""Events: the surfaces meet or part; the sliding speed exceeds the upper bound of its friction
regime, or falls below the lower one; the normal force or the depth has a peak."""
NO_EVENT = np.int64(-1)
MARK = np.dtype([(name, float) for name in ("depth", "rate", "sliding", "normal_rate")])
"""What shows the events of the joint, at a point of a step."""
TAIL = 0.001  # share at the end of a step near an event where the event function is linear
OWN = "driven", "began", "length", "size"
"""Numbers of the state besides those of all models: the speed that the drive gives; the last step's
start, its length, and the size of its error, 0 if it was in another contact state."""
GROWTH, FAR = 3.0, 1.8  # largest ratio of a step to the last one; at which that one gives a guess
SAFETY, SHRINKING = 0.9, 0.2
"""Share of the step at which the error would be the tolerance's, and smallest ratio of a step that
is tried again to the one tried (Hairer and Wanner, sec. IV.8)."""
LEAST_SIZE = 1e-6  # errors below it are rounding, and say nothing about the next step
ITERATIONS = 10  # at most, of Newton's method
EXACT_ENOUGH = 0.001
"""Error that Newton's method may leave, over what the tolerance allows: at 0.02 it was the largest
error (found by measuring)."""
UNSOLVED = NO_EVENT - 1  # an event to which no step was found
MOST_IDLE = 100  # events in a row without a change of time: more will never end
ROUNDOFF = 1e-16


@inner
def mark(i, joint, work):
    """Keep what shows events at point ``i`` of a step."""
    kept = work.marks[i]
    kept.depth, kept.rate = joint.depth, joint.rate
    kept.sliding, kept.normal_rate = joint.sliding, joint.normal_rate


@inner
def event_value(event, contact, joint, p):
    """Event function of the joint, by its motion or a mark: negative before the event."""
    if event == SURFACES:
        return -joint.depth if contact.closed else joint.depth
    if not contact.closed:
        return -1.0
    if event == FORCE_PEAK:
        return -joint.normal_rate
    if event == DEPTH_PEAK:
        return -joint.rate
    bounds = (-inf, -p.v1, -p.v0, p.v0, p.v1, inf)  # of the friction regimes -2 to 2
    if event == UPWARDS:
        return joint.sliding - bounds[contact.regime + 3]
    return bounds[contact.regime + 2] - joint.sliding


@inner
def evaluate(work, h, x, contact, p, law):
    """Motion at the share ``x`` of a step, where ``trial`` is the state."""
    collocation.inside(work, h, x)
    work.evaluations += 1
    return rigid.motion(work.trial, contact, p, law)


@inner
def _value_at(event, x, work, h, contact, p, law):
    """Event function of the joint at the share ``x`` of a step."""
    return event_value(event, contact, evaluate(work, h, x, contact, p, law).joint, p)


@inner
def _locate(event, low, high, work, h, contact, p, law):
    """Share of a step, between two, at which an event function turns positive.

    By the Illinois form of false position, on the step's polynomial: the value at an end that stays
    twice is halved, so that both ends close in. The share returned is just after the event, so that
    the next contact state begins beyond it.
    """
    before = _value_at(event, low, work, h, contact, p, law)
    after, side = _value_at(event, high, work, h, contact, p, law), 0
    if before > -1e-9 * after:  # the state begins on the event: its value is rounding
        before = -after
    while high - low > 1e-12 + 1e-9 * high:
        middle = (low * after - high * before) / (after - before)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        value = _value_at(event, middle, work, h, contact, p, law)
        if value < 0:
            after = after / 2 if side < 0 else after
            low, before, side = middle, value, -1
        else:
            before = before / 2 if side > 0 else before
            high, after, side = middle, value, 1
            if value == 0:
                break
    return high


@inner
def first_event(work, h, contact, p, law):
    """First event in a step or `NO_EVENT`, and the share of the step where it is."""
    first, share = NO_EVENT, inf
    for event in (SURFACES, UPWARDS, DOWNWARDS):
        low = 0.0
        for i in range(STAGES):
            if low < share and event_value(event, contact, work.marks[i], p) >= 0:
                at = _locate(event, low, POINTS[i], work, h, contact, p, law)
                if at < share:
                    first, share = event, at
                break
            low = POINTS[i]
    return first, share


@inner
def measure_peaks(impact, row, work, state, start, contact, p, law):
    """Locate peaks of force and depth inside the last step, which began with ``start``.

    ``row`` is that of output at the peak of the force.
    """
    h = state.length
    for event in (FORCE_PEAK, DEPTH_PEAK):
        low, before = 0.0, event_value(event, contact, start, p)
        for i in range(STAGES):
            value = event_value(event, contact, work.marks[i], p)
            if before < 0 <= value:
                share = _locate(event, low, POINTS[i], work, h, contact, p, law)
                peak = evaluate(work, h, share, contact, p, law)
                impact.peak_depth = max(impact.peak_depth, peak.joint.depth)
                if peak.joint.normal > impact.peak_force:
                    impact.peak_force = peak.joint.normal
                    row.time = state.began + share * h
                    rigid.write_output(row, work.trial, peak, p)
            low, before = POINTS[i], value


@inner
def refine(event, work, h, contact, p, law):
    """Share of a step, which ends close to an event, at which it would end on the event.

    It is where a line through the event function at the end, and `TAIL` before it, vanishes. A line
    that leads far away is not trusted: the step stays as it is.
    """
    before = _value_at(event, 1 - TAIL, work, h, contact, p, law)
    after = event_value(event, contact, work.marks[STAGES - 1], p)
    share = 1 - TAIL * after / (after - before)
    return share if abs(share - 1) < 0.1 else 1.0


@inner
def _collocate(work, h, contact, p, law):
    """Find the accelerations at the points of a step by Newton's method; say if it converged."""
    before = inf
    collocation.factorise(work, h)
    for _ in range(ITERATIONS):
        work.evaluations += STAGES
        for i in range(STAGES):
            collocation.stage(i, work, h)
            motion = rigid.motion(work.trial, contact, p, law)
            for m in range(rigid.UNKNOWNS):
                work.residuals[i, m] = motion.accelerations[m] - work.rates[1 + i, m]
            for m in range(rigid.INTEGRALS):
                work.rates[1 + i, rigid.UNKNOWNS + m] = motion.powers[m]
            mark(i, motion.joint, work)
        collocation.improve(work, h)
        size = collocation.largest(work)
        if not size < before:
            return size < EXACT_ENOUGH
        left = size * size / (before - size) if before < inf else size
        if left < EXACT_ENOUGH:
            return True
        before = size
    return False


@inner
def _try_step(work, h, rates, contact, state, tolerance, p, law):
    """Size of the error of a step of ``h``, over the tolerance; infinite if none was found."""
    y, clearance, (accelerations, powers) = work.y, law.clearance, rates
    for m in range(len(y)):
        work.start[m] = y[m]
    work.joints[rigid.BEFORE] = work.joints[rigid.NOW]
    for m in range(rigid.UNKNOWNS):
        work.rates[AT_START, m] = accelerations[m]
    for m in range(rigid.INTEGRALS):
        work.rates[AT_START, rigid.UNKNOWNS + m] = powers[m]
    # guesses of the accelerations at the points
    if state.size > 0 and h < FAR * state.length:
        collocation.guess(work, 1.0, h / state.length)
    else:
        for i in range(STAGES):
            for m in range(rigid.UNKNOWNS):
                work.rates[1 + i, m] = work.rates[AT_START, m]
    # Weights are the inverses of the errors of z and z' that the tolerance allows. Places are
    # compared with the clearance, a depth with the largest one that the approach speed can lead
    # to, and speeds with a tenth of the speed that the drive gives over the clearance (found by
    # measuring).
    weights = work.weights
    speed = 1 / (0.1 * tolerance * state.driven + ROUNDOFF * p.l1 * abs(y[OMEGA]))
    angle = tolerance * clearance + ROUNDOFF * p.l1 * abs(y[THETA])
    place = 1 / (tolerance * clearance)
    weights[THETA], weights[OMEGA] = p.l1 / angle, p.l1 * speed
    weights[FIRST], weights[SECOND] = place, place
    weights[FIRST_RATE], weights[SECOND_RATE] = speed, speed
    if contact.closed:
        weights[FIRST] = 1 / (tolerance * max(work.joints[rigid.NOW].deep, y[FIRST]))
        weights[SECOND], weights[SECOND_RATE] = 1 / tolerance, clearance * speed
    state.steps += 1
    if not _collocate(work, h, contact, p, law):
        return inf
    collocation.estimate(work, h)
    return collocation.largest(work)


@inner
def _try_again(h, state, work):
    """Shorten the step to ``h``; say if time still changes by it."""
    state.step, work.most = h, 1.0
    return h > 1e-15 * state.time


@inner
def _end_step(work, h, contact, p, law):
    """End a step of ``h`` at its first event, or as it is.

    Returns the event, the step's length, and the motion at its end. The event is `UNSOLVED`, and
    the state that at the start, if Newton's method found no shorter step. The polynomial of the
    whole step places the event only as well as the step's error allows. A step that ends near the
    event places it exactly: it is nearly linear there. The third step ends on the event.
    """
    event = NO_EVENT
    for attempt in range(3):
        collocation.finish(work, h)
        work.evaluations += 1
        motion = rigid.motion(work.y, contact, p, law)
        mark(STAGES - 1, motion.joint, work)
        if attempt == 0:
            event, share = first_event(work, h, contact, p, law)
        elif attempt == 1:
            share = refine(event, work, h, contact, p, law)
        if event < 0 or attempt == 2:
            break
        collocation.guess(work, 0.0, share)
        h *= share
        if not _collocate(work, h, contact, p, law):
            event = UNSOLVED
            for m in range(len(work.y)):
                work.y[m] = work.start[m]
            break
    return event, h, motion


@compiled
def advance(state, work, p, law, tolerance, horizon, rows, impacts, events):
    """Step to the time of each row and fill it; return the number of rows filled and the ending.

    Rows are filled from the polynomial of the step that they are in; the last step ends at the
    ``horizon``.
    """
    (contact, motion), done = rigid.current(work, p, law), 0
    while done < len(rows) and state.steps < state.until:
        t, h = state.time, state.step
        if rows[done].time <= t:
            share = (rows[done].time - state.began) / state.length
            before = rigid.contact_state(work.joints[rigid.BEFORE])
            at = evaluate(work, state.length, share, before, p, law)
            rigid.write_output(rows[done], work.trial, at, p)
            done += 1
            continue
        if state.impacts == len(impacts):
            return done, stepping.FULL
        landing = t + h * 1.000001 >= horizon  # no last step of rounding errors
        length = horizon - t if landing else h
        rates = motion.accelerations, motion.powers
        size = _try_step(work, length, rates, contact, state, tolerance, p, law)
        if not size <= 1.0:
            ratio = max(SHRINKING, SAFETY / sixth_root(size)) if size < inf else 0.5
            if _try_again(length * ratio, state, work):
                continue
            return done, stepping.FAILED
        size = max(size, LEAST_SIZE)
        growth = SAFETY / sixth_root(size)
        if state.size > 0:  # prediction by two steps (Hairer and Wanner, sec. IV.8)
            foretold = length / state.length * sixth_root(state.size / size)
            growth = min(growth, growth * foretold)
        h, work.most = length * min(growth, work.most), GROWTH
        event, length, end = _end_step(work, length, contact, p, law)
        if event == UNSOLVED:  # again, with a step that ends before the event
            state.size = 0.0
            if _try_again(0.5 * length, state, work):
                continue
            return done, stepping.FAILED
        if event >= 0:
            work.idle = work.idle + 1 if length <= 1e-14 * state.time else 0
            if work.idle > MOST_IDLE:
                return done, stepping.FAILED
        state.began, state.length, state.size = t, length, size if event < 0 else 0.0
        state.time = horizon if landing and event < 0 else t + length
        lost = work.y[rigid.LOST_DAMPING], work.y[rigid.LOST_FRICTION]
        state.lost_damping, state.lost_friction = lost
        state.current_impact = work.joints[rigid.NOW].impact
        if _too_deep(work, contact, motion.joint, end, state, (impacts, events), p, law):
            return done, stepping.TOO_DEEP
        if event < 0:
            rigid.derive(work.y, contact, p, end, work.k)
            motion = end
        else:
            h = _change_contact(event, end, state, work, h, p, law, (impacts, events))
            contact, motion = rigid.current(work, p, law)
        state.step = h
    return done, stepping.FINE


@inner
def _too_deep(work, contact, start, end, state, table, p, law):
    """Follow the impact through a step; say if the ball went deeper than one clearance."""
    impacts, events = table
    if not contact.closed:
        return False
    impact, joint = impacts[state.current_impact], end.joint
    row = events[state.current_impact, stepping.PEAK]
    measure_peaks(impact, row, work, state, start, contact, p, law)
    if not (joint.depth <= law.clearance and impact.peak_depth <= law.clearance):
        state.limit = law.clearance
        return True
    if stepping.follow_impact(impacts, state, joint.normal, joint.depth):
        row = stepping.event_row(events, state, stepping.PEAK)
        rigid.write_output(row, work.y, end, p)
    return False


@inner
def _change_contact(event, motion, state, work, h, p, law, table):
    """Begin the contact state that follows an event, in its coordinates; return its first step.

    ``table`` has the impacts and their rows of output.
    """
    (impacts, events), y, joint = table, work.y, work.joints[rigid.NOW]
    e = motion.eccentricity
    if event != SURFACES:
        joint.regime += 1 if event == UPWARDS else -1
        return h
    if joint.closed:
        stepping.end_impact(impacts, state, -e.rate)
        rigid.write_output(stepping.event_row(events, state, stepping.END), y, motion, p)
        across = law.clearance * e.spin
        y[FIRST], y[SECOND] = law.clearance * e.nx, law.clearance * e.ny
        y[FIRST_RATE] = e.rate * e.nx - across * e.ny
        y[SECOND_RATE] = e.rate * e.ny + across * e.nx
        joint.closed, joint.regime = False, 0
        return h
    if e.rate <= 0:  # it grazes, and goes on in flight
        return h
    y[FIRST], y[SECOND] = 0.0, angle_of(e.ny, e.nx)
    y[FIRST_RATE] = e.rate
    y[SECOND_RATE] = (e.nx * e.y_rate - e.ny * e.x_rate) / law.clearance
    joint.closed, joint.approach, joint.impact = True, e.rate, state.impacts
    joint.regime = friction_regime(motion.joint.sliding, p.v0, p.v1)
    stepping.begin_impact(impacts, state, state.time, e.rate)
    rigid.write_output(stepping.event_row(events, state, stepping.START), y, motion, p)
    ny, nx = sine_cosine(y[SECOND])
    joint.deep = rigid.impact_depth(y[THETA], law.clearance * ny, nx, ny, e.rate, p, law)
    return min(h, 0.1 * joint.deep / e.rate)  # a tenth of the time to this depth


def stepper(
    scene: Scene, law: np.record, horizon: float, tolerance: float
) -> tuple[np.recarray, Callable]:
    """State at t = 0, and the loop that steps it, for ``advance_in_blocks``; ``horizon`` in s."""
    p, clearance, state = scene.constants(), scene.clearance, stepping.new_state(*OWN)
    fields = collocation.fields(rigid.UNKNOWNS, rigid.INTEGRALS)
    fields += [("joints", rigid.JOINT, (2,)), ("marks", MARK, (STAGES,)), ("most", float)]
    fields += [("idle", np.int64), ("evaluations", np.int64)]  # evaluations of `rigid.motion`
    (work,) = np.zeros(1, fields).view(np.recarray)
    work.y[THETA], work.y[OMEGA] = scene.initial_crank_angle, scene.starting_speed
    work.y[FIRST], work.y[SECOND] = scene.initial_eccentricity
    _, motion = rigid.current(work, p, law)
    work.joints[rigid.NOW].deep = clearance
    driven = sqrt(norm(*motion.accelerations[FIRST : SECOND + 1]) * clearance)
    state.driven = max(driven, clearance / horizon)
    state.step = min(1e-3 * clearance / state.driven, horizon)
    work.start[:], work.joints[rigid.BEFORE] = work.y, work.joints[rigid.NOW]
    state.length, work.most = 1.0, GROWTH
    return state, partial(advance, state, work, p, law, tolerance, horizon)


def blocks(
    scene: Scene, law: np.record, times: NDArray[np.float64], tolerance: float
) -> Iterator[stepping.Block]:
    """Blocks of output rows at ``times`` of the scene with its clearance joint and a packed law."""
    state, loop = stepper(scene, law, times[-1], tolerance)
    failure = f"no step is small enough for tolerance {tolerance:g}"
    return stepping.advance_in_blocks(loop, times, state, failure)
