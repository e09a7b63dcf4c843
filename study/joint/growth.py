"""The whole force-depth curve of a joint at once: contact grows from the pole, node by node.

Contact regions are nested, so that one Cholesky factor serves all of them: its leading part is
the factor of a smaller contact. Each node gives the depth at which the contact's edge is there.
Errors are then smooth in depth, and two resolutions are extrapolated. `study.joint.force_curve`
solves given depths, and large displacements.
"""

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from study import checks
from study.contact import largest_depth
from study.joint import contact_kinematics, curve
from study.joint.curve import ForceCurve, UnresolvedError
from study.joint.joint import Joint
from study.threads import one_thread

Floats = NDArray[np.float64]
LEAST_R2_STAR = 1.5
"""Below, the ball moves too far for a matrix that is made at few eccentricities."""
_MADE = 3  # eccentricities at which the matrix is made; one where R2* is large
_FIRST = 4  # elements of the coarser mesh in the smallest contact
_COUNT = 48  # depths of a curve, about
_FINITE = 40  # depths with large displacements, a sixth of a second each


@one_thread
def whole_curve(joint: Joint, deepest: float = 1.0, resolution: int | None = None) -> ForceCurve:
    """Force-depth curve of a joint from about 0.0003 clearances to ``deepest``, or just beyond.

    Depths are those at which the contact's edge is a node, some 50 in about equal steps of their
    square root. Force, depth and half-angle are extrapolated from two resolutions. Takes 30 ms; new
    bodies take 60 ms more by the series, or some seconds by finite elements.

    Parameters
    ----------
    deepest
        Depth_star that the curve has to reach, > 0 and < sqrt(2 R2* - 1) - 1.
    resolution
        Elements along the surface, a multiple of 32, by default 320 for the series and 160 for
        finite elements; half of it is solved too.

    Returns
    -------
    ForceCurve
        Its ``error_estimate`` is the change of the force by extrapolation at equal depth.

    Raises
    ------
    ValueError
        For a value outside its range, ``finite`` kinematics, or contact that reaches the rim.
    """
    depth, force, fine = _grown(joint, deepest, resolution)
    first = 2 * _FIRST
    steps = np.sqrt(depth[first:])
    wanted = np.linspace(steps[0], steps[-1], _COUNT)
    nodes = np.unique(first + np.abs(steps - wanted[:, None]).argmin(axis=1))
    slope = np.gradient(force, depth)[nodes]  # what the finer mesh gives at these depths
    unextrapolated = fine.force[2 * nodes] + slope * (depth[nodes] - fine.depth[2 * nodes])
    pressure = np.array([fine.pressure(2 * node) for node in nodes])
    return ForceCurve(
        joint=joint,
        solver=curve.chosen_solver(joint, None),
        depth_star=depth[nodes],
        force_star=force[nodes],
        contact_half_angle_deg=np.degrees(fine.angles[2 * nodes]),
        peak_pressure_star=pressure.max(axis=1),
        error_estimate=np.abs(unextrapolated / force[nodes] - 1),
        angles=fine.angles,
        pressure=pressure,
    )


def curve_to(joint: Joint, deepest: float = 1.0) -> ForceCurve:
    """Curve of any joint for a table: `whole_curve`, or 40 depths if displacements are large."""
    if joint.kinematics != "finite":
        return whole_curve(joint, deepest)
    checks.number("deepest", deepest, above=0, scalar=True)
    return curve.force_curve(joint, np.linspace(0, np.sqrt(deepest), _FINITE + 1)[1:] ** 2)


@one_thread
def depths_and_forces(
    joint: Joint, deepest: float = 1.0, resolution: int | None = None
) -> tuple[Floats, Floats]:
    """Depths and forces of `whole_curve` at all nodes, without pressures: 8 ms for known bodies."""
    depth, force, _ = _grown(joint, deepest, resolution)
    return depth[_FIRST:], force[_FIRST:]


def _grown(joint, deepest, resolution):
    """Extrapolated depths and forces to ``deepest`` or just beyond, and the finer growth."""
    checks.instance("joint", joint, Joint)
    checks.choice("kinematics", joint.kinematics, ("small", "linear"))
    checks.number("r2_star of a whole curve", joint.r2_star, least=LEAST_R2_STAR)
    deepest = checks.number("deepest", deepest, above=0, scalar=True)
    checks.number("deepest", deepest, below=largest_depth(joint.r2_star))
    solver = curve.chosen_solver(joint, None)
    resolution = curve.checked_resolution(joint, solver, resolution)
    meshes = curve.meshes(joint, None, resolution)
    fine, coarse = (_Growth(joint, *bodies, deepest) for bodies in meshes)
    size = min(len(coarse.depth), len(fine.depth[::2]))
    depth, force = (
        f[: 2 * size : 2] + (f[: 2 * size : 2] - c[:size]) / 3
        for c, f in ((coarse.depth, fine.depth), (coarse.force, fine.force))
    )
    reached = np.flatnonzero(depth >= deepest)
    if not reached.size:
        raise checks.RangeError(
            "deepest must keep the contact off the socket's rim (half-angle < 90 deg), "
            f"got {deepest:g}"
        )
    if reached[0] < 4 * _FIRST:
        raise UnresolvedError(
            f"deepest must be a contact of {4 * _FIRST} elements or more, got {deepest:g}: "
            f"take a resolution finer than {resolution}"
        )
    return depth[: reached[0] + 1], force[: reached[0] + 1], fine


class _Growth:
    """Contacts up to each node of one mesh: their depths, forces and pressures."""

    def __init__(self, joint, ball, socket, deepest):
        paired = (
            contact_kinematics.small if joint.kinematics == "small" else contact_kinematics.linear
        )
        problem, axial = paired(joint, ball, socket)
        self.angles = ball.angles
        # the matrix and the gap's last factor hardly change with the eccentricity: all contacts are
        # solved at a few of them, and polynomials lead to the eccentricity of each contact
        count = 1 if joint.r2_star > 1e6 else _MADE
        made = 1 + deepest * (1 - np.cos(np.pi * np.arange(count) / max(count - 1, 1))) / 2
        made_problems = (problem(eccentricity - 1) for eccentricity in made)
        solved = [
            contact_kinematics.factor(matrix, np.vstack([gap, axial]))
            for matrix, gap in made_problems
        ]
        self._made, self._factors = made, [factor for factor, _ in solved]
        *self._gaps, load = np.array([of for _, of in solved]).swapaxes(0, 1)
        one, first, second = self._gaps
        root = np.sqrt(np.maximum(1 - 4 * one * second / first**2, 0))
        met = -2 * one / (first * (1 + root))
        size = np.argmax(np.append(~((met > 1) & (met < 1 + 2 * deepest)).all(axis=0), True))
        sums = [np.cumsum(gap * load, axis=1)[:, :size] for gap in self._gaps]
        met = met[:, :size]
        force = self._polynomial(-joint.r2_star * (sums[0] + met * (sums[1] + met * sums[2])))
        met = self._polynomial(met)
        slopes = met[1:] * np.arange(1, len(met))[:, None]
        self._own = met[0]
        for _ in range(6):  # Newton's steps to the eccentricity of a contact
            off = polyval(self._own, met, tensor=False) - self._own
            slope = polyval(self._own, slopes, tensor=False) if len(slopes) else 0.0
            self._own = self._own - off / (slope - 1)
        self.depth, self.force = self._own - 1, polyval(self._own, force, tensor=False)

    def _polynomial(self, values):
        """Coefficients in powers of the eccentricity, of values where the matrix was made."""
        return np.linalg.solve(np.vander(self._made, increasing=True), values)

    def pressure(self, node):
        """Pressure at all nodes, of the contact that ends at one."""
        own, profiles = self._own[node], np.zeros((len(self._made), len(self.angles)))
        for k, (factor, one, first, second) in enumerate(
            zip(self._factors, *self._gaps, strict=True)
        ):
            gap = (one + own * (first + own * second))[:node]
            part = factor[:node, :node]
            profiles[k, :node] = solve_triangular(part, -gap, lower=True, trans=1)
        return polyval(own, self._polynomial(profiles))
