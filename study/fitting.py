"""Coefficients of laws from force-depth curves, by least squares.

The paper's two steps: one coefficient f1 per case, then a surrogate of f1 over R2*. The
surrogate is a straight line, because P* -> R2* F(ds) as R2* grows, with an intercept for the
next order in 1/R2*; its coefficients are ours, the paper's are lost.
"""

import numpy as np
import pandas as pd

from study.contact import LAWS

FITTED_LAWS = ("hyperbolic_winkler", "winkler")
LARGEST_DEPTH = 0.5  # of the fit, in dR, as in the paper
LARGEST_R2_STAR = 300  # of the surrogate's fit, as in the paper


def coefficient(law, depth_star, force_star):
    """Coefficient f1 that minimises the sum of (P* - f1 f2(ds))^2 over one curve.

    Parameters
    ----------
    law : {"hyperbolic_winkler", "winkler"}
        Whose f2 to use.
    depth_star, force_star : array_like, shape (n,)
        One case's curve.

    Returns
    -------
    float
    """
    shape = LAWS[law](depth_star, 2.0, coefficient=1.0)
    return float(shape @ np.asarray(force_star) / (shape @ shape))


def coefficients_by_case(law, curves):
    """Coefficient f1 of every case of the dataset.

    Parameters
    ----------
    law : {"hyperbolic_winkler", "winkler"}
    curves : pandas.DataFrame
        Rows of `study.dataset.load`, one joint set-up; depths beyond 0.5 are left out.

    Returns
    -------
    pandas.DataFrame
        Columns ``r2_star`` and ``f1``, ordered by the former.
    """
    inside = curves[curves.depth_star <= LARGEST_DEPTH]
    rows = [
        (r2_star, coefficient(law, case.depth_star, case.force_star))
        for r2_star, case in inside.groupby("r2_star")
    ]
    return pd.DataFrame(rows, columns=["r2_star", "f1"])


def surrogate(r2_star, f1):
    """Straight line f1 = slope R2* + intercept by least squares.

    Parameters
    ----------
    r2_star, f1 : array_like, shape (n,)
        At least two cases.

    Returns
    -------
    dict
        ``slope`` and ``intercept``.
    """
    slope, intercept = np.polyfit(r2_star, f1, 1)
    return {"slope": float(slope), "intercept": float(intercept)}


def fit_laws(curves):
    """Surrogates of all fitted laws over the paper's range 20 <= R2* <= 300.

    Parameters
    ----------
    curves : pandas.DataFrame
        Rows of `study.dataset.load` for one joint set-up.

    Returns
    -------
    dict
        Law name -> ``slope`` and ``intercept``.
    """
    fits = {}
    for law in FITTED_LAWS:
        cases = coefficients_by_case(law, curves[curves.r2_star <= LARGEST_R2_STAR])
        fits[law] = surrogate(cases.r2_star, cases.f1)
    return fits
