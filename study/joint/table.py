"""Table of the elastic solution of a joint as a contact law, checked between its points.

The force is known at the depths of a curve. The joint is solved again between them and below the
first; where the interpolated force is wrong there, these points are added to the table. Where even
more points do not help, such as where the contact reaches the rim, the range of the table ends.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.contact import Table
from study.joint.kinematics import UnresolvedError
from study.joint.solution import Solution

if TYPE_CHECKING:
    from study.joint.joint import Joint

Floats = NDArray[np.float64]
TOLERANCE = 1e-3
"""Maximum relative error of the interpolated force at a depth that is checked."""
SHALLOWEST = 0.001
"""Minimum depth_star that is checked."""
_ROUNDS = 4  # in which points are added
_BELOW = np.array([0.5, 0.75])  # roots of the depths below the first point, over its own


@lru_cache(maxsize=16)
def checked(
    joint: Joint,
    deepest: float | None = None,
    tilt: float | None = None,
    resolution: int | None = None,
) -> Table:
    """Table of the elastic solution: see `study.joint.Joint.table`."""
    curve = joint.curve(deepest, tilt, resolution)
    tilt = None if curve.tilt is None else float(curve.tilt[0])
    depth, force = curve.depth_star, curve.force_star
    if depth[0] > depth[-1] / 10:
        raise UnresolvedError(
            f"the maximum depth_star of a table must be >= {10 * depth[0]:.3g}, so that elements "
            f"of this size resolve the contact at a tenth of it, got {depth[-1]:.3g}"
        )
    error, checked = 0.0, np.zeros(0)
    for round_ in range(_ROUNDS + 1):
        law, roots = Table.of_curve(_curve(curve, depth, force)), np.sqrt(depth)
        places = (roots[1:] + roots[:-1]) ** 2 / 4
        if round_ == 0:  # at both ends and in the middle; everywhere if one of these is wrong
            places = places[[0, len(places) // 2, -1]]
        if tilt is None:  # off the axis, contacts below the first are not resolved
            places = np.append((_BELOW * roots[0]) ** 2, places)
        places = np.setdiff1d(places[places >= SHALLOWEST], checked)
        checked, (true, numerical) = (
            np.append(checked, places),
            _solved(joint, places, tilt, resolution),
        )
        off = np.abs(law(places) / true - 1)
        fails = (off > TOLERANCE + numerical) | (law(places, derivative=True) <= 0)
        error = max(error, off[~fails & np.isfinite(off)].max(initial=0))
        if not fails.any() or round_ == _ROUNDS:
            break
        known = fails & np.isfinite(true)
        depth, force = np.append(depth, places[known]), np.append(force, true[known])
        order = np.argsort(depth)
        depth, force = depth[order], force[order]
    above = fails & (places > depth[0])  # where even more points do not help
    error = max(error, off[fails & ~above].max(initial=0))
    if above.any():
        keep = depth < places[above].min()
        law = Table.of_curve(_curve(curve, depth[keep], force[keep]))
    return replace(law, error=float(error), curve=curve)


def _curve(curve, depth, force):
    return Solution(
        joint=curve.joint,
        solver=curve.solver,
        depth_star=depth,
        force_star=force,
        error_estimate=np.zeros_like(depth),
    )


def _solved(joint, depths, tilt, resolution):
    """Forces and their numerical errors at depths.

    The force is infinite where the contact reaches the rim, and unknown (NaN) where it is too small
    to be resolved.
    """
    if not depths.size:
        return np.zeros((2, 0))
    try:
        solution = joint.solve(depth_star=depths, tilt=tilt, resolution=resolution)
        return np.array([solution.force_star, solution.error_estimate])
    except checks.RangeError as error:
        if len(depths) == 1:
            return np.array([[np.nan if isinstance(error, UnresolvedError) else np.inf], [0.0]])
    return np.hstack([_solved(joint, part, tilt, resolution) for part in np.array_split(depths, 2)])
