"""One step of collocation at Radau's points, for compiled loops: of order 9, for stiff equations.

It solves z'' = f(z, z') with n unknowns, and integrals whose rates depend on z and z' alone. A
state is (z, z', integrals). A step works on one record, of `fields`.

A step's accelerations are a polynomial in time that meets the equations at the five points of
Radau's right rule (Radau IIA). It gives the state at every time in the step. Newton's method finds
the accelerations at the points, with the derivatives at the step's start. The eigenvectors of
Radau's matrix split its system into one real and two complex systems of n unknowns. The error is
estimated against a method of order 5 with the same points and the step's start (Hairer and Wanner,
Solving Ordinary Differential Equations II, secs. IV.5 and IV.8).

The rule's constants are in ``radau.toml``.
"""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from study.compiled import compiled, inlined

STAGES = 5
"""Points of a step; the error estimate grows with the power 6 of the step, hence sixth roots."""
PAIRS = STAGES // 2
AT_START = 0  # row of the rates at a step's start, before those at its points
_RULE = tomllib.loads(Path(__file__).with_name("radau.toml").read_text(encoding="utf-8"))


def _numbers(name):
    """Array of the rule's numbers of a name; complex ones are stored in two parts."""
    stored = _RULE[name]
    if isinstance(stored, dict):
        return np.array(stored["real"]) + 1j * np.array(stored["imaginary"])
    return np.array(stored)


POINTS = _numbers("points")
RATE, PLACE = _numbers("rate"), _numbers("place")
REAL, REAL_VECTOR, REAL_INVERSE = _RULE["real"], _numbers("real_vector"), _numbers("real_inverse")
COMPLEX = _numbers("complex")
COMPLEX_VECTORS, COMPLEX_INVERSES = _numbers("complex_vectors"), _numbers("complex_inverses")
MONOMIALS = _numbers("monomials")
RATE_ERROR, PLACE_ERROR = _numbers("rate_error"), _numbers("place_error")
SHARES = 1 / np.arange(1.0, STAGES + 3)
"""Factor of the power x^i in its integral, whose power is one higher."""


def fields(unknowns: int, integrals: int) -> list[tuple[Any, ...]]:
    """Names, types and shapes of what a step works on.

    ``start`` and ``y`` are the states at the step's start and end. ``rates`` has accelerations and
    integrals' rates at the start and at each point, ``polynomial`` their coefficients for each
    power of time, and ``k`` the derivatives of f by (z, z') at the start. ``error`` and ``weights``
    are those of (z, z'). The rest is for Newton's method.
    """
    n = unknowns
    return [
        *((name, float, (2 * n + integrals,)) for name in ("y", "start", "trial")),
        *((name, float, (1 + STAGES, n + integrals)) for name in ("rates", "polynomial")),
        ("k", float, (n, 2 * n)),
        *((name, float, (2 * n,)) for name in ("error", "weights")),
        ("residuals", float, (STAGES, n)),
        ("single", float, (n, n)),
        ("pairs", complex, (PAIRS, n, n)),
        ("x", float, (n,)),
        ("z", complex, (PAIRS, n)),
    ]


@compiled
def factorise(work, h):
    """Triangular factors of Newton's systems, for each eigenvalue of Radau's matrix."""
    _factorise(work.single, work.k, h * REAL)
    for q in range(PAIRS):
        _factorise(work.pairs[q], work.k, h * COMPLEX[q])


@inlined
def _factorise(matrix, k, a):
    """Factors of I - a df/dz' - a^2 df/dz, with the inverses of the pivots on the diagonal.

    ``a`` is the step times an eigenvalue, real or complex.
    Rows are not exchanged: the largest entries are those of the depths, on the diagonal.
    """
    n = len(matrix)
    for i in range(n):
        for j in range(n):
            matrix[i, j] = -a * (k[i, n + j] + a * k[i, j])
        matrix[i, i] += 1
    for i in range(n):
        matrix[i, i] = _inverse(matrix[i, i])
        for row in range(i + 1, n):
            matrix[row, i] *= matrix[i, i]
            for j in range(i + 1, n):
                matrix[row, j] -= matrix[row, i] * matrix[i, j]


@inlined
def _inverse(z):
    """Inverse of a number near 1, without the scaling of a complex division."""
    if z.imag == 0:
        return z.conjugate() * 0 + 1 / z.real
    return z.conjugate() * (1 / (z.real * z.real + z.imag * z.imag))


@inlined
def _solve(matrix, x):
    """Solve a factorised system for ``x`` in place."""
    n = len(x)
    for i in range(n):
        for j in range(i):
            x[i] -= matrix[i, j] * x[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= matrix[i, j] * x[j]
        x[i] *= matrix[i, i]


@compiled
def stage(i, work, h):
    """Fill ``trial`` with the state at point ``i`` of a step, without the integrals."""
    start, rates, n = work.start, work.rates, len(work.x)
    for m in range(n):
        place = speed = 0.0
        for j in range(STAGES):
            place += PLACE[i, j] * rates[1 + j, m]
            speed += RATE[i, j] * rates[1 + j, m]
        work.trial[m] = start[m] + h * (POINTS[i] * start[n + m] + h * place)
        work.trial[n + m] = start[n + m] + h * speed


@compiled
def improve(work, h):
    """One step of Newton's method on the accelerations at the points.

    ``error`` becomes a bound of what this changes at the step's end.
    """
    residuals, x, z, n = work.residuals, work.x, work.z, len(work.x)
    for m in range(n):
        x[m] = 0.0
        for j in range(STAGES):
            x[m] += REAL_INVERSE[j] * residuals[j, m]
    _solve(work.single, x)
    for q in range(PAIRS):
        for m in range(n):
            z[q, m] = 0.0
            for j in range(STAGES):
                z[q, m] += COMPLEX_INVERSES[q, j] * residuals[j, m]
        _solve(work.pairs[q], z[q])
    for m in range(n):
        place = speed = 0.0
        for i in range(STAGES):
            change = REAL_VECTOR[i] * x[m]
            for q in range(PAIRS):
                v = COMPLEX_VECTORS[i, q]
                change += v.real * z[q, m].real - v.imag * z[q, m].imag
            work.rates[1 + i, m] += change
            place += abs(PLACE[STAGES - 1, i] * change)
            speed += abs(RATE[STAGES - 1, i] * change)
        work.error[m], work.error[n + m] = h * h * place, h * speed


@compiled
def finish(work, h):
    """Fill ``y`` with the state at the step's end, and ``polynomial``."""
    start, rates, n = work.start, work.rates, len(work.x)
    stage(STAGES - 1, work, h)
    for m in range(2 * n):
        work.y[m] = work.trial[m]
    for m in range(2 * n, len(start)):
        integral = 0.0
        for j in range(STAGES):
            integral += RATE[STAGES - 1, j] * rates[1 + j, m - n]
        work.y[m] = start[m] + h * integral
    for i in range(1 + STAGES):
        for m in range(len(start) - n):
            total = 0.0
            for j in range(1 + STAGES):
                total += MONOMIALS[i, j] * rates[j, m]
            work.polynomial[i, m] = total


@compiled
def estimate(work, h):
    """Fill ``error`` with the estimated errors of z and z' of a step."""
    rates, k, error, n, g = work.rates, work.k, work.error, len(work.x), h * REAL
    for m in range(n):
        place, speed = 0.0, REAL * rates[AT_START, m]
        for j in range(STAGES):
            place += PLACE_ERROR[j] * rates[1 + j, m]
            speed += RATE_ERROR[j] * rates[1 + j, m]
        error[m], work.x[m] = h * h * place, h * speed
    for m in range(n):
        for j in range(n):
            work.x[m] += g * k[m, j] * error[j]
    _solve(work.single, work.x)
    for m in range(n):
        error[n + m] = work.x[m]
        error[m] += g * work.x[m]


@compiled
def largest(work):
    """Largest weighted ``error``; infinite if one is not a number."""
    size = total = 0.0
    for m in range(len(work.error)):
        weighted = abs(work.error[m]) * work.weights[m]
        size, total = max(size, weighted), total + weighted
    return size if total < np.inf else np.inf


@compiled
def guess(work, share, ratio):
    """Guess the accelerations at the points of a step from the polynomial of another.

    The step starts at ``share`` of the other one and has ``ratio`` times its length.
    """
    for j in range(STAGES):
        x = share + ratio * POINTS[j]
        for m in range(len(work.x)):
            total = 0.0
            for i in range(STAGES, -1, -1):
                total = total * x + work.polynomial[i, m]
            work.rates[1 + j, m] = total


@compiled
def inside(work, h, x):
    """Fill ``trial`` with the state at the share ``x`` of the step, integrals too."""
    start, n = work.start, len(work.x)
    for m in range(len(start) - n):
        speed = place = 0.0
        for i in range(STAGES, -1, -1):
            share = work.polynomial[i, m] * SHARES[i]
            speed = speed * x + share
            place = place * x + share * SHARES[i + 1]
        work.trial[n + m] = start[n + m] + h * x * speed
        if m < n:
            work.trial[m] = start[m] + h * x * (start[n + m] + h * x * place)
