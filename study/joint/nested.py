"""Contacts that grow from the pole, all of them from one Cholesky factor.

A deeper contact contains every shallower one, so that the leading part of one factor is the factor
of a smaller contact. A node's closure depth is the depth at which the contact's edge reaches it.
Errors are smooth in the closure depths, so that two resolutions can be extrapolated.

A thin socket that is held over a part of its outside may bend until the contact is a ring. Such
contacts are not nested, and `pivoted` finds them one by one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import scipy
from numpy.polynomial.polynomial import polyder, polyval
from numpy.typing import NDArray

from study.contact import hertz_factor
from study.joint import complementarity
from study.joint.compliance import Compliance
from study.joint.kinematics import problem_of

if TYPE_CHECKING:
    from study.joint.joint import Joint

Floats = NDArray[np.float64]
ALONG, AT = (0, 0.5, 1), (1,)
"""Depths at which a matrix is made, divided by the deepest one."""
_STEPS = 5  # of Newton, more than enough
_RIGID = 1e6  # R2* from which on the matrix does not change with the depth, within 1e-6
_WIDEST = 2.2  # half-angles of Hertz: a thin incompressible liner has 2, and no contact has more
_MORE = 8  # elements of the coarser mesh beyond the widest contact
_ZERO = 1e-3  # of the largest pressure, or of the depth: less may be the parabola's error


class NestedContacts:
    """Contacts that end at each node of one mesh: closure depths, forces, stiffnesses, pressures.

    With the matrix A = L L^T, the contact of the first n nodes has the pressure -L^-T y, where y is
    L^-1 gap in its first n rows. The next entry of y is, but for a positive factor, the gap that
    is left at the next node. It is a parabola of the depth_star, and the node closes where it is
    zero. The axial force is -(L^-1 axial) y, summed over the nodes in contact.

    No contact of interest reaches the polar angle ``widest``, in rad. The matrix is ``made`` at
    some values of depth_star; a polynomial leads to all others.
    """

    def __init__(
        self, joint: Joint, ball: Compliance, socket: Compliance, widest: float, made: Floats
    ):
        problem, axial = problem_of(joint, ball, socket)
        self._per_pressure = joint.r2_star * axial
        self.angles, self._size = ball.angles, np.searchsorted(ball.angles, widest, "right")
        # matrix and gap change with the depth by terms of order 1/R2* beside the parabola: all
        # contacts are solved at a few depths, and a polynomial leads to their own
        self._deepest, self._made, self._factors, solved = made.max(), made, [], []
        for depth in made:
            matrix, gap = problem(depth)
            factor, rows = _factorised(matrix, np.vstack([gap, axial]), self._size)
            self._factors.append(factor)
            solved.append(rows)
        self._closing = np.abs(gap[1])  # of the gap, per depth
        *self._gaps, load = np.array(solved).swapaxes(0, 1)  # each (depths made, nodes)
        closure = _smaller_root(*self._gaps)
        const, linear, square = (np.cumsum(g * load, axis=1) for g in self._gaps)
        force = -joint.r2_star * (const + closure * (linear + closure * square))
        # a node closes at the depth of its own contact, where the polynomial is that depth itself
        powers = self._polynomial(closure) / self._deepest
        own, slopes = closure[len(closure) // 2] / self._deepest, polyder(powers)
        for _ in range(_STEPS):  # of Newton
            missing = polyval(own, powers, tensor=False) - own
            own = own - missing / (polyval(own, slopes, tensor=False) - 1)
        nested = np.diff(own, prepend=0.0) > 0
        own = own[: np.argmin(np.append(nested, False))]
        self.depth, size = self._deepest * own, len(own)
        self.force = polyval(own, self._polynomial(force)[:, :size], tensor=False)
        # the derivative of the force at a constant contact, as its growth begins with pressure 0;
        # the node that just closes counts half
        inside = (np.cumsum(g * load, axis=1) - g * load / 2 for g in self._gaps)
        const, linear, square = (of[:, :size] for of in inside)
        value = const + self.depth * (linear + self.depth * square)
        slope = linear + 2 * self.depth * square
        by_matrix = polyval(own, polyder(self._polynomial(value)), tensor=False) / self._deepest
        slope = polyval(own, self._polynomial(slope), tensor=False)
        self.stiffness = -joint.r2_star * (slope + by_matrix)

    def _polynomial(self, values):
        """Coefficients in powers of depth over deepest, of values where the matrix was made."""
        places = self._made / self._deepest
        return np.linalg.solve(np.vander(places, increasing=True), values)

    def resultant(self, pressure: Floats) -> float:
        """Force_star of a pressure at all nodes."""
        return float(self._per_pressure @ pressure)

    def pressure(self, depth: float) -> Floats | None:
        """Pressure at all nodes at a depth_star, or None if its contact is not nested."""
        count = np.searchsorted(self.depth, depth)
        profiles = np.zeros((2, len(self._made), self._size))  # of pressure, and of the gap left
        for pressure, gap, factor, gaps in zip(
            *profiles, self._factors, np.swapaxes(self._gaps, 0, 1), strict=True
        ):
            solved, inside = polyval(depth, gaps), factor[:count, :count]
            pressure[:count] = scipy.linalg.solve_triangular(
                inside, -solved[:count], lower=True, trans=1
            )
            gap[count:] = factor[count:, count:] @ solved[count:]
        place = depth / self._deepest
        pressure, gap = (polyval(place, self._polynomial(values)) for values in profiles)
        if pressure.min() < -_ZERO * pressure.max():
            return None
        if (gap < -_ZERO * depth * self._closing[: self._size]).any():
            return None
        return np.append(np.maximum(pressure, 0), np.zeros(len(self.angles) - self._size))


@dataclass(frozen=True)
class Extrapolated:
    """Contacts that end at the nodes of the coarser of two meshes, extrapolated from both.

    Depth_star, force_star and stiffness_star at equal half-angle have errors of order 2. The
    ``error`` is the relative difference of the two meshes' forces at equal depth. Arrays (m,), from
    the pole on.
    """

    depth: Floats
    force: Floats
    stiffness: Floats
    error: Floats
    fine: NestedContacts
    coarse: NestedContacts

    def at(self, joint: Joint, depths: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Forces, stiffnesses, half-angles in rad and errors at depths below the last one.

        Force and stiffness are interpolated as multiples of Hertz's, which they are at depth 0,
        over the root of the depth. The error is taken to grow to 1 below the first contact.
        """
        root, places = np.sqrt(depths), np.append(0, np.sqrt(self.depth[1:]))
        unit = hertz_factor(joint.r2_star)
        force = np.append(1, self.force[1:] / (unit * self.depth[1:] * places[1:]))
        stiffness = np.append(1, self.stiffness[1:] / (1.5 * unit * places[1:]))
        slope = self.coarse.angles[1 : len(places)] / places[1:]
        values = np.array([force, stiffness, np.append(slope[0], slope)])
        force, stiffness, slope = _interpolated(root, places, values)
        error = np.interp(root, places, np.append(1, self.error[1:]))
        return force * unit * depths * root, 1.5 * unit * stiffness * root, slope * root, error


def widest(joint: Joint, depth: float) -> float:
    """Polar angle in rad that no contact at a depth_star reaches."""
    return float(_WIDEST * np.sqrt(depth / joint.radius_ratio))


def extrapolated(
    joint: Joint,
    meshes: Iterable[tuple[Compliance, Compliance]],
    deepest: float,
    made: Sequence[float] = ALONG,
) -> Extrapolated:
    """Nested contacts up to a depth, and somewhat beyond.

    The ``meshes`` are ball and socket, and the same with half the elements. The matrix is ``made``
    at some depths, relative to the deepest: `ALONG` serves all depths; `AT` is exact at the deepest
    one, but for the stiffness.
    """
    depths = deepest * np.array(made if joint.r2_star < _RIGID else AT)
    (ball, socket), (coarse_ball, coarse_socket) = meshes
    most = widest(joint, deepest) + coarse_ball.angles[_MORE]
    fine = NestedContacts(joint, ball, socket, most, depths)
    coarse = NestedContacts(joint, coarse_ball, coarse_socket, most, depths)
    size = min(len(coarse.depth), len(fine.depth[::2]))
    of_fine = [of[: 2 * size : 2] for of in (fine.depth, fine.force, fine.stiffness)]
    of_coarse = [of[:size] for of in (coarse.depth, coarse.force, coarse.stiffness)]
    depth, force, stiffness = (
        of + (of - same) / 3 for of, same in zip(of_fine, of_coarse, strict=True)
    )
    (fine_depth, fine_force, _), (coarse_depth, coarse_force, _) = of_fine, of_coarse
    grown = (np.diff(depth, prepend=-1.0) > 0) & (np.diff(force, prepend=-1.0) > 0)
    size = int(np.argmin(np.append(grown, False)))
    depth, force, error = depth[:size], force[:size], np.zeros(size)
    if size > 1:
        slope = np.gradient(force, depth)  # leads from equal half-angle to equal depth
        apart = fine_force[:size] - coarse_force[:size]
        apart -= slope * (fine_depth[:size] - coarse_depth[:size])
        error[1:] = np.abs(apart[1:] / force[1:])
    return Extrapolated(depth, force, stiffness[:size], error, fine, coarse)


def pivoted(
    joint: Joint, ball: Compliance, socket: Compliance, depth: float
) -> tuple[Floats, float]:
    """Pressure and force at a depth_star, of a contact that may be a ring or have several parts."""
    problem, axial = problem_of(joint, ball, socket)
    matrix, parts = problem(depth)
    pressure, _ = complementarity.solve(matrix, depth ** np.arange(3) @ parts)
    return pressure, joint.r2_star * float(axial @ pressure)


def _factorised(matrix, right, size):
    """Lower Cholesky factor of a matrix's leading part, and rows (m, n) solved with it."""
    factorise = partial(scipy.linalg.cholesky, lower=True)
    lower = complementarity.factorised(factorise, matrix[:size, :size])
    return lower, scipy.linalg.solve_triangular(
        lower, right[:, :size].T, lower=True, check_finite=False
    ).T


def _smaller_root(const, linear, square):
    """Root of const + linear x + square x^2 near -const/linear; nothing cancels as square -> 0."""
    root = np.sqrt(np.maximum(1 - 4 * const * square / linear**2, 0))
    return -2 * const / (linear * (1 + root))


def _interpolated(x, places, values):
    """Values (m, n) at increasing places, by the cubic through the four places beside each x."""
    four = np.clip(np.searchsorted(places, x) - 2, 0, len(places) - 4)[:, None] + np.arange(4)
    at, found = places[four], np.zeros((len(values), len(x)))
    for k in range(4):
        others = np.delete(at, k, axis=1)
        weight = ((x[:, None] - others) / (at[:, [k]] - others)).prod(axis=1)
        found += weight * values[:, four[:, k]]
    return found
