"""Tables of a law over s = sqrt(ds), cubic Hermite splines that `shapes.table` evaluates.

They hold the secant stiffness F = P*/(scale ds), for which Hertz's law is linear in s and every
power of the depth is smooth. SciPy is imported late: most laws need no table.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.contact import shapes

Floats = NDArray[np.float64]
STEPS, STEPS_OF_FUNCTION = 256, 1024
"""Intervals per unit of s in the table of a curve, and of a function."""
FEWEST = 64
"""Minimum number of intervals."""
DEEPEST = 200.0
"""Largest depth_star of a function's table."""
TOLERANCE, FLOOR = 0.01, 1e-6
"""Largest error of a function's table between its knots, relative to the force there, or to the
force at the largest depth where this allows more: kinks are rounded. A smooth function is followed
within 1e-6."""
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
    slopes, steps = monotone_slopes(root, factor), np.diff(root)
    knots = _knots(root[-1], STEPS)
    k = np.clip(np.searchsorted(root, knots, "right") - 1, 0, len(root) - 2)
    left, right = slopes[k] * steps[k], slopes[k + 1] * steps[k]
    value, slope = shapes.cubic((knots - root[k]) / steps[k], factor[k], left, factor[k + 1], right)
    return _constants(knots, knots * value, value + knots * slope / steps[k])


def of_function(function: Callable[..., Any], name: str, r2_star: float, deepest: float) -> Floats:
    """Constants of `shapes.table` of a function of one depth_star and one r2_star.

    Raises
    ------
    ValueError
        For a force that is not a finite number, is not 0 at depth 0, or does not increase with
        depth, and for one that its table does not follow within `TOLERANCE`.
    """
    knots = _knots(np.sqrt(deepest), STEPS_OF_FUNCTION)
    root = np.linspace(0, knots[-1], 4 * len(knots) - 3)  # the knots, and three places between two
    depth = root * root
    force = np.empty_like(depth)
    for k, ds in enumerate(depth.tolist()):
        value, at = np.asarray(function(ds, r2_star)), f"at depth_star {ds:.6g}"
        value = value.item() if value.size == 1 else value
        force[k] = checks.number(f"force_star of law {name} {at}", value, scalar=True)
    if abs(force[0]) > 1e-12 * abs(force[-1]):
        raise ValueError(f"force_star of law {name} must be 0 at depth_star 0, got {force[0]:g}")
    force[0] = 0.0
    falls = np.flatnonzero(np.diff(force) <= 0)
    if falls.size:
        (ds1, ds2), (p1, p2) = depth[falls[0] :][:2], force[falls[0] :][:2]
        raise ValueError(
            f"force_star of law {name} must increase with depth_star, got {p1:.9g} at {ds1:.6g} "
            f"and {p2:.9g} at {ds2:.6g}"
        )
    secant = np.append(0.0, force[4::4] / depth[4::4])
    secant[0] = max(0.0, secant[1:4] @ (3, -3, 1))  # a parabola through the next three
    constants = _constants(knots, secant, monotone_slopes(knots, secant))
    table, slope = shapes.table(depth[1:], constants)
    allowed = np.maximum(TOLERANCE * force[1:], FLOOR * force[-1])
    wrong = (np.abs(table - force[1:]) > allowed) | (slope <= 0)
    if wrong.any():
        raise ValueError(
            f"law {name} must be smooth, because it is tabulated: no table is within "
            f"{TOLERANCE:g} of its force at depth_star {depth[1:][wrong][0]:.4g}"
        )
    return constants


def _knots(last, steps):
    return np.linspace(0, last, max(FEWEST, int(np.ceil(steps * last))) + 1)


def _constants(knots, secant, slope):
    return np.append((len(knots) - 1) / knots[-1], np.column_stack([secant, slope]).ravel())
