"""The cheapest law that is accurate enough for a joint, and how one knows.

A law's error is the largest relative error of its force over all depths from `SHALLOWEST`
clearances to the scene's largest. Inside the range of the dataset's group ``fit`` the exact
force is interpolated from it; outside, or for other supports and unequal materials, the joint
is solved. Costs are those of ``data/published/peers.csv``. The choice of a whole mechanism's
model is in `study.choose.model`.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import RegularGridInterpolator

from study import checks, dataset
from study.contact import LAWS, hertz, largest_depth, tabulated
from study.joint import Joint, UnresolvedError, first_yield, force_curve
from study.threads import one_thread

SHALLOWEST = 0.005
"""Least depth_star of the error: below, the force is less than 1/1000 of that at 0.5."""
INTERPOLATION = 5e-4
"""Largest relative error of `stiffening`: twice that on the dataset's group ``judge``."""
ESTIMATE = 1.5  # times a solution's error estimate, for depths between those solved
RESOLUTIONS = {"series": (64, 160, 320, 640, 1280), "quadratic": (64, 160), "finite": (32, 64, 96)}
DEPTHS = {"series": 40, "quadratic": 40, "finite": 12}  # `finite` takes a second for each
TOLERANCES = (1e-5, 1.0)
"""Least and largest. No solution at the finest resolution is known to within 1e-5; to find that
out for a joint takes a minute."""


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
        Time of a call in a compiled loop over that of Hertz's law. The time to solve the joint
        once, for ``tabulated``, is not in it.
    depths
        Least and largest depth_star that the bound holds for.
    source
        ``dataset`` or ``solver``: where the exact force comes from.
    note
        Why the joint had to be solved; empty where the dataset sufficed.
    rejected
        Laws that cost less and whose bound misses the tolerance, the most expensive first:
        ``law``, ``options``, ``error``, ``error_bound``, ``relative_cost``.
    errors
        Every closed law that the joint can have -> largest relative error found.
    first_yield
        `study.joint.FirstYield` by its names, if materials have a yield stress and the joint yields
        within the depths. Beyond it, errors and bounds are those of joints that do not yield.
    evaluate
        The law, of (``depth_star``, ``r2_star``); None for ``solver``. It is known to be good
        enough between ``depths`` only.
    """

    law: str
    options: dict
    error_bound: float
    relative_cost: float
    depths: tuple[float, float]
    source: str
    note: str
    rejected: tuple[dict, ...]
    errors: dict[str, float]
    first_yield: dict[str, object] | None
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
        If not even the finest solution is known to be within the tolerance; says what is.
    """
    checks.instance("joint", joint, Joint)
    deepest = checks.number("depth_star", depth_star, above=0, scalar=True)
    checks.number("tolerance", tolerance, least=TOLERANCES[0], most=TOLERANCES[1], scalar=True)
    widest = largest_depth(joint.r2_star)
    checks.number("depth_star", deepest, below=widest / 1.05)  # room to estimate errors beside it
    note = outside(joint, deepest)
    least = min(SHALLOWEST, deepest / 12) if note else SHALLOWEST
    depths = _depths(least, deepest, DEPTHS[_kind(joint)])
    force, uncertainty = _exact(joint, depths, note)
    found = {law: float(error.max()) for law, error in errors(joint, depths, force).items()}
    names, rejected = ("law", "options", "error", "error_bound", "relative_cost", "evaluate"), []
    for values in _candidates(joint, deepest, found, float(uncertainty.max())):
        candidate = dict(zip(names, values, strict=True))
        if candidate["error_bound"] <= tolerance:
            break
        rejected.append({name: candidate[name] for name in names if name != "evaluate"})
    else:
        raise checks.StudyError(
            f"no model is known to be within the tolerance {tolerance:g}: the finest solution, of "
            f"resolution {candidate['options']['resolution']}, is known to "
            f"{candidate['error_bound']:.2g}"
        )
    del candidate["error"]
    strong = any(material.yield_stress for material in joint.materials.values())
    first = first_yield(joint, deepest) if strong else None
    return Choice(
        **candidate,
        depths=(float(least), deepest),
        source="solver" if note or candidate["law"] in ("tabulated", "solver") else "dataset",
        note=note,
        rejected=tuple(reversed(rejected)),
        errors=found,
        first_yield=vars(first) if first else None,
    )


def _candidates(joint, deepest, found, uncertainty):
    """Closed laws and tables by their cost, tables from the coarsest on; the solution is last.

    Each is its law, options, error, bound, cost and function. Every second depth of a solution
    is left out of its table, and tells how this interpolates.
    """
    costs, kind, least = relative_costs(), _kind(joint), min(SHALLOWEST, deepest / 12)
    finest = RESOLUTIONS[kind][-1]
    for law in sorted([*found, "tabulated"], key=costs.__getitem__):
        if law != "tabulated":
            options, bound = law_options(law, joint), _bounded(found[law], uncertainty)
            yield law, options, found[law], bound, costs[law], partial(LAWS[law], **options)
            continue
        depths = _depths(least, deepest, 2 * DEPTHS[kind] - 1)
        for resolution in RESOLUTIONS[kind]:
            try:
                curve = force_curve(joint, depths, resolution)
            except UnresolvedError:  # at the least depth
                if resolution == finest:
                    raise
                continue
            names = ("depth_star", "force_star", "error_estimate")
            table = tabulated(replace(curve, **{name: getattr(curve, name)[::2] for name in names}))
            between = float(np.abs(table(depths) / curve.force_star - 1).max())
            error = float(curve.error_estimate.max())
            bound = _bounded(ESTIMATE * error, between)
            yield law, {"resolution": resolution}, error, bound, costs[law], table
    curve = force_curve(joint, _depths(least, deepest, DEPTHS[kind]), finest)
    error = float(curve.error_estimate.max())
    yield "solver", {"resolution": finest}, error, ESTIMATE * error, costs["solver"], None


def _exact(joint, depths, note, resolution=None):
    """Exact forces, solved if there is a ``note`` and else from the dataset, and how sure."""
    if not note:
        force = hertz(depths, joint.r2_star) * stiffening(joint, depths)
        return force, np.full(len(depths), INTERPOLATION)
    curve = force_curve(joint, depths, resolution)
    return curve.force_star, ESTIMATE * curve.error_estimate + INTERPOLATION


def _bounded(error, uncertainty):
    """Bound of a relative error that was found against a force of some uncertainty."""
    return error * (1 + uncertainty) + uncertainty


def outside(joint: Joint, depth_star: float) -> str:
    """Why the dataset's group ``fit`` does not hold a joint and a depth, or an empty text."""
    for name, usual in (("kinematics", "linear"), ("ball_drive", "plane"), ("rim", "mirror")):
        if getattr(joint, name) != usual:
            return f"{name} {getattr(joint, name)} is outside the dataset, which has {usual}"
    if joint.layers:
        return "a socket of layers is outside the dataset"
    if joint.ball != joint.socket:
        return "unequal materials are outside the dataset"
    places = (joint.r2_star, joint.socket_ratio, joint.ball.poisson, depth_star)
    names = ("R2*", "socket ratio", "Poisson's ratio", "depth_star")
    for name, value, axis in zip(names, places, _grid()[0], strict=True):
        if not axis[0] <= value <= axis[-1]:
            return f"{name} {value:g} is outside the dataset, {axis[0]:g} to {axis[-1]:g}"
    return ""


def stiffening(joint: Joint, depth_star: ArrayLike) -> NDArray[np.float64]:
    """Exact force over Hertz's, interpolated from the dataset, for what is not `outside`.

    Cubic in 1/R2*, ln(q - 1), 1/(1 - 1.8 nu) and sqrt(ds), q the socket ratio and nu Poisson's
    ratio, in which the values are smooth.
    """
    place = _straight(joint.r2_star, joint.socket_ratio, joint.ball.poisson, 0.0)[:3]
    roots = np.sqrt(np.atleast_1d(depth_star))
    return _grid()[1](np.column_stack([np.tile(place, (len(roots), 1)), roots]))


def errors(
    joint: Joint, depth_star: ArrayLike, force_star: ArrayLike
) -> dict[str, NDArray[np.float64]]:
    """Relative errors, against exact forces, of every law whose cost is known.

    Left out are those whose formula or fit does not hold the joint.
    """
    found: dict[str, NDArray[np.float64]] = {}
    for law in filter(relative_costs().__contains__, LAWS):
        try:
            force = LAWS[law](depth_star, joint.r2_star, **law_options(law, joint))
        except checks.RangeError:
            continue
        found[law] = np.abs(force / force_star - 1)
    return found


@one_thread
def cheapest(
    joints: Iterable[Joint],
    depth_star: ArrayLike,
    tolerances: Iterable[float],
    resolution: int | None = None,
) -> pd.DataFrame:
    """Cheapest adequate law over joints and largest depths, as `choose` would find it.

    ``tabulated`` stands where no closed law is adequate.

    Parameters
    ----------
    depth_star
        Rising, from `SHALLOWEST`.
    resolution
        Of the solution of joints that the dataset does not hold.
    """
    costs, rows = relative_costs(), []
    depths = np.asarray(depth_star)
    for joint in joints:
        place = joint.r2_star, joint.socket_ratio, joint.ball.poisson
        force, uncertainty = _exact(joint, depths, outside(joint, depths[-1]), resolution)
        largest = {
            law: _bounded(np.maximum.accumulate(error), np.maximum.accumulate(uncertainty))
            for law, error in errors(joint, depths, force).items()
        }
        ranked = sorted(largest, key=costs.__getitem__)
        for tolerance in tolerances:
            for n, ds in enumerate(depths):
                able = (law for law in ranked if largest[law][n] <= tolerance)
                rows.append((*place, float(ds), tolerance, next(able, "tabulated")))
    columns = ["r2_star", "socket_ratio", "poisson", "depth_star", "tolerance", "law"]
    return pd.DataFrame(rows, columns=columns)


def law_options(law: str, joint: Joint) -> dict[str, object]:
    """Options with which a law knows of the joint what it can; `RangeError` if it cannot.

    ``stiffened_hertz`` is for a radially free ball: of supports it knows nothing, and what they
    cost it in the joint at hand is part of its error.
    """
    if law != "stiffened_hertz":
        return {}
    if joint.ball != joint.socket or joint.layers:
        raise checks.RangeError("materials of ball and socket must be equal for stiffened_hertz")
    return {
        "socket_ratio": joint.socket_ratio,
        "poisson": joint.ball.poisson,
        "kinematics": joint.kinematics,
    }


def relative_costs() -> dict[str, float]:
    """Law -> time of a call in a compiled loop over that of Hertz's, as measured.

    A law that `study measure` has not yet timed is not among them, and not chosen.
    """
    rows = dataset.measured("laws")
    costs = dict(zip(rows["method"], rows["relative"].astype(float), strict=True))
    for law in ("hertz", "tabulated", "solver"):
        if law not in costs:
            raise dataset.DatasetError(
                f"data/published/peers.csv lacks {law}; mend it with: git checkout -- data"
            )
    return costs


def _kind(joint):
    """Which of `RESOLUTIONS` a joint is solved with."""
    if joint.kinematics == "finite":
        return "finite"
    return "series" if joint.series_applies else "quadratic"


def _depths(least, deepest, count):
    """Depths in equal steps of their square root."""
    return np.linspace(np.sqrt(least), np.sqrt(deepest), count) ** 2


def _straight(r2_star, socket_ratio, poisson, depth_star):
    """Coordinates in which the stiffening is smooth."""
    return 1 / r2_star, np.log(socket_ratio - 1), 1 / (1 - 1.8 * poisson), np.sqrt(depth_star)


@lru_cache(maxsize=1)
def _grid():
    """Axes of the dataset's group ``fit``, and the interpolator over them."""
    keys = ["r2_star", "socket_ratio", "poisson_ball", "depth_star"]
    rows = dataset.load(group="fit", kinematics="linear").sort_values(keys)
    axes = [np.sort(rows[key].unique()) for key in keys]
    values = rows["force_star"].to_numpy() / hertz(rows["depth_star"], rows["r2_star"])
    values = values.reshape([len(axis) for axis in axes])
    points = [np.asarray(axis) for axis in _straight(*axes)]
    points[0], values = points[0][::-1], values[::-1]  # 1/R2* falls as R2* grows
    return axes, RegularGridInterpolator(
        points, values, method="cubic", bounds_error=False, fill_value=None
    )  # the edges are met up to rounding; `outside` keeps out what is beyond
