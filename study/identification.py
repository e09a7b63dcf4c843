"""What the paper leaves unsaid about its finite elements, inferred from its Table 2.

A candidate is a socket ratio, a drive, kinematics, elements, depths at which the forces were
sampled, and the area element of f2. For each one the RMSE column of Table 2 is computed anew
and compared with the published one; what explains it best, and how much better than the rest,
is the likelihood under a stated error.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from study import contact, dataset, design, fitting, statistics
from study.joint import Joint, force_curve

R2_STAR = 200  # of Table 2
LARGEST_DEPTH = 0.5
ROWS = ("hertz", "steuermann", "winkler", "hyperbolic_winkler")
"""Rows of Table 2 that count: Liu's formula is a reconstruction."""
AREAS = {"sphere": "hyperbolic_winkler", "flat": "hyperbolic_winkler_flat"}
SAMPLINGS = {f"{n}, from 0": np.linspace(0, LARGEST_DEPTH, n) for n in (19, 20, 21)} | {
    f"{n}, without 0": np.linspace(0, LARGEST_DEPTH, n + 1)[1:] for n in (19, 20, 21)
}
DIVISORS = ("n", "n - 1", "n - 2")
LOSERS = ("hertz", "steuermann", "liu")
"""Laws that the proposed one beats beyond some depth, and whose R2 in Table 2 is negative."""
RATIOS = tuple(np.round(1 + np.geomspace(0.05, 2.0, 13), 4).tolist())
_DEPTHS = np.linspace(0.1, LARGEST_DEPTH**0.5, 32) ** 2


@dataclass(frozen=True)
class Explanation:
    """A set-up that may be the paper's.

    Attributes
    ----------
    group : str
        Its curves in the dataset.
    joint : dict
        Arguments of `study.joint.Joint`.
    area : {"sphere", "flat"}
        Area element of the hyperbolic law.
    sampling : str
        A key of `SAMPLINGS`.
    """

    group: str
    joint: dict
    area: str
    sampling: str

    def truth(self):
        """Its forces at R2* = 200, as a function of the depth."""
        grid = np.linspace(0, LARGEST_DEPTH, 401)
        return CubicSpline(grid, forces(grid, **self.joint))


EXPLANATIONS = {
    "clamped 1.3, flat area": Explanation(
        "clamped",
        {"ball_drive": "clamped", "socket_ratio": design.CLAMPED_RATIO},
        "flat",
        "20, from 0",
    ),
    "plane 1.19, sphere": Explanation(
        "paper", {"socket_ratio": contact.SOCKET_RATIO}, "sphere", "20, without 0"
    ),
}


def forces(sample, solver=None, resolution=None, **joint):
    """Forces of one joint at any depths up to 0.5.

    Parameters
    ----------
    sample : ndarray, shape (n,)
        Values of ``depth_star``.
    solver, resolution
        As for `study.joint.force_curve`.
    **joint
        Arguments of `study.joint.Joint`, R2* being 200 by default.

    Returns
    -------
    ndarray, shape (n,)
    """
    joint = Joint(**({"r2_star": R2_STAR} | joint))
    return contact.tabulated(force_curve(joint, _DEPTHS, resolution, solver))(sample)


def table_2(sample, force, area="sphere", at=None):
    """Forces of the five laws of Table 2, the Winkler ones fitted to the sample.

    Parameters
    ----------
    sample, force : ndarray, shape (n,)
        Depths and finite-element forces to fit to.
    area : {"sphere", "flat"}
        Area element of the hyperbolic law.
    at : ndarray, shape (m,), optional
        Depths of the result, by default the sample.

    Returns
    -------
    dict
        Law -> forces, shape (m,).
    """
    at = sample if at is None else at
    options = {law: {} for law in contact.PAPER_LAWS}
    options["winkler"] = {"coefficient": fitting.coefficient("winkler", sample, force)}
    coefficient = fitting.coefficient(AREAS[area], sample, force)
    options["hyperbolic_winkler"] = {"area": area, "coefficient": coefficient}
    return {law: contact.LAWS[law](at, R2_STAR, **options[law]) for law in options}


def scan(published, ratios=RATIOS, **set_up):
    """Deviations of Table 2's RMSE column for many socket ratios of one set-up.

    Parameters
    ----------
    published : pandas.Series
        Published RMSE by law.
    ratios : sequence of float
        Socket ratios.
    **set_up
        As for `forces`.

    Returns
    -------
    pandas.DataFrame
        Per socket ratio, sampling, area and divisor: ``ln(RMSE found / published)`` by law.
    """
    rows = []
    grid = np.linspace(0, LARGEST_DEPTH, 401)
    for ratio in ratios:
        truth = CubicSpline(grid, forces(grid, socket_ratio=ratio, **set_up))
        for (sampling, sample), area in product(SAMPLINGS.items(), AREAS):
            laws = table_2(sample, truth(sample), area)
            error = {law: np.sum((f - truth(sample)) ** 2) for law, f in laws.items()}
            for less, divisor in enumerate(DIVISORS):
                key = {"ratio": ratio, "sampling": sampling, "area": area, "divisor": divisor}
                rmse = {law: np.sqrt(e / (len(sample) - less)) for law, e in error.items()}
                rows.append(key | {law: np.log(rmse[law] / published[law]) for law in rmse})
    return pd.DataFrame(rows)


def profile(candidate, count=4001):
    """Deviations of one candidate over the socket ratio, between those of its scan.

    Parameters
    ----------
    candidate : pandas.DataFrame
        Rows of `scan` for one sampling, area and divisor.
    count : int
        Number of ratios, in equal steps of ln(ratio).

    Returns
    -------
    pandas.DataFrame
        ``ratio``, deviations by law, and ``misfit``: the RMS of those of `ROWS`.
    """
    x = np.log(candidate.ratio.to_numpy())
    fine = np.linspace(x[0], x[-1], count)
    laws = list(contact.PAPER_LAWS)
    table = pd.DataFrame(CubicSpline(x, candidate[laws])(fine), columns=laws)
    table.insert(0, "ratio", np.exp(fine))
    return table.assign(misfit=np.sqrt((table[list(ROWS)] ** 2).mean(axis=1)))


def likelihood(deviations, sigma):
    """Best ratio, misfit and evidence of every candidate.

    Parameters
    ----------
    deviations : pandas.DataFrame
        From `scan`, with any further columns that name the set-up.
    sigma : float
        Standard deviation of ln(RMSE) that unstated details may cause.

    Returns
    -------
    pandas.DataFrame
        One row per candidate, best first: ``best_ratio``, ``low`` and ``high`` (central 95 %
        of the likelihood over ln(ratio)), ``misfit`` (RMS of the deviations of `ROWS` at the
        best ratio) and ``evidence``, the mean likelihood over ln(ratio) relative to that of
        the best candidate.
    """
    names = [c for c in deviations.columns if c not in ("ratio", *contact.PAPER_LAWS)]
    rows = []
    for key, candidate in deviations.groupby(names, sort=False):
        table = profile(candidate)
        exponent = -len(ROWS) * table.misfit**2 / (2 * sigma**2)
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


def consequences(explanation):
    """What a set-up predicts for the numbers of Tables 1 and 2 and of Figs. 10 and 14.

    Parameters
    ----------
    explanation : Explanation

    Returns
    -------
    pandas.Series
        Value by (``row``, ``quantity``) as in ``data/published/tables.csv``, and for each of
        `LOSERS` the depth (``crossing``) beyond which the proposed law is nearer.
    """
    sample, truth = SAMPLINGS[explanation.sampling], explanation.truth()
    laws = table_2(sample, truth(sample), explanation.area)
    found = {(law, "RMSE"): statistics.rmse(truth(sample), f) for law, f in laws.items()}
    other = contact.liu(sample, R2_STAR, reading="half-angle")
    found["liu_half_angle", "RMSE"] = statistics.rmse(truth(sample), other)
    fine = np.linspace(0, LARGEST_DEPTH, 2001)[1:]
    laws = table_2(sample, truth(sample), explanation.area, at=fine)
    error = {law: np.abs(f - truth(fine)) for law, f in laws.items()}
    for law in LOSERS:
        lead = error[law] - error["hyperbolic_winkler"]
        found[law, "crossing"] = statistics.last_crossing(fine, lead)

    law, curves = AREAS[explanation.area], dataset.paper_curves(group=explanation.group)
    fits = fitting.coefficients_by_case(law, curves)
    last = curves[(curves.r2_star == fits.r2_star.max()) & (curves.depth_star <= LARGEST_DEPTH)]
    prediction = fits.f1.iloc[-1] * fitting.shape(law, last.depth_star)
    with_zero = [np.append(0, values) for values in (last.force_star, prediction)]
    limit = 100 * statistics.relative_rmse(*with_zero)
    found["proposed", "relative_RMSE_limit_percent"] = limit
    fits = fits[fits.r2_star <= fitting.LARGEST_R2_STAR]
    line = fitting.surrogate(fits.r2_star, fits.f1)
    surrogate = line["slope"] * fits.r2_star + line["intercept"]
    relative = 100 * statistics.relative_error(fits.f1, surrogate)
    found["f1", "RMSE"] = statistics.rmse(fits.f1, surrogate)
    found["f1", "RE_min_percent"], found["f1", "RE_max_percent"] = relative.min(), relative.max()
    return pd.Series(found).rename_axis(["row", "quantity"])


def windows(truth, area, lows, highs, size=20):
    """R2 of the five laws over windows of depths, with coefficients fitted up to 0.5.

    Parameters
    ----------
    truth : callable
        Depths -> finite-element forces.
    area : {"sphere", "flat"}
        Area element of the hyperbolic law.
    lows, highs : sequence of float
        Ends of the windows, in clearances; pairs less than 0.03 apart are left out.
    size : int
        Number of depths.

    Returns
    -------
    pandas.DataFrame
        ``low``, ``high`` and R2 by law.
    """
    whole = SAMPLINGS["20, from 0"]
    rows = []
    for low, high in product(lows, highs):
        if high - low >= 0.03 - 1e-9:
            sample = np.linspace(low, high, size)
            laws = table_2(whole, truth(whole), area, at=sample)
            found = {law: statistics.r_squared(truth(sample), f) for law, f in laws.items()}
            rows.append({"low": low, "high": high} | found)
    return pd.DataFrame(rows)
