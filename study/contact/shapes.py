"""How each law's force grows with depth: force_star = scale(R2*) shape(depth_star).

Every shape returns its value and its derivative for depth_star > 0. The same lines serve NumPy
arrays and the compiled stepping loops (`study.contact.forces`). ``constants`` is what a shape needs
besides the depth; most need nothing.
"""

from math import factorial, pi

import numpy as np


def hertz(depth_star, constants):
    """ds^(3/2)."""
    root = np.sqrt(depth_star)
    return depth_star * root, 1.5 * root


def winkler(depth_star, constants):
    """ds^2."""
    return depth_star * depth_star, 2 * depth_star


def power(depth_star, constants):
    """ds^m, with the exponent m as the only constant."""
    value = depth_star ** constants[0]
    return value, constants[0] * value / depth_star


def chord(depth_star, constants):
    """Steuermann's ds sin(eps), with cos(eps) = 1/(1 + ds)."""
    root = np.sqrt(depth_star * (2 + depth_star))
    sine = root / (1 + depth_star)
    return depth_star * sine, sine + depth_star / (root * (1 + depth_star) ** 2)


def liu(depth_star, constants):
    """Liu's ds sin(eps) sin(eps/2), with cos(eps) = 1/(1 + ds)."""
    share = depth_star / (1 + depth_star)  # the whole never overflows on the way
    value = depth_star * share * np.sqrt(1 - share / 2)
    return value, value * (2 / depth_star + 0.5 / (2 + depth_star) - 1.5 / (1 + depth_star))


def hyperbolic(depth_star, constants):
    """f2 of the hyperbolic Winkler law: ds times the bracket of Eq. 20, a power series in ds.

    ``constants`` are its coefficients, one of `BRACKETS`, from the highest power to 0. Nothing
    cancels as ds -> 0, and the series has full accuracy up to a half-angle of 90 deg.
    """
    bracket = slope = 0.0 * depth_star
    for k in range(len(constants)):
        slope = slope * depth_star + bracket
        bracket = bracket * depth_star + constants[k]
    return depth_star * bracket, bracket + depth_star * slope


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


def stiffened(depth_star, constants):
    """ds^(3/2) S, with S = 1 + c1 u + c2 u^2 + ... + c9 u^9, u = s/(1 + s) and s = sqrt(ds).

    ``constants`` are the coefficients from c9 to c1. Powers are summed in pairs, and pairs of pairs
    (Estrin), which is faster than one after the other.
    """
    root = np.sqrt(depth_star)
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
    return depth_star * root * factor, root * 1.5 * factor + depth_star * steepness / 2


def cubic(x, left, slope, right, next_slope):
    """Value and dvalue/dx at x = 0 to 1 in an interval of a cubic Hermite spline.

    ``left``, ``slope``, ``right`` and ``next_slope`` are those at its ends.
    """
    rise = right - left
    c2, c3 = 3 * rise - 2 * slope - next_slope, slope + next_slope - 2 * rise
    return left + x * (slope + x * (c2 + x * c3)), slope + x * (2 * c2 + x * 3 * c3)


def tabulated(depth_star, constants):
    """ds^(3/2) S, with S a cubic Hermite spline on equal steps of s = sqrt(ds).

    ``constants`` are the steps per unit of s, then S and dS/ds in turn at every knot.
    """
    root = np.sqrt(depth_star)
    place = root * constants[0]
    knot = np.int64(np.minimum(place, (len(constants) - 1) // 2 - 2))
    x, step, at = place - knot, 1 / constants[0], 1 + 2 * knot
    left, slope = constants[at], constants[at + 1] * step
    right, next_slope = constants[at + 2], constants[at + 3] * step
    factor, steepness = cubic(x, left, slope, right, next_slope)
    steepness = steepness * constants[0]
    return depth_star * root * factor, root * 1.5 * factor + depth_star * steepness / 2


def sampled(depth_star, constants):
    """F ds, with F a cubic Hermite spline over s = sqrt(ds).

    ``constants`` are its knots, F there, and dF/ds there.
    """
    root, count = np.sqrt(depth_star), len(constants) // 3
    knot = np.searchsorted(constants[:count], root, "right") - 1
    knot = np.minimum(knot, count - 2)
    step = constants[knot + 1] - constants[knot]
    x, value, end = (root - constants[knot]) / step, count + knot, 2 * count + knot
    left, slope = constants[value], constants[end] * step
    right, next_slope = constants[value + 1], constants[end + 1] * step
    factor, steepness = cubic(x, left, slope, right, next_slope)
    return depth_star * factor, factor + root * steepness / (2 * step)


LIMITS = {hyperbolic: pi**2 / 8, stiffened: 1.0}
"""Largest depth_star of shapes that have one: a half-angle of 90 deg, and the end of the fit."""
SHAPES = (hertz, winkler, power, chord, liu, hyperbolic, stiffened, tabulated, sampled)
