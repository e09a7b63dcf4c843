"""A contact law of one joint in SI units: force, stiffness, and the depth of a force.

It adds dimensions to a law of `study.contact.laws`, and packs it for the compiled loops.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from math import inf, isclose
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from study import checks
from study.contact.laws import AnyLaw, Floats, find
from study.contact.materials import LIMIT_MARGIN
from study.contact.shapes import SHAPES

_STEPS, _CLOSE = 200, 1e-8  # of Newton's method: most steps (five are usual); last one, relative
CAPACITIES = 4096, 65536
"""How many constants a record may hold; the first is enough for all laws but large tables."""


class DimensionalLaw:
    """A contact law of a joint with dimensions, in SI units.

    Its methods `force`, `stiffness` and `depth` evaluate it. `study.joint.Joint.law` makes it.
    Raises ``ValueError`` for an unknown law, or a value outside its range.

    Parameters
    ----------
    law
        Key of `study.contact.LAWS`, or a law itself, such as ``Steuermann(n=2)``.
    ball_radius, socket_radius
        Radii in m; the ball is smaller than the socket.
    composite_modulus
        Composite modulus E* > 0 in Pa (`study.contact.composite_modulus`).
    joint
        The `study.joint.Joint` to which the law belongs, or None.

    Attributes
    ----------
    deepest
        Maximum penetration depth of the law in m; infinite for a law without a limit.
    parts
        The law at the R2* of the joint, as `study.contact.laws.Parts`.

    Examples
    --------
    >>> law = DimensionalLaw(
    ...     "hertz", ball_radius=9.95e-3, socket_radius=10e-3, composite_modulus=1.1e11
    ... )
    >>> print(f"{law.force(5e-6):.0f} N")
    2313 N
    """

    def __init__(
        self,
        law: AnyLaw,
        *,
        ball_radius: float,
        socket_radius: float,
        composite_modulus: float,
        joint: Any = None,
    ) -> None:
        self.law, self.joint = find(law, joint), joint
        self.name = self.law.name
        r1 = checks.number("ball_radius", ball_radius, "m", above=0, scalar=True)
        r2 = checks.number("socket_radius", socket_radius, "m", above=r1, scalar=True)
        self.ball_radius, self.socket_radius = r1, r2
        self.clearance, self.r2_star = r2 - r1, r2 / (r2 - r1)
        checks.number("socket_radius divided by clearance", self.r2_star, above=1)  # 1 by rounding
        self.composite_modulus = checks.number(
            "composite modulus", composite_modulus, "Pa", above=0, scalar=True
        )
        self.force_unit = self.composite_modulus * self.clearance**2  # of the dimensionless force
        own = self.law.r2_star
        if own is not None and not isclose(self.r2_star, own, rel_tol=1e-6):
            raise ValueError(
                f"socket_radius divided by clearance must be {own:.9g}, that of the joint of the "
                f"law {self.name}, got {self.r2_star:.9g}"
            )
        self.parts = self.law.parts(self.r2_star)
        limit = self.law.deepest
        self.deepest = inf if limit is None else self.clearance * limit

    def __repr__(self) -> str:
        """The law with its numbers, or with its joint."""
        joint = self.joint or self.law.joint
        return repr(self.law) if joint is None else f"{self.name} of {joint}"

    def force(self, depth: ArrayLike) -> Floats:
        """Contact force in N at penetration depths in m, with their shape; 0 at depths <= 0."""
        return self._evaluated(depth, 0)

    def stiffness(self, depth: ArrayLike) -> Floats:
        """Stiffness dP/dd in N/m at penetration depths in m, with their shape; 0 at depths <= 0."""
        return self._evaluated(depth, 1)

    def depth(self, force: ArrayLike) -> Floats:
        """Penetration depths in m under contact forces >= 0 in N, with their shape.

        This is the inverse of `force`, by Newton's method in ln(depth) and ln(force) between
        bounds, and exact except for rounding. Raises ``ValueError`` for a force that is greater
        than that at the maximum depth of the law.
        """
        most = None
        if self.deepest < inf:
            most = float(self.force(self.deepest)) * (1 + LIMIT_MARGIN)
        forces = np.asarray(checks.number(f"force of {self.name}", force, "N", least=0, most=most))
        depth = np.zeros(forces.shape)
        pressed, shape = forces > 0, self.parts.shape
        wanted = forces[pressed] / self.force_unit / self.parts.scale
        deepest = self.deepest / self.clearance * (1 + 2 * LIMIT_MARGIN)
        low, high = np.zeros_like(wanted), np.full_like(wanted, deepest)
        star = np.minimum(wanted ** (2 / 3), high)  # Hertz's, in clearances
        for _ in range(_STEPS):
            value, slope = shape(star, self.parts.constants)
            off = np.log(value / wanted)
            low, high = np.where(off < 0, star, low), np.where(off > 0, star, high)
            before, star = star, star * np.exp(-off * value / (slope * star))
            inside = (star > low) & (star < high)  # else it may cross a kink for ever
            star = np.where(inside, star, (before + np.clip(star, low, high)) / 2)
            if np.all(np.abs(star - before) <= _CLOSE * star):
                depth[pressed] = self.clearance * star
                return float(depth) if depth.ndim == 0 else depth
        raise checks.StudyError(
            f"no depth of the law {self.name} was found for a force; check that its force "
            "increases with depth"
        )

    def _evaluated(self, depth, derivative):
        depths = checks.number("depth", depth, "m")
        most = self.deepest * (1 + LIMIT_MARGIN) if self.deepest < inf else None
        checks.number(f"depth of {self.name}", depths, "m", most=most)
        star = self.law(depths / self.clearance, self.r2_star, derivative=derivative)
        return self.force_unit / self.clearance**derivative * star

    def packed(self) -> np.record:
        """Record for `forces.elastic_force`, with lengths in m and forces in N."""
        scale, shape, constants = self.parts
        count = len(constants)
        capacity = next(size for size in CAPACITIES if size >= count)
        padded = np.pad(np.asarray(constants, dtype=float), (0, capacity - count))
        values: Any = SHAPES.index(shape), self.clearance, self.force_unit * scale, count, padded
        return np.rec.array(
            [values],
            dtype=[
                ("shape_index", np.int64),
                ("clearance", float),
                ("scale", float),
                ("count", np.int64),
                ("constants", float, (capacity,)),
            ],
        )[0]
