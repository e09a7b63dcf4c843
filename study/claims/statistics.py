"""Measures of agreement between a law and the elastic solution, as the paper defines them.

The first argument of each function is the elastic solution, and the second one the prediction of a
law at the same depths, two or more. `determination` is the coefficient by the usual definition.
"""

import numpy as np
from numpy.typing import ArrayLike

from study.contact.power_fit import adjusted, determination, rmse

AS_PRINTED = {"size": 20, "predictors": 1}
"""Numbers of values and of predictors in the adjusted coefficients of Table 2, whose factor is
19/18: the 21st depth, zero, seems not to be counted."""


def kappa_as_printed(reference: ArrayLike, prediction: ArrayLike) -> float:
    """Coefficient of Table 2 and Fig. 14 of the paper: 1 - (sum of differences)^2/SST.

    SST is the sum of squared differences of the reference from its mean. The sum of differences is
    squared instead of its terms (identified, notebook 13), so that errors of opposite sign cancel.
    """
    reference = np.asarray(reference)
    squares = np.sum((reference - reference.mean()) ** 2)
    return float(1 - np.sum(reference - prediction) ** 2 / squares)


def relative_rmse(reference: ArrayLike, prediction: ArrayLike) -> float:
    """RMS error divided by the mean of the reference (the paper's RMSE/mean(P*), Fig. 14)."""
    return rmse(reference, prediction) / float(np.mean(np.asarray(reference)))


def goodness_of_fit(reference: ArrayLike, prediction: ArrayLike) -> dict[str, float]:
    """All measures; both coefficients are adjusted as in the paper, by `AS_PRINTED`."""
    kappa, square = kappa_as_printed(reference, prediction), determination(reference, prediction)
    return {
        "kappa_as_printed": kappa,
        "kappa_adjusted_as_printed": adjusted(kappa, **AS_PRINTED),
        "determination": square,
        "determination_adjusted": adjusted(square, **AS_PRINTED),
        "RMSE": rmse(reference, prediction),
        "relative_RMSE": relative_rmse(reference, prediction),
    }
