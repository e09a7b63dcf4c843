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
def _changes(y, fx, fy, turn, p):
    """Changes of (theta', e_x', e_y', phi') by an impulse on the ball and its moment about it."""
    st, ct = sine_cosine(y[THETA])
    sp = (y[EY] - p.l1 * st) / p.l2
    cp = sqrt(1 - sp * sp)
    q1, q2 = p.l1 * (ct * fy - st * fx), p.l2 * (cp * fy - sp * fx) + turn
    coupling = p.a12 * (ct * cp + st * sp)
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    alpha, beta = (p.a22 * q1 - coupling * q2) * inverse, (p.a11 * q2 - coupling * q1) * inverse
    ex = fx / p.m3 - p.l1 * st * alpha - p.l2 * sp * beta
    return np.array([alpha, ex, p.l1 * ct * alpha + p.l2 * cp * beta, beta])


@compiled
def _meet(y, approach, gap, h, restitution, p):
    """Change the velocities of a contact; returns its normal impulse."""
    r = norm(y[EX], y[EY])
    nx, ny = y[EX] / r, y[EY] / r
    by_normal, by_tangent = _changes(y, -nx, -ny, 0.0, p), _changes(y, -ny, nx, p.r1, p)
    st, ct = sine_cosine(y[THETA])
    sp = (y[EY] - p.l1 * st) / p.l2
    psi = (y[EY_RATE] - p.l1 * ct * y[OMEGA]) / (p.l2 * sqrt(1 - sp * sp))
    rate = nx * y[EX_RATE] + ny * y[EY_RATE]
    sliding = nx * y[EY_RATE] - ny * y[EX_RATE] + p.r1 * psi
    allowed = -restitution * approach
    if approach <= SLOWEST_REBOUND:
        allowed = gap / h if gap > 0 else CORRECTION * gap / h
    rates = np.zeros((2, 2))  # of the depth and of sliding, by unit impulses
    for j, by in enumerate((by_normal, by_tangent)):
        rates[0, j] = nx * by[1] + ny * by[2]
        rates[1, j] = nx * by[2] - ny * by[1] + p.r1 * by[3]
    normal = tangential = 0.0
    for _ in range(SWEEPS):
        normal = max(0.0, -(rate - allowed + rates[0, 1] * tangential) / rates[0, 0])
        stopping = -(sliding + rates[1, 0] * normal) / rates[1, 1]
        tangential = min(max(stopping, -p.friction * normal), p.friction * normal)
    for i in range(3):
        y[3 + i] += normal * by_normal[i] + tangential * by_tangent[i]
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
