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
    Returns depth, its rate and the slider's acceleration.
    """
    r = norm(y[1], y[2])
    if not (contact and r > law.clearance):
        found, _ = rigid.motion(y, (False, 0, 1.0), p, law)
        out[0], out[1], out[2] = found.accelerations
        return found.joints[0].depth, found.joints[0].rate, found.slider
    nx, ny = y[1] / r, y[2] / r
    work[0], work[1], work[2], work[3] = y[0], r - law.clearance, angle_of(ny, nx), y[3]
    rate, spin = nx * y[4] + ny * y[5], (nx * y[5] - ny * y[4]) / r
    work[4], work[5] = rate, spin
    st, ct = sine_cosine(y[0])
    sp = (y[2] - p.l1 * st) / p.l2
    psi = (y[5] - p.l1 * ct * y[3]) / (p.l2 * sqrt(1 - sp * sp))
    branch = friction_branch(r * spin + p.r1 * psi, p.v0, p.v1)
    found, _ = rigid.motion(work, (True, branch, approach), p, law)
    alpha, growth, turn = found.accelerations
    outward, across = growth - r * spin * spin, r * turn + 2 * rate * spin
    out[0], out[1], out[2] = alpha, outward * nx - across * ny, outward * ny + across * nx
    return found.joints[0].depth, found.joints[0].rate, found.slider


@compiled
def _limit(scheme, y, depth, approach, p, law):
    """Longest stable step in a contact, in s.

    h^2 P' c + 2 h D P c/v0 < 4 and h mu P s/(v1 - v0) < 2, with the inverse masses c along the
    normal and s along the tangent. It is exact for ``lagged`` and safe for the others. The centred
    velocity has no damping limit, but `_centre` has one.
    """
    r = law.clearance + depth
    nx, ny = y[1] / r, y[2] / r
    ease = rigid.compliance(y[0], y[2], nx, ny, 0.0, p)
    force, stiffness = elastic_force(law, depth)
    stiff, loss = stiffness * ease, force * p.damping / approach * ease
    limit = (sqrt(loss * loss + 4 * stiff) - loss) / stiff
    if scheme == CENTRED:
        limit = min(2 / sqrt(stiff), MOST_DAMPING / loss if loss > 0 else inf)
    slip = rigid.compliance(y[0], y[2], -ny, nx, p.r1, p)
    grip = force * p.friction / (p.v1 - p.v0) * slip
    return min(limit, 2 / grip) if grip > 0 else limit


@compiled
def advance(scheme, y, approach, p, law, h, strides, outputs, found, deepest, guarded):
    """Step ``outputs`` times ``strides`` steps; fill ``found`` with slider's x'' and depth.

    Returns the number of outputs reached, fewer after a failure, and the step's limit if it was
    passed, or 0 if the ball went too deep.
    """
    a, b, c, d = np.zeros((4, 3))
    work, z, half = np.zeros(6), np.zeros(6), 0.5 * h
    depth, rate, pull = acceleration(y, True, approach, p, law, work, a)
    if scheme in (LAGGED, CENTRED):  # velocities half a step before the positions
        y[3:] -= half * a
    limit = _limit(scheme, y, depth, approach, p, law) if guarded and depth > 0 else inf
    if h > limit:
        return 0, limit
    for output in range(outputs + 1):
        for _ in range(strides if output > 0 else 0):
            if scheme in (EULER, LAGGED, CENTRED):
                y[3:] += h * (c if scheme == CENTRED else a)
                y[:3] += h * y[3:]
            elif scheme == VERLET:
                y[:3] += h * (y[3:] + half * a)
                z[:3] = y[:3]
                z[3:] = y[3:] + h * a
                acceleration(z, True, approach, p, law, work, b)
                y[3:] += half * (a + b)
            else:
                z[:3] = y[:3] + half * y[3:]
                z[3:] = y[3:] + half * a
                acceleration(z, True, approach, p, law, work, b)
                z[:3] = y[:3] + half * (y[3:] + half * a)
                z[3:] = y[3:] + half * b
                acceleration(z, True, approach, p, law, work, c)
                z[:3] = y[:3] + h * (y[3:] + half * b)
                z[3:] = y[3:] + h * c
                acceleration(z, True, approach, p, law, work, d)
                y[:3] += h * (y[3:] + h / 6 * (a + b + c))
                y[3:] += h / 6 * (a + 2 * (b + c) + d)
            before = depth
            depth, rate, pull = acceleration(y, True, approach, p, law, work, a)
            if not depth <= deepest:
                return output, 0.0
            if depth > 0 and before <= 0:
                approach = rate if rate > 0 else inf
                depth, rate, pull = acceleration(y, True, approach, p, law, work, a)
            elif depth <= 0:
                approach = inf
            if guarded and depth > 0:
                limit = _limit(scheme, y, depth, approach, p, law)
                if h > limit:
                    return output, limit
            if scheme == CENTRED:
                pull = _centre(y, approach, p, law, half, work, z, a, b, c)
        if scheme == CENTRED and output == 0:
            c[:] = a
        found[output, 0], found[output, 1] = pull, depth
    return outputs + 1, 0.0


@compiled
def _centre(y, approach, p, law, half, work, z, a, b, c):
    """Accelerations ``c`` at the velocity of the step's middle, which depends on them.

    They depend nearly linearly on it, and strongly along the normal alone: two steps of a fixed
    point and one of Aitken's extrapolation find it. Returns the slider's acceleration.
    """
    z[:3] = y[:3]
    z[3:] = y[3:] + half * a
    acceleration(z, True, approach, p, law, work, b)
    first, second = b - a, 0.0
    z[3:] = y[3:] + half * b
    acceleration(z, True, approach, p, law, work, c)
    size = (first * first).sum()
    if size > 0:
        second = ((c - b) * first).sum() / size
    z[3:] = y[3:] + half * (b + (c - b) / (1 - second))
    return acceleration(z, True, approach, p, law, work, c)[2]


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
        From ``study.contact.forces.pack``.
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
    own = start_of(scene)
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
    y = np.array(own if start is None else start, float)
    strides, h = divide(duration * np.arange(2) / outputs, step)
    found = np.zeros((outputs + 1, 2))
    args = (scene.constants(), law, h, strides, outputs, found, scene.clearance, guarded)
    reached, limit = advance(SCHEMES.index(scheme), y, float(approach), *args)
    if reached <= outputs:
        what = f"the depth must stay <= one clearance ({scene.clearance:g} m)"
        if limit > 0:
            what = f"the step must stay <= {limit:.4g} s, the limit of stability"
        time = reached * duration / outputs
        raise MechanismError(f"{what}; stopped before time {time:.9g} s, step {h:.4g} s")
    return found[:, 0], found[:, 1]
