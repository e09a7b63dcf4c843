"""Tables over s = sqrt(ds), cubic Hermite splines, which `study.contact.shapes` evaluates.

They are made from the curve of a joint, or from a force that is a plain Python function. SciPy is
imported late: most laws need no spline.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.contact import shapes

STEPS = 256  # intervals per unit of s, with which the table of a function begins
NARROWEST, MOST_KNOTS = 1e-10, 20_000  # least interval as a share of the range, and most knots
DEEPEST = 1000.0  # largest depth_star of a function's table
TOLERANCE = 1e-7
"""Largest error of a function's table between its knots, relative to the force there."""
_NEWTON = 30  # steps of Newton's method, which converges from above
FLOOR = 1e-9
"""The same relative to the force at the largest depth, where this allows more."""


def monotone_slopes(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
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


def in_series(root: NDArray[np.float64], known: float, factor: float) -> NDArray[np.float64]:
    """Stiffening S at some s below the first one that is ``known``, where it is ``factor``.

    The contact of Hertz's law is in series with a linear spring, which is the wall that the contact
    bends: with y = S^(1/3), the depth over that of Hertz's law is 1/y^2 = 1 + c y s.
    """
    y = np.cbrt(factor)
    c = (1 / y**2 - 1) / (y * known)
    y = np.ones_like(root)
    for _ in range(_NEWTON):
        y = y - (c * root * y**3 + y**2 - 1) / (3 * c * root * y**2 + 2 * y)
    return y**3


def of_points(root: NDArray[np.float64], factor: NDArray[np.float64]) -> NDArray[np.float64]:
    """Constants of `shapes.tabulated`, from a factor that is known at some s, the first of them 0.

    They are the steps per unit of s, then the factor and its slope in turn at every knot.
    """
    slopes, steps = monotone_slopes(root, factor), np.diff(root)
    knots = np.linspace(0, root[-1], int(np.ceil(STEPS * root[-1])) + 1)
    k = np.clip(np.searchsorted(root, knots, "right") - 1, 0, len(root) - 2)
    left, right = slopes[k] * steps[k], slopes[k + 1] * steps[k]
    value, slope = shapes.cubic((knots - root[k]) / steps[k], factor[k], left, factor[k + 1], right)
    table = np.column_stack([value, slope / steps[k]]).ravel()
    return np.array([(len(knots) - 1) / root[-1], *table])


def of_function(
    function: Callable[..., Any], name: str, r2_star: float, deepest: float
) -> NDArray[np.float64]:
    """Constants of `shapes.sampled`: a table of the secant stiffness P*/ds of a function.

    ``function`` takes one depth_star and one r2_star, and returns one P*. Intervals are halved
    until the table rises and is within `TOLERANCE` of the function at three places in each.

    Raises
    ------
    ValueError
        For a force that is not a finite number, is not 0 at depth 0, or does not increase with
        depth; and for a function that no table follows, such as one that jumps.
    """
    root = np.sqrt(deepest)
    known = {0.0: _force(function, name, 0.0, r2_star)}
    knots = np.linspace(0, root, max(4, int(np.ceil(STEPS * root))) + 1)
    while True:
        within = knots[:-1, None] + np.diff(knots)[:, None] * (0, 0.25, 0.5, 0.75)
        places = np.append(within, root)
        for s in places.tolist():
            if s not in known:
                known[s] = _force(function, name, s * s, r2_star)
        depth, force = places * places, np.array([known[s] for s in places.tolist()])
        _check(name, depth, force)
        spline = _secant(knots, force[::4])
        table, slope = depth * spline(places), spline(places) + places * spline(places, 1) / 2
        allowed = np.maximum(TOLERANCE * force, FLOOR * force[-1])
        wrong = (np.abs(table - force) > allowed) | ((slope <= 0) & (depth > 0))
        intervals = np.flatnonzero(wrong[:-1].reshape(-1, 4).any(axis=1))
        if intervals.size == 0:
            return np.concatenate([knots, spline(knots), spline(knots, 1)])
        narrow = np.diff(knots)[intervals] < NARROWEST * root
        if narrow.any() or len(knots) + intervals.size > MOST_KNOTS:
            at = knots[intervals[np.argmax(narrow)]] ** 2
            raise ValueError(
                f"law {name} must be continuous with few kinks, because it is tabulated: no table "
                f"is within {TOLERANCE:g} of its force at depth_star {at:.4g}"
            )
        knots = np.sort(np.append(knots, within[intervals, 2]))


def _force(function, name, depth_star, r2_star):
    force = np.asarray(function(depth_star, r2_star))
    at = f"force_star of law {name} at depth_star {depth_star:.6g}"
    return checks.number(at, force.item() if force.size == 1 else force, scalar=True)


def _check(name, depth, force):
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


def _secant(knots, force):
    """Spline of P*/ds at the knots; at 0 it is extrapolated from the others, and at least 0."""
    from scipy.interpolate import CubicHermiteSpline, CubicSpline

    secant = force[1:] / (knots[1:] * knots[1:])
    at_0 = float(CubicSpline(knots[1:], secant)(0.0))
    secant = np.append(max(0.0, at_0), secant)
    return CubicHermiteSpline(knots, secant, monotone_slopes(knots, secant))
