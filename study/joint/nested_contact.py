"""The whole force-depth curve of a joint at once, from nested contacts.

A deeper contact contains every shallower one, so that one Cholesky factor serves all of them: its
leading part is the factor of a smaller contact. A node's closure depth is the depth at which the
contact's edge reaches it. Errors are then smooth in depth, and two resolutions are extrapolated.
`study.joint.force_curve` solves given depths, and large displacements.
"""

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from study import checks
from study.contact import largest_depth
from study.joint import contact_kinematics, curve
from study.joint.compliance import surface_angles
from study.joint.contact_kinematics import UnresolvedError
from study.joint.curve import ForceCurve
from study.joint.definition import Joint
from study.threads import one_thread

Floats = NDArray[np.float64]
LEAST_R2_STAR = 1.5
"""Below, the ball moves too far for a matrix that is made at few eccentricities."""
_MADE = 3  # eccentricities at which the matrix is made: a parabola leads to all others
_RIGID = 1e6  # R2* beyond which the matrix does not change with the eccentricity, within 1e-6
_FIRST = 4  # elements of the coarser mesh in the smallest contact
_COUNT = 48  # depths of a curve, about
_FINITE = 40  # depths with large displacements, a sixth of a second each


@one_thread
def whole_curve(joint: Joint, deepest: float = 1.0, resolution: int | None = None) -> ForceCurve:
    """Force-depth curve of a joint from about 0.0003 clearances to ``deepest``, or just beyond.

    Depths are those at which the contact's edge is a node, some 50 in about equal steps of their
    square root. Force, depth and half-angle are extrapolated from two resolutions. Takes 30 ms; new
    bodies take 60 ms more by the series, or some seconds by finite elements.

    With ``finite`` kinematics contacts are not nested: 40 depths are solved one by one.

    Parameters
    ----------
    deepest
        Depth_star that the curve has to reach, > 0 and < sqrt(2 R2* - 1) - 1.
    resolution
        Elements along the surface, a multiple of 32, by default as for `study.joint.force_curve`;
        half of it is solved too.

    Returns
    -------
    ForceCurve
        Its ``error_estimate`` is the change of the force by extrapolation at equal depth.

    Raises
    ------
    ValueError
        For a value outside its range, or contact that reaches the rim.
    """
    checks.instance("joint", joint, Joint)
    deepest = checks.number("deepest", deepest, above=0, scalar=True)
    if joint.has_large_displacements:
        depths = np.linspace(0, np.sqrt(deepest), _FINITE + 1)[1:] ** 2
        return curve.force_curve(joint, depths, resolution)
    depth, force, fine, solver = _extrapolated(joint, deepest, resolution)
    first = 2 * _FIRST
    roots = np.sqrt(depth[first:])
    wanted = np.linspace(roots[0], roots[-1], _COUNT)
    nodes = np.unique(first + np.abs(roots - wanted[:, None]).argmin(axis=1))
    slope = np.gradient(force, depth)[nodes]  # what the finer mesh gives at these depths
    unextrapolated = fine.force[2 * nodes] + slope * (depth[nodes] - fine.depth[2 * nodes])
    pressure = np.array([fine.pressure(2 * node) for node in nodes])
    return ForceCurve(
        joint=joint,
        solver=solver,
        depth_star=depth[nodes],
        force_star=force[nodes],
        contact_half_angle_deg=np.degrees(fine.angles[2 * nodes]),
        peak_pressure_star=pressure.max(axis=1),
        error_estimate=np.abs(unextrapolated / force[nodes] - 1),
        angles=fine.angles,
        pressure=pressure,
    )


@one_thread
def depths_and_forces(
    joint: Joint, deepest: float = 1.0, resolution: int | None = None
) -> tuple[Floats, Floats]:
    """Depths and forces of `whole_curve` at all nodes, without pressures: 8 ms for known bodies.

    Not for ``finite`` kinematics.
    """
    kinematics = checks.instance("joint", joint, Joint).kinematics
    checks.choice("kinematics", kinematics, contact_kinematics.PROBLEMS)
    deepest = checks.number("deepest", deepest, above=0, scalar=True)
    depth, force, *_ = _extrapolated(joint, deepest, resolution)
    return depth[_FIRST:], force[_FIRST:]


def _extrapolated(joint, deepest, resolution):
    """Depths and forces to ``deepest`` or just beyond, the finer mesh's contacts, the solver."""
    checks.number("r2_star of a whole curve", joint.r2_star, least=LEAST_R2_STAR)
    checks.number("deepest", deepest, below=largest_depth(joint.r2_star))
    solver, resolution = curve.settings(joint, None, resolution)
    # Even the contact of a thin incompressible liner ends within twice Hertz's half-angle
    widest = 2 * np.sqrt(deepest * joint.ball_radius)
    if widest < surface_angles(resolution // 2, joint.reach)[4 * _FIRST]:
        raise _unresolved(deepest, resolution)
    meshes = curve.meshes(joint, None, resolution)
    fine, coarse = (_NestedContacts(joint, *bodies, deepest) for bodies in meshes)
    size = min(len(coarse.depth), len(fine.depth[::2]))
    depth, force = (
        of_fine[: 2 * size : 2] + (of_fine[: 2 * size : 2] - of_coarse[:size]) / 3
        for of_coarse, of_fine in ((coarse.depth, fine.depth), (coarse.force, fine.force))
    )
    reached = np.flatnonzero(depth >= deepest)
    if not reached.size and size < 4 * _FIRST:
        raise _unresolved(deepest, resolution)
    if not reached.size:
        raise checks.RangeError(
            "deepest must keep the contact off the socket's rim (half-angle < "
            f"{np.degrees(joint.reach):g} deg), got {deepest:g}"
        )
    if reached[0] < 4 * _FIRST:
        raise _unresolved(deepest, resolution)
    return depth[: reached[0] + 1], force[: reached[0] + 1], fine, solver


def _unresolved(deepest, resolution):
    return UnresolvedError(
        f"deepest must be a contact of {4 * _FIRST} elements or more, got {deepest:g}: "
        f"take a resolution finer than {resolution}"
    )


class _NestedContacts:
    """Contacts that end at each node of one mesh: closure depths, forces and pressures.

    With the matrix A = L L^T, the contact of the first n nodes has the pressure -L^-T y, where y is
    L^-1 gap in its first n rows. The next entry of y is, but for a positive factor, the gap that
    is left at the next node. It is a parabola of the eccentricity D = 1 + depth_star, and the node
    closes where it is zero. The axial force is -(L^-1 axial) y, summed over the nodes in contact.
    """

    def __init__(self, joint, ball, socket, deepest):
        problem, axial = contact_kinematics.PROBLEMS[joint.kinematics](joint, ball, socket)
        self.angles = ball.angles
        # matrix and gap change with the eccentricity by terms of order 1/R2* beside the parabola:
        # all contacts are solved at a few eccentricities, and a polynomial leads to their own
        count = 1 if joint.r2_star > _RIGID else _MADE
        places = (1 - np.cos(np.pi * np.arange(count) / max(count - 1, 1))) / 2
        self._made, self._factors, solved = 1 + deepest * places, [], []
        for eccentricity in self._made:
            matrix, gap = problem(eccentricity - 1)
            factor, rows = contact_kinematics.factor(matrix, np.vstack([gap, axial]))
            self._factors.append(factor)
            solved.append(rows)
        *self._gaps, load = np.array(solved).swapaxes(0, 1)  # each (eccentricities, nodes)
        closure = _smaller_root(*self._gaps)
        closes = ((closure > 1) & (closure < 1 + 2 * deepest)).all(axis=0)
        size = np.argmin(np.append(closes, False))
        closure = closure[:, :size]
        const, linear, square = (np.cumsum(g * load, axis=1)[:, :size] for g in self._gaps)
        force = -joint.r2_star * (const + closure * (linear + closure * square))
        powers = self._polynomial(closure)
        # a node closes at the eccentricity D of its own contact, where the polynomial is D itself
        self._own = powers[0] if count == 1 else _smaller_root(powers[0], powers[1] - 1, powers[2])
        self.depth = self._own - 1
        self.force = polyval(self._own, self._polynomial(force), tensor=False)

    def _polynomial(self, values):
        """Coefficients in powers of the eccentricity, of values where the matrix was made."""
        return np.linalg.solve(np.vander(self._made, increasing=True), values)

    def pressure(self, node):
        """Pressure at all nodes, of the contact that ends at a node."""
        own, profiles = self._own[node], np.zeros((len(self._made), len(self.angles)))
        for profile, factor, gaps in zip(
            profiles, self._factors, np.swapaxes(self._gaps, 0, 1), strict=True
        ):
            gap = polyval(own, gaps[:, :node])
            profile[:node] = solve_triangular(factor[:node, :node], -gap, lower=True, trans=1)
        return polyval(own, self._polynomial(profiles))


def _smaller_root(const, linear, square):
    """Root of const + linear x + square x^2 near -const/linear; nothing cancels as square -> 0."""
    root = np.sqrt(np.maximum(1 - 4 * const * square / linear**2, 0))
    return -2 * const / (linear * (1 + root))
