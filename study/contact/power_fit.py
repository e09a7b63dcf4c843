"""The power law F = k d^n, fitted to a force over a range of penetration depths.

Programs for multibody dynamics need the two numbers k and n. The fit minimises the maximum of the
relative error, so that its error is known at every depth of the range. Measures of how well
predicted values agree with given ones are here too.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from study import checks

DEPTHS = 60  # in equal ratios, at which a law is fitted
USUAL_RANGE = 0.05, 0.5
"""Depths in clearances: where the paper's example and its finite elements are."""


class PowerFit(NamedTuple):
    """Fitted power law: force = ``coefficient`` depth^``exponent``.

    ``error`` is its maximum relative error between the minimum and the maximum of ``depths``.
    """

    coefficient: float
    exponent: float
    error: float
    depths: tuple[float, float]

    @property
    def coefficient_mm(self) -> float:
        """The coefficient in N/mm^n, of a fit in SI units."""
        return self.coefficient * 1e-3**self.exponent


def fit_power(depth: ArrayLike, force: ArrayLike, exponent: float | None = None) -> PowerFit:
    """Fit a power law so that the maximum of the relative error is minimal.

    The error is (m - 1)/(m + 1), where m is the largest over the smallest ratio of law and force.
    ln m is convex and piecewise linear in n. Its minimum is at the slope between two of the points
    in logarithms.

    Depths and forces, shape (n,), are > 0 in any units, with at least two different depths; else
    ``ValueError``. With a given ``exponent``, only the coefficient is fitted.
    """
    depths, forces = np.asarray(depth, dtype=float), np.asarray(force, dtype=float)
    if depths.ndim != 1 or depths.size < 2 or depths.shape != forces.shape:
        wanted = "depth and force must be lists of the same length >= 2"
        raise ValueError(f"{wanted}, got shapes {depths.shape} and {forces.shape}")
    checks.number("depth", depths, above=0)
    checks.number("force", forces, above=0)
    x, y = np.log(depths), np.log(forces)
    if exponent is None:
        first, second = np.triu_indices(len(x), 1)
        apart = x[first] != x[second]
        if not apart.any():
            raise ValueError(f"depth must have two different values, got only {depths[0]:g}")
        slopes = ((y[second] - y[first])[apart]) / ((x[second] - x[first])[apart])
        exponent = slopes[np.ptp(y - slopes[:, None] * x, axis=1).argmin()]
    ratio = np.exp(y - exponent * x)
    least, most = ratio.min(), ratio.max()
    coefficient = 2 / (1 / least + 1 / most)
    error = float((most - least) / (most + least))
    ends = float(depths.min()), float(depths.max())
    return PowerFit(float(coefficient), float(exponent), error, ends)


def rmse(reference: ArrayLike, prediction: ArrayLike) -> float:
    """Root-mean-square error sqrt(SSE/n), in the unit of the data."""
    return float(np.sqrt(np.mean(np.subtract(reference, prediction) ** 2)))


def determination(reference: ArrayLike, prediction: ArrayLike) -> float:
    """Coefficient of determination R^2 = 1 - SSE/SST, SST about the mean of the reference."""
    reference = np.asarray(reference)
    squares = np.sum((reference - prediction) ** 2)
    return float(1 - squares / np.sum((reference - reference.mean()) ** 2))


def adjusted(determination: float, size: int, predictors: int) -> float:
    """Adjusted coefficient 1 - (1 - c) (n - 1)/(n - p - 1) of n values, p predictors and c."""
    return 1 - (1 - determination) * (size - 1) / (size - predictors - 1)
