"""Comparison of the laws with a force-depth curve of the user, from finite elements or a test rig.

`fit_curve` compares every law with the curve. Clearance, composite modulus and an offset of the
depth can be fitted by least squares of the force. The coefficient of a law that has one is always
fitted. The power law does not depend on a joint.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import LAWS, Law, Table
from study.contact.power_fit import DEPTHS, PowerFit, adjusted, determination, fit_power, rmse
from study.joint import Joint
from study.joint.joint import LEAST_R2_STAR
from study.threads import one_thread

Floats = NDArray[np.float64]
Fitted = Literal["clearance", "modulus", "offset"]
NOISE = 0.1
"""Fraction of the maximum force: a larger decrease of the force with depth is not noise."""
RELATIVE_FROM = 0.01
"""Fraction of the maximum force: relative errors are evaluated for larger forces."""
SEARCHED = 1 / 3, 3.0
"""Minimum and maximum clearance of a fit, divided by the given one."""
_SHALLOWEST = 1e-4  # clearances: a curve that ends above has another unit
_STEP, _SINGULAR = 1e-3, 1e-6  # of a derivative, relative; of singular values, least over largest
_AT_ONCE = 200  # points of `fit_power`, whose memory grows with their third power
_EXPONENTS = 0.1, 10.0


@dataclass(frozen=True)
class LawFit:
    """How well a law agrees with the curve.

    Attributes
    ----------
    law
        Key of ``study.contact.LAWS``.
    force
        Force of the law at the depths of the curve, shape (n,).
    rmse, max_error
        Root-mean-square and maximum error, in the unit of the force.
    max_relative_error
        Maximum relative error, where the force is at least 1 % of its maximum.
    determination, determination_adjusted
        R^2 = 1 - SSE/SST, and 1 - (1 - R^2) (n - 1)/(n - p - 1) with p fitted parameters.
    parameters
        Fitted parameters: ``coefficient`` (of the power law in N/m^n, else without unit),
        ``exponent``, ``clearance`` in m, composite ``modulus`` in Pa, and ``offset`` of the depth.
    standard_errors
        Standard errors of the parameters that are fitted by least squares of the force, for
        independent errors of the forces. That of the power law's coefficient is omitted, because
        it depends on that of the exponent.
    """

    law: str
    force: Floats
    rmse: float
    max_error: float
    max_relative_error: float
    determination: float
    determination_adjusted: float
    parameters: dict[str, float]
    standard_errors: dict[str, float]


@dataclass(frozen=True)
class CurveFit:
    """Comparison of all laws with a curve.

    Attributes
    ----------
    depth, force
        The curve in order of depth, shape (n,).
    laws
        Result for each law, in order of the RMSE.
    power
        The power law F = k d^n, with its maximum relative error and its range of depths.
    left_out
        Laws that are not compared, and the reason for each.
    notes
        Sentences on the curve and the fit that the user should know.
    """

    depth: Floats
    force: Floats
    laws: tuple[LawFit, ...]
    power: PowerFit
    left_out: dict[str, str]
    notes: tuple[str, ...]


class TriedPower(NamedTuple):
    """Constants of a power law F = k d^n that a user has, and their errors.

    Attributes
    ----------
    coefficient, exponent
        k in N/m^n, and n.
    depths
        Minimum and maximum depth in m at which the law was compared.
    rms_error, max_error
        RMS and maximum of its relative error, against the elastic solution.
    best
        The constants that fit the elastic solution best over these depths.
    """

    coefficient: float
    exponent: float
    depths: tuple[float, float]
    rms_error: float
    max_error: float
    best: PowerFit


def try_power(
    joint: Joint,
    coefficient: float,
    exponent: float,
    depths: tuple[float, float] | None = None,
) -> TriedPower:
    """Compare constants of a power law F = k d^n with the elastic solution of a joint.

    Parameters
    ----------
    joint
        The joint, with dimensions.
    coefficient, exponent
        k in N/m^n, and n, both > 0.
    depths
        Minimum and maximum depth in m. The default is 0.05 and 0.5 clearances.

    Examples
    --------
    >>> joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
    >>> tried = try_power(joint, 2.3e12, 1.65)
    >>> print(f"{tried.max_error:.1%}, best {tried.best.error:.1%}")
    5.8%, best 1.0%
    """
    checks.number("coefficient", coefficient, above=0, scalar=True)
    checks.number("exponent", exponent, above=0, scalar=True)
    best = joint.power_law(depths)
    places = np.geomspace(*best.depths, DEPTHS)
    deepest = best.depths[1] / joint.clearance
    table = joint.table(deepest if deepest > joint.default_depth else None)
    elastic = joint.force_unit * table(places / joint.clearance)
    errors = coefficient * places**exponent / elastic - 1
    rms = float(np.sqrt(np.mean(errors**2)))
    return TriedPower(coefficient, exponent, best.depths, rms, float(np.abs(errors).max()), best)


@one_thread
def fit_curve(
    depth: ArrayLike,
    force: ArrayLike,
    joint: Joint | None = None,
    fit: Sequence[Fitted] = (),
) -> CurveFit:
    """Compare every law with a force-depth curve, and fit unknown parameters.

    Parameters
    ----------
    depth, force
        Penetration depths in m and forces > 0 in N, shape (n,), in any order, where n is at least 4
        plus the number of fitted parameters. For a joint that was made from ratios they are
        normalised, d/dR and P/(E* dR^2). Noise is allowed.
    joint
        The joint. If it is None, only the power law is fitted.
    fit
        Parameters to fit: ``clearance`` (the search begins at the given one, and the radius of the
        socket is not changed), ``modulus`` (the composite modulus E*) and ``offset`` (the depth
        reading at first touch).

    Raises
    ------
    ValueError
        If there are too few points, or the values cannot be the curve of a joint.

    Examples
    --------
    >>> joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
    >>> depth = np.linspace(1e-6, 20e-6, 20)
    >>> fit_curve(depth, joint.law().force(depth), joint).laws[0].law
    'tabulated'
    """
    for fitted_name in fit:
        checks.choice("fit", fitted_name, get_args(Fitted))
    depths, forces = _checked(depth, force, joint, fit)
    length, modulus, unit = 1.0, 1.0, 1.0
    if joint is not None and joint.has_dimensions:
        length, modulus, unit = joint.clearance, joint.composite_modulus, joint.force_unit
    units = {"clearance": length, "modulus": modulus, "offset": length}

    power, fitted = _power(depths, forces, "offset" in fit)
    found, left_out = [_judged(depths, forces, 1.0, {}, "power", *fitted)], {}
    for name, law in LAWS.items():
        if name == "power":
            continue
        if joint is None:
            left_out[name] = "it requires the description of the joint, which is not given"
            continue
        try:
            fitted = _fit_law(law, joint, depths / length, forces / unit, fit)
            found.append(_judged(depths, forces, unit, units, name, *fitted))
        except checks.RangeError as error:
            left_out[name] = str(error)
    found.sort(key=lambda of: (of.rmse, of.law))
    notes = tuple(_notes(found, forces, fit, joint))
    return CurveFit(depths, forces, tuple(found), power, left_out, notes)


def _checked(depth, force, joint, fit):
    """Depths and forces by depth, as arrays; `ValueError` if they are no curve of the joint."""
    is_star = joint is not None and not joint.has_dimensions
    length, load = ("clearances", "E* dR^2") if is_star else ("m", "N") if joint else ("", "")
    depths = np.asarray(checks.number("depth", depth, length))
    forces = np.asarray(checks.number("force", force, load))
    least = 4 + len(fit)
    if depths.ndim != 1 or depths.shape != forces.shape or len(depths) < least:
        raise ValueError(
            f"depth and force must be lists of the same length >= {least} to fit {least - 2} "
            f"parameters, got shapes {depths.shape} and {forces.shape}; give more points or fit "
            "fewer parameters"
        )
    if "offset" not in fit and (depths < 0).any():
        raise checks.RangeError(
            f"depth must be >= 0, got {depths.min():g}, because the penetration depth is measured "
            "from first touch into the socket; change the sign, or fit the offset of the depth"
        )
    lowest = -NOISE * forces.max() if "offset" in fit else 0
    if (forces < lowest).any() or forces.max() < 0:
        raise checks.RangeError(
            f"force must be >= 0, got {forces.min():g}, because a force that presses the ball into "
            "the socket is positive; change the sign, or, if this is noise before first touch, "
            "remove these points or fit the offset of the depth"
        )
    pressed = forces > 0 if "offset" in fit else (forces > 0) & (depths > 0)
    if np.unique(depths[pressed]).size < 2:
        raise ValueError(
            "force must be > 0 at two or more different depths, but the curve has no such contact"
        )
    order = np.lexsort((forces, depths))
    depths, forces = depths[order], forces[order]
    highest = np.maximum.accumulate(forces)
    falls = highest - forces
    worst = int(falls.argmax())
    if falls[worst] > NOISE * forces.max() or np.corrcoef(depths, forces)[0, 1] <= 0:
        before = int(forces[: worst + 1].argmax())
        raise ValueError(
            f"force must increase with depth, got {forces[before]:g} {load} at "
            f"{depths[before]:g} {length} and then {forces[worst]:g}; give a loading "
            "curve without unloading, and check that the columns are not exchanged"
        )
    if joint is not None:
        largest = np.ptp(depths) if "offset" in fit else depths[-1]
        clearance = 1 if is_star else joint.clearance
        radius, smallest = joint.r2_star * clearance, _SHALLOWEST * clearance
        if not smallest <= largest < radius:
            raise checks.RangeError(
                f"the maximum depth must be >= {smallest:g} {length} ({_SHALLOWEST:g} clearances) "
                f"and < {radius:g} {length}, the radius of the socket, got {largest:g} {length}; "
                "check the unit of the depths"
            )
    if (joint is None or is_star) and set(fit) - {"offset"}:
        raise ValueError(
            f"{' and '.join(sorted(set(fit) - {'offset'}))} can only be fitted to a curve with "
            "units and a joint with dimensions; describe the joint with its dimensions, or do not "
            "fit it"
        )
    return depths, forces


def _notes(found, forces, fit, joint):
    fall = float(np.max(np.maximum.accumulate(forces) - forces) / forces.max())
    if fall > 0:
        yield (
            f"The force decreases with depth by up to {100 * fall:.2g} % of its maximum, which is "
            "treated as noise."
        )
    if "modulus" in fit:
        yield (
            "A law with a fitted coefficient (winkler, hyperbolic_winkler, power) has no "
            "modulus to fit, because the coefficient contains it."
        )
    if joint is not None and all(of.determination < 0.5 for of in found if of.law in _PREDICTED):
        yield (
            "No law without a fitted coefficient is near the curve. Check units, sizes and "
            "materials, or fit the clearance, the modulus or the offset."
        )


_PREDICTED = {name for name, law in LAWS.items() if not law.fitted_constants}


def _judged(depths, forces, unit, units, law, force_star, values, errors):
    """`LawFit` of a law's forces, in a unit, with fitted values and standard errors in theirs."""
    force = unit * force_star
    square = determination(forces, force)
    return LawFit(
        law,
        force,
        rmse(forces, force),
        float(np.abs(force - forces).max()),
        _relative_error(forces, force),
        square,
        adjusted(square, len(forces), len(values)),
        {name: units.get(name, 1) * value for name, value in values.items()},
        {name: units.get(name, 1) * error for name, error in errors.items()},
    )


def _relative_error(forces, prediction):
    counts = forces >= RELATIVE_FROM * forces.max()
    return float(np.abs(prediction[counts] / forces[counts] - 1).max())


def _power(depths, forces, with_offset):
    """The power law: `PowerFit`, and forces, values and standard errors of its fit.

    If the force increases from point to point, the fit is that of a solved joint: the least maximum
    of the relative error. Else there is noise, and it is by least squares.
    """
    unit, most = np.ptp(depths) if with_offset else depths[-1], forces.max()
    touching = (depths > 0) & (forces > 0)
    is_clean = (np.diff(depths[touching]) > 0).all() and (np.diff(forces[touching]) > 0).all()
    if is_clean and not with_offset:
        d, f = depths[touching], forces[touching]
        some = np.unique(np.linspace(0, len(d) - 1, min(len(d), _AT_ONCE)).round().astype(int))
        fit = fit_power(d[some], f[some])
        values = {"coefficient": fit.coefficient, "exponent": fit.exponent}
        return fit, (fit.coefficient * depths**fit.exponent, values, {})

    def model(coefficient, exponent, offset=0.0):
        return coefficient * ((depths - offset) / unit).clip(0) ** exponent

    start = {"coefficient": float(most), "exponent": 1.5}
    if with_offset:
        start["offset"] = _first_touch(depths, forces)
    scales = {"coefficient": float(most), "offset": float(unit)}
    values, errors = _least_squares(model, forces, start, {"exponent": _EXPONENTS}, scales)
    force, offset = model(**values), values.get("offset", 0.0)
    errors = {name: error for name, error in (errors or {}).items() if name != "coefficient"}
    values["coefficient"] = float(values["coefficient"] / unit ** values["exponent"])
    pressed = (depths - offset)[(depths > offset) & (forces > 0)]
    ends = float(pressed.min()), float(pressed.max())
    error = _relative_error(forces, force)
    fit = PowerFit(values["coefficient"], values["exponent"], error, ends)
    return fit, (force, values, errors)


def _first_touch(depths, forces):
    """Depth at which the force begins, as force^(2/3) is a line for Hertz's law."""
    counts = forces > NOISE * forces.max()
    if np.ptp(depths[counts]) == 0:
        return float(depths[0])
    slope, intercept = np.polyfit(depths[counts], forces[counts] ** (2 / 3), 1)
    return float(-intercept / slope) if slope > 0 else float(depths[0])


def _fit_law(law, joint, depth_star, force_star, fit):
    """Forces of a law at depths, without dimensions, and its fitted values and standard errors."""
    own = bool(law.fitted_constants)
    kept = ["offset"]
    if not own:
        kept = list(get_args(Fitted))
    elif law().exponent_of_depth is None:  # that of k d^n contains the clearance too
        kept.append("clearance")
    names = [name for name in fit if name in kept]
    at = _evaluation(law, joint)
    start = dict.fromkeys(names, 1.0)
    if "offset" in names:
        start["offset"] = _first_touch(depth_star, force_star)
    if not start and not own:
        return at(depth_star), {}, {}
    numbers = {"coefficient": 1.0} if own else {}
    shape = at(depth_star, offset=start.get("offset", 0.0), clip=True, **numbers)
    if own:
        start["coefficient"] = float(shape @ force_star / (shape @ shape))
    least = max(law.least_r2_star, LEAST_R2_STAR)
    most = min(SEARCHED[1], joint.r2_star / least * (1 - 1e-6))
    bounds = {"clearance": (SEARCHED[0], most)}
    if "clearance" in start:
        start["clearance"] = min(1.0, most)
    scales = {"offset": float(np.ptp(depth_star)), "coefficient": start.get("coefficient", 1.0)}
    values, errors = _least_squares(
        partial(at, depth_star, clip=True), force_star, start, bounds, scales
    )
    if errors is None:
        raise checks.RangeError(
            "clearance and modulus cannot both be identified, because different pairs give the "
            "same force of this law; fit only one of them"
        )
    return at(depth_star, **values), values, errors


def _evaluation(law: type[Law], joint: Joint) -> Callable[..., Floats]:
    """Function of depths and of the fitted quantities: a law's force in E* dR^2 as given."""
    table = lru_cache(maxsize=64)(lambda other, deepest: Table.of_curve(other.curve(deepest)))

    def force(
        depth_star: Floats,
        clearance: float = 1.0,
        modulus: float = 1.0,
        offset: float = 0.0,
        clip: bool = False,
        **numbers: Any,
    ) -> Floats:
        other = joint if clearance == 1 else replace(joint, clearance=clearance * joint.clearance)
        depth = (depth_star - offset) / clearance
        if law is Table:  # checked tables would take several times as long
            deepest = float(depth.max())
            found: Law = table(other, deepest if deepest > 1 else None)
        else:
            found = law(**numbers) if numbers else law.of(other)
        if clip and found.deepest is not None:  # while a fit searches
            depth = np.minimum(depth, found.deepest)
        return modulus * clearance**2 * found(depth, other.r2_star)

    return force


def _least_squares(model, forces, start, bounds, scales):
    """Fitted values and their standard errors by name; None for these if values are degenerate."""
    from scipy.optimize import least_squares

    names, most = list(start), np.abs(forces).max()
    scale = np.array([scales.get(name, 1.0) for name in names])
    low, high = np.array([bounds.get(name, (-np.inf, np.inf)) for name in names]).T / scale
    found = least_squares(
        lambda x: (model(**dict(zip(names, scale * x, strict=True))) - forces) / most,
        np.array([start[name] for name in names]) / scale,
        jac="3-point",
        bounds=(low, high),
        diff_step=_STEP,
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
    )
    values = dict(zip(names, (scale * found.x).tolist(), strict=True))
    norms = np.linalg.norm(found.jac, axis=0)
    if not norms.all() or np.linalg.cond(found.jac / norms) > 1 / _SINGULAR:
        return values, None
    for name, at_bound in zip(names, found.active_mask, strict=True):
        if at_bound:
            raise checks.RangeError(
                f"its best {name} is outside the search range, which is "
                f"{bounds[name][0]:.3g} to {bounds[name][1]:.3g} times the given one"
            )
    covariance = np.linalg.inv(found.jac.T @ found.jac) * 2 * found.cost
    errors = scale * np.sqrt(np.diag(covariance) / (len(forces) - len(names)))
    return values, dict(zip(names, errors.tolist(), strict=True))
