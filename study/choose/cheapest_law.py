"""The cheapest law that is accurate enough for a joint, with the evidence.

The error of a law is the maximum relative error of its force, relative to the elastic solution of
the joint, over all depths from `SHALLOWEST` clearances to a maximum depth. Its bound includes 3
times the error estimate of that solution. If no closed-form law is within the tolerance, the table
of the coarsest solution within it is chosen. Costs are those of `study.contact.costs`.

A law for the axial direction is also accurate up to some tilt. This is known from a rule if the
supports of ball and socket are the same all round and the rim is distant, that is for a ball on a
core, a socket that is held at its whole outside, and a contact at a distance of at least twice the
wall thickness from the rim. In 8 joints that were solved along the axis, such a rim changed the
force by a fraction of at most 0.0015. In other cases the joint is solved.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import LAWS, hertz, largest_depth, tabulated
from study.contact.costs import relative_costs
from study.joint import Joint, UnresolvedError, force_curve, tilted_contact, whole_curve
from study.joint.compliance import RESOLUTION
from study.joint.dimensional import usual_depth
from study.joint.law_parameters import law_parameters
from study.joint.nested_contact import LEAST_R2_STAR
from study.joint.supports import Core
from study.joint.tilted import LARGEST_TILT
from study.threads import one_thread

SHALLOWEST = 0.005
"""Minimum depth_star of the error: below it, the force is less than 1/1000 of that at 0.5."""
ESTIMATE = 3.0  # times a solution's error estimate, for depths between those solved
RESOLUTIONS = {"series": (64, 160, 320, 640, 1280), "quadratic": (64, 160), "finite": (32, 64, 96)}
DEPTHS = 40  # of a law's error
SOLVED_FIRST = 1.25
"""Factor on the cost of a table, because its joint has to be solved first, and because measured
costs are noisy: the costs of a table and of ``stiffened_hertz`` differed by 1 to 13 % from run to
run."""
FINITE_DEPTHS = 13  # with large displacements, a second each; odd: first and last are in a table
DEEPER = (1, 4, 12)
"""Factors on a depth: laws are compared up to the smallest of these depths that elements resolve.
The range begins at or below a twelfth of its end, so that the depth itself is within it."""
TOLERANCES = (1e-5, 1.0)
"""Minimum and maximum tolerance. The finest solution is not known to be within 1e-5, and it takes a
minute to find this out."""
OF_RULE = 0.002
"""Maximum change of the force by a rim that is distant according to the rule."""
_WALLS, _LARGEST_POISSON = 2, 0.4  # of the rule: thickness to the rim, and of every material
_TILTS = 4


@dataclass(frozen=True)
class Choice:
    """The chosen law for a joint, with the evidence.

    Attributes
    ----------
    law
        Key of ``study.contact.LAWS``; ``tabulated`` for a table of the elastic solution; or
        ``solver`` if the joint has to be solved at every call.
    options
        Options of the law; for ``tabulated`` and ``solver`` the resolution of the solution.
    error_bound
        Bound of the relative error of the force between the `depths`.
    relative_cost
        Computing time of a call in a compiled loop relative to that of Hertz's law, without the
        time to solve the joint once for ``tabulated``.
    depths
        Minimum and maximum depth_star for which the bound is valid.
    rejected
        Cheaper laws whose bound exceeds the tolerance, the most expensive first: ``law``,
        ``options``, ``error``, ``error_bound``, ``relative_cost``.
    errors
        Maximum relative error of every closed-form law that applies to the joint, by its name.
    evaluate
        The law as a function of (``depth_star``, ``r2_star``); None for ``solver``.
    """

    law: str
    options: dict
    error_bound: float
    relative_cost: float
    depths: tuple[float, float]
    rejected: tuple[dict, ...]
    errors: dict[str, float]
    evaluate: Callable | None = field(repr=False, compare=False)


@one_thread
def choose(joint: Joint, depth_star: float, tolerance: float) -> Choice:
    """Cheapest law whose force is known to be within a tolerance.

    Parameters
    ----------
    joint
        The joint without dimensions.
    depth_star
        Maximum normalised penetration depth d/dR.
    tolerance
        Maximum relative error of the force, from 1e-5 to 1.

    Raises
    ------
    ValueError
        If a value is outside its range, or the contact cannot be so deep.
    study.checks.StudyError
        If the error of even the finest elastic solution may exceed the tolerance.

    Examples
    --------
    >>> choice = choose(Joint(r2_star=75, socket_ratio=1.4), depth_star=0.5, tolerance=0.02)
    >>> choice.law, choice.error_bound < 0.002
    ('stiffened_hertz', True)
    """
    deepest = checks.number("depth_star", depth_star, above=0, scalar=True)
    checks.number("tolerance", tolerance, least=TOLERANCES[0], most=TOLERANCES[1], scalar=True)
    widest = largest_depth(joint.r2_star)
    # errors are estimated at depths up to 1.05 times this one
    checks.number("depth_star", deepest, below=widest / 1.05)
    least = min(SHALLOWEST, deepest / 12)
    depths = np.linspace(np.sqrt(least), np.sqrt(deepest), DEPTHS) ** 2
    force, uncertainty = _exact(joint, depths)
    largest = {law: float(error.max()) for law, error in law_errors(joint, depths, force).items()}
    made = partial(Choice, depths=(float(least), deepest), rejected=(), errors=largest)
    rejected: list[dict] = []
    for error, choice in _candidates(joint, depths, force, uncertainty, largest, made):
        if choice.error_bound <= tolerance:
            return replace(choice, rejected=tuple(reversed(rejected)))
        row = {"law": choice.law, "options": choice.options, "error": error}
        row |= {"error_bound": choice.error_bound, "relative_cost": choice.relative_cost}
        rejected.append(row)
    raise checks.StudyError(
        f"no law is known to be within the tolerance {tolerance:g}, because the estimated relative "
        f"error of the finest elastic solution, of resolution {choice.options['resolution']}, is "
        f"{choice.error_bound:.2g}; give a larger tolerance"
    )


def choose_beside(joint: Joint, depth_star: float, tolerance: float) -> Choice:
    """`choose` up to a depth, or up to a larger one if that contact is too small for elements.

    Raises the errors of `choose`. For a contact that is much too small, the message of
    `study.checks.RangeError` states the error of Hertz's law there.
    """
    is_small = max(DEEPER) * depth_star <= usual_depth(joint)
    for deeper in DEEPER if is_small else (1,):
        try:
            return choose(joint, deeper * depth_star, tolerance)
        except checks.RangeError:
            if not is_small:
                raise
    force = hertz(depth_star, joint.r2_star)  # stiffened_hertz begins as this law
    error = law_errors(joint, depth_star, force).get("stiffened_hertz")
    known = "" if error is None else f"; there Hertz's law is valid within {100 * error:.2g} %"
    raise checks.RangeError(
        f"the contact at a depth of {depth_star:.3g} clearances is too small to compare laws{known}"
    )


def _candidates(joint, depths, force, uncertainty, largest, made):
    """Errors and choices, by cost: closed laws, tables from the coarsest on, and the solution."""
    costs, resolutions = relative_costs(), RESOLUTIONS[_kind(joint)]
    ahead = costs | {"tabulated": SOLVED_FIRST * costs["tabulated"]}
    for law in sorted([*largest, "tabulated"], key=ahead.__getitem__):
        if law != "tabulated":
            options = law_parameters(LAWS[law], joint, depths, force)
            bound, evaluate = _bounded(largest[law], uncertainty), partial(LAWS[law], **options)
            yield largest[law], made(law, options, bound, costs[law], evaluate=evaluate)
            continue
        for resolution, curve, error in _solutions(joint, depths, resolutions):
            # every second depth is left out of the table, and shows its error of interpolation
            in_table = np.arange(len(curve.depth_star)) % 2 == (len(curve.depth_star) - 1) % 2
            names = ("depth_star", "force_star", "error_estimate")
            table = tabulated(replace(curve, **{n: getattr(curve, n)[in_table] for n in names}))
            left_out = ~in_table & (curve.depth_star >= depths[0])
            exact = curve.force_star[left_out]
            between = float(np.abs(table(curve.depth_star[left_out]) / exact - 1).max())
            off = float(np.abs(table(depths) / force - 1).max())
            bound = _bounded(max(ESTIMATE * error, off), between)
            yield error, made(law, {"resolution": resolution}, bound, costs[law], evaluate=table)
    options = {"resolution": resolutions[-1]}
    error = float(force_curve(joint, depths[::4], resolutions[-1]).error_estimate.max())
    yield error, made("solver", options, ESTIMATE * error, costs["solver"], evaluate=None)


def _solutions(joint, depths, resolutions):
    """Curves that resolve the range of ``depths``, and their largest errors there."""
    apart = joint.has_large_displacements or joint.r2_star < LEAST_R2_STAR
    places = np.linspace(*np.sqrt(depths[[0, -1]]), FINITE_DEPTHS) ** 2
    for resolution in resolutions:
        try:
            if apart:
                curve = force_curve(joint, places, resolution)
            else:
                curve = whole_curve(joint, float(depths[-1]), resolution)
            if curve.depth_star[0] > depths[0]:
                raise UnresolvedError(
                    f"depth_star must be >= {curve.depth_star[0]:.3g} so that elements of this "
                    f"size resolve the contact, got {depths[0]:.3g}"
                )
        except UnresolvedError:
            if resolution == resolutions[-1]:
                raise
            continue  # a finer one may
        error = curve.error_estimate[curve.depth_star >= depths[0]].max()
        yield resolution, curve, float(error)


def _exact(joint, depths):
    """Exact forces at depths, and their relative uncertainty, one number."""
    kind = _kind(joint)
    finer = [n for n in RESOLUTIONS[kind] if n > RESOLUTION[kind]]  # for very shallow depths
    _, curve, error = next(_solutions(joint, depths, (None, *finer)))
    return tabulated(curve)(depths), ESTIMATE * error


def _bounded(error, uncertainty):
    """Bound of a relative error that was computed against an uncertain force."""
    return error * (1 + uncertainty) + uncertainty


def law_errors(
    joint: Joint, depth_star: ArrayLike, force_star: ArrayLike
) -> dict[str, NDArray[np.float64]]:
    """Errors, relative to given forces, of every law with a known cost.

    Laws that do not apply to the joint are left out. ``power`` is fitted to the forces.
    """
    by_law: dict[str, NDArray[np.float64]] = {}
    for law in filter(relative_costs().__contains__, LAWS):
        if law == "power" and np.size(depth_star) < 2:
            continue
        try:
            options = law_parameters(LAWS[law], joint, depth_star, force_star)
            force = LAWS[law](depth_star, joint.r2_star, **options)
        except checks.RangeError:
            continue
        by_law[law] = np.abs(force / force_star - 1)
    return by_law


def _kind(joint):
    if joint.has_large_displacements:
        return "finite"
    return "series" if joint.series_applies else "quadratic"


@dataclass(frozen=True)
class OffAxis:
    """Whether one law for the axial direction is within a tolerance for all tilts.

    Attributes
    ----------
    one_law_for_all_directions
        The answer.
    direction_error
        Maximum difference between the force, as a vector, and that along the axis, relative to the
        latter. A measured difference includes the error estimate of the solution.
    known_by
        ``rule``, or ``measured`` at the maximum depth and four tilts.
    """

    one_law_for_all_directions: bool
    direction_error: float
    known_by: Literal["rule", "measured"]


def axial_law_suffices(joint: Joint, depth_star: float, tilt: float, tolerance: float) -> OffAxis:
    """Whether one law for the axial direction is within a tolerance for all tilts up to a maximum.

    Parameters
    ----------
    joint
        The joint without dimensions.
    depth_star
        Maximum normalised penetration depth d/dR.
    tilt
        Maximum angle in deg between displacement and axis.
    tolerance
        Maximum relative error of the force, > 0 and <= 1.

    Raises
    ------
    ValueError
        If a value is outside its range, or as `study.joint.tilted_contact` does.

    Examples
    --------
    >>> hip = Joint(r2_star=100, ball_support="core:0.5", socket_ratio=1.2)
    >>> axial_law_suffices(hip, depth_star=0.3, tilt=20, tolerance=0.05).known_by
    'rule'
    """
    depth = checks.number("depth_star", depth_star, above=0, scalar=True)
    most = checks.number("tilt", tilt, "deg", above=0, most=LARGEST_TILT, scalar=True)
    checks.number("tolerance", tolerance, above=0, most=1, scalar=True)
    if isinstance(joint.ball_support, Core) and joint.is_held_all_round:
        edge = force_curve(joint, depth).contact_half_angle_deg[0] + most
        edge += _WALLS * np.degrees(joint.socket_ratio - 1)
        stiff = all(m.poisson <= _LARGEST_POISSON for m in joint.materials.values())
        if stiff and edge <= joint.opening.last and tolerance >= OF_RULE:
            return OffAxis(True, OF_RULE, "rule")
    tilts = np.linspace(0, most, _TILTS + 1)[1:]
    found = tilted_contact(joint, np.full(_TILTS, depth), tilts)
    axial = force_curve(joint, depth).force_star
    off = np.hypot(found.force_star / axial - 1, found.transverse_star / axial)
    error = float((off + found.error_estimate).max())
    return OffAxis(error <= tolerance, error, "measured")
