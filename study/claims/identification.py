"""What the paper leaves unsaid about its finite elements, inferred from its Table 2.

A candidate is a socket ratio, a drive, kinematics, elements, depths at which the forces were
sampled, and the area element of f2. For each one R2 and RMSE of the rows whose formulas are
known are computed anew and compared with the published ones; what explains them best, and how
much better than the rest, is the likelihood under a stated error.
"""

from itertools import product

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from study import contact
from study.claims import statistics
from study.dataset import fitting
from study.dataset.fitting import LARGEST_DEPTH, R2_STAR, SAMPLE
from study.joint import force_curve, paper_joint

ROWS = ("hertz", "steuermann", "winkler", "hyperbolic_winkler")
"""Rows of Table 2 that count: Liu's formula is reconstructed from its own row."""
NUMBERS = tuple(f"{quantity} {law}" for law in ROWS for quantity in ("1 - R2", "RMSE"))
"""The eight numbers that are compared."""
AREAS = {"flat": "hyperbolic_winkler", "sphere": "hyperbolic_winkler_sphere"}
SAMPLINGS = {f"{n}, from 0": np.linspace(0, LARGEST_DEPTH, n) for n in (19, 20, 21, 22, 39)} | {
    f"{n}, without 0": np.linspace(0, LARGEST_DEPTH, n + 1)[1:] for n in (19, 20, 21)
}
FACTORS = {"1": 1.0, "19/18": 19 / 18}
"""Of 1 - R2: the latter is that of an adjusted coefficient."""
RATIOS = tuple(np.round(1 + np.geomspace(0.05, 2.0, 13), 4).tolist())
_DEPTHS = np.linspace(0.1, LARGEST_DEPTH**0.5, 32) ** 2


def forces(sample, solver=None, resolution=None, **joint):
    """Forces of one joint at any depths up to 0.5.

    Parameters
    ----------
    sample : ndarray, shape (n,)
        Values of ``depth_star``.
    solver, resolution
        As for `study.joint.force_curve`.
    **joint
        What differs from `study.joint.paper_joint`.

    Returns
    -------
    ndarray, shape (n,)
    """
    curve = force_curve(paper_joint(R2_STAR, **joint), _DEPTHS, resolution, solver)
    return contact.tabulated(curve)(sample)


def table_2(sample, force, area="flat", lower=0.0):
    """Forces of the five laws of Table 2, the Winkler ones fitted to the sample.

    Parameters
    ----------
    sample, force : ndarray, shape (n,)
        Depths and finite-element forces to fit to.
    area : {"flat", "sphere"}
        Area element of the hyperbolic law.
    lower : float
        Share by which the fitted coefficients are lowered.

    Returns
    -------
    dict
        Law -> forces, shape (n,).
    """
    options = {law: {} for law in contact.PAPER_LAWS}
    for law, name in (("winkler", "winkler"), ("hyperbolic_winkler", AREAS[area])):
        coefficient = (1 - lower) * fitting.coefficient(name, sample, force)
        options[law] = {"coefficient": coefficient}
    options["hyperbolic_winkler"]["area"] = area
    return {law: contact.LAWS[law](sample, R2_STAR, **options[law]) for law in options}


def deviations(published, sample, force, area="flat", lower=0.0, factor=1.0):
    """How far the numbers of Table 2 are from the published ones.

    Parameters
    ----------
    published : pandas.DataFrame
        `study.dataset.published_table_2`.
    sample, force, area, lower
        As for `table_2`.
    factor : float
        Times 1 - R2, by the paper's definition.

    Returns
    -------
    dict
        Key of `NUMBERS` -> ln(found/published).
    """
    laws, found = table_2(sample, force, area, lower), {}
    for law in ROWS:
        missing = factor * (1 - statistics.r_squared_as_published(force, laws[law]))
        rmse = statistics.rmse(force, laws[law])
        found[f"1 - R2 {law}"] = np.log(missing / (1 - published.R2[law]))
        found[f"RMSE {law}"] = np.log(rmse / published.RMSE[law])
    return found


def misfit(deviations):
    """RMS of the deviations of `NUMBERS`, in every row of a frame."""
    return np.sqrt((deviations[list(NUMBERS)] ** 2).mean(axis=1))


def scan(published, ratios=RATIOS, **set_up):
    """Deviations of Table 2 for many socket ratios of one set-up.

    Parameters
    ----------
    published : pandas.DataFrame
        `study.dataset.published_table_2`.
    ratios : sequence of float
        Socket ratios.
    **set_up
        As for `forces`.

    Returns
    -------
    pandas.DataFrame
        Per socket ratio, sampling, area and factor the deviations of `NUMBERS`.
    """
    rows = []
    grid = np.linspace(0, LARGEST_DEPTH, 401)
    for ratio in ratios:
        truth = CubicSpline(grid, forces(grid, socket_ratio=ratio, **set_up))
        for (sampling, sample), area, factor in product(SAMPLINGS.items(), AREAS, FACTORS):
            key = {"ratio": ratio, "sampling": sampling, "area": area, "factor": factor}
            found = deviations(published, sample, truth(sample), area, factor=FACTORS[factor])
            rows.append(key | found)
    return pd.DataFrame(rows)


def profile(candidate, count=4001):
    """Deviations of one candidate over the socket ratio, between those of its scan.

    Parameters
    ----------
    candidate : pandas.DataFrame
        Rows of `scan` for one sampling, area and factor.
    count : int
        Number of ratios, in equal steps of ln(ratio).

    Returns
    -------
    pandas.DataFrame
        ``ratio``, the deviations of `NUMBERS`, and ``misfit``.
    """
    x = np.log(candidate.ratio.to_numpy())
    fine = np.linspace(x[0], x[-1], count)
    values = CubicSpline(x, candidate[list(NUMBERS)])(fine)
    table = pd.DataFrame({"ratio": np.exp(fine)} | dict(zip(NUMBERS, values.T, strict=True)))
    return table.assign(misfit=misfit(table))


def likelihood(deviations, sigma):
    """Best ratio, misfit and evidence of every candidate.

    Parameters
    ----------
    deviations : pandas.DataFrame
        From `scan`, with any further columns that name the set-up.
    sigma : float
        Standard deviation of the deviations that unstated details may cause.

    Returns
    -------
    pandas.DataFrame
        One row per candidate, best first: ``best_ratio``, ``low`` and ``high`` (central 95 %
        of the likelihood over ln(ratio)), ``misfit`` (RMS of the deviations of `NUMBERS` at
        the best ratio) and ``evidence``, the mean likelihood over ln(ratio) relative to that
        of the best candidate.
    """
    names = [c for c in deviations.columns if c not in ("ratio", *NUMBERS)]
    rows = []
    for key, candidate in deviations.groupby(names, sort=False):
        table = profile(candidate)
        exponent = -len(NUMBERS) * table.misfit**2 / (2 * sigma**2)
        weight = np.exp(exponent - exponent.max())
        share = np.cumsum(weight) / weight.sum()
        low, high = np.interp([0.025, 0.975], share, table.ratio)
        found = {
            "best_ratio": table.ratio[exponent.idxmax()],
            "low": low,
            "high": high,
            "misfit": table.misfit.min(),
            "evidence": np.log(weight.mean()) + exponent.max(),
        }
        rows.append(dict(zip(names, key, strict=True)) | found)
    table = pd.DataFrame(rows).sort_values("evidence", ascending=False, ignore_index=True)
    table["evidence"] = np.exp(table.evidence - table.evidence.max())
    return table


DEFINITIONS = {
    "(sum of errors)^2 / sum (y - mean y)^2": lambda y, e: e.sum() ** 2 / _about_mean(y),
    "sum of squared errors / sum (y - mean y)^2": lambda y, e: e @ e / _about_mean(y),
    "the same, y the law's force": lambda y, e: e @ e / _about_mean(y + e),
    "the same, over depths from 0.35": lambda y, e: e[14:] @ e[14:] / _about_mean(y[14:]),
    "the same, of ln(force)": lambda y, e: _logarithmic(y[1:], y[1:] + e[1:]),
    "sum of squared errors / sum y^2": lambda y, e: e @ e / (y @ y),
    "sum of squared errors / sum y f": lambda y, e: e @ e / (y @ (y + e)),
    "(sum of |errors|)^2 / sum (y - mean y)^2": lambda y, e: abs(e).sum() ** 2 / _about_mean(y),
    "|1 - sum (f - mean y)^2 / sum (y - mean y)^2|": lambda y, e: abs(
        1 - np.sum((y + e - y.mean()) ** 2) / _about_mean(y)
    ),
    "1 - squared correlation": lambda y, e: 1 - np.corrcoef(y, y + e)[0, 1] ** 2,
    "sum of squared errors / variance": lambda y, e: e @ e / np.var(y),
}
"""Readings of 1 - R2: words -> function of the truth y and the errors e = f - y of a law f."""


def _about_mean(values):
    return np.sum((values - values.mean()) ** 2)


def _logarithmic(truth, prediction):
    return np.sum(np.log(prediction / truth) ** 2) / _about_mean(np.log(truth))


def definitions(published, force):
    """What other readings of R2 would give at the depths of `SAMPLE`.

    Parameters
    ----------
    published : pandas.DataFrame
        `study.dataset.published_table_2`.
    force : ndarray, shape (21,)
        Finite-element forces.

    Returns
    -------
    pandas.DataFrame
        Columns ``definition``, 1 - R2 by row of `ROWS`, and ``misfit``: the RMS of the
        logarithm of its ratio to the published one. The first row is published.
    """
    laws = table_2(SAMPLE, force)
    stated = 1 - published.R2[list(ROWS)]
    rows = [{"definition": "published"} | stated.to_dict() | {"misfit": 0.0}]
    for words, missing in DEFINITIONS.items():
        found = {law: float(missing(force, laws[law] - force)) for law in ROWS}
        off = np.array([np.log(found[law] / stated[law]) for law in ROWS])
        rows.append({"definition": words} | found | {"misfit": np.sqrt(np.mean(off**2))})
    return pd.DataFrame(rows)


def _pressed(pressure):
    """Form of a pressure over the socket's sphere up to the half-angle eps."""
    place, weight = np.polynomial.legendre.leggauss(24)
    share, weight = (1 + place) / 2, weight / 2

    def form(depth, eps):
        angle = np.outer(eps, share)
        return depth * eps * ((np.sin(angle) * np.cos(angle)) @ (weight * pressure(share)))

    return form


LIU_FORMS = {
    "ds sin(eps) sin(eps/2)": lambda ds, eps: ds * np.sin(eps) * np.sin(eps / 2),
    "ds int (1 - t^2/eps^2) sin(t) cos(t) dt": _pressed(lambda share: 1 - share**2),
    "ds int sqrt(1 - t^2/eps^2) sin(t) cos(t) dt": _pressed(lambda share: np.sqrt(1 - share**2)),
    "ds eps sin(eps)": lambda ds, eps: ds * eps * np.sin(eps),
    "ds (1 - cos(eps))": lambda ds, eps: ds * (1 - np.cos(eps)),
    "ds sin(eps)^2": lambda ds, eps: ds * np.sin(eps) ** 2,
    "ds sin(eps/2)": lambda ds, eps: ds * np.sin(eps / 2),
    "ds eps": lambda ds, eps: ds * eps,
}
"""Forms that Liu's lost law may have: words -> function of depth and half-angle eps,
cos(eps) = 1/(1 + ds). The first is `study.contact.liu`; the next two are what the paper's words
describe; the last two are those of older readings."""


def liu_forms(published, force):
    """Each of `LIU_FORMS` with the factor that gives it the published R2, and its RMSE.

    Parameters
    ----------
    published : pandas.DataFrame
        `study.dataset.published_table_2`.
    force : ndarray, shape (21,)
        Finite-element forces at `SAMPLE`.

    Returns
    -------
    pandas.DataFrame
        Columns ``form``, ``factor`` (of R2* times the form), ``RMSE``, ``difference_percent``
        from the published RMSE, and ``last``: the force at the depth 0.5.
    """
    rows = []
    for form, shape in LIU_FORMS.items():
        unit = shape(SAMPLE[1:], np.arccos(1 / (1 + SAMPLE[1:])))
        factor = fitting.liu_coefficient(force, published.R2["liu"], unit)
        law = np.append(0, R2_STAR * factor * unit)
        rmse = statistics.rmse(force, law)
        off = 100 * (rmse / published.RMSE["liu"] - 1)
        rows.append((form, factor, rmse, off, law[-1]))
    return pd.DataFrame(rows, columns=["form", "factor", "RMSE", "difference_percent", "last"])
