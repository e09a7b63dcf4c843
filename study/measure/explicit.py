"""Rigid links integrated by explicit steps of constant length, for comparison.

The equations are those of `study.mechanism.rigid`, always in the coordinates (theta, e_x, e_y). The
times of impacts are not located: a contact begins with the first step that ends in overlap, and its
approach speed is the rate of the depth at the end of this step. If the surfaces no longer approach
each other then, the contact is not damped. The energies lost, and the work of the loads, are
integrated over the steps by the trapezoidal rule.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study.compiled import compiled
from study.contact.forces import elastic_force, friction_regime
from study.mechanism import rigid
from study.mechanism.angles import angle_of, norm, sine_cosine
from study.mechanism.law_in_scene import in_scene
from study.mechanism.response import OUTPUT
from study.mechanism.rigid import LOST_DAMPING
from study.mechanism.scene import Scene
from study.mechanism.stepping import MechanismError, add_stored_energy, divide

SCHEMES = ("symplectic Euler", "velocity Verlet", "RK4")
EULER, VERLET, RK4 = range(len(SCHEMES))
STAGES = 1, 2, 4
"""Evaluations of the equations of motion in a step of each scheme."""
THETA, EX, EY, OMEGA, EX_RATE, EY_RATE = range(6)
"""Places in a state: the crank's angle and the eccentricity, and their rates."""
FIRST, SECOND, THIRD = range(3)  # stages of a step


@compiled
def acceleration(y, contact, approach, p, law, work, out):
    """Fill ``out`` with (theta'', e_x'', e_y'') at a state ``y``.

    ``contact``: whether overlapping surfaces exert a force; ``approach``: approach speed, inf for
    a contact without damping.
    Returns the slider's acceleration.
    """
    return _motion(y, contact, approach, p, law, work, out)[0]


@compiled
def _motion(y, contact, approach, p, law, work, out):
    """As `acceleration`, with the rates of the integrals and the `ContactState`.

    ``work`` is then the state in the coordinates of `rigid.motion`.
    """
    r = norm(y[EX], y[EY])
    closed, regime = contact and r > law.clearance, 0
    work[: len(y)] = y
    if closed:  # there the coordinates of `rigid.motion` are (theta, depth, direction)
        nx, ny = y[EX] / r, y[EY] / r
        rate, spin = nx * y[EX_RATE] + ny * y[EY_RATE], (nx * y[EY_RATE] - ny * y[EX_RATE]) / r
        work[rigid.FIRST], work[rigid.SECOND] = r - law.clearance, angle_of(ny, nx)
        work[rigid.FIRST_RATE], work[rigid.SECOND_RATE] = rate, spin
        st, ct = sine_cosine(y[THETA])
        sp = (y[EY] - p.l1 * st) / p.l2
        psi = (y[EY_RATE] - p.l1 * ct * y[OMEGA]) / (p.l2 * sqrt(1 - sp * sp))
        regime = friction_regime(r * spin + p.r1 * psi, p.v0, p.v1)
    state = rigid.ContactState(closed, regime, approach)
    motion = rigid.motion(work, state, p, law)
    out[THETA], out[EX], out[EY] = motion.accelerations
    if closed:
        outward, across = out[EX] - r * spin * spin, r * out[EY] + 2 * rate * spin
        out[EX], out[EY] = outward * nx - across * ny, outward * ny + across * nx
    return motion.slider, motion.powers, state


@compiled
def _limit(y, depth, approach, p, law):
    """Longest stable step in a contact, in s.

    h^2 P' c + 2 h D P c/v0 < 4 and h mu P s/(v1 - v0) < 2, with the inverse effective masses c
    along the normal and s along the tangent. It is exact for symplectic Euler and safe for the
    others.
    """
    r = law.clearance + depth
    nx, ny = y[EX] / r, y[EY] / r
    ease = rigid.inverse_effective_mass(y[THETA], y[EY], nx, ny, 0.0, p)
    force, stiffness = elastic_force(law, depth)
    stiff, loss = stiffness * ease, force * p.damping / approach * ease
    limit = (sqrt(loss * loss + 4 * stiff) - loss) / stiff
    slip = rigid.inverse_effective_mass(y[THETA], y[EY], -ny, nx, p.r1, p)
    grip = force * p.friction / (p.v1 - p.v0) * slip
    return min(limit, 2 / grip) if grip > 0 else limit


@compiled
def advance(scheme, y, approach, p, law, h, strides, outputs, rows, guarded):
    """Take ``strides`` steps for each of ``outputs`` outputs; fill the ``rows``.

    Returns the number of outputs reached, which is smaller after a failure. The second value is
    then the limit of the step if it was exceeded, or 0 if the depth exceeded one clearance.
    """
    a, slopes, stage, work = np.zeros(3), np.zeros((3, 3)), np.zeros(6), np.zeros(9)
    depth, integrals = norm(y[EX], y[EY]) - law.clearance, work[LOST_DAMPING:]
    _, powers, state = _motion(y, True, approach, p, law, work, a)
    for output in range(outputs + 1):
        for _ in range(strides if output > 0 else 0):
            if guarded and depth > 0:
                limit = _limit(y, depth, approach, p, law)
                if h > limit:
                    return output, limit
            _step(scheme, y, a, h, approach, p, law, work, stage, slopes)
            before, depth = depth, norm(y[EX], y[EY]) - law.clearance
            if not depth <= law.clearance:  # NaN too
                return output, 0.0
            approach = _approach(y, before, depth, approach)
            old = powers
            _, powers, state = _motion(y, True, approach, p, law, work, a)
            for i in range(len(integrals)):
                integrals[i] += 0.5 * h * (old[i] + powers[i])
        rigid.write_output(rows[output], work, rigid.motion(work, state, p, law), p)
    return outputs + 1, 0.0


@compiled
def _approach(y, before, depth, approach):
    """Approach speed of the contact after a step; inf without contact or damping."""
    if depth <= 0:
        return inf
    if before > 0:
        return approach
    r = norm(y[EX], y[EY])
    rate = y[EX] / r * y[EX_RATE] + y[EY] / r * y[EY_RATE]
    return rate if rate > 0 else inf


@compiled
def _step(scheme, y, a, h, approach, p, law, work, stage, slopes):
    """Move the state ``y`` by one step from its accelerations ``a``."""
    half, b, c, d = 0.5 * h, slopes[FIRST], slopes[SECOND], slopes[THIRD]
    if scheme == EULER:
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
        last, stage[OMEGA:] = a, y[OMEGA:]
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


def packed(scene: Scene, law: str) -> np.record:
    """A law in the joint of a mechanism, for the compiled functions."""
    return in_scene(scene, law).packed()


def start_of(scene: Scene) -> NDArray[np.float64]:
    """(theta, e_x, e_y) and their rates at t = 0.

    Raises ``ValueError`` for a scene with a constant speed.
    """
    if scene.crank_speed is not None:
        raise ValueError("crank_speed does not apply to explicit steps; remove it")
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
) -> NDArray[np.void]:
    """Rows of output with the fields `study.mechanism.response.ALL_COLUMNS`, shape (outputs + 1,).

    The duration in s is divided into ``outputs`` equal intervals, and each of these into steps of
    one of `SCHEMES`, in s and at most ``step``. The law is from `packed`. The start is the state at
    t = 0, by default `start_of` the scene, and ``approach`` the approach speed in m/s of a contact
    at the start, or inf without one.

    Raises `study.mechanism.MechanismError` if the penetration depth exceeds one clearance and, with
    ``guarded``, if the step exceeds its stability limit in a contact.
    """
    y = np.array(start_of(scene) if start is None else start, float)
    strides, h = divide(duration * np.arange(2) / outputs, step)
    rows = np.zeros(outputs + 1, OUTPUT)
    rows["time"] = duration * np.arange(outputs + 1) / outputs
    table = rows.view(np.recarray)
    arguments = (scene.constants(), law, h, strides, outputs, table, guarded)
    reached, limit = advance(SCHEMES.index(scheme), y, float(approach), *arguments)
    if reached <= outputs:
        what = f"the penetration depth must stay <= one clearance ({scene.clearance:g} m)"
        if limit > 0:
            what = f"the step must stay <= {limit:.4g} s, the stability limit"
        time = reached * duration / outputs
        raise MechanismError(
            f"{what}; the run stopped before {time:.9g} s with a step of {h:.4g} s"
        )
    add_stored_energy(table, law)
    return rows
