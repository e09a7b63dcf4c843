"""How the force of each law grows with depth: force_star = scale(R2*) shape(depth_star).

Each shape is a function of ``ds`` > 0 and of ``constants`` that returns its value and its
derivative. It is for NumPy arrays, and for the compiled stepping loops (`study.contact.forces`),
which hold a shape by its place in `SHAPES`.
"""

from math import factorial

import numpy as np


def hertz(ds, constants):
    """Shape of Hertz's law: ds^(3/2)."""
    s = np.sqrt(ds)
    return ds * s, 1.5 * s


def winkler(ds, constants):
    """Shape of Winkler's law: ds^2."""
    return ds * ds, 2 * ds


def power(ds, constants):
    """Shape of the power law, and of Steuermann's profiles: ds^n, where n is the only constant."""
    value = ds ** constants[0]
    return value, constants[0] * value / ds


def chord(ds, constants):
    """Shape of Steuermann's law: ds sin(eps), cos(eps) = 1/(1 + ds)."""
    root = np.sqrt(ds * (2 + ds))
    sine = root / (1 + ds)
    return ds * sine, sine + ds / (root * (1 + ds) ** 2)


def liu(ds, constants):
    """Shape of Liu's law: ds sin(eps) sin(eps/2), cos(eps) = 1/(1 + ds)."""
    share = ds / (1 + ds)
    value = ds * share * np.sqrt(1 - share / 2)  # the whole never overflows on the way
    return value, value * (2 / ds + 0.5 / (2 + ds) - 1.5 / (1 + ds))


def hyperbolic(ds, constants):
    """f2 of the hyperbolic Winkler law: ds times the bracket of Eq. 20, a power series in ds.

    ``constants`` are its coefficients, one of `BRACKETS`, from the highest power to 0. Nothing
    cancels as ds -> 0, and the series has full accuracy up to a half-angle of 90 deg.
    """
    bracket = slope = 0.0 * ds
    for k in range(len(constants)):
        slope = slope * ds + bracket
        bracket = bracket * ds + constants[k]
    return ds * bracket, bracket + ds * slope


BRACKETS = {
    "sphere": tuple(
        (-1) ** (k + 1) * (2 * k + 1) * 8.0**k / factorial(2 * k + 2) if k else 0.0
        for k in range(19, -1, -1)
    ),
    "flat": tuple(
        (-1) ** (k + 1) * 2.0**k / (factorial(2 * k - 2) * k * (k + 1)) if k else 0.0
        for k in range(19, -1, -1)
    ),
}
"""Series of 2 int_0^a (1 - t^2/a^2) w(t) cos(t) dt with a = sqrt(2 ds). The area element is that of
the sphere, w(t) = sin(t), or of a flat disc with the arc as its radius, w(t) = t."""


def stiffened(ds, constants):
    """Shape of stiffened Hertz: ds^(3/2) S, S = 1 + c1 u + ... + c9 u^9; constants from c9 to c1.

    u = s/(1 + s) with s = sqrt(ds).
    Powers are summed in pairs, and pairs of pairs (Estrin): faster than one after the other.
    """
    root = np.sqrt(ds)
    u = root / (1 + root)
    u2 = u * u
    u4 = u2 * u2
    c9, c8, c7 = constants[0], constants[1], constants[2]
    c6, c5, c4 = constants[3], constants[4], constants[5]
    c3, c2, c1 = constants[6], constants[7], constants[8]
    rise = c5 + c6 * u + u2 * (c7 + c8 * u) + u4 * c9
    factor = 1 + u * (c1 + c2 * u + u2 * (c3 + c4 * u) + u4 * rise)
    slope = 5 * c5 + 6 * c6 * u + u2 * (7 * c7 + 8 * c8 * u) + u4 * (9 * c9)
    slope = c1 + 2 * c2 * u + u2 * (3 * c3 + 4 * c4 * u) + u4 * slope
    steepness = slope * (1 - u) ** 2
    return ds * root * factor, root * 1.5 * factor + ds * steepness / 2


def table(ds, constants):
    """Table of the secant stiffness: ds F(s), F a cubic Hermite spline over s = sqrt(ds).

    ``constants`` are the knots per unit of s, which are equally spaced, then F and dF/ds in turn at
    every knot.
    """
    root = np.sqrt(ds)
    place = root * constants[0]
    knot = np.int64(np.minimum(place, (len(constants) - 1) // 2 - 2))
    x, step, at = place - knot, 1 / constants[0], 1 + 2 * knot
    left, slope = constants[at], constants[at + 1] * step
    right, next_slope = constants[at + 2], constants[at + 3] * step
    secant, steepness = cubic(x, left, slope, right, next_slope)
    return ds * secant, secant + root * steepness * constants[0] / 2


def cubic(x, left, slope, right, next_slope):
    """Value and dvalue/dx at x = 0 to 1 in an interval of a cubic Hermite spline.

    ``left``, ``slope``, ``right`` and ``next_slope`` are those at its ends.
    """
    rise = right - left
    c2, c3 = 3 * rise - 2 * slope - next_slope, slope + next_slope - 2 * rise
    return left + x * (slope + x * (c2 + x * c3)), slope + x * (2 * c2 + x * 3 * c3)


SHAPES = (
    hertz,
    winkler,
    power,
    chord,
    liu,
    hyperbolic,
    stiffened,
    table,
)
"""All shapes; compiled code holds a shape by its place, so that a new one is added at the end."""
