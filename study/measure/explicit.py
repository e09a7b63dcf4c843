"""Rigid links by explicit steps of one length, to compare the study's own stepper with.

The equations are those of `study.mechanism.rigid`, in (theta, e_x, e_y) throughout. Impacts are
not located: a contact begins with a step that ends in overlap, and its approach speed is the rate
of the depth there. If the surfaces no longer approach by then, the contact is not damped.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.compiled import compiled
from study.contact.forces import elastic_force
from study.contact.friction import friction_branch
from study.mechanism import rigid
from study.mechanism.angles import angle_of, norm, sine_cosine
from study.mechanism.scene import Scene
from study.mechanism.stepping import MechanismError, divide

SCHEMES = ("symplectic Euler", "lagged", "centred", "velocity Verlet", "RK4")
"""``lagged`` and ``centred``: central differences with two velocities for damping and friction."""
EULER, LAGGED, CENTRED, VERLET, RK4 = range(5)
MOST_STEPS = 1e10
MOST_DAMPING = 100.0  # largest h D P c/v0 at which `_centre` still finds the velocity


@compiled
def acceleration(y, contact, approach, p, law, work, out):
    """Fill ``out`` with (theta'', e_x'', e_y'') at ``y`` = (theta, e, theta', e').

    ``contact``: whether overlapping surfaces press; ``approach``: approach speed, inf for none.
    Returns the slider's acceleration.
    """
    r = norm(y[1], y[2])
    pressed, branch = contact and r > law.clearance, 0
    work[:] = y
    if pressed:  # there the coordinates of `rigid.motion` are (theta, depth, direction)
        nx, ny = y[1] / r, y[2] / r
        rate, spin = nx * y[4] + ny * y[5], (nx * y[5] - ny * y[4]) / r
        work[1], work[2], work[4], work[5] = r - law.clearance, angle_of(ny, nx), rate, spin
        st, ct = sine_cosine(y[0])
        sp = (y[2] - p.l1 * st) / p.l2
        psi = (y[5] - p.l1 * ct * y[3]) / (p.l2 * sqrt(1 - sp * sp))
        branch = friction_branch(r * spin + p.r1 * psi, p.v0, p.v1)
    motion, _ = rigid.motion(work, (pressed, branch, approach), p, law)
    out[0], out[1], out[2] = motion.accelerations
    if pressed:
        outward, across = out[1] - r * spin * spin, r * out[2] + 2 * rate * spin
        out[1], out[2] = outward * nx - across * ny, outward * ny + across * nx
    return motion.slider


@compiled
def _limit(scheme, y, depth, approach, p, law):
    """Longest stable step in a contact, in s.

    h^2 P' c + 2 h D P c/v0 < 4 and h mu P s/(v1 - v0) < 2, with the inverse effective masses c
    along the normal and s along the tangent. It is exact for ``lagged`` and safe for the others.
    The centred velocity has no damping limit, but `_centre` has one.
    """
    r = law.clearance + depth
    nx, ny = y[1] / r, y[2] / r
    ease = rigid.inverse_effective_mass(y[0], y[2], nx, ny, 0.0, p)
    force, stiffness = elastic_force(law, depth)
    stiff, loss = stiffness * ease, force * p.damping / approach * ease
    limit = (sqrt(loss * loss + 4 * stiff) - loss) / stiff
    if scheme == CENTRED:
        limit = min(2 / sqrt(stiff), MOST_DAMPING / loss if loss > 0 else inf)
    slip = rigid.inverse_effective_mass(y[0], y[2], -ny, nx, p.r1, p)
    grip = force * p.friction / (p.v1 - p.v0) * slip
    return min(limit, 2 / grip) if grip > 0 else limit


@compiled
def advance(scheme, y, approach, p, law, h, strides, outputs, history, guarded):
    """Step ``outputs`` times ``strides`` steps; fill ``history`` with slider's x'' and depth.

    Returns the number of outputs reached, fewer after a failure, and the step's limit if it was
    passed, or 0 if the ball went deeper than one clearance.
    """
    a, slopes, stage, work = np.zeros(3), np.zeros((3, 3)), np.zeros(6), np.zeros(6)
    depth = norm(y[1], y[2]) - law.clearance
    pull = acceleration(y, True, approach, p, law, work, a)
    if scheme in (LAGGED, CENTRED):  # velocities half a step before the positions
        y[3:] -= 0.5 * h * a
    for output in range(outputs + 1):
        for _ in range(strides if output > 0 else 0):
            if guarded and depth > 0:
                limit = _limit(scheme, y, depth, approach, p, law)
                if h > limit:
                    return output, limit
            _step(scheme, y, a, h, approach, p, law, work, stage, slopes)
            before, depth = depth, norm(y[1], y[2]) - law.clearance
            if not depth <= law.clearance:  # NaN too
                return output, 0.0
            approach = _approach(y, before, depth, approach)
            pull = acceleration(y, True, approach, p, law, work, a)
            if scheme == CENTRED:
                pull = _centre(y, a, 0.5 * h, approach, p, law, work, stage, slopes)
        history[output, 0], history[output, 1] = pull, depth
    return outputs + 1, 0.0


@compiled
def _approach(y, before, depth, approach):
    """Approach speed after a step: that of the contact that begins or goes on, inf for none."""
    if depth <= 0:
        return inf
    if before > 0:
        return approach
    r = norm(y[1], y[2])
    rate = y[1] / r * y[4] + y[2] / r * y[5]
    return rate if rate > 0 else inf


@compiled
def _step(scheme, y, a, h, approach, p, law, work, stage, slopes):
    """Move the state ``y`` by one step from its accelerations ``a``."""
    half, b, c, d = 0.5 * h, slopes[0], slopes[1], slopes[2]
    if scheme in (EULER, LAGGED, CENTRED):
        for i in range(3):
            y[3 + i] += h * a[i]
            y[i] += h * y[3 + i]
    elif scheme == VERLET:
        for i in range(3):
            y[i] += h * (y[3 + i] + half * a[i])
            stage[i], stage[3 + i] = y[i], y[3 + i] + h * a[i]
        acceleration(stage, True, approach, p, law, work, b)
        for i in range(3):
            y[3 + i] += half * (a[i] + b[i])
    else:
        last, stage[3:] = a, y[3:]
        for n in range(3):  # each stage from the velocity and acceleration of the one before
            length = half if n < 2 else h
            for i in range(3):
                stage[i] = y[i] + length * stage[3 + i]
                stage[3 + i] = y[3 + i] + length * last[i]
            last = slopes[n]
            acceleration(stage, True, approach, p, law, work, last)
        for i in range(3):
            y[i] += h * (y[3 + i] + h / 6 * (a[i] + b[i] + c[i]))
            y[3 + i] += h / 6 * (a[i] + 2 * (b[i] + c[i]) + d[i])


@compiled
def _centre(y, a, half, approach, p, law, work, stage, slopes):
    """Change ``a`` to the accelerations at the velocity of the step's middle, which has them too.

    They depend nearly linearly on it, and strongly along the normal alone: two steps of a fixed
    point and one of Aitken's extrapolation find it. Returns the slider's acceleration.
    """
    last, pull = a, 0.0
    for n in range(3):
        for i in range(3):
            stage[i], stage[3 + i] = y[i], y[3 + i] + half * last[i]
        pull = acceleration(stage, True, approach, p, law, work, slopes[n])
        last = slopes[n]
        if n == 1:
            size = along = 0.0
            for i in range(3):
                first = slopes[0, i] - a[i]
                size += first * first
                along += (slopes[1, i] - slopes[0, i]) * first
            ratio = along / size if size > 0 else 0.0
            for i in range(3):
                last[i] = slopes[0, i] + (slopes[1, i] - slopes[0, i]) / (1 - ratio)
    a[:] = last
    return pull


def start_of(scene: Scene) -> NDArray[np.float64]:
    """(theta, e_x, e_y) and their rates at t = 0.

    Raises ``ValueError`` for a scene with a constant speed or a second clearance joint.
    """
    checks.instance("scene", scene, Scene).has_none_of("crank_speed", "crank_clearance")
    places = scene.initial_crank_angle, *scene.initial_eccentricity
    return np.array([*places, scene.initial_crank_speed, 0.0, 0.0])


def integrate(
    scene: Scene,
    law: np.record,
    duration: float,
    outputs: int,
    step: float,
    scheme: str,
    start: ArrayLike | None = None,
    approach: float = inf,
    guarded: bool = True,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Slider's acceleration and depth of the clearance joint at equally spaced times.

    Parameters
    ----------
    law
        From `study.contact.DimensionalLaw.packed`.
    duration
        In s.
    outputs
        Number of equal intervals between the times of output.
    step
        Largest step, in s, shortened to divide the outputs' distance.
    scheme
        One of `SCHEMES`.
    start
        (theta, e_x, e_y) and their rates at t = 0; by default those of the scene.
    approach
        Approach speed of the contact that the start is in, in m/s; inf for none.
    guarded
        Whether to stop where the step is beyond its limit in the contact. Otherwise a wrong run
        stops only if the ball goes too deep.

    Returns
    -------
    acceleration, depth : ndarray, shapes (outputs + 1,)
        In m/s^2 and m.

    Raises
    ------
    study.mechanism.MechanismError
        If the step is beyond its limit, or the ball goes deeper than one clearance.
    """
    beginning = start_of(scene)
    checks.instance("law", law, np.record)
    checks.choice("scheme", scheme, SCHEMES)
    checks.number("duration", duration, "s", above=0, scalar=True)
    checks.number("step", step, "s", least=duration / MOST_STEPS, scalar=True)
    outputs = checks.whole("outputs", outputs, least=1, most=10**6)
    checks.flag("guarded", guarded)
    if not (isinstance(approach, float) and approach == inf):
        checks.number("approach", approach, "m/s", above=0, scalar=True)
    if start is not None and np.shape(checks.number("start", start)) != (6,):
        raise ValueError(f"start must be 6 numbers, got {checks.shown(start)}")
    y = np.array(beginning if start is None else start, float)
    strides, h = divide(duration * np.arange(2) / outputs, step)
    history = np.zeros((outputs + 1, 2))
    arguments = (scene.constants(), law, h, strides, outputs, history, guarded)
    reached, limit = advance(SCHEMES.index(scheme), y, float(approach), *arguments)
    if reached <= outputs:
        what = f"the depth must stay <= one clearance ({scene.clearance:g} m)"
        if limit > 0:
            what = f"the step must stay <= {limit:.4g} s, the limit of stability"
        time = reached * duration / outputs
        raise MechanismError(f"{what}; stopped before time {time:.9g} s, step {h:.4g} s")
    return history[:, 0], history[:, 1]
