"""Ball pressed into the socket along its axis: two elastic bodies and a gap become a solution.

For every depth the contact pressure p solves a complementarity problem on the contact arc::

    p >= 0,    w = A p + gap(depth) >= 0,    p w = 0

in the weak (Galerkin) sense of the pressure's hat functions: A is the sum of the flexibilities of
ball and socket, and w the gap that is left, both integrated with the hats. The contact is elastic
and without friction. `study.joint.kinematics` says which points face each other, and
`study.joint.nested` solves all depths with few factors of A. Two meshes are solved, and their
forces, which have errors of order 2, are extrapolated.

Lengths are in socket radii R2 and pressures in E* dR/R2 inside this module.
"""

from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.compiled import one_thread
from study.contact import hertz_factor, largest_depth
from study.joint import complementarity, series
from study.joint.compliance import (
    FINEST_RESOLUTION,
    RESOLUTION,
    Compliance,
    HatFunctions,
    surface_angles,
)
from study.joint.description import JointDescription
from study.joint.kinematics import UnresolvedError, at_rim, problem_of, unresolved
from study.joint.nested import NestedContacts
from study.joint.solution import Solution

Floats = NDArray[np.float64]
Solver = Literal["series", "quadratic", "linear"]
SOLVERS: tuple[Solver, ...] = get_args(Solver)
_FIRST = 8  # elements of the coarser mesh in the smallest contact of a whole curve
_COUNT = 48  # depths of a whole curve
_NEAR = 5e-3  # relative change of the depth for the stiffness of contacts that are not nested
_STEPS, _TOLERANCE = 60, 1e-7  # of the search for a depth; of the force that is asked for


class Pair(NamedTuple):
    """Ball and socket under the hats of one mesh."""

    ball: Compliance
    socket: Compliance


class AxialContact(NamedTuple):
    """A contact at one depth: normalised as in `Solution`, the half-angle in rad."""

    force: float
    stiffness: float
    half_angle: float
    error: float
    peak_error: float
    pressure: Floats


@one_thread
def solve(
    joint: JointDescription,
    asked: Floats,
    is_force: bool = False,
    resolution: int | None = None,
    solver: Solver | None = None,
) -> Solution:
    """Solution at depths, or under forces, along the axis: see `study.joint.Joint.solve`.

    ``asked`` are normalised depths or forces, shape (k,).
    """
    solver, resolution = settings(joint, solver, resolution)
    pairs, depths = meshes(joint, solver, resolution), asked
    if is_force:
        depths = np.array([_depth_under(joint, pairs, force, solver) for force in asked])
    checks.number("depth_star", depths, below=largest_depth(joint.r2_star))
    fine, coarse = meshed = [NestedContacts(joint, *pair, depths.max()) for pair in pairs]
    if (unseen := depths <= coarse.depth[:1]).any():
        raise unresolved(depths[unseen].max(), fine.angles)
    contacts = [_contact(joint, pairs, meshed, depth, solver) for depth in depths]
    force, stiffness, half_angle, error, peak_error, pressure = (
        np.array(of) for of in zip(*contacts, strict=True)
    )
    if (reaching := pressure[:, -2:].any(axis=1)).any():
        raise at_rim("depth_star", joint, f"{depths[reaching].min():g}")
    if is_force:
        error = error + np.abs(force / asked - 1)
    hats = HatFunctions(fine.angles)
    torque, along = (pressure @ hats.integrate(of) for of in (np.sin, np.cos))
    radius = joint.radius_ratio if joint.acts_on_ball else 1.0
    # the area is that of a cap inside the edge, less the part that does not touch
    inside = (pressure == 0) & (fine.angles < half_angle[:, None])
    area = 2 * np.pi * (1 - np.cos(half_angle)) - inside @ hats.integrate(np.ones_like)
    return Solution(
        joint=joint,
        solver=solver,
        resolution=resolution,
        depth_star=depths,
        force_star=force,
        stiffness_star=stiffness,
        contact_half_angle_deg=np.degrees(half_angle),
        contact_area_star=radius**2 * area,
        peak_pressure_star=pressure.max(axis=1),
        peak_error=peak_error,
        friction_radius_star=radius * torque / along,
        error_estimate=error,
        angle_deg=np.degrees(fine.angles),
        pressure_star=pressure,
    )


def depths_of_curve(joint: JointDescription, deepest: float, resolution: int | None) -> Floats:
    """Depths of `study.joint.Joint.curve`, in equal steps of the root of the depth_star."""
    checks.number("deepest", deepest, above=0, below=largest_depth(joint.r2_star), scalar=True)
    _, resolution = settings(joint, None, resolution)
    angles = surface_angles(resolution // 2, joint.opening.reach)
    first, fewest = (angles[k] ** 2 / joint.radius_ratio for k in (_FIRST, 2 * _FIRST))  # Hertz's
    if deepest < fewest:
        raise UnresolvedError(
            f"deepest must be large enough for a contact of >= {2 * _FIRST} elements, got "
            f"{deepest:g}; use a resolution finer than {resolution}"
        )
    return np.linspace(np.sqrt(first), np.sqrt(deepest), _COUNT) ** 2


@one_thread
def at_nodes(
    joint: JointDescription, deepest: float = 1.0, resolution: int | None = None
) -> Solution | None:
    """Forces where nodes of the finer mesh close, up to a depth_star; 10 ms for known bodies.

    They are dense where the contact grows fast, and have no pressures. None if contacts are not
    nested up to this depth.
    """
    depths_of_curve(joint, deepest, resolution)  # checked
    solver, resolution = settings(joint, None, resolution)
    pairs = meshes(joint, solver, resolution)
    fine, coarse = meshed = [NestedContacts(joint, *pair, deepest) for pair in pairs]
    if not all(of.is_nested and of.depth[-1] > deepest for of in meshed):
        return None
    depths = fine.depth[(fine.depth > coarse.depth[_FIRST // 4]) & (fine.depth < deepest)]
    depths = np.append(depths, deepest)
    of_fine, of_coarse = fine.at(depths), coarse.at(depths)
    force, stiffness, half_angle = of_fine + (of_fine - of_coarse) / 3
    error = np.abs(of_fine[0] - of_coarse[0]) / force
    # the parts of the error, which may cancel each other, are known at the last depth
    parts = _contact(joint, pairs, meshed, deepest, solver).error / error[-1]
    return Solution(
        joint=joint,
        solver=solver,
        resolution=resolution,
        depth_star=depths,
        force_star=force,
        stiffness_star=stiffness,
        contact_half_angle_deg=np.degrees(half_angle),
        error_estimate=max(parts, 1.0) * error,
    )


def settings(
    joint: JointDescription, solver: Solver | None, resolution: int | None
) -> tuple[Solver, int]:
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
    most = FINEST_RESOLUTION
    if solver == "series":
        if not joint.series_applies:
            raise ValueError(
                "solver must be quadratic or linear for this joint, because the series requires "
                "ball_support guided, rim mirror and a hemispherical socket held at its whole "
                f"outside, got {', '.join(f'{n} {v}' for n, v in joint.supports.items())}"
            )
    else:
        from study.joint import meridian

        most = meridian.FINEST_RESOLUTION
    resolution = RESOLUTION[solver] if resolution is None else resolution
    resolution = checks.whole("resolution", resolution, least=32, most=most)
    if resolution % 32:
        raise ValueError(f"resolution must be a multiple of 32, got {resolution}")
    return solver, resolution


def meshes(joint: JointDescription, solver: Solver | None, resolution: int) -> list[Pair]:
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
            from study.joint import modes

            finer, coarser = (
                modes.compliance(body, n, nodes) for n in (resolution, resolution // 2)
            )
            bodies.append((finer, coarser))
    return [Pair(*pair) for pair in zip(*bodies, strict=True)]


def _contact(joint, pairs, meshed, depth, solver):
    """Contact at a depth, from nested contacts on two meshes or, if it is not nested, by pivoting.

    The force error is the sum of the changes from the coarser mesh that are due to the ball, to
    the socket and to the contact, because they may cancel each other by chance.
    """
    fine, coarse = (of.pressure(depth) for of in meshed)
    if fine is not None and coarse is not None:
        of_fine, of_coarse = (of.at(depth) for of in meshed)
        force, stiffness, half_angle = of_fine + (of_fine - of_coarse) / 3
        if solver == "linear":  # of the finer mesh, to show what it gives
            force = meshed[0].resultant(fine)
        # below the first closure depth of the coarser mesh both only follow Hertz's law
        change = of_fine[0] - of_coarse[0]
        unseen = max(0.0, 1 - np.sqrt(depth / meshed[1].depth[1]))
    else:
        unseen = 0.0
        (fine, force), (coarse, other) = (_pivoted(joint, pair, depth) for pair in pairs)
        nearby = [_pivoted(joint, pairs[0], depth * s)[1] for s in (1 - _NEAR, 1 + _NEAR)]
        stiffness = np.diff(nearby)[0] / (2 * _NEAR * depth)
        last = np.flatnonzero(fine)[-1]
        half_angle, change = meshed[0].angles[last : last + 2].mean(), force - other
    of_bodies = stiffness * _body_changes(joint, pairs, coarse)
    error = unseen + (np.abs(of_bodies).sum() + abs(change - of_bodies.sum())) / force
    return AxialContact(force, stiffness, half_angle, error, _peak_error(fine, coarse), fine)


def _body_changes(joint, pairs, pressure):
    """Depths by which ball and socket of the finer mesh yield less than those of the coarser one.

    Under a pressure p with the resultant F it is p (A_coarse - A_fine) p/F, both under the hats of
    the coarser mesh.
    """
    of_ball, of_socket = joint.modulus_shares
    load = pressure @ HatFunctions(pairs[1].ball.angles).integrate(np.cos)
    changes = []
    for share, finer, coarser in zip(
        (of_ball * joint.radius_ratio, of_socket), *pairs, strict=True
    ):
        if finer.coarser is coarser:  # the series
            changes.append(0.0)
        else:
            apart = coarser.flexibility - finer.coarser.flexibility
            changes.append(share * (pressure @ apart @ pressure) / load)
    return np.array(changes)


def _pivoted(joint, pair, depth):
    """Pressure and force of a contact that may be a ring or have several parts."""
    problem, axial = problem_of(joint, *pair)
    matrix, parts = problem(depth)
    pressure, _ = complementarity.solve(matrix, depth ** np.arange(3) @ parts)
    return pressure, joint.r2_star * float(axial @ pressure)


def _depth_under(joint, pairs, force, solver):
    """Depth_star under a force_star, by Newton's method in logarithms, within a bracket.

    The first guess is Hertz's, which may be too small to be resolved where the wall yields.
    """
    low, high, borne, small = 0.0, float(largest_depth(joint.r2_star)), 0.0, None
    depth = min((force / hertz_factor(joint.r2_star)) ** (2 / 3), high / 2)
    for _ in range(_STEPS):
        meshed = [NestedContacts(joint, *pair, depth) for pair in pairs]
        if (depth <= meshed[1].depth[:1]).any():
            small = unresolved(depth, meshed[0].angles)
            if high < 1.01 * depth:
                raise small
            low, depth = depth, min(4 * depth, (depth + high) / 2)
            continue
        found = _contact(joint, pairs, meshed, depth, solver)
        if abs(found.force / force - 1) < _TOLERANCE:
            return depth
        if found.force > force or found.pressure[-2:].any():
            high = depth
        else:
            low, borne = depth, found.force
        if min(found.force, found.stiffness) > 0:
            depth *= (force / found.force) ** (found.force / (found.stiffness * depth))
        if not low < depth < high:
            depth = (low + high) / 2
        if high < low * (1 + 1e-9):
            break
    if borne == 0 and small is not None:
        raise small
    raise checks.RangeError(
        f"force must be <= {joint.force_unit * borne:.6g} N, got {joint.force_unit * force:g} N; "
        "beyond this the contact would reach the rim of the socket"
    )


def _peak_error(fine, coarse):
    """Estimated relative error of the peak pressure, from the pressures on two meshes.

    Two peaks may agree by chance; the estimate is the largest difference in the middle of the
    contact, where the pressure is above 0.7 of the peak.
    """
    apart, peak = np.abs(fine[::2] - coarse), fine.max()
    return apart[fine[::2] > 0.7 * peak].max(initial=abs(coarse.max() - peak)) / peak
