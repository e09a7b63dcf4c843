"""Events and peaks of rigid links inside a step, located on the step's polynomial.

The surfaces meet or part; the sliding speed leaves the friction regime; force and
depth have peaks. The signs of event functions at the step's points show whether there
is an event between two of them: two events of one kind there, such as a touch shorter than a fifth
of a step, are not seen.
"""

from math import inf

import numpy as np

from study.compiled import inner
from study.mechanism.collocation import POINTS, STAGES, inside
from study.mechanism.rigid import motion, write_output

# From NumPy, since numba compiles a function again for each of Python's own whole numbers.
SURFACES, UPWARDS, DOWNWARDS, FORCE_PEAK, DEPTH_PEAK = np.arange(5)
"""Events: the surfaces meet or part, the sliding speed leaves the friction regime, peaks."""
NO_EVENT = np.int64(-1)
MARK = np.dtype([(name, float) for name in ("depth", "rate", "sliding", "normal_rate")])
"""What shows the events of the joint, at a point of a step."""
TAIL = 0.001
"""Share at the end of a step, which ends close to an event, where the event function is linear."""


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
    """Motion and its parts at the share ``x`` of a step, where ``trial`` is the state."""
    inside(work, h, x)
    work.evaluations += 1
    return motion(work.trial, contact, p, law)


@inner
def _value_at(event, x, work, h, contact, p, law):
    """Event function of the joint at the share ``x`` of a step."""
    state, _ = evaluate(work, h, x, contact, p, law)
    return event_value(event, contact, state.joint, p)


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
def measure_peaks(impact, row, work, t, h, start, contact, p, law):
    """Locate peaks of force and depth inside a step that begins at ``t`` with ``start``.

    ``row`` is that of output at the peak of the force.
    """
    for event in (FORCE_PEAK, DEPTH_PEAK):
        low, before = 0.0, event_value(event, contact, start, p)
        for i in range(STAGES):
            value = event_value(event, contact, work.marks[i], p)
            if before < 0 <= value:
                share = _locate(event, low, POINTS[i], work, h, contact, p, law)
                state, parts = evaluate(work, h, share, contact, p, law)
                depth, normal = state.joint.depth, state.joint.normal
                impact.peak_depth = max(impact.peak_depth, depth)
                if normal > impact.peak_force:
                    impact.peak_force = normal
                    row.time = t + share * h
                    write_output(row, work.trial, state, parts, p)
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
