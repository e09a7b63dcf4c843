"""What follows from Table 2 of the paper alone, without any elastic solution.

The input consists of the printed numbers, the formulas of Hertz and Steuermann, which have no
parameter, the shapes of the fitted laws, R2*, and a list of depths of shape (n,). `printed` returns
the numbers with every combination of the rounding of their last digits, so that each function
returns arrays. Their first element follows from the numbers as printed, and `interval` gives it
with the minimum and the maximum. ``factor`` is a factor by which 1 - kappa_as_printed may have been
multiplied before it was printed.
"""

from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from study import checks, contact
from study.dataset import fitting
from study.dataset.fitting import R2_STAR

ROWS = ("hertz", "steuermann", "winkler", "hyperbolic_winkler")
"""Rows of Table 2 with known formulas; Liu's is reconstructed from its own row."""
HALF_DIGIT = 5e-5
"""Half of the last digit that Table 2 prints."""

Numbers = NDArray[np.float64]
Printed = dict[str, tuple[Numbers, Numbers]]


def printed(published: pd.DataFrame) -> Printed:
    """1 - kappa_as_printed and RMSE of each of `ROWS`, each of shape (257,).

    The first element is as printed, the others are the 2^8 corners of what rounds to it.
    ``published`` is `study.dataset.published_table_2`.
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
    table: Printed, law: str, depths: ArrayLike, factor: float = 1.0, **reading
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
    table: Printed, law: str, depths: ArrayLike, factor: float = 1.0, **reading
) -> Numbers:
    """Relative difference in percent of a law's two `coefficients`; 0 for the paper's sample."""
    by_kappa, by_rmse = coefficients(table, law, depths, factor, **reading)
    return 100 * (by_kappa / by_rmse - 1)


def forces(
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
    limits = [lambda x: rest(x) / unit, lambda x: x[8] - x[:8], lambda x: x[8] + x[:8]]
    limits = [{"type": "ineq", "fun": limit} for limit in limits]
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
