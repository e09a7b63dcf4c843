"""One step of Rodas5P, a stiffly accurate Rosenbrock method of order 5, for compiled loops.

For z'' = f(z, z') with three or five unknowns, beside which integrals are carried whose rates
depend on z and z' alone. A state is (z, z', integrals), ``f`` the accelerations and, from `POWERS`
on, the integrals' rates, ``k`` their derivatives to (z, z'). The form needs no product with the
Jacobian: (I/(gamma h) - J) u_i = f(y + sum_j A_ij u_j) + sum_j C_ij u_j / h. The caller computes f
between `begin_stage` and `end_stage`. Coefficients: Steinebach, BIT 63 (2023), 27.

Three unknowns are solved for by cofactors, more by elimination with pivots.
"""

import numpy as np

from study.compiled import compiled

STAGES = 8
POWERS = 5
"""Place of the integrals' rates in ``f`` and ``k``."""
GAMMA = 0.21193756319429014
A = np.zeros((STAGES, STAGES))
A[1, 0] = 3.0
A[2, :2] = 2.849394379747939, 0.45842242204463923
A[3, :3] = -6.954028509809101, 2.489845061869568, -10.358996098473584
A[4, :4] = 2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641
A[5, :3] = -7.502846399306121, 2.561846144803919, -11.627539656261098
A[5, 3:5] = -0.18268767659942256, 0.030198172008377946
A[6], A[7] = A[5], A[5]
A[6, 5] = A[7, 5] = A[7, 6] = 1.0
C = np.zeros((STAGES, STAGES))
C[1, 0] = -14.155112264123755
C[2, :2] = -17.97296035885952, -2.859693295451294
C[3, :3] = 147.12150275711716, -1.41221402718213, 71.68940251302358
C[4, :4] = 165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306
C[5, :3] = 24.854864614690072, -3.0009227002832186, 47.4931110020768
C[5, 3:5] = 5.5814197821558125, -0.6610691825249471
C[6, :3] = 30.91273214028599, -3.1208243349937974, 77.79954646070892
C[6, 3:6] = 34.28646028294783, -19.097331116725623, -28.087943162872662
C[7, :4] = 37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047
C[7, 4:7] = -40.06618937091002, -54.66780262877968, -9.48861652309627


@compiled
def cofactors(k, h):
    """Return gamma h and the inverse of I/(gamma h) - df/dz' - gamma h df/dz, by cofactors.

    The six unknowns of a stage are reduced to three: the first half of the system is the
    definition of z'.
    """
    g = GAMMA * h
    w00, w01, w02 = 1 / g - k[0, 3] - g * k[0, 0], -k[0, 4] - g * k[0, 1], -k[0, 5] - g * k[0, 2]
    w10, w11, w12 = -k[1, 3] - g * k[1, 0], 1 / g - k[1, 4] - g * k[1, 1], -k[1, 5] - g * k[1, 2]
    w20, w21, w22 = -k[2, 3] - g * k[2, 0], -k[2, 4] - g * k[2, 1], 1 / g - k[2, 5] - g * k[2, 2]
    c00, c01, c02 = w11 * w22 - w12 * w21, w02 * w21 - w01 * w22, w01 * w12 - w02 * w11
    c10, c11, c12 = w12 * w20 - w10 * w22, w00 * w22 - w02 * w20, w02 * w10 - w00 * w12
    c20, c21, c22 = w10 * w21 - w11 * w20, w01 * w20 - w00 * w21, w00 * w11 - w01 * w10
    d = 1 / (w00 * c00 + w01 * c10 + w02 * c20)
    return g, ((c00, c01, c02), (c10, c11, c12), (c20, c21, c22)), d


@compiled
def triangles(k, h, n):
    """The same for ``n`` unknowns: gamma h, both triangles, and the rows exchanged."""
    g, w, pivots = GAMMA * h, np.empty((n, n)), np.zeros(n, np.int64)
    for i in range(n):
        for j in range(n):
            w[i, j] = -k[i, n + j] - g * k[i, j]
        w[i, i] += 1 / g
    _eliminate(w, pivots)
    return g, w, pivots


@compiled
def _eliminate(w, pivots):
    """Factorise a matrix in place, with the rows exchanged that ``pivots`` tell."""
    n = len(w)
    for i in range(n):
        best = i
        for row in range(i + 1, n):
            if abs(w[row, i]) > abs(w[best, i]):
                best = row
        pivots[i] = best
        for j in range(n):
            w[i, j], w[best, j] = w[best, j], w[i, j]
        for row in range(i + 1, n):
            w[row, i] /= w[i, i]
            for j in range(i + 1, n):
                w[row, j] -= w[row, i] * w[i, j]


@compiled
def begin_stage(i, y, rate, u, work, new, size):
    """Fill ``new`` with the state of stage ``i``, ``work`` with sum_j C_ij u_j times rate 1/h.

    ``size`` is the number of their places.
    """
    for n in range(size):
        new[n] = y[n]
        work[n] = 0.0
    for j in range(i):
        a, c = A[i, j], C[i, j] * rate
        for n in range(size):
            new[n] += a * u[j, n]
            work[n] += c * u[j, n]


@compiled
def end_stage_of_three(i, new, f, k, factors, u, work, integrals):
    """Solve stage ``i`` for ``u[i]``; the last one is the step's error estimate.

    ``integrals`` is a tuple with their number: its length is known to the compiler, for speed.
    """
    g, (c0, c1, c2), d = factors
    r0, r1, r2 = work[0] + new[3], work[1] + new[4], work[2] + new[5]
    b0 = work[3] + f[0] + g * (k[0, 0] * r0 + k[0, 1] * r1 + k[0, 2] * r2)
    b1 = work[4] + f[1] + g * (k[1, 0] * r0 + k[1, 1] * r1 + k[1, 2] * r2)
    b2 = work[5] + f[2] + g * (k[2, 0] * r0 + k[2, 1] * r1 + k[2, 2] * r2)
    u[i, 3] = (c0[0] * b0 + c0[1] * b1 + c0[2] * b2) * d
    u[i, 4] = (c1[0] * b0 + c1[1] * b1 + c1[2] * b2) * d
    u[i, 5] = (c2[0] * b0 + c2[1] * b1 + c2[2] * b2) * d
    u[i, 0], u[i, 1], u[i, 2] = g * (r0 + u[i, 3]), g * (r1 + u[i, 4]), g * (r2 + u[i, 5])
    for n in range(len(integrals)):
        power = f[POWERS + n] + work[6 + n]
        for j in range(6):
            power += k[POWERS + n, j] * u[i, j]
        u[i, 6 + n] = g * power


@compiled
def end_stage(i, new, f, k, factors, u, work):
    """The same for more unknowns, with `triangles`."""
    g, w, pivots = factors
    n = len(w)
    rates = u[i, n : 2 * n]
    for m in range(n):
        rates[m] = work[n + m] + f[m]
        for j in range(n):
            rates[m] += g * k[m, j] * (work[j] + new[n + j])
    _substitute(w, pivots, rates)
    for m in range(n):
        u[i, m] = g * (work[m] + new[n + m] + rates[m])
    for m in range(len(new) - 2 * n):
        power = f[POWERS + m] + work[2 * n + m]
        for j in range(2 * n):
            power += k[POWERS + m, j] * u[i, j]
        u[i, 2 * n + m] = g * power


@compiled
def _substitute(w, pivots, x):
    """Solve for a right side in place, with what `_eliminate` has found."""
    n = len(w)
    for i in range(n):
        best = pivots[i]
        x[i], x[best] = x[best], x[i]
    for i in range(n):
        for j in range(i):
            x[i] -= w[i, j] * x[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= w[i, j] * x[j]
        x[i] /= w[i, i]
