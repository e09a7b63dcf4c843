"""Ball in socket: two elastic bodies and a gap become a force-depth curve.

For every depth the contact pressure solves a complementarity problem on the contact arc:
pressure >= 0, gap >= 0, pressure * gap = 0, all in the weak (Galerkin) sense of the pressure's
hat functions. Frictionless and elastic. `study.joint.contact_kinematics` says which points face
each other, and `study.joint.nested_contact` solves all depths with one factor of the matrix.

Lengths are in socket radii R2 and pressures in E* dR/R2 inside this module.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import largest_depth
from study.joint import nested_contact, series
from study.joint.compliance import (
    FINEST_RESOLUTION,
    RESOLUTION,
    Compliance,
    HatFunctions,
    layer_steps,
    surface_angles,
)
from study.joint.contact_kinematics import UnresolvedError, at_rim, unresolved
from study.joint.definition import Joint
from study.threads import one_thread

Floats = NDArray[np.float64]
Solver = Literal["series", "quadratic", "linear"]
SOLVERS: tuple[Solver, ...] = get_args(Solver)
_FIRST = 8  # elements of the coarser mesh in the smallest contact of a whole curve
_COUNT = 48  # depths of a whole curve, about
_FINITE = 40  # depths with large displacements, a sixth of a second each


@dataclass(frozen=True)
class ForceCurve:
    """Force-depth curve of one joint, with the contact half-angle and pressure at each depth.

    Attributes
    ----------
    depth_star, force_star
        Normalised depth d/dR, in the given order, and normalised force P/(E* dR^2); shape (k,).
    contact_half_angle_deg
        Polar angle of the edge of the contact, in deg; shape (k,).
    peak_pressure_star
        Maximum pressure, in units of E* dR/R2; shape (k,).
    error_estimate
        Estimated relative discretisation error of the force, shape (k,): the relative difference
        of the forces, as vectors, that two meshes give at this depth, one of which has twice the
        elements of the other. The force is extrapolated from the two. Its error is smaller, by a
        factor above 10 for the series and about 1 for elements of bodies that are held at a core,
        a neck or a seat, where stresses have no bound. A force that is not extrapolated, because
        the contact is a ring or the solver ``linear``, is that of the finer mesh. Other results
        than the force have their own errors.
    angles, pressure
        Polar angles in rad, shape (n,), and the pressure there in E* dR/R2, shape (k, n): that of
        the finer mesh, whose force is not extrapolated.
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
        own = [of.name for of in fields(self) if of.name not in ("joint", "angles", "pressure")]
        return self.joint.columns() | {name: getattr(self, name) for name in own}


@one_thread
def force_curve(
    joint: Joint,
    depth_star: ArrayLike,
    resolution: int | None = None,
    solver: Solver | None = None,
) -> ForceCurve:
    """Force-depth curve of a joint at given depths, extrapolated from two resolutions.

    The compliances of the bodies are cached, so that further curves with the same bodies take
    milliseconds for any R2*, moduli and depths. With ``finite`` kinematics each depth takes a sixth
    of a second.

    Parameters
    ----------
    joint
        The joint without dimensions.
    depth_star
        Normalised penetration depths d/dR, >= 0 and < sqrt(2 R2* - 1) - 1; shape (k,).
    resolution
        Number of elements along the surface, a multiple of 32. The default is 320 for ``series``,
        160 for finite elements and 96 for ``finite`` kinematics. Half of it is solved too.
    solver
        ``series`` for the Legendre series of both bodies, or finite elements with six-node
        (``quadratic``) or three-node (``linear``) triangles. Forces of three-node triangles, which
        Yao et al. use, are not extrapolated, to show what such a mesh gives. The default is the
        series where it applies (ball support ``guided``, rim ``mirror``, and kinematics other than
        ``finite``), else six-node triangles.

    Raises
    ------
    ValueError
        If the contact reaches the rim of the socket or is too small for the elements to resolve,
        if the solver does not apply to this joint, or if a value is outside its range.
    study.joint.complementarity.ComplementarityError
        If the contact problem does not converge.

    Examples
    --------
    >>> from study.joint import Joint
    >>> curve = force_curve(Joint(r2_star=200), [0.1, 0.3])
    >>> curve.force_star.round(2), curve.contact_half_angle_deg.round(1)
    (array([13.64, 81.63]), array([20. , 34.3]))
    """
    depths = np.atleast_1d(checks.number("depth_star", depth_star, least=0))
    checks.number("depth_star", depths, below=largest_depth(joint.r2_star))
    if depths.ndim != 1 or depths.size == 0:
        raise ValueError(f"depth_star must be a list of depths, got shape {depths.shape}")
    solver, resolution = settings(joint, solver, resolution)
    angles, touching = surface_angles(resolution, joint.reach), np.flatnonzero(depths)
    force, edge, error = np.zeros((3, len(depths)))
    pressure = np.zeros((len(depths), len(angles)))
    finite = joint.has_large_displacements
    solve = _solve_finite if finite else _solve
    at_once = finite or joint.r2_star >= nested_contact.LEAST_R2_STAR
    for some in [touching] if at_once else touching[:, None]:
        if some.size:
            solved = solve(joint, depths[some], solver, resolution)
            force[some], edge[some], error[some], pressure[some] = solved
    reaching = pressure[:, -2:].any(axis=1)
    if reaching.any():
        raise at_rim("depth_star", joint, f"{depths[reaching].min():g}")
    return _curve(joint, solver, depths, force, edge, error, angles, pressure)


def _curve(joint, solver, depths, force, edge, error, angles, pressure):
    degrees, peak = np.degrees(edge), pressure.max(axis=1)
    return ForceCurve(joint, solver, depths, force, degrees, peak, error, angles, pressure)


@one_thread
def whole_curve(joint: Joint, deepest: float = 1.0, resolution: int | None = None) -> ForceCurve:
    """Force-depth curve of a joint from about 0.0003 clearances to a maximum depth.

    The depths are about 50 at which the edge of the contact is a node, in about equal steps of
    their square root; the last one may be slightly greater than the maximum. The curve takes 30 ms,
    and new bodies take 60 ms more by the series or some seconds by finite elements. With
    ``finite`` kinematics, or where contacts are not nested (`study.joint.nested_contact`), 40
    depths are solved by `force_curve`, whose errors are raised here too.

    Parameters
    ----------
    joint
        The joint without dimensions.
    deepest
        Maximum depth_star, > 0 and < sqrt(2 R2* - 1) - 1.
    resolution
        Number of elements along the surface, as in `force_curve`.

    Examples
    --------
    >>> from study.contact import tabulated
    >>> from study.joint import Joint
    >>> law = tabulated(whole_curve(Joint(r2_star=200)))
    >>> round(law(0.3), 2)
    81.63
    """
    deepest = checks.number("deepest", deepest, above=0, scalar=True)
    if joint.has_large_displacements or joint.r2_star < nested_contact.LEAST_R2_STAR:
        return _solved_apart(joint, deepest, resolution)
    nested, solver, last = _nested_to(joint, deepest, resolution)
    if nested is None:
        return _solved_apart(joint, deepest, resolution)
    roots = np.sqrt(nested.depth[_FIRST : last + 1])
    wanted = np.linspace(roots[0], roots[-1], _COUNT)
    nodes = np.unique(_FIRST + np.abs(roots - wanted[:, None]).argmin(axis=1))
    profiles = [nested.fine.pressure(depth) for depth in nested.fine.depth[2 * nodes]]
    if any(profile is None for profile in profiles):
        return _solved_apart(joint, deepest, resolution)
    depth, force, error = (of[nodes] for of in (nested.depth, nested.force, nested.error))
    edge, angles = nested.coarse.angles[nodes], nested.fine.angles
    return _curve(joint, solver, depth, force, edge, error, angles, np.array(profiles))


@one_thread
def depths_and_forces(
    joint: Joint, deepest: float = 1.0, resolution: int | None = None
) -> tuple[Floats, Floats]:
    """Depths and forces of `whole_curve` at all nodes of nested contacts: 8 ms for known bodies."""
    nested, _, last = _nested_to(joint, deepest, resolution)
    inside = slice(_FIRST // 2, last + 1)
    return nested.depth[inside], nested.force[inside]


def _solved_apart(joint, deepest, resolution):
    depths = np.linspace(0, np.sqrt(deepest), _FINITE + 1)[1:] ** 2
    return force_curve(joint, depths, resolution)


def _nested_to(joint, deepest, resolution):
    """Nested contacts to a depth or just beyond, or None; the solver; and the last node."""
    checks.number("deepest", deepest, below=largest_depth(joint.r2_star))
    solver, resolution = settings(joint, None, resolution)
    few = UnresolvedError(
        f"deepest must be large enough for a contact of >= {2 * _FIRST} elements, got {deepest:g}; "
        f"use a resolution finer than {resolution}"
    )
    angles = surface_angles(resolution // 2, joint.reach)
    if nested_contact.widest(joint, deepest) < angles[2 * _FIRST]:
        raise few  # before bodies are solved
    nested = nested_contact.extrapolated(joint, meshes(joint, None, resolution), deepest)
    last = np.searchsorted(nested.depth, deepest)
    if last < min(2 * _FIRST, len(nested.depth)):
        raise few
    if last == len(nested.depth) >= len(angles) - 2:
        raise at_rim("deepest", joint, f"{deepest:g}")
    return (nested if last < len(nested.depth) else None), solver, last


def settings(joint: Joint, solver: Solver | None, resolution: int | None) -> tuple[Solver, int]:
    """Solver and elements along the surface, as given or by default, checked for this joint."""
    if not joint.has_pole:
        raise checks.RangeError(
            "a load along the axis requires a ball and a socket that face each other on the axis, "
            f"got opening {joint.opening} and ball_support {joint.ball_support}; load this joint "
            "off the axis, for example at a tilt of 90 deg (study.joint.tilted_contact or "
            "--tilt 90)"
        )
    if solver is None:
        solver = "series" if joint.series_applies else "quadratic"
    checks.choice("solver", solver, SOLVERS)
    if solver == "series":
        joint.check_series()
    if solver == "linear" and joint.has_large_displacements:
        raise ValueError("solver must be quadratic for kinematics finite, got 'linear'")
    usual, least, most = RESOLUTION["series"], 32, FINEST_RESOLUTION
    if solver != "series":
        from study.joint import fem

        steps = layer_steps(joint.socket_body.layers[0])
        checks.number(
            "outer radius of a layer divided by its inner radius", steps, least=fem.THINNEST_RATIO
        )
        usual, most = RESOLUTION["quadratic"], fem.FINEST_RESOLUTION
        least = 64 if steps.min() < 1.05 else 32
    if joint.has_large_displacements:
        from study.joint.large_displacement import LARGEST_R2_STAR

        checks.number("r2_star", joint.r2_star, most=LARGEST_R2_STAR)
        usual = RESOLUTION["finite"]
    resolution = usual if resolution is None else resolution
    resolution = checks.whole("resolution", resolution, least=least, most=most)
    if resolution % 32:
        raise ValueError(f"resolution must be a multiple of 32, got {resolution}")
    return solver, resolution


def _solve(joint, depths, solver, resolution):
    """Forces, half-angles, errors and pressures at depths > 0, of linear bodies."""
    bodies = list(meshes(joint, solver, resolution))
    nested = nested_contact.extrapolated(joint, bodies, depths.max(), single=len(depths) == 1)
    if (unseen := depths <= nested.coarse.depth[:1]).any():
        raise unresolved(depths[unseen].max(), nested.fine.angles)
    force, edge, error = np.zeros((3, len(depths)))
    within = depths < (nested.depth[-1] if len(nested.depth) > 3 else 0)
    if within.any():
        force[within], edge[within], error[within] = nested.at(joint, depths[within])
    pressure = np.zeros((len(depths), len(nested.fine.angles)))
    for k, depth in enumerate(depths):
        profile = nested.fine.pressure(depth) if within[k] else None
        if profile is None:
            solved = (nested_contact.pivoted(joint, *pair, depth) for pair in bodies)
            (profile, force[k]), (_, coarse) = solved
            edge[k], error[k] = _edge(nested.fine.angles, profile), abs(coarse / force[k] - 1)
        elif solver == "linear":
            force[k] = nested.fine.resultant(profile)
        pressure[k] = profile
    return force, edge, error, pressure


def _solve_finite(joint, depths, solver, resolution):
    """Forces, half-angles, errors and pressures at depths > 0, at large displacements.

    Their force over that of linear kinematics is smooth in depth and resolution.
    """
    from study.joint import fem, large_displacement

    of_linear, _, error, _ = _solve(replace(joint, kinematics="linear"), depths, solver, resolution)
    solved = []
    for elements in (resolution, resolution // 2):
        bodies = (fem.meshed(body, elements) for body in (joint.ball_body, joint.socket_body))
        pressure, force, linear = large_displacement.solve(joint, depths, *bodies)
        solved.append((pressure, force / linear))
    (pressure, ratio), (_, coarse) = solved
    edge = [_edge(surface_angles(resolution, joint.reach), profile) for profile in pressure]
    return of_linear * ratio, edge, error + np.abs(coarse / ratio - 1), pressure


def friction_radii(curve: ForceCurve) -> dict[str, Floats]:
    """Friction radii, in R2, of a ball in ``spin`` about the load, and in ``tilt`` across it; (k,).

    That is the friction torque over coefficient of friction and force, if the whole contact slides
    (this study) under the pressure of the frictionless joint. A place of the contact is at n R from
    the ball's centre and slides along w x n, where w is the unit vector of the axis through this
    centre. The torque along w is mu times the integral of p R abs(w x n) dA. R is the radius of the
    surface on whose areas the force acts. Hertz's pressure on a small radius a gives 3 pi a/16
    (``spin``) and R (``tilt``). Depths are > 0.
    """
    from scipy.special import ellipe  # late: for this alone

    hats = HatFunctions(curve.angles)
    radius = curve.joint.ball_radius if curve.joint.acts_on_ball else 1.0
    spin = hats.integrate(np.sin)  # of abs(w x n), or of its mean over the azimuth
    tilt = hats.integrate(lambda angle: 2 / np.pi * ellipe(np.sin(angle) ** 2))
    unit = radius / (curve.pressure @ hats.integrate(np.cos))
    return {"spin": unit * (curve.pressure @ spin), "tilt": unit * (curve.pressure @ tilt)}


def meshes(
    joint: Joint, solver: Solver | None, resolution: int
) -> Iterator[tuple[Compliance, Compliance]]:
    """Ball and socket at a resolution, then at half of it.

    Each is solved by its best solver if none is given. Coarser finite elements are solved too; the
    series is projected on coarser hats.
    """
    nodes: Literal[6, 3] = 3 if solver == "linear" else 6
    bodies: list[tuple[Compliance, Compliance]] = []
    for body in (joint.ball_body, joint.socket_body):
        if body.by_series and solver in (None, "series"):
            finer = series.compliance(body, resolution)
            bodies.append((finer, finer.coarser))
        else:
            from study.joint import fem

            finer = fem.compliance(body, resolution, nodes)
            bodies.append((finer, fem.compliance(body, resolution // 2, nodes)))
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
    beyond = min(last + 1, len(angles) - 1)
    x = np.cos(angles) - np.cos(angles[last])
    inner = (angles >= 0.3 * angles[last]) & (np.arange(len(angles)) <= last - 2)
    degree = min(3, np.count_nonzero(inner) // 4)
    roots = np.array([x[beyond] / 2])
    if degree > 0:
        fitted = np.polynomial.Polynomial.fit(x[inner], pressure[inner] ** 2, degree).roots()
        real = fitted[np.isreal(fitted)].real
        roots = real if real.size else roots
    nearest = roots[np.argmin(np.abs(roots))]
    inside = x[max(last - 1, 0)]
    return float(np.arccos(np.cos(angles[last]) + np.clip(nearest, x[beyond], inside)))
