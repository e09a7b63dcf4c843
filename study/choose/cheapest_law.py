"""The cheapest law that is accurate enough for a joint, with the evidence.

The error of a law is the maximum relative error of its force, relative to the elastic solution of
the joint, over all depths from `SHALLOWEST` clearances to a maximum depth. Its bound includes 3
times the error estimate of that solution. If no closed-form law is within the tolerance, a table of
the elastic solution is chosen. Costs are those of `relative_costs`.

A law for the axial direction is also accurate up to some tilt, which `axial_law_suffices` finds by
solving the joint at three tilts.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import json
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import CLOSED_FORM, LAWS, Hertz, Law, largest_depth
from study.joint import Joint, UnresolvedError, axial
from study.joint.tilted import LARGEST_TILT
from study.threads import one_thread

SHALLOWEST = 0.005
"""Minimum depth_star of the error: below it, the force is less than 1/1000 of that at 0.5."""
ESTIMATE = 3.0  # times a solution's error estimate, for depths between those solved
RESOLUTIONS = {"series": (320, 640, 1280), "quadratic": (160,)}
"""Resolutions of tables, the default first, which `study export` has."""
DEPTHS = 40  # of a law's error
SOLVED_FIRST = 1.25
"""Factor on the cost of a table, because its joint has to be solved first, and because measured
costs are noisy: the costs of a table and of ``stiffened_hertz`` differed by 1 to 13 % from run to
run."""
DEEPER = (1, 4, 12)
"""Factors on a depth: laws are compared up to the smallest of these depths that elements resolve.
The range begins at or below a twelfth of its end, so that the depth itself is within it."""
TOLERANCES = (1e-5, 1.0)
"""Minimum and maximum tolerance. The finest solution is not known to be within 1e-5, and it takes a
minute to find this out."""
TILTS = 3  # equally spaced up to the maximum, at which a law for the axial direction is tested


def relative_costs() -> dict[str, float]:
    """Law -> time of a call in a compiled loop over that of Hertz's law, as last measured.

    ``tabulated`` and ``solver`` are included. A law that has not been timed is missing, and
    `choose` does not choose it.
    """
    return json.loads(Path(__file__).with_name("relative_costs.json").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Choice:
    """The chosen law for a joint, with the evidence.

    Attributes
    ----------
    law
        The law of the joint; ``law.name`` is a key of `study.contact.LAWS`.
    error_bound
        Bound of the relative error of the force between the `depths`.
    relative_cost
        Computing time of a call in a compiled loop relative to that of Hertz's law, without the
        time to solve the joint once for ``tabulated``.
    depths
        Minimum and maximum depth_star for which the bound is valid.
    rejected
        Cheaper laws whose bound exceeds the tolerance, the most expensive first: ``law`` (its
        name), ``error``, ``error_bound``, ``relative_cost``.
    errors
        Maximum relative error of every closed-form law that applies to the joint, by its name.
    """

    law: Law
    error_bound: float
    relative_cost: float
    depths: tuple[float, float]
    rejected: tuple[dict, ...]
    errors: dict[str, float]


@one_thread
def choose(joint: Joint, depth_star: float, tolerance: float) -> Choice:
    """Cheapest law whose force is known to be within a tolerance.

    Parameters
    ----------
    joint
        The joint.
    depth_star
        Maximum normalised penetration depth d/dR.
    tolerance
        Maximum relative error of the force, from 1e-5 to 1.

    Raises
    ------
    ValueError
        If a value is outside its range, or the contact cannot be so deep.
    study.checks.StudyError
        If the error of even the finest table of the elastic solution may exceed the tolerance.

    Examples
    --------
    >>> joint = Joint.from_ratios(r2_star=75, socket_ratio=1.4)
    >>> choice = choose(joint, depth_star=0.5, tolerance=0.02)
    >>> choice.law.name, choice.error_bound < 0.002
    ('stiffened_hertz', True)
    """
    deepest = checks.number("depth_star", depth_star, above=0, scalar=True)
    checks.number("tolerance", tolerance, least=TOLERANCES[0], most=TOLERANCES[1], scalar=True)
    # errors are estimated at depths up to 1.05 times this one
    checks.number("depth_star", deepest, below=largest_depth(joint.r2_star) / 1.05)
    least = min(SHALLOWEST, deepest / 12)
    depths = np.linspace(np.sqrt(least), np.sqrt(deepest), DEPTHS) ** 2
    tables = _tables(joint, depths)
    first = next(tables)
    solved, _, uncertainty = first
    force = solved(depths)
    errors = {law: float(off.max()) for law, off in law_errors(joint, depths, force).items()}
    rejected: list[dict] = []
    costs = relative_costs()
    ahead = costs | {"tabulated": SOLVED_FIRST * costs["tabulated"]}
    for name in sorted([*errors, "tabulated"], key=ahead.__getitem__):
        candidates: Iterable[Any] = chain([first], tables)
        if name != "tabulated":
            error = errors[name]
            bound = error * (1 + uncertainty) + uncertainty
            candidates = [(LAWS[name].fit(joint, depths, force), error, bound)]
        for law, error, bound in candidates:
            if bound <= tolerance:
                ends, cheaper = (float(least), deepest), tuple(reversed(rejected))
                return Choice(law, bound, costs[name], ends, cheaper, errors)
            row = {"law": name, "error": error, "error_bound": bound}
            rejected.append(row | {"relative_cost": costs[name]})
    row = min(rejected, key=lambda row: row["error_bound"])
    raise checks.StudyError(
        f"no law is known to be within the tolerance {tolerance:g}: the minimum error bound is "
        f"{row['error_bound']:.2g}, that of {row['law']}; give a larger tolerance"
    )


def _tables(joint, depths):
    """Tables of the elastic solution, with estimated errors and bounds of their errors."""
    deepest, (kind, _) = float(depths[-1]), axial.settings(joint, None, None)
    for resolution in RESOLUTIONS[kind]:
        try:
            law = joint.table(deepest, resolution=resolution)
        except UnresolvedError:  # a finer one may
            if resolution == RESOLUTIONS[kind][-1]:
                raise
            continue
        error = float(law.curve.error_estimate[law.curve.depth_star >= depths[0]].max())
        bound = max(ESTIMATE * error, error + law.error)
        yield law, error, bound


def choose_beside(joint: Joint, depth_star: float, tolerance: float) -> Choice:
    """`choose` up to a depth, or up to a larger one if that contact is too small for elements.

    Raises the errors of `choose`. For a contact that is much too small, the message of
    `study.checks.RangeError` states the error of Hertz's law there.
    """
    is_small = max(DEEPER) * depth_star <= 1
    for deeper in DEEPER if is_small else (1,):
        try:
            return choose(joint, deeper * depth_star, tolerance)
        except checks.RangeError:
            if not is_small:
                raise
    force = Hertz()(depth_star, joint.r2_star)  # stiffened_hertz begins as this law
    error = law_errors(joint, depth_star, force).get("stiffened_hertz")
    known = "" if error is None else f"; there Hertz's law is valid within {100 * error:.2g} %"
    raise checks.RangeError(
        f"the contact at a depth of {depth_star:.3g} clearances is too small to compare laws{known}"
    )


def law_errors(
    joint: Joint, depth_star: ArrayLike, force_star: ArrayLike
) -> dict[str, NDArray[np.float64]]:
    """Errors, relative to given forces, of every law with a known cost.

    Laws that do not apply to the joint are left out. ``power`` is fitted to the forces.
    """
    by_law: dict[str, NDArray[np.float64]] = {}
    for name in filter(relative_costs().__contains__, CLOSED_FORM):
        law = LAWS[name]
        if len(law.fitted_constants) > 1 and np.size(depth_star) < 2:
            continue  # nothing to fit them to
        try:
            force = law.fit(joint, depth_star, force_star)(depth_star, joint.r2_star)
        except checks.RangeError:
            continue
        by_law[name] = np.abs(force / force_star - 1)
    return by_law


@dataclass(frozen=True)
class OffAxis:
    """Whether one law for the axial direction is within a tolerance for all tilts.

    Attributes
    ----------
    one_law_for_all_directions
        The answer.
    direction_error
        Maximum difference between the force, as a vector, and that along the axis, relative to the
        latter, including the error estimate of the solution.
    force_change, stiffness_change
        Relative differences of the force and of the stiffness along the displacement from those
        along the axis, where their magnitude is largest.
    """

    one_law_for_all_directions: bool
    direction_error: float
    force_change: float
    stiffness_change: float


def axial_law_suffices(joint: Joint, depth_star: float, tilt: float, tolerance: float) -> OffAxis:
    """Whether one law for the axial direction is within a tolerance for all tilts up to a maximum.

    The joint is solved at the maximum depth along the axis and at `TILTS` tilts.

    Parameters
    ----------
    joint
        The joint.
    depth_star
        Maximum normalised penetration depth d/dR.
    tilt
        Maximum angle in deg between displacement and axis, > 0.
    tolerance
        Maximum relative error of the force, > 0 and <= 1.

    Raises
    ------
    ValueError
        If a value is outside its range, or as `study.joint.Joint.solve` does under a tilt.

    Examples
    --------
    >>> hip = Joint.from_ratios(r2_star=100, ball_support="core:0.5", rim="free", socket_ratio=1.2)
    >>> axial_law_suffices(hip, depth_star=0.3, tilt=20, tolerance=0.05).one_law_for_all_directions
    True
    """
    depth = checks.number("depth_star", depth_star, above=0, scalar=True)
    most = checks.number("tilt", tilt, "deg", above=0, most=LARGEST_TILT, scalar=True)
    checks.number("tolerance", tolerance, above=0, most=1, scalar=True)
    axial.settings(joint, None, None)  # refuses a joint that has no axial law
    tilts = np.linspace(0, most, TILTS + 1)[1:]
    tilted = joint.solve(depth_star=np.full(TILTS, depth), tilt=tilts)
    along = joint.solve(depth_star=depth)
    force = tilted.force / along.force - 1
    stiffness = np.divide(tilted.stiffness, along.stiffness) - 1
    off = np.hypot(force, np.divide(tilted.transverse, along.force)) + tilted.error_estimate
    largest = (float(change[np.abs(change).argmax()]) for change in (force, stiffness))
    return OffAxis(bool(off.max() <= tolerance), float(off.max()), *largest)
