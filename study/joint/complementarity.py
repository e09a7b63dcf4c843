"""Linear complementarity: find p >= 0 with w = A p + b >= 0 and p w = 0.

Unilateral contact is this problem, with the pressure p and the gap w. Here A is symmetric and
positive definite: there is exactly one solution, and block principal pivoting ends.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from study import checks
from study.checks import StudyError
from study.threads import one_thread

TOLERANCE = 1e-11  # share of the largest p, or of the largest |b|, that counts as zero
PATIENCE = 10


class ComplementarityError(StudyError):
    """The pivoting did not end; the message has the residual."""


def factorised(factorise: Callable, matrix: NDArray[np.float64]) -> Any:
    """Cholesky factor by one of SciPy's functions, or a `ComplementarityError`."""
    try:
        return factorise(matrix, check_finite=False)
    except LinAlgError:
        why = "its matrix is not positive definite"
        raise ComplementarityError(f"contact did not converge: {why}") from None


@one_thread
def solve(
    matrix: ArrayLike,
    vector: ArrayLike,
    active: NDArray[np.bool_] | None = None,
    max_pivots: int | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Solve a linear complementarity problem by block principal pivoting.

    All indices whose sign is wrong change sides at once, as long as this makes progress. Else only
    the last of them does, which ends for every positive definite matrix (Murty). After Judice and
    Pires, Computers & Operations Research 21 (1994) 587-596.

    Parameters
    ----------
    matrix, vector
        A, symmetric positive definite, and b; shapes (n, n) and (n,).
    active
        First guess of where p > 0; by default where ``vector`` < 0.
    max_pivots
        Limit of pivoting steps, by default 20 n + 100.

    Returns
    -------
    p, active : ndarray, shape (n,)
        The solution, and where it is positive: a first guess for a neighbouring problem.

    Raises
    ------
    ValueError
        For an entry that is not finite, shapes that do not match, or ``max_pivots`` below 1.
    ComplementarityError
        At the limit of steps, with the residual ``max |min(p, w)|``; or for a matrix that is not
        positive definite. The rounded matrix of a socket much softer than its ball is not.
    """
    a = np.asarray(checks.number("matrix", matrix))
    b = np.asarray(checks.number("vector", vector))
    size = len(b) if b.ndim == 1 else -1
    if a.shape != (size, size):
        shapes = f"{a.shape} and {b.shape}"
        raise ValueError(f"matrix and vector must be of shapes (n, n) and (n,), got {shapes}")
    zero = TOLERANCE * np.abs(b).max(initial=0.0)
    active = b < 0 if active is None else np.array(active)
    if active.shape != (size,) or active.dtype != bool:
        raise ValueError(f"active must be {size} of True and False, got {checks.shown(active)}")
    max_pivots = 20 * size + 100 if max_pivots is None else max_pivots
    fewest, patience = size + 1, PATIENCE
    for _ in range(checks.whole("max_pivots", max_pivots, least=1)):
        p = np.zeros(size)
        if active.any():
            block = factorised(cho_factor, a[np.ix_(active, active)])
            p[active] = cho_solve(block, -b[active], check_finite=False)
        w = b + a[:, active] @ p[active]
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
        f"contact did not converge: residual {residual:.3g}, {count} of {size} points undecided"
    )
