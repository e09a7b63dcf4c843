"""Constants of `shapes.table`: cubic Hermite splines over s = sqrt(ds).

They hold the secant stiffness F = P*/(scale ds), for which Hertz's law is linear in s and every
power of the depth is smooth.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks

Floats = NDArray[np.float64]
STEPS = 256
"""Intervals per unit of s."""
FEWEST = 64
"""Minimum number of intervals."""


def in_order(depth_star: ArrayLike, force_star: ArrayLike) -> tuple[Floats, Floats]:
    """Depths > 0 and forces in order of the depth; ``ValueError`` if they cannot be a table."""
    depth, force = np.broadcast_arrays(
        checks.number("depth_star", depth_star), checks.number("force_star", force_star)
    )
    order = np.argsort(depth)
    order = order[depth[order] > 0]
    depth, force = depth[order], force[order]
    if len(depth) < 4 or (np.diff(depth) <= 0).any():
        raise ValueError(f"depth_star must be >= 4 different depths > 0, got {len(depth)}")
    if depth[0] > 0.1 * depth[-1]:
        raise ValueError(
            "the minimum depth_star must be <= a tenth of the maximum, because a table is not "
            f"reliable below it, got {depth[0]:g} and {depth[-1]:g}"
        )
    falls = np.diff(force, prepend=0) <= 0
    if falls.any():
        raise ValueError(
            "force_star must be > 0 and increase with depth_star, but it does not at depth_star "
            f"{depth[falls][0]:g}"
        )
    return depth, force


def monotone_spline(x: Floats, y: Floats) -> Any:
    """Cubic spline, as a function of SciPy, that is monotone where its points are.

    Each slope is limited to three times the smaller of the neighbouring chords' (Hyman, SIAM J.
    Sci. Stat. Comput. 4 (1983) 645-654).
    """
    from scipy.interpolate import CubicHermiteSpline, CubicSpline  # late: few laws need a table

    chords = np.diff(y) / np.diff(x)
    left, right = np.insert(chords, 0, chords[0]), np.append(chords, chords[-1])
    most = 3 * np.minimum(np.abs(left), np.abs(right)) * (left * right > 0)
    least = np.where(left > 0, 0, -most)
    slopes = np.clip(CubicSpline(x, y)(x, 1), least, np.where(left > 0, most, 0))
    return CubicHermiteSpline(x, y, slopes)


def of_points(root: Floats, factor: Floats) -> Floats:
    """Constants of `shapes.table` from the stiffening S over Hertz's law at some s > 0.

    Between the points, S is interpolated by a monotone cubic spline from S = 1 at s = 0, and
    F = s S. Below the first point a contact softer than Hertz's bends the wall, which is a linear
    spring in series with it: with y = S^(1/3), the depth over that of Hertz's law is
    1/y^2 = 1 + c y s.
    """
    below, y = np.zeros(1), np.ones(1)
    if factor[0] < 1:
        y = np.linspace(1, np.cbrt(factor[0]), 5)
        s = (1 / y**2 - 1) / y
        below, y = root[0] * s[:-1] / s[-1], y[:-1]
    spline = monotone_spline(np.append(below, root), np.append(y**3, factor))
    s = _knots(root[-1])
    return _constants(s, s * spline(s), spline(s) + s * spline(s, 1))


def of_secants(root: Floats, secant: Floats) -> Floats:
    """Constants of `shapes.table` from the secant stiffness F at some s > 0, at least three.

    Between the points, F is interpolated by a monotone cubic spline, from the value at s = 0 of a
    parabola through the first three points, but not less than 0.
    """
    first = max(0.0, float(np.polyval(np.polyfit(root[:3], secant[:3], 2), 0.0)))
    spline, s = monotone_spline(np.append(0, root), np.append(first, secant)), _knots(root[-1])
    return _constants(s, spline(s), spline(s, 1))


def _knots(last):
    """Equally spaced knots from 0."""
    return np.linspace(0, last, max(FEWEST, int(np.ceil(STEPS * last))) + 1)


def _constants(knots, secant, slope):
    return np.append((len(knots) - 1) / knots[-1], np.column_stack([secant, slope]).ravel())
