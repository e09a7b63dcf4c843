"""How each law's force grows with depth: force_star = scale(R2*) shape(depth_star).

Every shape returns its value and its derivative for depth_star > 0. The functions are written
so that the same lines serve NumPy arrays and the compiled stepping loops (`study.contact.forces`).
``constants`` is what a shape needs besides the depth; most need nothing.
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
    """Liu's ds sqrt(ds / (2 (1 + ds)))."""
    root = np.sqrt(depth_star / (2 * (1 + depth_star)))
    return depth_star * root, root * (1.5 + depth_star) / (1 + depth_star)


def half_angle(depth_star, constants):
    """Liu's other reading, ds eps with cos(eps) = 1/(1 + ds)."""
    root = np.sqrt(depth_star * (2 + depth_star))
    eps = np.arctan(root)
    return depth_star * eps, eps + depth_star / (root * (1 + depth_star))


def hyperbolic(depth_star, constants):
    """f2 of the hyperbolic Winkler law: ds times the bracket of Eq. 20.

    In t = 2a = sqrt(8 ds) the bracket is the entire function
    sum_{k>=1} (-1)^(k+1) (2k+1)/(2k+2)! t^(2k), a rapidly converging series in ds: no
    cancellation as ds -> 0, and full accuracy up to a = pi/2.
    """
    bracket = 0.0 * depth_star
    slope = 0.0 * depth_star
    for coefficient in _BRACKET:
        slope = slope * depth_star + bracket
        bracket = bracket * depth_star + coefficient
    return depth_star * bracket, bracket + depth_star * slope


_BRACKET = tuple(
    (-1) ** (k + 1) * (2 * k + 1) * 8.0**k / factorial(2 * k + 2) if k else 0.0
    for k in range(19, -1, -1)
)

LIMITS = {hyperbolic: pi**2 / 8}
"""Largest depth_star, of shapes that have one: there the half-angle a is 90 deg."""
SHAPES = (hertz, winkler, power, chord, liu, half_angle, hyperbolic)
