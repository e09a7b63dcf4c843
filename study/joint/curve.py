"""Ball in socket: two elastic bodies and a gap become a force-depth curve.

For every depth the contact pressure solves a complementarity problem on the contact arc:
pressure >= 0, gap >= 0, pressure * gap = 0, all in the weak (Galerkin) sense of the pressure's
hat functions. Frictionless and elastic. `study.joint.contact_kinematics` says which points face
each other.

Lengths are in socket radii R2 and pressures in E* dR/R2 inside this module.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import largest_depth
from study.joint import contact_kinematics, series
from study.joint.bodies import layer_steps
from study.joint.compliance import FINEST_RESOLUTION, RESOLUTION, Compliance, surface_angles
from study.joint.definition import Joint
from study.threads import one_thread

Solver = Literal["series", "quadratic", "linear"]
SOLVERS: tuple[Solver, ...] = get_args(Solver)
_TIMES = (1.0, 0.97, 1.03)  # factors of a depth at which the error is estimated


@dataclass(frozen=True)
class ForceCurve:
    """Force against depth of one joint, with what the contact looks like at each depth.

    Attributes
    ----------
    depth_star, force_star
        Dimensionless depth d/dR, in the order asked for, and force P/(E* dR^2); shape (k,).
    contact_half_angle_deg
        Polar angle of the contact's edge, in deg; shape (k,).
    peak_pressure_star
        Largest pressure, in E* dR/R2; shape (k,).
    error_estimate
        Estimated relative discretisation error of the force, shape (k,). It is the largest
        difference from the force at half the resolution, at this depth and 3 % to both sides,
        because the error oscillates as the contact's edge passes the nodes. In the tests it covers
        true errors below 1 %. It shows that there are errors of tens of percent, not their size.
    angles, pressure
        Polar angles in rad, shape (n,), and the pressure there in E* dR/R2, shape (k, n).
    """

    joint: Joint
    solver: Solver
    depth_star: NDArray[np.float64]
    force_star: NDArray[np.float64]
    contact_half_angle_deg: NDArray[np.float64]
    peak_pressure_star: NDArray[np.float64]
    error_estimate: NDArray[np.float64]
    angles: NDArray[np.float64]
    pressure: NDArray[np.float64]

    def columns(self) -> dict[str, Any]:
        """The curve as columns of a table, a row per depth, as in `study.dataset.load`."""
        return self.joint.columns() | {
            "solver": self.solver,
            "depth_star": self.depth_star,
            "force_star": self.force_star,
            "contact_half_angle_deg": self.contact_half_angle_deg,
            "peak_pressure_star": self.peak_pressure_star,
            "error_estimate": self.error_estimate,
        }


@one_thread
def force_curve(
    joint: Joint,
    depth_star: ArrayLike,
    resolution: int | None = None,
    solver: Solver | None = None,
) -> ForceCurve:
    """Force-depth curve of a joint, at two resolutions.

    The bodies are cached: further curves with the same ones cost milliseconds, whatever their R2*,
    moduli and depths. With ``finite`` kinematics a depth takes a sixth of a second.

    Parameters
    ----------
    depth_star
        Dimensionless penetration depths, >= 0 and < sqrt(2 R2* - 1) - 1; shape (k,).
    resolution
        Elements along the surface, a multiple of 32, by default 320 for ``series``, 160 for
        finite elements and 96 for ``finite`` kinematics; the error estimate uses half of it.
    solver
        Exact Legendre ``series`` of both bodies, or finite elements: six-node (``quadratic``) or
        three-node (``linear``) triangles. By default the series where it applies (``plane``
        drive, ``mirror`` rim, kinematics other than ``finite``), and else six-node triangles.

    Raises
    ------
    ValueError
        For contact that reaches the socket's rim or is too small for the elements to resolve, a
        solver that cannot solve this joint, or a value outside its range.
    study.joint.complementarity.ComplementarityError
        If the contact does not converge; the message has the residual.
    """
    checks.instance("joint", joint, Joint)
    depths = np.atleast_1d(checks.number("depth_star", depth_star, least=0))
    checks.number("depth_star", depths, below=largest_depth(joint.r2_star))
    if depths.ndim != 1 or depths.size == 0:
        raise ValueError(f"depth_star must be a list of depths, got shape {depths.shape}")
    solver, resolution = settings(joint, solver, resolution)
    angles, pressure, fine, coarse = _solve(joint, solver, depths, resolution)
    at_rim = pressure[:, -2:].any(axis=1)
    if at_rim.any():
        raise checks.RangeError(
            "depth_star must keep the contact off the socket's rim (half-angle < "
            f"{np.degrees(joint.reach):g} deg), got {depths[at_rim].min():g}"
        )
    unseen = ((np.minimum(fine, coarse) == 0) & (depths > 0)).any(axis=0)
    if unseen.any():
        raise contact_kinematics.unresolved(depths[unseen].max(), angles)
    relative = np.divide(np.abs(fine - coarse), fine, out=np.zeros_like(fine), where=fine > 0)
    return ForceCurve(
        joint=joint,
        solver=solver,
        depth_star=depths,
        force_star=fine[0],
        contact_half_angle_deg=np.degrees([_edge(angles, p) for p in pressure]),
        peak_pressure_star=pressure.max(axis=1),
        error_estimate=relative.max(axis=0),
        angles=angles,
        pressure=pressure,
    )


def settings(joint: Joint, solver: Solver | None, resolution: int | None) -> tuple[Solver, int]:
    """Solver and elements along the surface, as given or by default, checked for this joint."""
    if solver is None:
        solver = "series" if joint.series_applies else "quadratic"
    checks.choice("solver", solver, SOLVERS)
    if solver == "series" and not joint.series_applies:
        raise ValueError(
            "solver must be quadratic or linear for this joint: the series needs ball_drive "
            "plane, rim mirror and small displacements, got "
            f"{', '.join(map(str, joint.configuration.values()))}"
        )
    if solver == "linear" and joint.has_large_displacements:
        raise ValueError("solver must be quadratic for kinematics finite, got 'linear'")
    usual, least, most = RESOLUTION["series"], 32, FINEST_RESOLUTION
    if solver != "series":
        from study.joint import fem

        steps = layer_steps(joint.socket_body.layers[0])
        checks.number("outer over inner radius of a layer", steps, least=fem.THINNEST_RATIO)
        usual, most = RESOLUTION["quadratic"], fem.FINEST_RESOLUTION
        least = 64 if steps.min() < 1.05 else 32
    if joint.has_large_displacements:
        checks.number("r2_star", joint.r2_star, most=contact_kinematics.LARGEST_R2_STAR)
        usual = RESOLUTION["finite"]
    resolution = usual if resolution is None else resolution
    resolution = checks.whole("resolution", resolution, least=least, most=most)
    if resolution % 32:
        raise ValueError(f"resolution must be a multiple of 32, got {resolution}")
    return solver, resolution


def _solve(joint, solver, depths, resolution):
    """Nodal angles, pressures (k, n), and forces (m, k) at `_TIMES` the depths by both meshes."""
    if joint.has_large_displacements:
        solutions = [_solve_finite(joint, depths, n) for n in (resolution, resolution // 2)]
    else:
        problem = contact_kinematics.PROBLEMS[joint.kinematics]
        solutions = [
            contact_kinematics.solve(joint, depths, *problem(joint, *bodies), _TIMES)
            for bodies in meshes(joint, solver, resolution)
        ]
    (pressure, fine), (_, coarse) = solutions
    return surface_angles(resolution, joint.reach), pressure, fine, coarse


def _solve_finite(joint, depths, resolution):
    """Pressures and forces at `_TIMES` the depths by one mesh."""
    from study.joint import fem

    ball, socket = (fem.meshed(body, resolution) for body in (joint.ball_body, joint.socket_body))
    pressure, force = contact_kinematics.solve_finite(joint, depths, ball, socket)
    linear = contact_kinematics.linear(joint, ball.compliance, socket.compliance)
    _, beside = contact_kinematics.solve(joint, depths, *linear, _TIMES)
    alone = np.where(beside[0] > 0, beside[0], 1.0)
    return pressure, force * (beside / alone)  # large displacements change the ratio little


def meshes(
    joint: Joint, solver: Solver | None, resolution: int
) -> Iterator[tuple[Compliance, Compliance]]:
    """Ball and socket at a resolution, then at half of it.

    Each is solved by its best solver if none is given. Coarser finite elements are solved too; the
    series is projected on coarser hats.
    """
    nodes: Literal[6, 3] = 3 if solver == "linear" else 6
    bodies = []
    for body in (joint.ball_body, joint.socket_body):
        if body.by_series and solver in (None, "series"):
            finer = series.compliance(body, resolution)
            bodies.append((finer, finer.coarser))
        else:
            from study.joint import fem

            bodies.append([fem.compliance(body, n, nodes) for n in (resolution, resolution // 2)])
    return zip(*bodies, strict=True)


def _edge(angles, pressure):
    """Polar angle where the pressure ends: a root of its square, to about 0.3 %.

    Pressure falls like the square root of the distance to the edge, so that its square is
    smooth and a cubic in cos(angle) fits it, without the last two nodes, which oscillate. A
    contact of few nodes gets a lower degree, one of very few the middle beyond its last node.
    """
    last = np.count_nonzero(pressure) - 1
    if last < 0:
        return 0.0
    x = np.cos(angles) - np.cos(angles[last])
    inner = (angles >= 0.3 * angles[last]) & (np.arange(len(angles)) <= last - 2)
    degree = min(3, np.count_nonzero(inner) // 4)
    roots = np.array([x[last + 1] / 2])
    if degree > 0:
        fitted = np.polynomial.Polynomial.fit(x[inner], pressure[inner] ** 2, degree).roots()
        real = fitted[np.isreal(fitted)].real
        roots = real if real.size else roots
    nearest = roots[np.argmin(np.abs(roots))]
    inside = x[max(last - 1, 0)]
    return float(np.arccos(np.cos(angles[last]) + np.clip(nearest, x[last + 1], inside)))
