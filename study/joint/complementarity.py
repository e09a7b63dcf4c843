"""Linear complementarity: find p >= 0 with w = A p + b >= 0 and p w = 0.

Unilateral contact is this problem, with the pressure p and the gap w. Here A is symmetric and
positive definite: there is exactly one solution, and block principal pivoting ends.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from study.checks import StudyError
from study.compiled import one_thread

TOLERANCE = 1e-11  # share of the largest p, or of the largest |b|, that counts as zero
PATIENCE = 10


class ComplementarityError(StudyError):
    """The pivoting did not end, or the matrix is not positive definite.

    The rounded matrix of a socket much softer than its ball is not.
    """


def factorised(factorise: Callable, matrix: NDArray[np.float64]) -> Any:
    """Cholesky factor by one of SciPy's functions, or a `ComplementarityError`."""
    try:
        return factorise(matrix, check_finite=False)
    except scipy.linalg.LinAlgError:
        raise ComplementarityError(
            "the contact problem cannot be solved because its matrix is not positive definite, "
            "which happens if the socket is much softer than the ball"
        ) from None


@one_thread
def solve(
    matrix: NDArray[np.float64],
    vector: NDArray[np.float64],
    active: NDArray[np.bool_] | None = None,
    max_pivots: int | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Solve a linear complementarity problem by block principal pivoting: p, and where it is > 0.

    All indices whose sign is wrong change sides at once, as long as this makes progress. Else only
    the last of them does, which ends for every positive definite matrix (Murty). After Judice and
    Pires, Computers & Operations Research 21 (1994) 587-596.

    Parameters
    ----------
    matrix, vector
        A, symmetric positive definite, and b; shapes (n, n) and (n,).
    active
        First guess of where p > 0, such as that of a neighbouring problem; by default where
        ``vector`` < 0.
    max_pivots
        Limit of pivoting steps, by default 20 n + 100. At the limit a `ComplementarityError` states
        the residual ``max |min(p, w)|``.
    """
    size, zero = len(vector), TOLERANCE * np.abs(vector).max(initial=0.0)
    active = vector < 0 if active is None else active.copy()
    fewest, patience = size + 1, PATIENCE
    for _ in range(max_pivots or 20 * size + 100):
        p = np.zeros(size)
        if active.any():
            block = factorised(scipy.linalg.cho_factor, matrix[np.ix_(active, active)])
            p[active] = scipy.linalg.cho_solve(block, -vector[active], check_finite=False)
        w = vector + matrix[:, active] @ p[active]
        wrong = np.where(active, p < -TOLERANCE * np.abs(p).max(initial=0.0), w < -zero)
        count = int(np.count_nonzero(wrong))
        if count == 0:
            p = np.maximum(p, 0.0)  # within the tolerance
            return p, p > 0
        if count < fewest:
            fewest, patience = count, PATIENCE
        elif patience > 0:
            patience -= 1
        else:
            wrong[: np.flatnonzero(wrong)[-1]] = False
        active ^= wrong
    residual = np.abs(np.minimum(p, w)).max()
    raise ComplementarityError(
        f"the contact problem did not converge: the residual is {residual:.3g}, and {count} of "
        f"{size} points are undecided"
    )
