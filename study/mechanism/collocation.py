"""One step of collocation at Radau's points, for compiled loops: of order 9, for stiff equations.

It solves z'' = f(z, z') with n unknowns, and n integrals whose rates depend on z and z' alone. A
state is (z, z', integrals). A step works on one record, of `fields`.

A step's accelerations are a polynomial in time that meets the equations at the five points of
Radau's right rule (Radau IIA). It gives the state at every time in the step. Newton's method finds
the accelerations at the points, with the derivatives at the step's start. The eigenvectors of
Radau's matrix split its system into one real and two complex systems of n unknowns. The error is
estimated against a method of order 5 with the same points and the step's start (Hairer and Wanner,
Solving Ordinary Differential Equations II, secs. IV.5 and IV.8).

The rule's constants are literals, which have the same bits on every processor.
`tests/mechanism/test_collocation.py` computes them again, in fractions.
"""

import numpy as np

from study.compiled import compiled, inlined

STAGES = 5
PAIRS = STAGES // 2
AT_START = 0  # row of the rates at a step's start, before those at its points
"""The error estimate grows with the power `STAGES` + 1 of the step, hence the sixth roots."""


def _numbers(text):
    return np.array(text.split(), dtype=complex if "j" in text else float)


POINTS = _numbers("""
    0.05710419611451768 0.2768430136381238 0.5835904323689168 0.8602401356562195
    1.0
""")
RATE = _numbers("""
    0.07299886431790333 -0.02673533110794557 0.01867692976398435 -0.01287910609330644
    0.0050428392338820165 0.15377523147918246 0.14621486784749346 -0.036444568905128066
    0.021233063119304712 -0.007935579902728777 0.14006304568480987 0.29896712949128346
    0.167585070135249 -0.03396910168661778 0.010944288744192267 0.14489430810953474
    0.2765000687601592 0.3257979229104211 0.12875675325490976 -0.01570891737880533
    0.14371356079122594 0.28135601514946207 0.3118265229757413 0.22310390108357073
    0.03999999999999999
""").reshape(STAGES, STAGES)
PLACE = _numbers("""
    0.0026921653450316194 -0.002419204202085872 0.0028442318729743716 -0.0026754663973015797
    0.0011887179883241085 0.03054120463258054 0.010010047971894266 -0.0041210906920285915
    0.003325532699545791 -0.0014346675118728028 0.0763215713643023 0.08375801730851298
    0.012150631980818893 -0.003080650913364248 0.001139326635999711 0.11512676760096317
    0.1651389462496801 0.08427834845361512 0.006011352233119417 -0.0005488690404623671
    0.1355069134314881 0.20346456801027135 0.12984754760823247 0.03118097095000806
    4.2673712501010904e-18
""").reshape(STAGES, STAGES)
"""Weights of the accelerations at the points in the change of rates and places up to each point:
Radau's matrix and its square."""
# Eigenvalues, vectors and inverse vectors of `RATE`: the real one, and one of each complex pair.
# Ten digits do: they affect the convergence of Newton's method only, not its result.
REAL = 0.1590658444
REAL_VECTOR = _numbers("""
    0.0135768673 0.0016179004 0.0791578533 0.4122560827 1.0
""")
REAL_INVERSE = _numbers("""
    27.6976937757 12.7833379113 3.2084893867 -0.9514904122 0.741550496
""")
COMPLEX = _numbers("""
    0.133179077+0.0749945118j 0.0650657785+0.1164685277j
""")
COMPLEX_VECTORS = _numbers("""
    -0.0229570306-0.0280397178j -0.0204840956+0.0953477546j
    -0.0153376614+0.0494171568j 0.100345729-0.1886636384j
    0.038796928+0.1636007074j -0.461079068+0.2054060908j
    0.8152023426+0.3993648558j 0.7557878044+0.9334882606j
    2+0j 2+0j
""").reshape(STAGES, PAIRS)
COMPLEX_INVERSES = _numbers("""
    -16.5209401068+4.3057219899j -8.6884767395-4.8499957048j -0.0860645316-0.9573643198j
    -0.049584889-1.209346003j 0.2656140579+0.523731744j 2.6720932189-1.8740299037j
    2.2968077839+1.9924828682j -1.5181801617+0.5222078208j 0.5253300951-0.5920492841j
    -0.1363893059+0.2249588851j
""").reshape(PAIRS, STAGES)
MONOMIALS = _numbers("""
    1.0 0.0 0.0 0.0
    0.0 0.0 -25.0 27.78093394406464
    -3.641478498049213 1.2525477211691185 -0.5920031671845428 0.20000000000000004
    150.0 -208.02785730090133 77.88337605511782 -29.16741431782969
    14.111895563613205 -4.800000000000002 -350.0 524.1878839694918
    -264.89491356822634 137.90290440413474 -72.39587480540027 25.200000000000006
    350.0 -543.8283560361325 317.67586907995275 -202.09087094360737
    123.04335789978718 -44.80000000000001 -126.0 199.88739542347736
    -127.02285306879499 92.1028331361332 -64.16737549081559 25.200000000000006
""").reshape(1 + STAGES, 1 + STAGES)
"""Coefficients of the polynomial in a step's time from its values at the start and the points:
a row for each power, from the lowest."""
RATE_ERROR = _numbers("""
    -0.25234331220596923 0.1603571220752778 -0.11627313432088354 0.08100664893157496
    -0.031813168880000006
""")
PLACE_ERROR = _numbers("""
    -0.002881972397679326 0.008878749786731284 -0.013571177746242714 0.013937034133190758
    -0.006362633776000002
""")
"""Weights of the difference to a method of order `STAGES`, whose weight at the start is `REAL`."""
SHARES = 1 / np.arange(1.0, STAGES + 3)
"""Factor of the power x^i in its integral, whose power is one higher."""


def fields(unknowns: int) -> list[tuple[str, type, tuple[int, ...]]]:
    """Names, types and shapes of what a step works on.

    ``start`` and ``y`` are the states at the step's start and end. ``rates`` has a row of
    accelerations and integrals' rates at the start and at each point, ``polynomial`` a row of their
    coefficients for each power of time. ``k`` has the derivatives of f by (z, z') at the start.
    ``error`` and ``weights`` are those of (z, z'). The rest is for Newton's method.
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
    """Triangular factors of Newton's systems, for each eigenvalue of Radau's matrix."""
    _factorise(work.real, work.k, h * REAL)
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
    _solve(work.real, x)
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
    for m in range(n):
        integral = 0.0
        for j in range(STAGES):
            integral += RATE[STAGES - 1, j] * rates[1 + j, n + m]
        work.y[m], work.y[n + m] = work.trial[m], work.trial[n + m]
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
        place, speed = 0.0, REAL * rates[AT_START, m]
        for j in range(STAGES):
            place += PLACE_ERROR[j] * rates[1 + j, m]
            speed += RATE_ERROR[j] * rates[1 + j, m]
        error[m], work.x[m] = h * h * place, h * speed
    for m in range(n):
        for j in range(n):
            work.x[m] += g * k[m, j] * error[j]
    _solve(work.real, work.x)
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
    for m in range(2 * n):
        speed = place = 0.0
        for i in range(STAGES, -1, -1):
            share = work.polynomial[i, m] * SHARES[i]
            speed = speed * x + share
            place = place * x + share * SHARES[i + 1]
        work.trial[n + m] = start[n + m] + h * x * speed
        if m < n:
            work.trial[m] = start[m] + h * x * (start[n + m] + h * x * place)
