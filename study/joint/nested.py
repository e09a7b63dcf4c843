"""Contacts that grow from the pole, all of them from three Cholesky factors.

A deeper contact contains every shallower one, so that the leading part of one factor is the factor
of a smaller contact. A node's closure depth is the depth at which the contact's edge reaches it.

With the matrix A = L L^T, the contact of the first n nodes has the pressure -L^-T y, where y is
L^-1 gap in its first n rows. The next entry of y is, but for a positive factor, the gap that is
left at the next node. It is a parabola of the depth, and the node closes where it is zero.

A thin socket that is held over a part of its outside may bend until the contact is a ring. Such
contacts are not nested, and have to be solved one by one.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import scipy
from numpy.typing import NDArray

from study.contact import hertz_factor
from study.joint.complementarity import factorised
from study.joint.compliance import Compliance
from study.joint.description import JointDescription
from study.joint.kinematics import problem_of

Floats = NDArray[np.float64]
_WIDEST = 2.2  # half-angles of Hertz: a thin incompressible liner has 2, and no contact has more
_MORE = 16  # elements beyond the widest contact
_FEWEST = 4  # closure depths of a curve
_ITERATIONS = 12  # each leaves about 1/R2* of the change before
_BEYOND = 1.5  # deepest depths, to which the parabola is trusted
_ZERO = 1e-3  # of the largest pressure, or of the depth: less may be the parabola's error


class NestedContacts:
    """Contacts that end at the nodes of one mesh, up to a depth and somewhat beyond.

    The matrix and the three factors of the gap change with the depth by terms of order 1/R2*. They
    are made at three depths, and a parabola leads to all others.

    Attributes
    ----------
    depth, force : shape (n,)
        Closure depths of the first nodes, and the force_star of the contacts that end there.
    """

    def __init__(
        self, joint: JointDescription, ball: Compliance, socket: Compliance, deepest: float
    ):
        problem, axial = problem_of(joint, ball, socket)
        self._per_pressure = joint.r2_star * axial
        widest = _WIDEST * np.sqrt(deepest / joint.radius_ratio) + ball.angles[_MORE]
        self.angles, size = ball.angles, np.searchsorted(ball.angles, widest, "right")
        self._deepest, self._size, self._parts = deepest, size, []
        closures, forces = [], []
        for depth in (0.0, deepest / 2, deepest):
            matrix, gap = problem(depth)
            lower = factorised(partial(scipy.linalg.cholesky, lower=True), matrix[:size, :size])
            right = np.vstack([gap, axial])[:, :size].T
            *gaps, load = scipy.linalg.solve_triangular(
                lower, right, lower=True, check_finite=False
            ).T
            const, linear, square = gaps
            # the smaller root of the parabola, without cancellation
            root = np.sqrt(np.maximum(1 - 4 * const * square / linear**2, 0))
            closure = -2 * const / (linear * (1 + root))
            below, slope, bend = np.cumsum(np.array(gaps) * load, axis=1)
            closures.append(closure)
            forces.append(-joint.r2_star * (below + closure * (slope + closure * bend)))
            self._parts.append((lower, np.array(gaps)))
        closure = closures[1]
        for _ in range(_ITERATIONS):  # a node closes at the depth of its own contact
            closure = self._at(closure, closures)
        count = int(np.argmin(np.append(np.diff(closure, prepend=0.0) > 0, False)))
        self.depth, self.force = closure[:count], self._at(closure, forces)[:count]
        self._closing = np.abs(gap[1, :size])  # of the gap, per depth
        self.is_nested = count >= _FEWEST
        if not self.is_nested:
            return
        # as multiples of Hertz's force, over the root of the depth, a curve is smooth
        roots, self._hertz = np.sqrt(self.depth[1:]), hertz_factor(joint.r2_star)
        stiffening = self.force[1:] / (self._hertz * roots**3)
        self._stiffening = scipy.interpolate.CubicSpline(
            np.append(0, roots), np.append(1, stiffening)
        )
        self._edge = scipy.interpolate.CubicSpline(
            np.append(0, roots), np.append(0, self.angles[1:count])
        )

    def _at(self, depth, values):
        """Values at a depth, of three where the matrix was made."""
        x = np.clip(depth / self._deepest, 0, _BEYOND)
        weights = (1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)
        return sum(weight * value for weight, value in zip(weights, values, strict=True))

    def at(self, depths: Floats) -> Floats:
        """Forces, stiffnesses and half-angles in rad at depths up to the last one, (3, ...)."""
        root = np.sqrt(depths)
        factor, slope = self._stiffening(root), self._stiffening(root, 1)
        force, stiffness = depths * root * factor, root * 1.5 * factor + depths * slope / 2
        return np.array([self._hertz * force, self._hertz * stiffness, self._edge(root)])

    def resultant(self, pressure: Floats) -> float:
        """Force_star of a pressure at all nodes."""
        return float(self._per_pressure @ pressure)

    def pressure(self, depth: float) -> Floats | None:
        """Pressure at all nodes at a depth_star, or None if its contact is not nested."""
        count, found = np.searchsorted(self.depth, depth), []
        if not self.is_nested or count == len(self.depth):
            return None
        for lower, (const, linear, square) in self._parts:
            y, both = const + depth * (linear + depth * square), np.zeros((2, self._size))
            both[0, :count] = scipy.linalg.solve_triangular(
                lower[:count, :count], -y[:count], 1, True
            )
            both[1, count:] = lower[count:, count:] @ y[count:]
            found.append(both)
        pressure, gap = self._at(depth, found)
        if pressure.min() < -_ZERO * pressure.max() or (gap < -_ZERO * depth * self._closing).any():
            return None
        return np.append(np.maximum(pressure, 0), np.zeros(len(self.angles) - self._size))
