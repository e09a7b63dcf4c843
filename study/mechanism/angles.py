"""Sine, angle and sixth root with the same bits on every processor, for compiled loops.

Impacts are chaotic: each enlarges the rounding of those before it. Sines of the system's
mathematical library differ in their last bit between processors. With them, impacts of an elastic
joint differ by more than 1e-3 from the 69th on, and 309 come out instead of 320 (scene of the
paper, rigid links, 0.2 s). The bits of sums, products, quotients and square roots are the same, and
nothing else is used here.
"""

from math import factorial, pi, sqrt

import numpy as np

from study.compiled import compiled

# pi/2 in three parts, of which the first two have 33 bits: their multiples by whole numbers below
# a million are exact
PART1, PART2, PART3 = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
SINE = np.array([(-1) ** k / factorial(2 * k + 1) for k in range(9)])
COSINE = np.array([(-1) ** k / factorial(2 * k) for k in range(10)])
"""Coefficients of the Taylor series in the square of the angle, enough for pi/4."""
LARGEST = 1e6


@compiled
def sine_cosine(angle):
    """Sine and cosine of an angle in rad, within 2e-16 up to `LARGEST`; NaN beyond it."""
    if not abs(angle) < LARGEST:
        return np.nan, np.nan
    quarters = np.floor(angle * (2 / pi) + 0.5)
    sine, cosine = _near_zero(((angle - quarters * PART1) - quarters * PART2) - quarters * PART3)
    turn = int(quarters) & 3
    if turn == 0:
        return sine, cosine
    if turn == 1:
        return cosine, -sine
    if turn == 2:
        return -sine, -cosine
    return -cosine, sine


@compiled
def _near_zero(x):
    """Sine and cosine of an angle between -pi/4 and pi/4.

    The series are summed in pairs, and pairs of pairs (Estrin), which is faster.
    """
    z = x * x
    z2 = z * z
    z4 = z2 * z2
    a, b = SINE, COSINE
    high = a[4] + a[5] * z + z2 * (a[6] + a[7] * z) + z4 * a[8]
    sine = a[0] + (a[1] * z + z2 * (a[2] + a[3] * z) + z4 * high)
    high = b[4] + b[5] * z + z2 * (b[6] + b[7] * z) + z4 * (b[8] + b[9] * z)
    cosine = b[0] + (b[1] * z + z2 * (b[2] + b[3] * z) + z4 * high)
    return x * sine, cosine


@compiled
def norm(x, y):
    """Length of a vector, which must be neither very long nor very short (over- and underflow)."""
    return sqrt(x * x + y * y)


@compiled
def direction(y, x):
    """Angle of the vector (x, y) from the x-axis in rad, in (-pi, pi], within 1e-15; 0 for none."""
    size = norm(x, y)
    return angle_of(y / size, x / size) if size > 0 else 0.0


@compiled
def angle_of(sine, cosine):
    """Angle in rad, in (-pi, pi], of a sine and a cosine."""
    steep = abs(sine) > abs(cosine)
    s, c = (cosine, abs(sine)) if steep else (sine, abs(cosine))  # from the nearest axis
    t = s / c
    guess = t * (pi / 4 + 0.273 * (1 - abs(t)))  # within 0.004 rad
    near_sine, near_cosine = _near_zero(guess)
    left = s * near_cosine - c * near_sine  # sine of what is left of the angle
    cube = left * left * left
    angle = guess + left + cube / 6 + 3 * cube * left * left / 40
    # conditional expressions, no branches: a loop over elements is then compiled to vectors
    upright = pi / 2 - angle if sine > 0 else angle - pi / 2
    backwards = pi - angle if sine >= 0 else -pi - angle
    level = angle if cosine > 0 else backwards
    return upright if steep else level


@compiled
def sixth_root(x):
    """Sixth root of a number by Newton's method, within 1e-15 from 1e-12 to 1e12."""
    square = sqrt(x)
    eighth = sqrt(sqrt(square))
    root = eighth * sqrt(sqrt(eighth))  # x^(5/32)
    for _ in range(12):
        root += (square / (root * root) - root) / 3
    return root


def arcsine(sine: float) -> float:
    """Angle in rad, in [-pi/2, pi/2], of a sine."""
    return angle_of(sine, sqrt(1 - sine * sine))
