"""What Table 2 of the paper says about its own computation, without and with elastic solutions.

**Without.** The input consists of the printed numbers, the formulas of Hertz and Steuermann, which
have no parameter, the shapes of the fitted laws, R2*, and a list of depths of shape (n,). `printed`
returns the numbers with every combination of the rounding of their last digits, so that `totals`
to `needed_rounding` return arrays. Their first element follows from the numbers as printed, and
`interval` gives it with the minimum and the maximum.

**With.** A candidate for the configuration of the paper's finite elements is a socket ratio, a
support of the ball, kinematics, elements, the depths of the sample, and the area element of f2. For
each one, the coefficient kappa as printed and the RMSE of the rows with known formulas are compared
with the published ones. They are functions of six sums of the forces (`SUMS`).

``published`` is `study.dataset.published_table_2`, and ``factor`` a factor by which
1 - kappa_as_printed may have been multiplied before it was printed.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares, minimize

from study import checks, contact
from study.contact.laws import AREA_COEFFICIENTS, Area
from study.dataset import fitting, solutions
from study.dataset.fitting import LARGEST_DEPTH, R2_STAR
from study.joint import Solver, reference_joint

ROWS = ("hertz", "steuermann", "winkler", "hyperbolic_winkler")
"""Rows of Table 2 with known formulas; Liu's is reconstructed from its own row."""
HALF_DIGIT = 5e-5
"""Half of the last digit that Table 2 prints."""
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

Numbers = NDArray[np.float64]
Printed = dict[str, tuple[Numbers, Numbers]]


def printed(published: pd.DataFrame) -> Printed:
    """1 - kappa_as_printed and RMSE of each of `ROWS`, each of shape (257,).

    The first element is as printed, the others are the 2^8 corners of what rounds to it.
    """
    corners = np.array([[0.0] * 8, *product((-HALF_DIGIT, HALF_DIGIT), repeat=8)]).T
    return {
        law: (
            1 - published.kappa_as_printed[law] + corners[k],
            published.RMSE[law] + corners[k + 4],
        )
        for k, law in enumerate(ROWS)
    }


def interval(values: ArrayLike) -> dict[str, float]:
    """The first value, which follows from the numbers as printed, the minimum and the maximum."""
    numbers = np.asarray(values)
    return {"value": numbers[0], "low": numbers.min(), "high": numbers.max()}


def known_forces(depths: ArrayLike) -> tuple[Numbers, Numbers]:
    """Forces of Hertz's and Steuermann's laws at some depths, as this study reads them."""
    return contact.Hertz()(depths, R2_STAR), contact.Steuermann()(depths, R2_STAR)


def totals(
    table: Printed,
    depths: ArrayLike,
    factor: float = 1.0,
    known: tuple[ArrayLike, ArrayLike] | None = None,
    opposite: bool = False,
) -> tuple[Numbers, Numbers]:
    """Sum of the elastic forces y, and sum of (y - mean)^2, from two coefficients kappa as printed.

    With 1 - kappa_as_printed = (sum of errors)^2/sum (y - mean)^2, the roots of the two are in the
    ratio of the laws' summed errors. These laws are Hertz's and Steuermann's, with the forces
    ``known``, by default `known_forces`; on average they err to the same side unless ``opposite``.
    """
    hertz, steuermann = (np.sum(force) for force in known or known_forces(depths))
    root = np.sqrt(table["hertz"][0] / table["steuermann"][0])
    root = -root if opposite else root
    force = (hertz - root * steuermann) / (1 - root)
    return force, factor * (force - hertz) ** 2 / table["hertz"][0]


def coefficients(
    table: Printed, law: str, depths: ArrayLike, factor: float = 1.0, **reading: Any
) -> tuple[Numbers, Numbers]:
    """Coefficient of a fitted law by its kappa as printed, and by its RMSE.

    The latter is that of least squares: n RMSE^2 = sum y^2 - c^2 sum f^2. The former has the sign
    of the law's mean error that brings the two nearer. ``law`` is a key of
    `study.dataset.fitting.FITTED_LAWS`, ``reading`` as for `totals`.
    """
    force, about_mean = totals(table, depths, factor, **reading)
    shape = fitting.shape(law, depths)
    missing, rmse = table["winkler" if law == "winkler" else "hyperbolic_winkler"]
    squares = about_mean + force**2 / len(shape)
    by_rmse = np.sqrt((squares - len(shape) * rmse**2) / (shape @ shape))
    error = np.sqrt(missing * about_mean / factor)
    both = np.array([force - error, force + error]) / shape.sum()
    nearer = np.abs(both / by_rmse - 1)[:, 0].argmin()
    return both[nearer], by_rmse


def disagreement(
    table: Printed, law: str, depths: ArrayLike, factor: float = 1.0, **reading: Any
) -> Numbers:
    """Relative difference in percent of a law's two `coefficients`; 0 for the paper's sample."""
    by_kappa, by_rmse = coefficients(table, law, depths, factor, **reading)
    return 100 * (by_kappa / by_rmse - 1)


def projection(
    table: Printed, law: str, depths: ArrayLike, factor: float = 1.0
) -> tuple[Numbers, Numbers]:
    """Forces at the depths, shape (n, 257), and the sum of squares of the part that is not known.

    The table gives the scalar products of the elastic forces with 1, with Hertz's law (from its
    RMSE), with the Winkler law and with another fitted ``law``. The forces returned are the part of
    the elastic forces that is a combination of these four. If the sum of squares of the remaining
    part is negative, no forces are consistent with the table.
    """
    total, about_mean = totals(table, depths, factor)
    squares, hertz = about_mean + total**2 / np.size(depths), known_forces(depths)[0]
    products = [total, (squares + hertz @ hertz - len(hertz) * table["hertz"][1] ** 2) / 2]
    basis = [np.ones(len(hertz)), hertz]
    for fitted in ("winkler", law):
        basis.append(fitting.shape(fitted, depths))
        by_rmse = coefficients(table, fitted, depths, factor)[1]
        products.append(by_rmse * (basis[-1] @ basis[-1]))
    directions, mixed = np.linalg.qr(np.array(basis).T)
    parts = np.linalg.solve(mixed.T, np.array(products))
    return directions @ parts, squares - np.sum(parts**2, axis=0)


def needed_rounding(table: Printed, law: str, depths: ArrayLike, factor: float = 1.0) -> float:
    """Minimum error of the printed numbers, in half digits, for which forces exist that give them.

    An error of up to 1 can be rounding. The eight numbers give the sum of the squared forces, and
    the products of the forces with 1 and with four laws, where the factors of the fitted laws need
    not be those of least squares. Therefore forces exist if the part of them within these five has
    no larger sum of squares. Raises `study.checks.StudyError` if no such error is found.
    """
    stated = np.array([[column[0] for column in table[name]] for name in ROWS]).T
    fitted = [fitting.shape(name, depths) for name in ("winkler", law)]
    laws = np.array([*known_forces(depths), *fitted])
    count, sums = laws.shape[1], laws.sum(axis=1)
    directions = np.linalg.qr(np.array([np.ones(count), *laws]).T)[1]

    def rest(changed):
        """Sum of squares that is left to other forces; below 0 there are none."""
        missing, rmse = stated + HALF_DIGIT * changed[:8].reshape(2, 4)
        root = np.sqrt(missing[0] / missing[1])
        total = (sums[0] - root * sums[1]) / (1 - root)
        about_mean = factor * (total - sums[0]) ** 2 / missing[0]
        factors = np.append([1.0, 1.0], total / sums[2:])
        factors[2:] -= np.sqrt(missing[2:] * about_mean / factor) / sums[2:]
        squares = about_mean + total**2 / count
        errors = count * rmse**2 - squares - factors**2 * (laws**2).sum(axis=1)
        parts = np.linalg.solve(directions.T, np.append(total, -errors / (2 * factors)))
        return squares - parts @ parts

    unit = abs(rest(np.zeros(8)))
    if rest(np.zeros(8)) >= 0:
        return 0.0
    functions = [lambda x: rest(x) / unit, lambda x: x[8] - x[:8], lambda x: x[8] + x[:8]]
    limits = [{"type": "ineq", "fun": function} for function in functions]
    start, options = np.append(np.zeros(8), 1.0), {"maxiter": 500, "ftol": 1e-10}
    positive = [(-0.9 * number / HALF_DIGIT, None) for number in stated.ravel()] + [(0, None)]
    found = minimize(
        lambda x: x[8], start, method="SLSQP", bounds=positive, constraints=limits, options=options
    )
    if not found.success or abs(rest(found.x)) > 1e-6 * unit:
        raise checks.StudyError(
            f"no forces were found for numbers near those of Table 2: {found.message}"
        )
    return float(found.x[8])


def forces(
    sample: Numbers, solver: Solver | None = None, resolution: int | None = None, **joint: Any
) -> Numbers:
    """Forces, shape (n,), at depths up to 0.5, of `study.joint.reference_joint` with changes."""
    curve = solutions.curve(reference_joint(R2_STAR, **joint), _DEPTHS, resolution, solver)
    return contact.Table.of_curve(curve)(sample)


def law_forces(sample: Numbers, force: Numbers, area: Area = "flat") -> dict[str, Numbers]:
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


def sums(sampling: str, force: Numbers) -> dict[str, float]:
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
    element of the hyperbolic law, the factor of 1 - kappa_as_printed, a common ``scale`` of all
    elastic forces, and relative shifts of the coefficients of Winkler's and the hyperbolic law from
    those of least squares.
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
    published: pd.DataFrame, sums: Mapping[str, Any], shifts: Numbers, scale: float = 1.0
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
    sampling, table = scanned.sampling.iloc[0], published.to_dict()
    low, high = np.array([[first, last], np.log(FREE_SCALE)]).T

    def off(x, log_scale):
        return deviations(table, sampling, at(x), scale=np.exp(log_scale), **reading)

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
            reading: dict[str, Any] = {"area": area, "factor": FACTORS[factor]}
            if scale_free:
                best = freed(published, scanned, **reading)
            else:
                over = profile(published, scanned, **reading)
                best = over.loc[over.misfit.idxmin(), ["ratio", "misfit"]]
                best = {"best_ratio": best.ratio, "misfit": best.misfit}
            rows.append(dict(zip(names, key, strict=True)) | reading | {"factor": factor} | best)
    return pd.DataFrame(rows).sort_values("misfit", kind="stable", ignore_index=True)
