"""The set-up of the paper's finite elements, inferred from its Table 2.

A candidate is a socket ratio, a drive, kinematics, elements, the depths of the sample, and the
area element of f2. For each one the coefficient of determination and the RMSE of the rows with
known formulas are compared with the published ones. A likelihood under a stated error ranks them.
"""

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from study import contact
from study.claims import statistics
from study.contact.laws import AREA_COEFFICIENTS, Area
from study.dataset import fitting
from study.dataset.fitting import LARGEST_DEPTH, R2_STAR
from study.joint import force_curve, paper_joint

ROWS = ("hertz", "steuermann", "winkler", "hyperbolic_winkler")
"""Rows of Table 2 that count; Liu's formula is reconstructed from its own row."""
NUMBERS = tuple(f"{quantity} {law}" for law in ROWS for quantity in ("1 - determination", "RMSE"))
"""The eight numbers that are compared."""
SAMPLINGS = {f"{n}, from 0": np.linspace(0, LARGEST_DEPTH, n) for n in (19, 20, 21, 22, 39)} | {
    f"{n}, without 0": np.linspace(0, LARGEST_DEPTH, n + 1)[1:] for n in (19, 20, 21)
}
FACTORS = {"1": 1.0, "19/18": 19 / 18}
"""Of 1 - determination: the latter is that of an adjusted coefficient."""
RATIOS = tuple(np.round(1 + np.geomspace(0.05, 2.0, 13), 4).tolist())
_DEPTHS = np.linspace(0.1, LARGEST_DEPTH**0.5, 32) ** 2

Forces = NDArray[np.float64]


def forces(
    sample: Forces, solver: str | None = None, resolution: int | None = None, **joint: Any
) -> Forces:
    """Forces, shape (n,), at a sample of depths up to 0.5.

    Parameters
    ----------
    **joint
        What differs from `study.joint.paper_joint`.
    """
    curve = force_curve(paper_joint(R2_STAR, **joint), _DEPTHS, resolution, solver)
    return contact.tabulated(curve)(sample)


def table_2(
    sample: Forces, force: Forces, area: Area = "flat", lower: float = 0.0
) -> dict[str, Forces]:
    """Forces of the five laws of Table 2, the Winkler ones fitted to forces at a sample of depths.

    Parameters
    ----------
    area
        Area element of the hyperbolic law.
    lower
        Share by which the fitted coefficients are lowered.
    """
    options = {law: {} for law in contact.PAPER_LAWS} | {"hyperbolic_winkler": {"area": area}}
    for law, name in (("winkler", "winkler"), ("hyperbolic_winkler", AREA_COEFFICIENTS[area])):
        options[law]["coefficient"] = (1 - lower) * fitting.coefficient(name, sample, force)
    return {law: contact.LAWS[law](sample, R2_STAR, **options[law]) for law in options}


def deviations(
    published: pd.DataFrame,
    sample: Forces,
    force: Forces,
    area: Area = "flat",
    lower: float = 0.0,
    factor: float = 1.0,
) -> dict[str, float]:
    """Deviations of Table 2's numbers from the published ones: ln(ours/published).

    Parameters
    ----------
    published
        `study.dataset.published_table_2`.
    factor
        Of 1 - determination, by the paper's definition; all else is as for `table_2`.
    """
    laws, logarithms = table_2(sample, force, area, lower), {}
    for law in ROWS:
        missing = factor * (1 - statistics.determination_as_published(force, laws[law]))
        stated = 1 - published.determination[law], published.RMSE[law]
        logarithms[f"1 - determination {law}"] = np.log(missing / stated[0])
        logarithms[f"RMSE {law}"] = np.log(statistics.rmse(force, laws[law]) / stated[1])
    return logarithms


def misfit(deviations: pd.DataFrame) -> pd.Series:
    """RMS of the deviations of `NUMBERS`, in every row of a frame."""
    return np.sqrt((deviations[list(NUMBERS)] ** 2).mean(axis=1))


def scan(published: pd.DataFrame, ratios: Sequence[float] = RATIOS, **set_up: Any) -> pd.DataFrame:
    """Deviations of Table 2 by socket ratio, sampling, area and factor, for one set-up.

    ``published`` is as for `deviations`, the set-up as for `forces`.
    """
    rows, grid = [], np.linspace(0, LARGEST_DEPTH, 401)
    for ratio in ratios:
        truth = CubicSpline(grid, forces(grid, socket_ratio=ratio, **set_up))
        for name, area, factor in product(SAMPLINGS, AREA_COEFFICIENTS, FACTORS):
            key = {"ratio": ratio, "sampling": name, "area": area, "factor": factor}
            sample = SAMPLINGS[name]
            off = deviations(published, sample, truth(sample), area, factor=FACTORS[factor])
            rows.append(key | off)
    return pd.DataFrame(rows)


def profile(candidate: pd.DataFrame, count: int = 4001) -> pd.DataFrame:
    """Deviations and ``misfit`` of one candidate over the socket ratio, between those of its scan.

    Parameters
    ----------
    candidate
        Rows of `scan` for one sampling, area and factor.
    count
        Number of ratios, in equal steps of ln(ratio).
    """
    x = np.log(candidate.ratio.to_numpy())
    fine = np.linspace(x[0], x[-1], count)
    values = CubicSpline(x, candidate[list(NUMBERS)])(fine)
    table = pd.DataFrame({"ratio": np.exp(fine)} | dict(zip(NUMBERS, values.T, strict=True)))
    return table.assign(misfit=misfit(table))


def likelihood(deviations: pd.DataFrame, sigma: float) -> pd.DataFrame:
    """Best ratio, misfit and evidence of every candidate, best first.

    Parameters
    ----------
    deviations
        From `scan`, with any further columns that name the set-up.
    sigma
        Standard deviation of the deviations that unstated details may cause.

    Returns
    -------
    pandas.DataFrame
        ``best_ratio``, ``low`` and ``high`` (central 95 % of the likelihood over ln(ratio)),
        ``misfit`` at the best ratio, and ``evidence``: the mean likelihood over ln(ratio)
        relative to that of the best candidate.
    """
    names = [c for c in deviations.columns if c not in ("ratio", *NUMBERS)]
    rows = []
    for key, candidate in deviations.groupby(names, sort=False):
        table = profile(candidate)
        exponent = -len(NUMBERS) * table.misfit**2 / (2 * sigma**2)
        weight = np.exp(exponent - exponent.max())
        low, high = np.interp([0.025, 0.975], np.cumsum(weight) / weight.sum(), table.ratio)
        judged = {
            "best_ratio": table.ratio[exponent.idxmax()],
            "low": low,
            "high": high,
            "misfit": table.misfit.min(),
            "evidence": np.log(weight.mean()) + exponent.max(),
        }
        rows.append(dict(zip(names, key, strict=True)) | judged)
    table = pd.DataFrame(rows).sort_values("evidence", ascending=False, ignore_index=True)
    table["evidence"] = np.exp(table.evidence - table.evidence.max())
    return table
