"""The force of a joint over penetration depth and tilt, as a table.

`study.joint.tilted_contact` solves a grid of depths and tilts. Two smooth ratios are interpolated:
the axial force divided by the force along the displacement, and the force across the displacement
divided by the force along it. They depend nearly linearly on sqrt(depth_star), and are 1 and 0 at
depth 0, where Hertz's law is valid for every direction. From them a finer table of both forces,
divided by that of Hertz's law, is computed, which other programs can read too (`study.export`).
Between its nodes, cubic convolution is used (Keys, IEEE Trans. ASSP 29 (1981) 1153).
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import hertz, largest_depth, tabulated
from study.contact.laws import LIMIT_MARGIN
from study.joint.curve import whole_curve
from study.joint.definition import Joint
from study.joint.tilted import LARGEST_TILT, RESOLUTION, SHALLOWEST, tilted_contact

Floats = NDArray[np.float64]
LEAST_DEEPEST = 0.2
"""Minimum of the maximum depth of a table, in clearances."""
_DEPTHS, _STEP = 7, 10.0  # depths solved; most deg from one tilt to the next
_ROWS, _FINER = 32, 4  # intervals of the finer table over the depth; of it in one between tilts


@dataclass(frozen=True)
class DirectionalLaw:
    """Force of a ball that is displaced in any direction up to a maximum tilt.

    Attributes
    ----------
    joint
        The joint without dimensions.
    depth_star, tilt
        Solved depths in clearances, shape (k,), and solved tilts in deg, shape (n,), 0 first.
    force_star, transverse_star
        Normalised forces along the displacement, and across it towards larger tilt; shape (k, n).
    error
        Maximum relative error of the force as a vector, at depths from the minimum of
        ``depth_star`` on: the difference from the elastic solution between the nodes, plus the
        maximum error estimate of that solution.
    table
        Forces along and across, divided by that of Hertz's law, shape (2, rows, columns), at equal
        steps of sqrt(depth_star) and of tilt from 0 on, with an additional node at either end.
    """

    joint: Joint
    depth_star: Floats
    tilt: Floats
    force_star: Floats
    transverse_star: Floats
    error: float
    table: Floats = field(repr=False)

    @property
    def steps(self) -> tuple[float, float]:
        """Steps of the table per unit of sqrt(depth_star), and per deg."""
        _, rows, columns = self.table.shape
        ends = np.sqrt(self.depth_star[-1]), self.tilt[-1]
        return (rows - 3) / float(ends[0]), (columns - 3) / float(ends[1])

    def force(self, depth_star: ArrayLike, tilt: ArrayLike) -> tuple[Floats, Floats]:
        """Normalised forces along and across a displacement, in the shape of the arguments.

        Both are 0 at depths <= 0. For a negative tilt, which is to the other side, the force along
        the displacement is the same and the force across has the opposite sign. Below the minimum
        solved depth the table approaches Hertz's law. Raises ``ValueError`` for a value beyond the
        table.
        """
        deepest, most = ((1 + LIMIT_MARGIN) * end[-1] for end in (self.depth_star, self.tilt))
        depth = np.asarray(checks.depth("depth_star", depth_star))
        checks.number("depth_star", depth, most=deepest)
        angle = np.asarray(checks.number("tilt", tilt, "deg", least=-most, most=most))
        try:
            depth, angle = np.broadcast_arrays(np.maximum(depth, 0), angle)
        except ValueError:
            wanted = "depth_star and tilt must have shapes that can be broadcast together"
            raise ValueError(f"{wanted}, got {depth.shape} and {angle.shape}") from None
        steps = self.steps
        row, by_row = _weights(np.sqrt(depth) * steps[0], self.table.shape[1])
        column, by_column = _weights(np.abs(angle) * steps[1], self.table.shape[2])
        factors = sum(
            by_row[a] * by_column[b] * self.table[:, row + a, column + b]
            for a in range(4)
            for b in range(4)
        )
        along, across = hertz(depth, self.joint.r2_star) * factors
        return along, np.where(angle < 0, -across, across)[()]


def directional_law(
    joint: Joint, depth_star: float = 1.0, tilt: float = 30.0, resolution: int = RESOLUTION
) -> DirectionalLaw:
    """Solve a joint at some depths and tilts, 10 deg apart or less, and make its table.

    Along the axis it is the table of `study.joint.whole_curve`. Takes some 10 s.

    Parameters
    ----------
    joint
        The joint without dimensions.
    depth_star
        Maximum depth in clearances, >= 0.2 and < sqrt(2 R2* - 1) - 1.
    tilt
        Maximum angle in deg between displacement and axis, > 0 and <= 120.
    resolution
        Number of elements along a quarter circle, as in `study.joint.tilted_contact`.

    Raises
    ------
    ValueError
        If `study.joint.tilted_contact` does not apply to the joint, a value is outside its range,
        or there is no contact at a tilt.
    """
    last = checks.number("depth_star", depth_star, least=LEAST_DEEPEST, scalar=True)
    checks.number("depth_star", last, below=largest_depth(joint.r2_star))
    most = checks.number("tilt", tilt, "deg", above=0, most=LARGEST_TILT, scalar=True)
    roots = np.linspace(np.sqrt(max(SHALLOWEST, last / 16)), np.sqrt(last), _DEPTHS)
    tilts = np.linspace(0, most, 1 + max(2, int(np.ceil(most / _STEP))))
    solved = _solved(joint, roots, tilts[1:], resolution)
    axial = tabulated(whole_curve(joint, last))
    along = np.column_stack([axial(roots**2), solved.force_star.reshape(_DEPTHS, -1)])
    across = np.insert(solved.transverse_star.reshape(_DEPTHS, -1), 0, 0.0, axis=1)
    nodes = roots**2, tilts, along, across
    table = _table(axial, *nodes)
    # in the first, a middle and the last interval of either
    middles = [(x[:-1] + x[1:])[[0, (len(x) - 1) // 2, -1]] / 2 for x in (roots, tilts)]
    between = _solved(joint, middles[0], middles[1], resolution)
    found = DirectionalLaw(joint, *nodes, 0.0, table).force(between.depth_star, between.tilt)
    true = between.force_star, between.transverse_star
    off = np.hypot(found[0] - true[0], found[1] - true[1]) / np.hypot(*true)
    own = max(solved.error_estimate.max(), between.error_estimate.max())
    return DirectionalLaw(joint, *nodes, float(off.max() + own), table)


def _solved(joint, roots, tilts, resolution):
    """Contacts at all depths and tilts of a grid, one depth after the other."""
    depths, angles = np.repeat(roots**2, len(tilts)), np.tile(tilts, len(roots))
    return tilted_contact(joint, depths, angles, resolution)


def _table(axial, depths, tilts, along, across):
    """The finer table of `DirectionalLaw`, from what was solved."""
    from scipy.interpolate import RectBivariateSpline

    roots = np.sqrt(depths)
    fine = np.linspace(0, roots[-1], _ROWS + 1)
    finer = np.linspace(0, tilts[-1], _FINER * (len(tilts) - 1) + 1)
    both_sides = np.append(-tilts[:0:-1], tilts)
    smooth = []
    for values, at_0, sign in ((along[:, :1] / along, 1.0, 1), (across / along, 0.0, -1)):
        values = np.insert(values, 0, at_0, axis=0)
        values = np.hstack([sign * values[:, :0:-1], values])
        smooth.append(RectBivariateSpline(np.append(0, roots), both_sides, values)(fine, finer))
    stiffening = axial(fine[1:] ** 2) / hertz(fine[1:] ** 2, axial.joint.r2_star)
    of_along = np.append(1, stiffening)[:, None] / smooth[0]
    table = np.pad([of_along, of_along * smooth[1]], ((0, 0), (1, 1), (1, 1)))
    table[1, :, 1] = 0  # but for rounding
    for edge in (table.swapaxes(0, 1), table[:, ::-1].swapaxes(0, 1), table.T[::-1]):
        edge[0] = 3 * edge[1] - 3 * edge[2] + edge[3]
    table[:, :, 0] = table[:, :, 2] * [[1], [-1]]
    return table


def _weights(place, count):
    """First of the four places of a table about a place, and their weights by cubic convolution."""
    first = np.minimum(place.astype(int), count - 4)
    x = place - first
    return first, (
        x * (x * (2 - x) - 1) / 2,
        (x * x * (3 * x - 5) + 2) / 2,
        x * (x * (4 - 3 * x) + 1) / 2,
        x * x * (x - 1) / 2,
    )
