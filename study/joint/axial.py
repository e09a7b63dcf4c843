"""Ball pressed into the socket along its axis: two elastic bodies and a gap become a solution.

For every depth the contact pressure solves a complementarity problem on the contact arc:
pressure >= 0, gap >= 0, pressure * gap = 0, all in the weak (Galerkin) sense of the pressure's
hat functions. Frictionless and elastic. `study.joint.kinematics` says which points face each other,
and `study.joint.nested` solves all depths with one factor of the matrix.

Lengths are in socket radii R2 and pressures in E* dR/R2 inside this module.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.contact import hertz_factor, largest_depth
from study.joint import nested, series, stress
from study.joint.compliance import (
    FINEST_RESOLUTION,
    RESOLUTION,
    Compliance,
    HatFunctions,
    layer_steps,
    surface_angles,
)
from study.joint.kinematics import UnresolvedError, at_rim, unresolved
from study.joint.solution import Solution
from study.threads import one_thread

if TYPE_CHECKING:
    from study.joint.joint import Joint

Floats = NDArray[np.float64]
Solver = Literal["series", "quadratic", "linear"]
SOLVERS: tuple[Solver, ...] = get_args(Solver)
_FIRST = 8  # elements of the coarser mesh in the smallest contact of a whole curve
_COUNT = 48  # depths of a whole curve, about
_APART = 40  # depths of a curve whose contacts are not nested
_NEAR = 5e-3  # relative change of the depth for the stiffness of contacts that are not nested
_OF_PRESSURES = 0.3  # fraction of the pressures' mean difference that errors of the peak are below
_STEPS, _TOLERANCE = 60, 1e-7  # of the search for a depth; of the force that is asked for


@one_thread
def solve(
    joint: Joint,
    asked: Floats,
    is_force: bool = False,
    stresses: bool = False,
    resolution: int | None = None,
    solver: Solver | None = None,
) -> Solution:
    """Solution at depths, or under forces, along the axis: see `study.joint.Joint.solve`.

    ``asked`` are normalised depths or forces, shape (k,).
    """
    method, usual = settings(joint, solver, resolution)
    # the series is cheap enough for finer elements where a contact is very small
    counts = (usual, 2 * usual) if resolution is None and method == "series" else (usual,)
    depths = asked
    for count in counts:
        try:
            if is_force:
                depths = np.array([_depth_under(joint, force, method, count) for force in asked])
            found = _solved(joint, depths, method, count)
            break
        except UnresolvedError:
            if count == counts[-1]:
                raise
    force, slope, edge, error, *more = found
    if is_force:
        error = error + np.abs(force / asked - 1)
    return _solution(joint, method, count, depths, (force, slope, edge, error, *more), stresses)


@one_thread
def curve(
    joint: Joint, deepest: float, resolution: int | None = None, stresses: bool = False
) -> Solution:
    """Force-depth curve along the axis to a maximum depth_star: see `study.joint.Joint.curve`.

    Where contacts are not nested (`study.joint.nested`), 40 depths are solved one by one.
    """
    deepest = checks.number("deepest", deepest, above=0, scalar=True)
    contacts, solver, count, last = _nested_to(joint, deepest, resolution)
    profiles: list[Floats | None] = [None]
    if contacts is not None:
        roots = np.sqrt(contacts.depth[_FIRST : last + 1])
        wanted = np.linspace(roots[0], roots[-1], _COUNT)
        nodes = np.unique(_FIRST + np.abs(roots - wanted[:, None]).argmin(axis=1))
        profiles = [contacts.fine.pressure(depth) for depth in contacts.fine.depth[2 * nodes]]
    if any(profile is None for profile in profiles):
        depths = np.linspace(0, np.sqrt(deepest), _APART + 1)[1:] ** 2
        return solve(joint, depths, stresses=stresses, resolution=resolution)
    every = contacts.depth, contacts.force, contacts.stiffness, contacts.error
    depth, force, slope, error = (of[nodes] for of in every)
    coarser = [contacts.coarse.pressure(at) for at in contacts.coarse.depth[nodes]]
    of_peak = [_peak_error(*pair) for pair in zip(profiles, coarser, strict=True)]
    found = force, slope, contacts.coarse.angles[nodes], error, np.array(profiles), of_peak
    return _solution(joint, solver, count, depth, found, stresses)


@one_thread
def depths_and_forces(
    joint: Joint, deepest: float = 1.0, resolution: int | None = None
) -> tuple[Floats, Floats]:
    """Depths and forces of `curve` at all nodes of nested contacts: 8 ms for known bodies."""
    contacts, _, _, last = _nested_to(joint, deepest, resolution)
    inside = slice(_FIRST // 2, last + 1)
    return contacts.depth[inside], contacts.force[inside]


def _solution(joint, solver, resolution, depths, found, stresses):
    force, slope, edge, error, pressure, of_peak = found
    angles = surface_angles(resolution, joint.opening.reach)
    hats = HatFunctions(angles)
    torque, along = (pressure @ hats.integrate(of) for of in (np.sin, np.cos))
    radius = joint.radius_ratio if joint.acts_on_ball else 1.0
    solution = Solution(
        joint=joint,
        solver=solver,
        resolution=resolution,
        depth_star=depths,
        force_star=force,
        stiffness_star=slope,
        contact_half_angle_deg=np.degrees(edge),
        contact_area_star=_area(joint, angles, edge, pressure),
        peak_pressure_star=pressure.max(axis=1),
        peak_error=np.array(of_peak),
        friction_radius_star=radius * torque / along,
        error_estimate=error,
        angle_deg=np.degrees(angles),
        pressure_star=pressure,
    )
    return replace(solution, stress=stress.largest(solution)) if stresses else solution


def _depth_under(joint, force, solver, resolution):
    """Depth_star under a force_star, by Newton's method in logarithms, within a bracket.

    A depth at which the contact is not resolved, or would reach the rim, narrows the bracket.
    """
    low, high, borne, small = 0.0, float(largest_depth(joint.r2_star)), 0.0, None
    depth, is_rim = min((force / hertz_factor(joint.r2_star)) ** (2 / 3), high / 2), True
    for _ in range(_STEPS):
        following = np.inf
        try:
            here = _solved(joint, np.array([depth]), solver, resolution, search=True)
        except UnresolvedError as error:
            low, small = depth, error
        except checks.RangeError:
            high, is_rim = depth, True
        else:
            found, slope, *_ = (of[0] for of in here)
            if abs(found / force - 1) < _TOLERANCE:
                return depth
            if found < force:
                low, borne = depth, found
            else:
                high, is_rim = depth, False
            following = depth * (force / found) ** (found / (slope * depth))
        if not low < following < high:
            following = np.sqrt(low * high) if low > 0 else high / 8
        if high < low * (1 + 1e-9):
            break
        depth = following
    if not is_rim:  # between two neighbouring depths
        if borne == 0 and small is not None:
            raise small
        return depth
    raise checks.RangeError(
        f"force must be <= {joint.force_unit * borne:.6g} N, got {joint.force_unit * force:g} N; "
        "beyond this the contact would reach the rim of the socket"
    )


def _nested_to(joint, deepest, resolution):
    """Nested contacts to a depth or just beyond, or None; solver, resolution, and the last node."""
    checks.number("deepest", deepest, below=largest_depth(joint.r2_star))
    solver, resolution = settings(joint, None, resolution)
    few = UnresolvedError(
        f"deepest must be large enough for a contact of >= {2 * _FIRST} elements, got {deepest:g}; "
        f"use a resolution finer than {resolution}"
    )
    angles = surface_angles(resolution // 2, joint.opening.reach)
    if nested.widest(joint, deepest) < angles[2 * _FIRST]:
        raise few  # before bodies are solved
    contacts = nested.extrapolated(joint, meshes(joint, None, resolution), deepest)
    last = np.searchsorted(contacts.depth, deepest)
    if last < min(2 * _FIRST, len(contacts.depth)):
        raise few
    if last == len(contacts.depth) >= len(angles) - 2:
        raise at_rim("deepest", joint, f"{deepest:g}")
    return (contacts if last < len(contacts.depth) else None), solver, resolution, last


def settings(joint: Joint, solver: Solver | None, resolution: int | None) -> tuple[Solver, int]:
    """Solver and elements along the surface, as given or by default, checked for this joint."""
    if not joint.has_pole:
        raise checks.RangeError(
            "a load along the axis requires a ball and a socket that face each other on the axis, "
            f"got opening {joint.opening} and ball_support {joint.ball_support}; load this joint "
            "off the axis, for example at a tilt of 90 deg"
        )
    if solver is None:
        solver = "series" if joint.series_applies else "quadratic"
    checks.choice("solver", solver, SOLVERS)
    least, most = 32, FINEST_RESOLUTION
    if solver == "series":
        if not joint.series_applies:
            raise ValueError(
                "solver must be quadratic or linear for this joint, because the series requires "
                "ball_support guided, rim mirror and a hemispherical socket held at its whole "
                f"outside, got {', '.join(f'{n} {v}' for n, v in joint.supports.items())}"
            )
    else:
        from study.joint import meridian

        steps = layer_steps(joint.socket_body.layers[0])
        name = "outer radius of a layer divided by its inner radius"
        checks.number(name, steps, least=meridian.THINNEST_RATIO)
        least, most = (64 if steps.min() < 1.05 else 32), meridian.FINEST_RESOLUTION
    resolution = RESOLUTION[solver] if resolution is None else resolution
    resolution = checks.whole("resolution", resolution, least=least, most=most)
    if resolution % 32:
        raise ValueError(f"resolution must be a multiple of 32, got {resolution}")
    return solver, resolution


def _solved(joint, depths, solver, resolution, search=False):
    """Forces, stiffnesses, half-angles, errors, pressures and errors of the peak at depths.

    A ``search`` has one depth, and an approximate stiffness.
    """
    checks.number("depth_star", depths, below=largest_depth(joint.r2_star))
    bodies = list(meshes(joint, solver, resolution))
    made = nested.AT if len(depths) == 1 else nested.ALONG
    contacts = nested.extrapolated(joint, bodies, depths.max(), made)
    if (unseen := depths <= contacts.coarse.depth[:1]).any():
        raise unresolved(depths[unseen].max(), contacts.fine.angles)
    force, slope, edge, error, of_peak = np.zeros((5, len(depths)))
    within = depths < (contacts.depth[-1] if len(contacts.depth) > 3 else 0)
    if within.any():
        found = contacts.at(joint, depths[within])
        force[within], slope[within], edge[within], error[within] = found
        if len(depths) == 1 and not search:
            _, slope, _, _ = nested.extrapolated(joint, bodies, depths[0]).at(joint, depths)
    pressure = np.zeros((len(depths), len(contacts.fine.angles)))
    for k, depth in enumerate(depths):
        profile = contacts.fine.pressure(depth) if within[k] else None
        coarse = contacts.coarse.pressure(depth) if within[k] else None
        if coarse is None or profile is None:
            coarse, of_coarse = nested.pivoted(joint, *bodies[1], depth)
        if profile is None:
            profile, force[k] = nested.pivoted(joint, *bodies[0], depth)
            edge[k], error[k] = _edge(contacts.fine.angles, profile), abs(of_coarse / force[k] - 1)
            near = [nested.pivoted(joint, *bodies[0], depth * s)[1] for s in (1 - _NEAR, 1 + _NEAR)]
            slope[k] = np.diff(near)[0] / (2 * _NEAR * depth)
        elif solver == "linear":
            force[k] = contacts.fine.resultant(profile)
        pressure[k], of_peak[k] = profile, _peak_error(profile, coarse)
    reaching = pressure[:, -2:].any(axis=1)
    if reaching.any():
        raise at_rim("depth_star", joint, f"{depths[reaching].min():g}")
    return force, slope, edge, error, pressure, of_peak


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
            from study.joint import modes

            pair = [modes.compliance(body, n, nodes) for n in (resolution, resolution // 2)]
            bodies.append((pair[0], pair[1]))
    return zip(*bodies, strict=True)


def _peak_error(fine, coarse):
    """Estimated relative error of the peak pressure, from the pressures on two meshes.

    Two peaks may agree by chance, all the pressures do not (`_OF_PRESSURES`).
    """
    if coarse is None:
        return np.nan
    apart = np.abs(fine[::2] - coarse).sum() / fine[::2].sum()
    return max(abs(1 - coarse.max() / fine.max()), _OF_PRESSURES * apart)


def _area(joint, angles, edge, pressure):
    """Area of contact in R2^2: a cap inside the edge, less the part that does not touch."""
    scale = joint.radius_ratio**2 if joint.acts_on_ball else 1.0
    area = 2 * np.pi * (1 - np.cos(edge))
    nodes = HatFunctions(angles).integrate(np.ones_like)
    open_inside = (pressure == 0) & (angles < edge[:, None])
    return scale * (area - open_inside @ nodes)


def _edge(angles, pressure):
    """Polar angle where the pressure ends: a root of its square, to about 0.3 %.

    Pressure falls like the square root of the distance to the edge, so that its square is
    smooth and a cubic in cos(angle) fits it, without the last two nodes, which oscillate. A
    contact of few nodes gets a lower degree, one of very few the middle beyond its last node.
    """
    last = int(np.flatnonzero(pressure)[-1]) if pressure.any() else -1
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
