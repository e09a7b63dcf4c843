"""Coefficients of laws from force-depth curves, by least squares.

As in the paper, there is one coefficient f1 for each case, and then a surrogate of f1 over R2*. The
surrogate is a straight line, because P* -> R2* F(ds) as R2* grows. Its intercept is the next order
in 1/R2*.
"""

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from study.contact import HyperbolicWinkler, Law, Winkler, shapes
from study.contact.laws import AREA_COEFFICIENTS
from study.contact.power_fit import USUAL_RANGE, fit_power
from study.dataset.store import PAPER_KINEMATICS, R2_STAR

FITTED_LAWS: dict[str, Law] = {
    name: HyperbolicWinkler(1.0, area) for area, name in AREA_COEFFICIENTS.items()
} | {"winkler": Winkler(1.0)}
"""Name of the coefficients -> law with the coefficient 1."""
LARGEST_DEPTH = 0.5  # maximum depth of the fit, in clearances, as in the paper
SAMPLE = np.linspace(0, LARGEST_DEPTH, 21)
"""Depths at which the paper evaluates its measures of agreement (inferred, notebook 13)."""
LARGEST_R2_STAR = 300  # of the surrogate's fit, as in the paper


def coefficient(law: str, depth_star: ArrayLike, force_star: ArrayLike) -> float:
    """Coefficient f1 that minimises the sum of (P* - f1 f2(ds))^2 over one case's curve.

    ``law`` is a key of `FITTED_LAWS`; depths and forces have the shape (n,), with a depth > 0.
    """
    f2 = shape(law, depth_star)
    return float(f2 @ np.asarray(force_star) / (f2 @ f2))


def shape(law: str, depth_star: ArrayLike) -> NDArray[np.float64]:
    """Function f2 of a law: its force with the coefficient 1."""
    return FITTED_LAWS[law](depth_star, 2.0)


def sampled(curve: pd.DataFrame) -> NDArray[np.float64]:
    """Forces of one case of the dataset at the depths of `SAMPLE`, 0 at depth 0; shape (21,)."""
    return np.append(0, curve.force_star[curve.depth_star <= LARGEST_DEPTH])


def coefficients_by_case(law: str, curves: pd.DataFrame) -> pd.DataFrame:
    """Coefficient ``f1`` of every case of one set-up, by ``r2_star``, to a depth of 0.5.

    ``law`` is a key of `FITTED_LAWS`; curves are rows of `study.dataset.load`.
    """
    inside = curves[curves.depth_star <= LARGEST_DEPTH]
    rows = [
        (r2_star, coefficient(law, case.depth_star, case.force_star))
        for r2_star, case in inside.groupby("r2_star")
    ]
    return pd.DataFrame(rows, columns=["r2_star", "f1"])


def surrogate(r2_star: ArrayLike, f1: ArrayLike) -> dict[str, float]:
    """``slope`` and ``intercept`` of the line f1 = slope R2* + intercept, by least squares."""
    slope, intercept = np.polyfit(np.asarray(r2_star), np.asarray(f1), 1)
    return {"slope": _rounded(slope), "intercept": _rounded(intercept)}


def _rounded(value):
    return float(f"{value:.7g}")


def _power(curves):
    """Fit of the power law: its exponent at the R2* of Table 2, and the line of its coefficient."""
    least, most = USUAL_RANGE
    inside = curves[curves.depth_star.between(least - 1e-9, most + 1e-9)]
    cases = {r2_star: (c.depth_star, c.force_star) for r2_star, c in inside.groupby("r2_star")}
    exponent = _rounded(fit_power(*cases[R2_STAR]).exponent)
    factors = [fit_power(*case, exponent).coefficient for case in cases.values()]
    return surrogate(list(cases), factors) | {"exponent": exponent}


def liu_coefficient(
    force_star: ArrayLike, published_determination: float, unit: ArrayLike
) -> float:
    """Coefficient c of Liu's law, P* = c R2* (...), from its row in Table 2 of the paper.

    The published coefficient of determination, which is negative, depends only on the mean
    difference of law and finite elements (`study.claims.statistics.kappa_as_printed`). The force of
    Liu's law is the smaller one. ``force_star`` has the elastic forces at `SAMPLE`, for the R2* of
    Table 2; ``unit`` is the force of the law over c R2*, at the same depths without 0, shape (20,).
    """
    force = np.asarray(force_star)
    missing = np.sqrt((1 - published_determination) * np.sum((force - force.mean()) ** 2))
    return float((force.sum() - missing) / (R2_STAR * np.sum(unit)))


def fit_laws(curves: pd.DataFrame, published: pd.DataFrame) -> dict[str, dict[str, float]]:
    """Content of ``coefficients.json``: laws fitted to the reference joint for 20 <= R2* <= 300.

    ``curves`` are those of the dataset. ``published`` is ``data/published/tables.csv``, from which
    Liu's law is reconstructed.
    """
    curves = curves[(curves.group == "paper") & (curves.kinematics == PAPER_KINEMATICS)]
    stated = published.set_index(["where", "row", "quantity"]).value
    liu_determination = -stated["Table 2", "liu", "determination"]  # published without its sign
    fits = {}
    for law in FITTED_LAWS:
        cases = coefficients_by_case(law, curves[curves.r2_star <= LARGEST_R2_STAR])
        fits[law] = surrogate(cases.r2_star, cases.f1)
    force, (unit, _) = sampled(curves[curves.r2_star == R2_STAR]), shapes.liu(SAMPLE[1:], ())
    slope = liu_coefficient(force, liu_determination, unit)
    fits["liu"] = {"slope": _rounded(slope), "intercept": 0.0}
    return fits | {"power": _power(curves[curves.r2_star <= LARGEST_R2_STAR])}
