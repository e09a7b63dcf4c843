"""Stepping rigid links: smooth motion between located events.

Between impacts, separations and kinks of the friction law the equations of one clearance joint
(`rigid`) or two (`two_joints`) are smooth: the joints keep their contact states. This part is
integrated by `collocation` with the exact Jacobian. Its end is located on the last step's
polynomial (`locating`). The step is then repeated with that length, so that an event is as exact as
the end of a step. Rows of output are read from the polynomial too, so that they change no step.

A state is (theta, two coordinates of each joint), their rates, the energies lost to damping and
friction in each joint, and the drive's work. The slider's joint comes first, the crank's second.
"""

from collections.abc import Callable, Iterator
from functools import partial
from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from study.compiled import compiled, inner
from study.contact.friction import friction_regime
from study.mechanism import collocation, equations, locating, stepping
from study.mechanism.angles import angle_of, norm, sine_cosine, sixth_root
from study.mechanism.collocation import AT_START, STAGES
from study.mechanism.equations import JOINT, THETA, Laws, impact_depth
from study.mechanism.locating import MARK, NO_EVENT, SURFACES, UPWARDS
from study.mechanism.scene import Scene
from study.mechanism.stepping import SLIDER

OWN = "driven", "began", "length", "size"
"""Numbers of the state besides those of all models: the speed that the drive gives; the last step's
start, its length, and the size of its error, 0 if it was in another contact state."""
GROWTH, FAR = 3.0, 1.8
"""Largest ratio of a step to the last one, and largest ratio at which that one gives a guess."""
SAFETY, SHRINKING = 0.9, 0.2
"""Share of the step at which the error would be the tolerance's, and smallest ratio of a step that
is tried again to the one tried (Hairer and Wanner, sec. IV.8)."""
LEAST_SIZE = 1e-6
"""Errors below it are rounding, and say nothing about the next step."""
ITERATIONS = 10
"""Most iterations of Newton's method."""
EXACT_ENOUGH = 0.001
"""Error that Newton's method may leave, over what the tolerance allows: at 0.02 it was the largest
error (found by measuring)."""
UNSOLVED = NO_EVENT - 1
"""An event to which no step was found."""
MOST_IDLE = 100
"""Events in a row without a change of time: more will never end."""
ROUNDOFF = 1e-16


@inner
def _weigh(work, contacts, joints, driven, tolerance, p, laws):
    """Fill ``weights`` with the inverses of the errors of z and z' that ``tolerance`` allows.

    Places are compared with the clearance, a depth with the largest one that the approach speed can
    lead to. Speeds are compared with a tenth of the speed that the drive gives over the clearance
    (found by measuring).
    """
    y, weights, n = work.start, work.weights, 1 + 2 * len(contacts)
    speed = 1 / (0.1 * tolerance * driven + ROUNDOFF * p.l1 * abs(y[n]))
    angle = tolerance * laws[SLIDER].clearance + ROUNDOFF * p.l1 * abs(y[THETA])
    weights[THETA] = p.l1 / angle
    weights[n] = p.l1 * speed
    for j in range(len(contacts)):
        clearance, at = laws[j].clearance, 1 + 2 * j
        place = 1 / (tolerance * clearance)
        weights[at], weights[at + 1] = place, place
        weights[n + at], weights[n + at + 1] = speed, speed
        if contacts[j].closed:
            weights[at] = 1 / (tolerance * max(work.joints[j].deep, joints[j].depth))
            weights[at + 1], weights[n + at + 1] = 1 / tolerance, clearance * speed


@inner
def _collocate(work, h, contacts, p, laws):
    """Find the accelerations at the points of a step by Newton's method; say if it converged."""
    n, before = 1 + 2 * len(contacts), inf
    collocation.factorise(work, h)
    for _ in range(ITERATIONS):
        for i in range(STAGES):
            collocation.stage(i, work, h)
            motion, _ = equations.move(work.trial, contacts, p, laws)
            for m in range(n):
                work.residuals[i, m] = motion.accelerations[m] - work.rates[1 + i, m]
                work.rates[1 + i, n + m] = motion.powers[m]
            locating.mark(i, motion.joints, work)
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
def _try_step(work, h, motion, contacts, state, tolerance, p, laws):
    """Size of the error of a step of ``h``, over the tolerance; infinite if none was found."""
    smooth = state.size > 0 and h < FAR * state.length
    _begin(work, motion, smooth, h / state.length)
    _weigh(work, contacts, motion.joints, state.driven, tolerance, p, laws)
    state.steps += 1
    if not _collocate(work, h, contacts, p, laws):
        return inf
    collocation.estimate(work, h)
    return collocation.largest(work)


@inner
def _next_step(size, length, state, work):
    """Length of the step that follows one with an error of ``size``."""
    growth = SAFETY / sixth_root(size)
    if state.size > 0:  # prediction by two steps (Hairer and Wanner, sec. IV.8)
        foretold = length / state.length * sixth_root(state.size / size)
        growth = min(growth, growth * foretold)
    h = length * min(growth, work.most)
    work.most = GROWTH
    return h


@inner
def _try_again(h, state, work):
    """Shorten the step to ``h``; say if time still changes by it."""
    state.step, work.most = h, 1.0
    return h > 1e-15 * state.time


@inner
def _is_idle(length, state, work):
    """Whether too many events in a row, with this one at the end of ``length``, changed no time."""
    work.idle = work.idle + 1 if length <= 1e-14 * state.time else 0
    return work.idle > MOST_IDLE


@inner
def _end_step(work, h, contacts, p, laws):
    """End a step of ``h`` at its first event, or as it is.

    Returns the event and its joint, the step's length, and what `move` returns at its end. The
    event is `UNSOLVED`, and the state that at the start, if Newton's method found no shorter step.
    The polynomial of the whole step places the event only as well as the step's error allows. A
    step that ends near the event places it exactly: it is nearly linear there. The third step ends
    on the event.
    """
    event, of_joint = NO_EVENT, 0
    for attempt in range(3):
        collocation.finish(work, h)
        motion, parts = equations.move(work.y, contacts, p, laws)
        locating.mark(STAGES - 1, motion.joints, work)
        if attempt == 0:
            event, of_joint, share = locating.first_event(work, h, contacts, p, laws)
        elif attempt == 1:
            share = locating.refine(event, of_joint, work, h, contacts, p, laws)
        if event < 0 or attempt == 2:
            break
        collocation.guess(work, 0.0, share)
        h *= share
        if not _collocate(work, h, contacts, p, laws):
            event = UNSOLVED
            for m in range(len(work.y)):
                work.y[m] = work.start[m]
            break
    return event, of_joint, h, motion, parts


@compiled
def advance(state, work, p, laws, tolerance, horizon, rows, impacts, events):
    """Step to the time of each row and fill it; return the number of rows filled and the ending.

    Rows are filled from the polynomial of the step that they are in; the last step ends at the
    ``horizon``.
    """
    (contacts, motion), done = equations.current(work, p, laws), 0
    while done < len(rows) and state.steps < state.until:
        t, h = state.time, state.step
        if rows[done].time <= t:
            _read(rows[done], state, work, p, laws)
            done += 1
            continue
        if state.impacts == len(impacts):
            return done, stepping.FULL
        landing = t + h * 1.000001 >= horizon  # no last step of rounding errors
        length = horizon - t if landing else h
        size = _try_step(work, length, motion, contacts, state, tolerance, p, laws)
        if not size <= 1.0:
            ratio = max(SHRINKING, SAFETY / sixth_root(size)) if size < inf else 0.5
            if _try_again(length * ratio, state, work):
                continue
            return done, stepping.FAILED
        size = max(size, LEAST_SIZE)
        h = _next_step(size, length, state, work)
        event, of_joint, length, end, parts = _end_step(work, length, contacts, p, laws)
        if event == UNSOLVED:  # again, with a step that ends before the event
            state.size = 0.0
            if _try_again(0.5 * length, state, work):
                continue
            return done, stepping.FAILED
        if event >= 0 and _is_idle(length, state, work):
            return done, stepping.FAILED
        state.began, state.length, state.size = t, length, size if event < 0 else 0.0
        state.time = horizon if landing and event < 0 else t + length
        if _too_deep(work, contacts, motion, end, parts, state, (impacts, events), p, laws):
            return done, stepping.TOO_DEEP
        if event < 0:
            equations.derive(work.y, contacts, p, end, parts, work.k)
            motion = end
        else:
            h = _change_contact(
                event, of_joint, end, parts, state, work, h, p, laws, (impacts, events)
            )
            contacts, motion = equations.current(work, p, laws)
        state.step = h
    return done, stepping.FINE


@inner
def _read(row, state, work, p, laws):
    """Fill a row of output inside the last step, from its polynomial and in its contact states."""
    contacts, length = equations.contact_states(work.was, laws), state.length
    share = (row.time - state.began) / length
    motion, parts = locating.evaluate(work, length, share, contacts, p, laws)
    equations.write_output(row, work.trial, motion, parts, p, laws)


@inner
def _begin(work, motion, smooth, ratio):
    """Begin a step at the current state, with guesses of the accelerations at its points."""
    n = len(work.x)
    for m in range(len(work.y)):
        work.start[m] = work.y[m]
    for j in range(len(work.joints)):
        work.was[j] = work.joints[j]
    for m in range(n):
        work.rates[AT_START, m], work.rates[AT_START, n + m] = (
            motion.accelerations[m],
            motion.powers[m],
        )
    if smooth:
        collocation.guess(work, 1.0, ratio)
    else:
        for i in range(STAGES):
            for m in range(n):
                work.rates[1 + i, m] = work.rates[AT_START, m]


@inner
def _too_deep(work, contacts, start, end, parts, state, table, p, laws):
    """Follow the impacts through a step; say if a ball went deeper than one clearance.

    ``table`` has the impacts and their rows of output.
    """
    impacts, events = table
    for j in range(len(contacts)):
        if not contacts[j].closed:
            continue
        _attend(j, state, work)
        number, joint, step = work.joints[j].impact, end.joints[j], state.length
        row = events[number, stepping.PEAK]
        at_start = start.joints[j]
        locating.measure_peaks(
            j, impacts[number], row, work, state.began, step, at_start, contacts, p, laws
        )
        if max(joint.depth, impacts[number].peak_depth) > laws[j].clearance:
            state.limit = laws[j].clearance
            return True
        if stepping.follow_impact(impacts, state, joint.normal, joint.depth):
            row = stepping.event_row(events, state, stepping.PEAK)
            equations.write_output(row, work.y, end, parts, p, laws)
    return False


@inner
def _attend(j, state, work):
    """Make a joint's impact the current one, with the energy lost in that joint."""
    y, lost = work.y, 2 * len(work.x) + 2 * j
    state.lost_damping, state.lost_friction = y[lost], y[lost + 1]
    state.current_impact = work.joints[j].impact


@inner
def _change_contact(event, j, motion, parts, state, work, h, p, laws, table):
    """Begin the contact state that follows an event, in its coordinates; return its first step.

    ``table`` has the impacts and their rows of output.
    """
    (impacts, events), y, joint, law = table, work.y, work.joints[j], laws[j]
    first, first_rate = 1 + 2 * j, 2 + 2 * len(laws) + 2 * j
    second, second_rate = first + 1, first_rate + 1
    if event != SURFACES:
        joint.regime += 1 if event == UPWARDS else -1
        return h
    _attend(j, state, work)
    if joint.closed:
        rate, across = y[first_rate], law.clearance * y[second_rate]
        stepping.end_impact(impacts, state, -rate)
        row = stepping.event_row(events, state, stepping.END)
        equations.write_output(row, y, motion, parts, p, laws)
        ny, nx = sine_cosine(y[second])
        y[first], y[second] = law.clearance * nx, law.clearance * ny
        y[first_rate], y[second_rate] = rate * nx - across * ny, rate * ny + across * nx
        joint.closed, joint.regime = False, 0
        return h
    if motion.joints[j].rate <= 0:  # it grazes, and goes on in flight
        return h
    r = norm(y[first], y[second])
    nx, ny, wx, wy = y[first] / r, y[second] / r, y[first_rate], y[second_rate]
    rate = nx * wx + ny * wy
    y[first], y[second] = 0.0, angle_of(ny, nx)
    y[first_rate], y[second_rate] = rate, (nx * wy - ny * wx) / law.clearance
    joint.closed, joint.approach, joint.impact = True, rate, state.impacts
    joint.regime = friction_regime(motion.joints[j].sliding, p.v0, p.v1)
    stepping.begin_impact(impacts, state, state.time, rate)
    impacts[joint.impact].joint = j
    row = stepping.event_row(events, state, stepping.START)
    equations.write_output(row, y, motion, parts, p, laws)
    (ny, nx), phi = sine_cosine(y[second]), (motion.coupler.sine, motion.coupler.cosine)
    joint.deep = impact_depth(j, y[THETA], phi, nx, ny, rate, p, laws)
    return min(h, 0.1 * joint.deep / rate)  # a tenth of the time to this depth


def stepper(
    scene: Scene, laws: Laws, horizon: float, tolerance: float
) -> tuple[np.recarray, Callable]:
    """State at t = 0, and the loop that steps it, for ``advance_in_blocks``; ``horizon`` in s."""
    p, clearances = scene.constants(), (scene.clearance, scene.crank_clearance or 0.0)[: len(laws)]
    unknowns, state = 1 + 2 * len(laws), stepping.new_state(*OWN)
    own = [
        *((name, JOINT, (len(laws),)) for name in ("joints", "was")),
        ("marks", MARK, (STAGES, len(laws))),
        ("most", float),
        ("idle", np.int64),
    ]
    (work,) = np.zeros(1, [*collocation.fields(unknowns), *own]).view(np.recarray)
    work.y[THETA], work.y[unknowns] = scene.initial_crank_angle, scene.starting_speed
    work.y[1:3] = scene.initial_eccentricity
    _, motion = equations.current(work, p, laws)
    for j, clearance in enumerate(clearances):
        work.joints[j].deep = clearance
        driven = sqrt(norm(*motion.accelerations[1 + 2 * j : 3 + 2 * j]) * clearance)
        state.driven = max(state.driven, driven, clearance / horizon)
    state.step = min(1e-3 * scene.clearance / state.driven, horizon)
    work.start[:], work.was[:], state.length, work.most = work.y, work.joints, 1.0, GROWTH
    return state, partial(advance, state, work, p, laws, tolerance, horizon)


def blocks(
    scene: Scene, laws: Laws, times: NDArray[np.float64], tolerance: float
) -> Iterator[stepping.Block]:
    """Blocks of output rows at ``times`` of the scene with its clearance joints and packed laws."""
    state, loop = stepper(scene, laws, times[-1], tolerance)
    failure = f"no step is small enough for tolerance {tolerance:g}"
    return stepping.advance_in_blocks(loop, times, state, failure)
