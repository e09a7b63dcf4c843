"""The configuration of the paper's finite elements, inferred from its Table 2.

A candidate is a socket ratio, a support of the ball, kinematics, elements, the depths of the
sample, and the area element of f2. For each one the coefficient kappa as printed and the RMSE of
the rows with known formulas are compared with the published ones. They are functions of six sums
of the forces.
`study.claims.table_alone` infers what needs no elastic solution.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

from study import contact
from study.claims.table_alone import ROWS, known_forces
from study.contact.laws import AREA_COEFFICIENTS, Area
from study.dataset import fitting, solutions
from study.dataset.fitting import LARGEST_DEPTH, R2_STAR
from study.joint import reference_joint

NUMBERS = tuple(
    f"{quantity} {law}" for law in ROWS for quantity in ("1 - kappa_as_printed", "RMSE")
)
"""The eight numbers that are compared."""
SAMPLINGS = {f"{n}, from 0": np.linspace(0, LARGEST_DEPTH, n) for n in (19, 20, 21, 22, 39)} | {
    f"{n}, without 0": np.linspace(0, LARGEST_DEPTH, n + 1)[1:] for n in (19, 20, 21)
}
USUAL = "21, from 0"
FACTORS = {"1": 1.0, "19/18": 19 / 18}
"""Factors of 1 - kappa_as_printed: 19/18 would mean that an adjusted coefficient was printed."""
RATIOS = tuple(np.round(1 + np.geomspace(0.05, 2.0, 13), 4).tolist())
SUMS = ("force", "force^2", *ROWS[:3], *AREA_COEFFICIENTS.values())
"""Sums over a sample: of the forces, of their squares, and of the force times each law."""
FREE_SCALE = (0.5, 2.0)
"""Range of a common factor on all forces."""
_DEPTHS = np.linspace(0.1, LARGEST_DEPTH**0.5, 32) ** 2

Forces = NDArray[np.float64]
Range = tuple[float, float]


def forces(
    sample: Forces, solver: str | None = None, resolution: int | None = None, **joint: Any
) -> Forces:
    """Forces, shape (n,), at depths up to 0.5, of `study.joint.reference_joint` with changes."""
    curve = solutions.curve(reference_joint(R2_STAR, **joint), _DEPTHS, resolution, solver)
    return contact.Table.of_curve(curve)(sample)


def table_2(sample: Forces, force: Forces, area: Area = "flat") -> dict[str, Forces]:
    """Forces of the five laws of Table 2, the Winkler ones fitted to forces at a sample of depths.

    The hyperbolic law has the area element ``area``.
    """
    laws = {law: contact.LAWS[law]() for law in contact.PAPER_LAWS}
    winkler, hyperbolic = (
        fitting.coefficient(name, sample, force) for name in ("winkler", AREA_COEFFICIENTS[area])
    )
    laws["winkler"] = contact.Winkler(winkler)
    laws["hyperbolic_winkler"] = contact.HyperbolicWinkler(hyperbolic, area)
    return {name: law(sample, R2_STAR) for name, law in laws.items()}


@lru_cache
def _laws(sampling):
    """Forces of the laws of `SUMS` at a sample of depths; of the fitted ones, their shapes."""
    sample = SAMPLINGS[sampling]
    fitted = {law: fitting.shape(law, sample) for law in SUMS[4:]}
    return dict(zip(ROWS[:2], known_forces(sample), strict=True)) | fitted


def sums(sampling: str, force: Forces) -> dict[str, float]:
    """`SUMS` of the forces at one of `SAMPLINGS`."""
    products = {law: float(values @ force) for law, values in _laws(sampling).items()}
    return {"force": float(force.sum()), "force^2": float(force @ force)} | products


def deviations(
    published: Mapping[str, Any],
    sampling: str,
    sums: Mapping[str, Any],
    area: Area = "flat",
    factor: float = 1.0,
    scale: Any = 1.0,
    shifts: Sequence[Any] = (0.0, 0.0),
) -> dict[str, Any]:
    """Deviations of Table 2's numbers from the published ones: ln(computed/published).

    The computed ones follow from `SUMS` at one of `SAMPLINGS`, each a number or an array, the area
    element of the hyperbolic law, a factor of 1 - kappa_as_printed, a common ``scale`` of all
    elastic forces, and relative shifts of the coefficients of Winkler's and the hyperbolic law from
    those of least squares. The others are `study.dataset.published_table_2`.
    """
    laws, logarithms = _laws(sampling), {}
    count = len(SAMPLINGS[sampling])
    kappa, rmse = published["kappa_as_printed"], published["RMSE"]
    about_mean = sums["force^2"] - sums["force"] ** 2 / count
    names = (*ROWS[:3], AREA_COEFFICIENTS[area])
    for law, name, shift in zip(ROWS, names, (None, None, *shifts), strict=True):
        squares = laws[name] @ laws[name]
        coefficient = 1 / scale if shift is None else (1 + shift) * sums[name] / squares
        missing = factor * (sums["force"] - coefficient * laws[name].sum()) ** 2 / about_mean
        errors = sums["force^2"] - 2 * coefficient * sums[name] + coefficient**2 * squares
        logarithms[f"1 - kappa_as_printed {law}"] = np.log(missing / (1 - kappa[law]))
        logarithms[f"RMSE {law}"] = np.log(scale * np.sqrt(errors / count) / rmse[law])
    return logarithms


def misfit(deviations: Mapping[str, Any]) -> Any:
    """RMS of the deviations of `NUMBERS`, each a number or an array."""
    return np.sqrt(sum(deviations[number] ** 2 for number in NUMBERS) / len(NUMBERS))


def shifted_misfit(
    published: pd.DataFrame, sums: Mapping[str, Any], shifts: Forces, scale: float = 1.0
) -> Any:
    """Minimum `misfit` for the sample `USUAL` if each fitted coefficient has one of some shifts.

    ``sums`` are numbers, or arrays of shape (n,); other arguments are as for `deviations`.
    """
    sums = {name: np.asarray(value)[..., None] for name, value in sums.items()}
    off = deviations(published, USUAL, sums, scale=scale, shifts=(shifts, shifts))
    squares = [off[f"1 - kappa_as_printed {law}"] ** 2 + off[f"RMSE {law}"] ** 2 for law in ROWS]
    return np.sqrt(sum(of_law.min(axis=-1) for of_law in squares) / len(NUMBERS))


def scan(ratios: Sequence[float] = RATIOS, **set_up: Any) -> pd.DataFrame:
    """`SUMS` by socket ratio and sampling, for one set-up; this is as for `forces`."""
    rows, grid = [], np.linspace(0, LARGEST_DEPTH, 401)
    for ratio in ratios:
        reference = CubicSpline(grid, forces(grid, socket_ratio=ratio, **set_up))
        for name, sample in SAMPLINGS.items():
            rows.append({"ratio": ratio, "sampling": name} | sums(name, reference(sample)))
    return pd.DataFrame(rows)


def between(scanned: pd.DataFrame) -> tuple[Any, float, float]:
    """`SUMS` between the ratios of a scan: function of ln(ratio), and the limits of its argument.

    ``scanned`` has the rows of `scan` for one sampling.
    """
    x = np.log(scanned.ratio.to_numpy())
    curve = CubicSpline(x, np.log(scanned[list(SUMS)]))

    def at(place):
        return dict(zip(SUMS, np.moveaxis(np.exp(curve(place)), -1, 0), strict=True))

    return at, x[0], x[-1]


def profile(
    published: pd.DataFrame, scanned: pd.DataFrame, count: int = 4001, **reading: Any
) -> pd.DataFrame:
    """Deviations and ``misfit`` of one candidate at ratios in equal steps of ln(ratio).

    ``scanned`` is as for `between`, ``reading`` area, factor and scale of `deviations`.
    """
    at, first, last = between(scanned)
    x = np.linspace(first, last, count)
    off = deviations(published, scanned.sampling.iloc[0], at(x), **reading)
    return pd.DataFrame({"ratio": np.exp(x)} | off | {"misfit": misfit(off)})


def freed(published: pd.DataFrame, scanned: pd.DataFrame, **reading: Any) -> dict[str, float]:
    """``best_ratio`` and ``scale`` of minimum ``misfit``, if both are free; see `profile`."""
    at, first, last = between(scanned)
    sampling, printed = scanned.sampling.iloc[0], published.to_dict()
    low, high = np.array([[first, last], np.log(FREE_SCALE)]).T

    def off(x, log_scale):
        return deviations(printed, sampling, at(x), scale=np.exp(log_scale), **reading)

    grids = np.meshgrid(*np.linspace(low, high, 66)[1:-1].T, indexing="ij")
    best = misfit(off(*grids)).argmin()
    start = [grid.ravel()[best] for grid in grids]
    tight = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-12)
    x = least_squares(lambda x: list(off(*x).values()), start, bounds=(low, high), **tight).x
    return {"best_ratio": np.exp(x[0]), "scale": np.exp(x[1]), "misfit": misfit(off(*x))}


def ranked(published: pd.DataFrame, scans: pd.DataFrame, scale_free: bool = False) -> pd.DataFrame:
    """``best_ratio`` and ``misfit`` of every candidate, best first; and the scale if it is free.

    ``scans`` are from `scan`, with any further columns that name the set-up.
    """
    names = [column for column in scans.columns if column not in ("ratio", *SUMS)]
    rows = []
    for key, scanned in scans.groupby(names, sort=False):
        for area, factor in product(AREA_COEFFICIENTS, FACTORS):
            reading = {"area": area, "factor": FACTORS[factor]}
            if scale_free:
                best = freed(published, scanned, **reading)
            else:
                over = profile(published, scanned, **reading)
                best = over.loc[over.misfit.idxmin(), ["ratio", "misfit"]]
                best = {"best_ratio": best.ratio, "misfit": best.misfit}
            rows.append(dict(zip(names, key, strict=True)) | reading | {"factor": factor} | best)
    return pd.DataFrame(rows).sort_values("misfit", kind="stable", ignore_index=True)
