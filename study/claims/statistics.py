"""How well a law agrees with the forces of the elastic solution, by the paper's measures.

Each takes the truth first (the elastic solution's values) and the prediction second (the law's).
"""

import numpy as np
import pandas as pd

from study import checks


def _pair(truth, prediction):
    return checks.same_length(2, truth=truth, prediction=prediction)


def r_squared(truth, prediction):
    """Multicorrelation coefficient R2 = 1 - SSE/SST.

    SSE is the sum of squared differences, SST that of the truth about its mean. It is negative
    for a prediction worse than that mean, and never more than 1.

    Parameters
    ----------
    truth, prediction : array_like, shape (n,)

    Returns
    -------
    float

    Raises
    ------
    ValueError
        For different shapes, fewer than two values, NaN, or a constant truth.
    """
    truth, prediction = _pair(truth, prediction)
    return float(1 - np.sum((truth - prediction) ** 2) / _total(truth))


def r_squared_as_published(truth, prediction):
    """R2 as the paper's Table 2 and Fig. 14 have it: 1 - (sum of differences)^2/SST.

    The sum is squared where its terms should be (identified, notebook 13): the result depends
    on the number of values and on the mean difference only, and errors of opposite sign cancel.

    Parameters
    ----------
    truth, prediction : array_like, shape (n,)

    Returns
    -------
    float

    Raises
    ------
    ValueError
        As for `r_squared`.
    """
    truth, prediction = _pair(truth, prediction)
    return float(1 - np.sum(truth - prediction) ** 2 / _total(truth))


def _total(truth):
    total = np.sum((truth - truth.mean()) ** 2)
    if total == 0:
        raise ValueError(f"truth must vary, got only {truth[0]:g}")
    return total


def adjusted(r_squared, size=20, predictors=1):
    """Adjusted coefficient 1 - (1 - R2) (n - 1)/(n - p - 1) of n values and p predictors.

    The default factor, 19/18, is that of all five rows of the paper's Table 2. Its errors
    belong to 21 depths; the one at zero, where every law is exact, seems not to count here.

    Parameters
    ----------
    r_squared : float
    size : int
        Number n of values.
    predictors : int
        Number p of predictors, from 0 to n - 2.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        For too many predictors, or a coefficient that is NaN or infinite.
    """
    checks.number("r_squared", r_squared, scalar=True)
    size = checks.whole("size", size, least=2)
    predictors = checks.whole("predictors", predictors, least=0, most=size - 2)
    return 1 - (1 - r_squared) * (size - 1) / (size - predictors - 1)


def rmse(truth, prediction):
    """Root-mean-square error sqrt(SSE/n), in the unit of the data.

    Parameters
    ----------
    truth, prediction : array_like, shape (n,)

    Returns
    -------
    float

    Raises
    ------
    ValueError
        As for `r_squared`.
    """
    truth, prediction = _pair(truth, prediction)
    return float(np.sqrt(np.mean((truth - prediction) ** 2)))


def relative_rmse(truth, prediction):
    """Root-mean-square error over the mean of the truth (the paper's RMSE/mean(P*), Fig. 14)."""
    error, mean = rmse(truth, prediction), float(np.mean(truth))
    if mean == 0:
        raise ValueError("truth must have a mean that is not 0 for a relative error, got 0")
    return error / mean


def agreement(truth, prediction):
    """All measures of agreement at once, the two coefficients by both definitions.

    Parameters
    ----------
    truth, prediction : array_like, shape (n,)

    Returns
    -------
    dict
        ``R2`` and ``R2_adj`` as published (`r_squared_as_published`), ``R2_correct`` and
        ``R2_adj_correct`` (`r_squared`), ``RMSE`` and ``relative_RMSE``.

    Raises
    ------
    ValueError
        As for `r_squared`.
    """
    published = r_squared_as_published(truth, prediction)
    correct = r_squared(truth, prediction)
    return {
        "R2": published,
        "R2_adj": adjusted(published),
        "R2_correct": correct,
        "R2_adj_correct": adjusted(correct),
        "RMSE": rmse(truth, prediction),
        "relative_RMSE": relative_rmse(truth, prediction),
    }


def relative_error(truth, prediction):
    """Relative error (prediction - truth)/truth of each value.

    Parameters
    ----------
    truth, prediction : array_like, shape (n,)

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    ValueError
        As for `r_squared`, or for a zero in ``truth``.
    """
    truth, prediction = _pair(truth, prediction)
    if (truth == 0).any():
        raise ValueError("truth must be non-zero for a relative error, got 0")
    return (prediction - truth) / truth


def last_crossing(x, lead):
    """Where a sampled lead turns positive for good, by linear interpolation.

    Parameters
    ----------
    x, lead : array_like, shape (n,)

    Returns
    -------
    float
        The first x if the lead is positive throughout.

    Raises
    ------
    ValueError
        If the lead is not positive at the end.
    """
    x, lead = checks.same_length(x=x, lead=lead)
    if lead[-1] <= 0:
        raise ValueError(f"the lead must be positive at the end, got {lead[-1]:g}")
    behind = np.flatnonzero(lead <= 0)
    if behind.size == 0:
        return float(x[0])
    pair = slice(behind[-1], behind[-1] + 2)
    return float(np.interp(0, lead[pair], x[pair]))


def local_exponent(table):
    """Exponents d ln(y) / d ln(x) of several curves, by central differences.

    Parameters
    ----------
    table : pandas.DataFrame
        A column per curve, values > 0; the index is x > 0, rising.

    Returns
    -------
    pandas.DataFrame
        Of the same shape; the first and last rows are one-sided.

    Raises
    ------
    ValueError
        For fewer than two rows, values that are not > 0, or an index that does not rise.
    """
    checks.frame("table", table, ())
    x = np.asarray(checks.number("index of table", table.index, above=0))
    checks.number("table", table, above=0)
    if len(x) < 2 or (np.diff(x) <= 0).any():
        raise ValueError(f"index of table must rise over two rows or more, got {checks.shown(x)}")
    slopes = np.gradient(np.log(table), np.log(table.index), axis=0)
    return pd.DataFrame(slopes, table.index, table.columns)
