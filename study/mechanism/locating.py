"""Events and peaks of rigid links inside a step, located on the step's polynomial.

The surfaces of a joint meet or part; its sliding speed leaves a branch of the friction law; its
force and its depth have peaks. The step's points show whether there is an event.
"""

from math import inf

from study.compiled import compiled
from study.mechanism import stepping
from study.mechanism.collocation import POINTS, STAGES, inside
from study.mechanism.equations import move, record

SURFACES, UPWARDS, DOWNWARDS, FORCE_PEAK, DEPTH_PEAK = range(5)
"""Events: the surfaces meet or part, the sliding speed leaves the friction branch, peaks."""
OF_DEPTH, OF_RATE, OF_SLIDING, OF_NORMAL_RATE = range(4)
"""Places of the quantities that show events, at a point of a step."""


@compiled
def mark(i, joints, work):
    """Keep the quantities that show events at point ``i`` of a step."""
    for j in range(len(joints)):
        one = work.marks[i, j]
        one[OF_DEPTH], one[OF_RATE] = joints[j].depth, joints[j].rate
        one[OF_SLIDING], one[OF_NORMAL_RATE] = joints[j].sliding, joints[j].normal_rate


@compiled
def event_value(which, piece, depth, rate, sliding, normal_rate, p):
    """Event function of a joint, negative before the event and positive after it."""
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
def told(which, piece, mark, p):
    """Event function at a point of a step."""
    return event_value(
        which, piece, mark[OF_DEPTH], mark[OF_RATE], mark[OF_SLIDING], mark[OF_NORMAL_RATE], p
    )


@compiled
def look(work, h, x, pieces, p, laws):
    """What is found at the share ``x`` of a step, where ``trial`` is the state."""
    inside(work, h, x)
    return move(work.trial, pieces, p, laws)


@compiled
def _locate(which, j, low, high, work, h, pieces, p, laws):
    """Share of a step, between two, at which an event function turns positive.

    By the Illinois form of false position, on the step's polynomial.
    """
    before = after = 0.0
    middle, side, known = low, 0, 0
    while known < 2 or high - low > 1e-12 + 1e-9 * high:
        joint = look(work, h, middle, pieces, p, laws)[0].joints[j]
        value = event_value(
            which, pieces[j], joint.depth, joint.rate, joint.sliding, joint.normal_rate, p
        )
        if known == 0:
            before, middle, known = value, high, 1
            continue
        if known == 1:
            after, known = value, 2
            if before > -1e-9 * after:  # the piece begins on the event
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
def first_event(work, h, pieces, p, laws):
    """First event in a step, -1 for none, its joint, and the share of the step where it is."""
    first, of, share = -1, 0, inf
    for j in range(len(pieces)):
        for which in (SURFACES, UPWARDS, DOWNWARDS):
            low = 0.0
            for i in range(STAGES):
                if low < share and told(which, pieces[j], work.marks[i, j], p) >= 0:
                    at = _locate(which, j, low, POINTS[i], work, h, pieces, p, laws)
                    if at < share:
                        first, of, share = which, j, at
                    break
                low = POINTS[i]
    return first, of, share


@compiled
def measure_peaks(j, impact, row, work, t, h, start, pieces, p, laws):
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
                found, parts = look(work, h, share, pieces, p, laws)
                depth, normal = found.joints[j].depth, found.joints[j].normal
                impact[stepping.PEAK_DEPTH] = max(impact[stepping.PEAK_DEPTH], depth)
                if normal > impact[stepping.PEAK_FORCE]:
                    impact[stepping.PEAK_FORCE] = normal
                    row[0] = t + share * h
                    record(row, work.trial, pieces, found, parts, p)
            low, rising = POINTS[i], work.marks[i, j, mark] > 0


@compiled
def nearer(which, j, work, h, pieces, p, laws):
    """Share of a step, which ends close to an event, at which it would end on the event."""
    at, end = look(work, h, 0.999, pieces, p, laws)[0].joints[j], work.marks[STAGES - 1, j]
    before = event_value(which, pieces[j], at.depth, at.rate, at.sliding, at.normal_rate, p)
    after = told(which, pieces[j], end, p)
    share = 1 - 0.001 * after / (after - before)
    return share if abs(share - 1) < 0.1 else 1.0
