"""How well predicted values agree with given ones: the usual measures.

Each takes the given values first and the predicted ones second, both of shape (n,) with n >= 2.
"""

import numpy as np
from numpy.typing import ArrayLike


def rmse(reference: ArrayLike, prediction: ArrayLike) -> float:
    """Root-mean-square error sqrt(SSE/n), in the unit of the data."""
    return float(np.sqrt(np.mean(np.subtract(reference, prediction) ** 2)))


def determination(reference: ArrayLike, prediction: ArrayLike) -> float:
    """Coefficient of determination R^2 = 1 - SSE/SST, by the usual definition.

    SSE is the sum of squared differences, SST that of the given values about their mean.
    """
    reference = np.asarray(reference)
    squares = np.sum((reference - prediction) ** 2)
    return float(1 - squares / np.sum((reference - reference.mean()) ** 2))


def adjusted(determination: float, size: int, predictors: int) -> float:
    """Adjusted coefficient 1 - (1 - c) (n - 1)/(n - p - 1) of n values, p predictors and c."""
    return 1 - (1 - determination) * (size - 1) / (size - predictors - 1)
