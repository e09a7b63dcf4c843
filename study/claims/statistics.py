"""How well a law agrees with the forces of the elastic solution, by the paper's measures.

Each takes the reference first, which is the elastic solution, and the prediction of a law second.
Both are lists of the same length, of two values or more. The coefficient of determination by its
usual definition is `determination`; that of the paper's Table 2 is `kappa_as_printed`.
"""

import numpy as np
from numpy.typing import ArrayLike

from study.contact.fit_measures import adjusted, determination, rmse

__all__ = [
    "adjusted",
    "determination",
    "goodness_of_fit",
    "kappa_as_printed",
    "relative_rmse",
    "rmse",
]
AS_PRINTED = {"size": 20, "predictors": 1}
"""Of the adjusted coefficients, whose factor is 19/18 in all five rows of the paper's Table 2. The
21st depth is zero, where every law is exact; it seems not to count there."""


def kappa_as_printed(reference: ArrayLike, prediction: ArrayLike) -> float:
    """Coefficient of Table 2 and Fig. 14 of the paper: 1 - (sum of differences)^2/SST.

    The paper calls it multicorrelation coefficient. SST is the sum of squared differences of the
    reference from its mean. The sum of differences is squared instead of its terms (identified,
    notebook 13). The result depends only on the number of values and the mean difference; errors of
    opposite sign cancel.
    """
    reference = np.asarray(reference)
    squares = np.sum((reference - reference.mean()) ** 2)
    return float(1 - np.sum(reference - prediction) ** 2 / squares)


def relative_rmse(reference: ArrayLike, prediction: ArrayLike) -> float:
    """RMS error divided by the mean of the reference (the paper's RMSE/mean(P*), Fig. 14)."""
    return rmse(reference, prediction) / float(np.mean(reference))


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
