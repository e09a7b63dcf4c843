"""Events and peaks of rigid links inside a step, located on the step's polynomial.

The surfaces of a joint meet or part; its sliding speed leaves a branch of the friction law; its
force and its depth have peaks. The signs of event functions at the step's points show whether there
is an event between two of them: two events of one kind there, such as a touch shorter than a fifth
of a step, are not seen.
"""

from math import inf

import numpy as np

from study.compiled import inner
from study.mechanism import stepping
from study.mechanism.collocation import inside
from study.mechanism.equations import move, record
from study.mechanism.radau import POINTS, STAGES

# From NumPy, since numba compiles a function again for each of Python's own whole numbers.
SURFACES, UPWARDS, DOWNWARDS, FORCE_PEAK, DEPTH_PEAK = np.arange(5)
"""Events: the surfaces meet or part, the sliding speed leaves the friction branch, peaks."""
NO_EVENT = np.int64(-1)
OF_DEPTH, OF_RATE, OF_SLIDING, OF_NORMAL_RATE = range(4)
"""Places of the quantities that show events, at a point of a step."""
TAIL = 0.001
"""Share at the end of a step, which ends close to an event, where the event function is linear."""


@inner
def _shown(joint):
    """Quantities of a joint that show events."""
    return joint.depth, joint.rate, joint.sliding, joint.normal_rate


@inner
def mark(i, joints, work):
    """Keep the quantities that show events at point ``i`` of a step."""
    for j in range(len(joints)):
        marks = work.marks[i, j]
        marks[OF_DEPTH], marks[OF_RATE], marks[OF_SLIDING], marks[OF_NORMAL_RATE] = _shown(
            joints[j]
        )


@inner
def event_value(event, mode, shown, p):
    """Event function of a joint, negative before the event and positive after it."""
    contact, branch, _ = mode
    if event == SURFACES:
        return -shown[OF_DEPTH] if contact else shown[OF_DEPTH]
    if not contact:
        return -1.0
    if event == FORCE_PEAK:
        return -shown[OF_NORMAL_RATE]
    if event == DEPTH_PEAK:
        return -shown[OF_RATE]
    bounds = (-inf, -p.v1, -p.v0, p.v0, p.v1, inf)  # of the branches -2 to 2
    if event == UPWARDS:
        return shown[OF_SLIDING] - bounds[branch + 3]
    return bounds[branch + 2] - shown[OF_SLIDING]


@inner
def evaluate(work, h, x, modes, p, laws):
    """Motion and its parts at the share ``x`` of a step, where ``trial`` is the state."""
    inside(work, h, x)
    return move(work.trial, modes, p, laws)


@inner
def _value_at(event, j, x, work, h, modes, p, laws):
    """Event function of a joint at the share ``x`` of a step."""
    motion, _ = evaluate(work, h, x, modes, p, laws)
    return event_value(event, modes[j], _shown(motion.joints[j]), p)


@inner
def _locate(event, j, low, high, work, h, modes, p, laws):
    """Share of a step, between two, at which an event function turns positive.

    By the Illinois form of false position, on the step's polynomial: the value at an end that stays
    twice is halved, so that both ends close in. The share returned is just after the event, so that
    the next mode begins beyond it.
    """
    before = _value_at(event, j, low, work, h, modes, p, laws)
    after, side = _value_at(event, j, high, work, h, modes, p, laws), 0
    if before > -1e-9 * after:  # the mode begins on the event: its value is rounding
        before = -after
    while high - low > 1e-12 + 1e-9 * high:
        middle = (low * after - high * before) / (after - before)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        value = _value_at(event, j, middle, work, h, modes, p, laws)
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
def first_event(work, h, modes, p, laws):
    """First event in a step or `NO_EVENT`, its joint, and the share of the step where it is."""
    first, of_joint, share = NO_EVENT, 0, inf
    for j in range(len(modes)):
        for event in (SURFACES, UPWARDS, DOWNWARDS):
            low = 0.0
            for i in range(STAGES):
                if low < share and event_value(event, modes[j], work.marks[i, j], p) >= 0:
                    at = _locate(event, j, low, POINTS[i], work, h, modes, p, laws)
                    if at < share:
                        first, of_joint, share = event, j, at
                    break
                low = POINTS[i]
    return first, of_joint, share


@inner
def measure_peaks(j, impact, row, work, t, h, start, modes, p, laws):
    """Locate peaks of force and depth inside a step that begins at ``t`` with ``start``.

    ``row`` is that of output at the peak of the force.
    """
    for event in (FORCE_PEAK, DEPTH_PEAK):
        low, before = 0.0, event_value(event, modes[j], _shown(start), p)
        for i in range(STAGES):
            value = event_value(event, modes[j], work.marks[i, j], p)
            if before < 0 <= value:
                share = _locate(event, j, low, POINTS[i], work, h, modes, p, laws)
                motion, parts = evaluate(work, h, share, modes, p, laws)
                depth, normal = motion.joints[j].depth, motion.joints[j].normal
                impact[stepping.PEAK_DEPTH] = max(impact[stepping.PEAK_DEPTH], depth)
                if normal > impact[stepping.PEAK_FORCE]:
                    impact[stepping.PEAK_FORCE] = normal
                    row[0] = t + share * h
                    record(row, work.trial, motion, parts, p, laws)
            low, before = POINTS[i], value


@inner
def refine(event, j, work, h, modes, p, laws):
    """Share of a step, which ends close to an event, at which it would end on the event.

    It is where a line through the event function at the end, and `TAIL` before it, vanishes. A line
    that leads far away is not trusted: the step stays as it is.
    """
    before = _value_at(event, j, 1 - TAIL, work, h, modes, p, laws)
    after = event_value(event, modes[j], work.marks[STAGES - 1, j], p)
    share = 1 - TAIL * after / (after - before)
    return share if abs(share - 1) < 0.1 else 1.0
