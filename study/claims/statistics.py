"""How well a law agrees with the forces of the elastic solution, by the paper's measures.

Each takes the truth first (the elastic solution's values) and the prediction second (the law's).
Both are lists of the same length, of two values or more.
"""

import numpy as np
from numpy.typing import ArrayLike


def determination(truth: ArrayLike, prediction: ArrayLike) -> float:
    """Coefficient of determination 1 - SSE/SST (the paper: multicorrelation coefficient).

    SSE is the sum of squared differences, SST that of the truth about its mean.
    """
    truth = np.asarray(truth)
    return float(1 - np.sum((truth - prediction) ** 2) / _total(truth))


def determination_as_published(truth: ArrayLike, prediction: ArrayLike) -> float:
    """The same as in Table 2 and Fig. 14 of the paper: 1 - (sum of differences)^2/SST.

    The sum is squared instead of its terms (identified, notebook 13). The result depends only on
    the number of values and the mean difference; errors of opposite sign cancel.
    """
    truth = np.asarray(truth)
    return float(1 - np.sum(truth - prediction) ** 2 / _total(truth))


def _total(truth):
    return np.sum((truth - truth.mean()) ** 2)


def adjusted(determination: float, size: int = 20, predictors: int = 1) -> float:
    """Adjusted coefficient 1 - (1 - c) (n - 1)/(n - p - 1) of n values, p predictors and c.

    The default factor, 19/18, is that of all five rows of the paper's Table 2. The 21st depth is
    zero, where every law is exact; it seems not to count here.
    """
    return 1 - (1 - determination) * (size - 1) / (size - predictors - 1)


def rmse(truth: ArrayLike, prediction: ArrayLike) -> float:
    """Root-mean-square error sqrt(SSE/n), in the unit of the data."""
    return float(np.sqrt(np.mean(np.subtract(truth, prediction) ** 2)))


def relative_rmse(truth: ArrayLike, prediction: ArrayLike) -> float:
    """Root-mean-square error over the mean of the truth (the paper's RMSE/mean(P*), Fig. 14)."""
    return rmse(truth, prediction) / float(np.mean(truth))


def goodness_of_fit(truth: ArrayLike, prediction: ArrayLike) -> dict[str, float]:
    """All measures; those without ``_correct`` follow `determination_as_published`."""
    measures = {}
    for suffix, measure in (("", determination_as_published), ("_correct", determination)):
        coefficient = measure(truth, prediction)
        measures[f"determination{suffix}"] = coefficient
        measures[f"determination_adjusted{suffix}"] = adjusted(coefficient)
    measures["RMSE"] = rmse(truth, prediction)
    measures["relative_RMSE"] = relative_rmse(truth, prediction)
    return measures
