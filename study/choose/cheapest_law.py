"""The cheapest law that is accurate enough for a joint, with the evidence.

A law's error is the largest relative error of its force over all depths from `SHALLOWEST`
clearances to the scene's largest, against the solved joint. Bodies are elastic there: from which
depth on they yield, `study.joint.first_yield` says. Its bound includes 3 times the error estimate
of that solution. Where no closed law is within the tolerance, it is the table of the coarsest
solution that is. Costs are those of `study.contact.costs`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import LAWS, hertz, largest_depth, tabulated
from study.contact.costs import relative_costs
from study.joint import Joint, UnresolvedError, force_curve, whole_curve
from study.joint.compliance import RESOLUTION
from study.joint.curve import ForceCurve
from study.joint.dimensional import usual_depth
from study.joint.law_parameters import law_parameters
from study.joint.nested_contact import LEAST_R2_STAR
from study.threads import one_thread

SHALLOWEST = 0.005
"""Least depth_star of the error: below, the force is less than 1/1000 of that at 0.5."""
ESTIMATE = 3.0  # times a solution's error estimate, for depths between those solved
RESOLUTIONS = {"series": (64, 160, 320, 640, 1280), "quadratic": (64, 160), "finite": (32, 64, 96)}
DEPTHS = 40  # of a law's error
SOLVED_FIRST = 1.25
"""Factor on the cost of a table, as its joint is solved first, and measured costs are noisy: those
of a table and of ``stiffened_hertz`` differed by 1 to 13 % from run to run."""
FINITE_DEPTHS = (
    13  # solved with large displacements, a second each; odd: first and last are in a table
)
DEEPER = (1, 4, 12)
"""Factors of a depth: laws are compared up to the least of these depths that elements resolve. The
range begins at a twelfth of its end at most, so that the depth itself is within it."""
TOLERANCES = (1e-5, 1.0)
"""Least and largest. The finest solution is not known to within 1e-5, and it takes a minute to find
this out."""


@dataclass(frozen=True)
class Choice:
    """A law for a joint, with the evidence.

    Attributes
    ----------
    law
        Key of ``study.contact.LAWS``; ``tabulated``, the table of a solved curve; or
        ``solver``, the solution itself at every call.
    options
        Of the law; for ``tabulated`` and ``solver`` the resolution of the solution.
    error_bound
        No relative error of the force is larger at any of the `depths`.
    relative_cost
        Time of a call in a compiled loop over that of Hertz's law, without the time to solve the
        joint once for ``tabulated``.
    depths
        Least and largest depth_star for which the bound holds.
    rejected
        Laws that cost less and whose bound misses the tolerance, the most expensive first:
        ``law``, ``options``, ``error``, ``error_bound``, ``relative_cost``.
    errors
        Every closed law that is for the joint -> its largest relative error.
    evaluate
        The law, of (``depth_star``, ``r2_star``); None for ``solver``. Its bound is known between
        ``depths`` only.
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
    depth_star
        Largest depth of the scene, in clearances.
    tolerance
        Largest relative error of the force, from 1e-5 to 1.

    Raises
    ------
    ValueError
        For a value outside its range, or a depth that the joint cannot have.
    study.checks.StudyError
        If even the finest solution is not known to be within the tolerance; says its bound.
    """
    deepest = checks.number("depth_star", depth_star, above=0, scalar=True)
    checks.number("tolerance", tolerance, least=TOLERANCES[0], most=TOLERANCES[1], scalar=True)
    widest = largest_depth(joint.r2_star)
    checks.number("depth_star", deepest, below=widest / 1.05)  # room to estimate errors beside it
    least = min(SHALLOWEST, deepest / 12)
    depths = np.linspace(np.sqrt(least), np.sqrt(deepest), DEPTHS) ** 2
    force, uncertainty = _exact(joint, depths)
    largest = {law: float(error.max()) for law, error in law_errors(joint, depths, force).items()}
    rejected = []
    for candidate in _candidates(joint, depths, force, uncertainty, largest):
        if candidate["error_bound"] <= tolerance:
            break
        rejected.append({name: candidate[name] for name in candidate if name != "evaluate"})
    else:
        raise checks.StudyError(
            f"no law is known to be within the tolerance {tolerance:g}: the finest solution, of "
            f"resolution {candidate['options']['resolution']}, is known to within "
            f"{candidate['error_bound']:.2g}"
        )
    del candidate["error"]
    return Choice(
        **candidate,
        depths=(float(least), deepest),
        rejected=tuple(reversed(rejected)),
        errors=largest,
    )


def choose_beside(joint: Joint, depth_star: float, tolerance: float) -> Choice:
    """`choose` up to a depth, or up to a deeper one if that contact is too small for elements.

    Raises the errors of `choose`. For a contact that is far too small, `study.checks.RangeError`
    says within what Hertz's law holds there.
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
    known = "" if error is None else f": there Hertz's law holds within {100 * error:.2g} %"
    raise checks.RangeError(f"the contact is too small for laws to be compared{known}")


def _candidates(joint, depths, force, uncertainty, largest):
    """Closed laws and tables by their cost, tables from the coarsest on; the solution is last."""
    costs, resolutions = relative_costs(), RESOLUTIONS[_kind(joint)]

    def candidate(law, options, error, bound, evaluate):
        values = {"law": law, "options": options, "error": error, "error_bound": bound}
        return values | {"relative_cost": costs[law], "evaluate": evaluate}

    ahead = costs | {"tabulated": SOLVED_FIRST * costs["tabulated"]}
    for law in sorted([*largest, "tabulated"], key=ahead.__getitem__):
        if law != "tabulated":
            options = law_parameters(LAWS[law], joint, depths, force)
            bound = _bounded(largest[law], uncertainty)
            yield candidate(law, options, largest[law], bound, partial(LAWS[law], **options))
            continue
        for resolution, curve, error in _solutions(joint, depths, resolutions):
            # every second depth is left out of the table, and shows its error of interpolation
            in_table = np.arange(len(curve.depth_star)) % 2 == (len(curve.depth_star) - 1) % 2
            table = tabulated(_some(curve, in_table))
            left_out = _some(curve, ~in_table & (curve.depth_star >= depths[0]))
            between = float(np.abs(table(left_out.depth_star) / left_out.force_star - 1).max())
            off = float(np.abs(table(depths) / force - 1).max())
            bound = _bounded(max(ESTIMATE * error, off), between)
            yield candidate(law, {"resolution": resolution}, error, bound, table)
    error = float(force_curve(joint, depths[::4], resolutions[-1]).error_estimate.max())
    yield candidate("solver", {"resolution": resolutions[-1]}, error, ESTIMATE * error, None)


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
                    f"depth_star must be >= {curve.depth_star[0]:.3g} for elements of this size to "
                    f"resolve the contact, got {depths[0]:.3g}"
                )
        except UnresolvedError:
            if resolution == resolutions[-1]:
                raise
            continue  # a finer one may
        error = curve.error_estimate[curve.depth_star >= depths[0]].max()
        yield resolution, curve, float(error)


def _some(curve: ForceCurve, chosen: NDArray[np.bool_]) -> ForceCurve:
    """A curve at some of its depths."""
    names = ("depth_star", "force_star", "error_estimate")
    return replace(curve, **{name: getattr(curve, name)[chosen] for name in names})


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
    """Relative errors, against exact forces, of every law whose cost is known.

    Laws whose formula or fit is not for the joint are left out. ``power`` is fitted to the depths.
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
    """Which of `RESOLUTIONS` a joint is solved with."""
    if joint.has_large_displacements:
        return "finite"
    return "series" if joint.series_applies else "quadratic"
