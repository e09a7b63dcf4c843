"""Tables of a law over s = sqrt(ds), cubic Hermite splines that `shapes.table` evaluates.

They hold the secant stiffness F = P*/(scale ds), for which Hertz's law is linear in s and every
power of the depth is smooth. SciPy is imported late: most laws need no table.
"""

import numpy as np
from numpy.typing import NDArray

from study.contact import shapes

Floats = NDArray[np.float64]
STEPS = 256
"""Intervals per unit of s."""
FEWEST = 64
"""Minimum number of intervals."""
_NEWTON = 30  # steps of Newton's method, which converges from above


def monotone_slopes(x: Floats, y: Floats) -> Floats:
    """Slopes of a cubic spline, limited to three times the smaller of the neighbouring chords'.

    The spline is then monotone where its points are (Hyman, SIAM J. Sci. Stat. Comput. 4 (1983)
    645-654).
    """
    chords = np.diff(y) / np.diff(x)
    left, right = np.insert(chords, 0, chords[0]), np.append(chords, chords[-1])
    most = 3 * np.minimum(np.abs(left), np.abs(right)) * (left * right > 0)
    least = np.where(left > 0, 0, -most)
    return np.clip(_spline_slopes(x, chords), least, np.where(left > 0, most, 0))


def _spline_slopes(x, chords):
    """Slopes of SciPy's ``CubicSpline``, whose import takes longer than to solve a joint."""
    from scipy.linalg import solve_banded

    step, bands, right = np.diff(x), np.zeros((3, len(x))), np.empty(len(x))
    bands[0, 2:], bands[1, 1:-1], bands[2, :-2] = step[:-1], 2 * (step[:-1] + step[1:]), step[1:]
    right[1:-1] = 3 * (step[1:] * chords[:-1] + step[:-1] * chords[1:])
    first, last = step[0] + step[1], step[-2] + step[-1]
    bands[1, 0], bands[0, 1], bands[1, -1], bands[2, -2] = step[1], first, step[-2], last
    right[0] = (step[0] + 2 * first) * step[1] * chords[0] + step[0] ** 2 * chords[1]
    right[-1] = (step[-1] + 2 * last) * step[-2] * chords[-1] + step[-1] ** 2 * chords[-2]
    right[[0, -1]] /= first, last
    return solve_banded((1, 1), bands, right)


def of_points(root: Floats, factor: Floats) -> Floats:
    """Constants of `shapes.table` from the stiffening S over Hertz's law at some s > 0.

    Between the points, S is interpolated by a monotone cubic spline from S = 1 at s = 0, and
    F = s S. Below the first point a contact softer than Hertz's bends the wall, which is a linear
    spring in series with it: with y = S^(1/3), the depth over that of Hertz's law is
    1/y^2 = 1 + c y s.
    """
    below = np.zeros(1)
    if factor[0] < 1:
        below = root[0] * np.array([0, 0.125, 0.25, 0.5])
    y = np.cbrt(factor[0])
    c, y = (1 / y**2 - 1) / (y * root[0]), np.ones_like(below)
    for _ in range(_NEWTON):
        y = y - (c * below * y**3 + y**2 - 1) / (3 * c * below * y**2 + 2 * y)
    root, factor = np.append(below, root), np.append(y**3, factor)
    knots, value, slope, step = _at_knots(root, factor)
    return _constants(knots, knots * value, value + knots * slope / step)


def of_secants(root: Floats, secant: Floats) -> Floats:
    """Constants of `shapes.table` from the secant stiffness F at some s > 0, at least three.

    Between the points, F is interpolated by a monotone cubic spline, from the value at s = 0 of a
    parabola through the first three points, but not less than 0.
    """
    first = max(0.0, float(np.polyval(np.polyfit(root[:3], secant[:3], 2), 0.0)))
    knots, value, slope, step = _at_knots(np.append(0.0, root), np.append(first, secant))
    return _constants(knots, value, slope / step)


def _at_knots(x, y):
    """Equally spaced knots from 0, and there a monotone cubic spline.

    These are its values, its slopes in units of the interval of ``x``, and the lengths of these.
    """
    slopes, steps = monotone_slopes(x, y), np.diff(x)
    knots = np.linspace(0, x[-1], max(FEWEST, int(np.ceil(STEPS * x[-1]))) + 1)
    k = np.clip(np.searchsorted(x, knots, "right") - 1, 0, len(x) - 2)
    left, right = slopes[k] * steps[k], slopes[k + 1] * steps[k]
    value, slope = shapes.cubic((knots - x[k]) / steps[k], y[k], left, y[k + 1], right)
    return knots, value, slope, steps[k]


def _constants(knots, secant, slope):
    return np.append((len(knots) - 1) / knots[-1], np.column_stack([secant, slope]).ravel())
