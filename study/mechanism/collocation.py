"""One step of collocation at Radau's points, for compiled loops: of order 9, for stiff equations.

It solves z'' = f(z, z') with n unknowns, and n integrals whose rates depend on z and z' alone. A
state is (z, z', integrals). A step works on one record, of `fields`.

A step's accelerations are a polynomial in time that meets the equations at the five points of
Radau's right rule (Radau IIA). It gives the state at every time in the step. Newton's method finds
the accelerations at the points, with the derivatives at the step's start. The eigenvectors of
Radau's matrix split its system into one real and two complex systems of n unknowns. The error is
estimated against a method of order 5 with the same points and the step's start (Hairer and Wanner,
Solving Ordinary Differential Equations II, secs. IV.5 and IV.8).
"""

from fractions import Fraction
from math import comb

import numpy as np

from study.compiled import compiled

STAGES = 5
PAIRS = STAGES // 2
"""The error estimate grows with the power `STAGES` + 1 of the step, hence the sixth roots."""


def _legendre(degree):
    """Coefficients of Legendre's polynomial on (0, 1), from the lowest power."""
    return [(-1) ** (degree + k) * comb(degree, k) * comb(degree + k, k) for k in range(degree + 1)]


def _value(coefficients, x):
    return sum(c * x**k for k, c in enumerate(coefficients))


def _points():
    """Radau's points in (0, 1], exact except for rounding: the same on every processor."""
    low = [*_legendre(STAGES - 1), 0]
    radau = [a - b for a, b in zip(_legendre(STAGES), low, strict=True)]
    slope = [k * c for k, c in enumerate(radau)][1:]
    points = sorted(float(x.real) for x in np.roots(radau[::-1]))
    for _ in range(3):  # Newton's method, in fractions
        exact = [Fraction(x) for x in points]
        points = [float(x - _value(radau, x) / _value(slope, x)) for x in exact]
    return [*points[:-1], 1.0]


def _polynomials(points):
    """Coefficients of Lagrange's polynomials of some points, each from the lowest power."""
    found = []
    for j, own in enumerate(points):
        one = [Fraction(1)]
        for i, other in enumerate(points):
            if i != j:
                scale = 1 / (own - other)
                shifted, kept = [Fraction(0), *one], [*one, Fraction(0)]
                one = [scale * (a - other * b) for a, b in zip(shifted, kept, strict=True)]
        found.append(one)
    return found


def _integrals(points):
    """Radau's matrix: Lagrange's polynomials integrated from 0 to each point."""
    antiderivatives = [
        [Fraction(0), *(c / (k + 1) for k, c in enumerate(one))] for one in _polynomials(points)
    ]
    return [[_value(one, x) for one in antiderivatives] for x in points]


def _eigenvectors(matrix):
    """Eigenvalues, vectors and inverse vectors: the real ones, and one of each complex pair.

    They are rounded, because their last bits differ between processors. They affect the convergence
    of Newton's method only, not its result.
    """
    values, vectors = np.linalg.eig(matrix)
    order = np.argsort(values.imag)
    order = np.append(order[PAIRS], order[PAIRS + 1 :])  # the real one, then Im > 0
    both = vectors / vectors[-1]
    inverse = np.linalg.inv(both)
    values, vectors, inverse = (
        np.round(x, 10) for x in (values[order], both[:, order], inverse[order])
    )
    real = values[0].real, vectors[:, 0].real.copy(), inverse[0].real.copy()
    return real, (values[1:], 2 * vectors[:, 1:], inverse[1:])


_EXACT = [Fraction(x) for x in _points()]
_MATRIX = _integrals(_EXACT)
_SQUARE = [
    [sum(a * b for a, b in zip(row, c, strict=True)) for c in zip(*_MATRIX, strict=True)]
    for row in _MATRIX
]
POINTS = np.array([float(x) for x in _EXACT])
RATE, PLACE = np.array(_MATRIX, dtype=float), np.array(_SQUARE, dtype=float)
"""Weights of the accelerations at the points in the change of rates and places up to each point."""
(REAL, REAL_VECTOR, REAL_INVERSE), (COMPLEX, COMPLEX_VECTORS, COMPLEX_INVERSES) = _eigenvectors(
    RATE
)
_WITH_START = _polynomials([Fraction(0), *_EXACT])
SHARES = 1 / np.arange(1.0, STAGES + 3)
"""Factor of the power x^i in its integral, whose power is one higher."""
MONOMIALS = np.array(list(zip(*_WITH_START, strict=True)), dtype=float)
"""Coefficients of the polynomial in a step's time from its values at the start and the points."""


def _lower_order():
    """Weights of the difference to a method of order `STAGES`, whose weight at 0 is `REAL`."""
    gamma = Fraction(REAL)
    # it integrates 1, x, x^2, ...: weights of Lagrange's polynomials on (0, 1), less gamma at 0
    weights = [
        sum(c / (k + 1) for k, c in enumerate(one)) - gamma * one[0] for one in _polynomials(_EXACT)
    ]
    change = [a - b for a, b in zip(weights, _MATRIX[-1], strict=True)]
    of_places = [
        sum(a * row[j] for a, row in zip(change, _MATRIX, strict=True)) for j in range(STAGES)
    ]
    return np.array(change, dtype=float), np.array(of_places, dtype=float)


RATE_ERROR, PLACE_ERROR = _lower_order()


def fields(unknowns: int) -> list[tuple[str, type, tuple[int, ...]]]:
    """Names, types and shapes of what a step works on.

    ``start`` and ``y`` are the states at the step's start and end. ``rates`` has a row of
    accelerations and integrals' rates at the start and at each point, ``polynomial`` a row of their
    coefficients for each power of time. ``k`` has the derivatives of f by (z, z') at the start.
    ``error`` has errors of (z, z'), and ``weights`` their weights. The rest is for Newton's method.
    """
    n = unknowns
    return [
        *((name, float, (3 * n,)) for name in ("y", "start", "trial")),
        *((name, float, (1 + STAGES, 2 * n)) for name in ("rates", "polynomial")),
        ("k", float, (n, 2 * n)),
        *((name, float, (2 * n,)) for name in ("error", "weights")),
        ("residuals", float, (STAGES, n)),
        ("real", float, (n, n)),
        ("pairs", complex, (PAIRS, n, n)),
        ("x", float, (n,)),
        ("z", complex, (PAIRS, n)),
    ]


@compiled
def factorise(work, h):
    """Triangular factors of Newton's systems I - h a df/dz' - (h a)^2 df/dz, for each eigenvalue a.

    Rows are not exchanged: the largest entries are those of the depths, on the diagonal.
    """
    k, real, pairs, n = work.k, work.real, work.pairs, len(work.x)
    a = h * REAL
    for i in range(n):
        for j in range(n):
            real[i, j] = -a * (k[i, n + j] + a * k[i, j])
        real[i, i] += 1
    for i in range(n):
        real[i, i] = 1 / real[i, i]
        for row in range(i + 1, n):
            real[row, i] *= real[i, i]
            for j in range(i + 1, n):
                real[row, j] -= real[row, i] * real[i, j]
    for q in range(PAIRS):
        b = h * COMPLEX[q]
        for i in range(n):
            for j in range(n):
                pairs[q, i, j] = -b * (k[i, n + j] + b * k[i, j])
            pairs[q, i, i] += 1
        for i in range(n):
            d = pairs[q, i, i]
            pairs[q, i, i] = d.conjugate() * (1 / (d.real * d.real + d.imag * d.imag))
            for row in range(i + 1, n):
                pairs[q, row, i] *= pairs[q, i, i]
                for j in range(i + 1, n):
                    pairs[q, row, j] -= pairs[q, row, i] * pairs[q, i, j]


@compiled
def _solve(work):
    """Solve the real system, for ``x`` in place."""
    real, x, n = work.real, work.x, len(work.x)
    for i in range(n):
        for j in range(i):
            x[i] -= real[i, j] * x[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= real[i, j] * x[j]
        x[i] *= real[i, i]


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
    residuals, pairs, x, z, n = work.residuals, work.pairs, work.x, work.z, len(work.x)
    for m in range(n):
        x[m] = 0.0
        for j in range(STAGES):
            x[m] += REAL_INVERSE[j] * residuals[j, m]
    _solve(work)
    for q in range(PAIRS):
        for m in range(n):
            z[q, m] = 0.0
            for j in range(STAGES):
                z[q, m] += COMPLEX_INVERSES[q, j] * residuals[j, m]
        for i in range(n):
            for j in range(i):
                z[q, i] -= pairs[q, i, j] * z[q, j]
        for i in range(n - 1, -1, -1):
            for j in range(i + 1, n):
                z[q, i] -= pairs[q, i, j] * z[q, j]
            z[q, i] *= pairs[q, i, i]
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
    for m in range(n):
        place = speed = integral = 0.0
        for j in range(STAGES):
            place += PLACE[STAGES - 1, j] * rates[1 + j, m]
            speed += RATE[STAGES - 1, j] * rates[1 + j, m]
            integral += RATE[STAGES - 1, j] * rates[1 + j, n + m]
        work.y[m] = start[m] + h * (start[n + m] + h * place)
        work.y[n + m] = start[n + m] + h * speed
        work.y[2 * n + m] = start[2 * n + m] + h * integral
    for i in range(1 + STAGES):
        for m in range(2 * n):
            total = 0.0
            for j in range(1 + STAGES):
                total += MONOMIALS[i, j] * rates[j, m]
            work.polynomial[i, m] = total


@compiled
def estimate(work, h):
    """Fill ``error`` with the estimated errors of z and z' of a step."""
    rates, k, error, n, g = work.rates, work.k, work.error, len(work.x), h * REAL
    for m in range(n):
        place, speed = 0.0, REAL * rates[0, m]
        for j in range(STAGES):
            place += PLACE_ERROR[j] * rates[1 + j, m]
            speed += RATE_ERROR[j] * rates[1 + j, m]
        error[m], work.x[m] = h * h * place, h * speed
    for m in range(n):
        for j in range(n):
            work.x[m] += g * k[m, j] * error[j]
    _solve(work)
    for m in range(n):
        error[n + m] = work.x[m]
        error[m] += g * work.x[m]


@compiled
def largest(work):
    """Largest weighted ``error``; infinite if one is not a number."""
    size = total = 0.0
    for m in range(len(work.error)):
        one = abs(work.error[m]) * work.weights[m]
        size, total = max(size, one), total + one
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
    for m in range(2 * n):
        speed = place = 0.0
        for i in range(STAGES, -1, -1):
            share = work.polynomial[i, m] * SHARES[i]
            speed = speed * x + share
            place = place * x + share * SHARES[i + 1]
        work.trial[n + m] = start[n + m] + h * x * speed
        if m < n:
            work.trial[m] = start[m] + h * x * (start[n + m] + h * x * place)
