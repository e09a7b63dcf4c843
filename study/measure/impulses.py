"""Rigid links with a rigid contact, in time steps as physics engines take them.

A step is one of semi-implicit Euler. Where it would end in overlap, a normal and a tangential
impulse act, which projected Gauss-Seidel finds: the surfaces then separate with the restitution
that the scene's damping delivers or, after a slow approach, only stop. Friction is Coulomb's at any
sliding speed. There is no penetration depth, and no contact law; an overlap by drift is corrected.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from study.compiled import compiled
from study.measure import explicit
from study.measure.explicit import EX, EX_RATE, EY, EY_RATE, OMEGA, THETA
from study.mechanism import Scene
from study.mechanism.angles import norm, sine_cosine

SLOWEST_REBOUND = 1e-3  # m/s: a slower approach has no restitution
CORRECTION = 0.2  # fraction of an overlap that a step corrects, as by default in many engines
SWEEPS = 10  # of projected Gauss-Seidel


@compiled
def _meet(y, approach, gap, h, restitution, p):
    """Change the velocities by the impulses of a contact; returns the normal one."""
    r, (st, ct) = norm(y[EX], y[EY]), sine_cosine(y[THETA])
    nx, ny, sp = y[EX] / r, y[EY] / r, (y[EY] - p.l1 * st) / p.l2
    cp = sqrt(1 - sp * sp)
    coupling = p.a12 * (ct * cp + st * sp)
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    velocities, rates = np.zeros((3, 3)), np.zeros((3, 2))  # by unit impulses, and now
    velocities[2] = y[OMEGA:]
    for j, (fx, fy, turn) in enumerate(((-nx, -ny, 0.0), (-ny, nx, p.r1))):  # on the ball
        q1, q2 = p.l1 * (ct * fy - st * fx), p.l2 * (cp * fy - sp * fx) + turn
        alpha, beta = (p.a22 * q1 - coupling * q2) * inverse, (p.a11 * q2 - coupling * q1) * inverse
        ex = fx / p.m3 - p.l1 * st * alpha - p.l2 * sp * beta
        velocities[j] = alpha, ex, p.l1 * ct * alpha + p.l2 * cp * beta
    for j, (omega, ex, ey) in enumerate(velocities):  # rates of depth and sliding
        psi = (ey - p.l1 * ct * omega) / (p.l2 * cp)
        rates[j] = nx * ex + ny * ey, nx * ey - ny * ex + p.r1 * psi
    allowed = gap / h if gap > 0 else CORRECTION * gap / h
    if approach > SLOWEST_REBOUND:
        allowed = -restitution * approach
    normal = tangential = 0.0
    for _ in range(SWEEPS):
        normal = max(0.0, (allowed - rates[2, 0] - rates[1, 0] * tangential) / rates[0, 0])
        stopping = -(rates[2, 1] + rates[0, 1] * normal) / rates[1, 1]
        tangential = min(max(stopping, -p.friction * normal), p.friction * normal)
    y[OMEGA:] += normal * velocities[0] + tangential * velocities[1]
    return normal


@compiled
def _advance(y, h, forces, restitution, p, law):
    """Take a step for each of ``forces``, which are filled."""
    work, a = np.zeros(6), np.zeros(3)
    for step in range(len(forces)):
        r = norm(y[EX], y[EY])
        nx, ny = (y[EX] / r, y[EY] / r) if r > 0 else (1.0, 0.0)
        approach, gap = nx * y[EX_RATE] + ny * y[EY_RATE], law.clearance - r
        explicit.acceleration(y, False, inf, p, law, work, a)
        for i in range(3):
            y[3 + i] += h * a[i]
        if norm(y[EX] + h * y[EX_RATE], y[EY] + h * y[EY_RATE]) > law.clearance:
            forces[step] = _meet(y, approach, gap, h, restitution, p) / h
        for i in range(3):
            y[i] += h * y[3 + i]


def integrate(
    scene: Scene, duration: float, steps: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Normal force of each step in N, its impulse over its length, and the state at the end.

    Shapes (steps,) and (6,); the state is one of `study.measure.explicit`. In a sustained contact
    the force converges to that of a rigid contact with shorter steps. In an impact it grows without
    limit, because the impulse is that of the impact however short the step.
    """
    y, forces = explicit.start_of(scene), np.zeros(steps)
    how = scene.delivered_restitution, scene.constants(), explicit.packed(scene, "hertz")
    _advance(y, duration / steps, forces, *how)
    return forces, y
