"""One BLAS thread inside every solve, wherever it is called from.

The matrices are small: several threads wait for each other longer than they compute, and ten times
as long if other processes are busy. A user's own code outside is not limited.
"""

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

ONE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Environment of a process, one of several side by side, before it imports NumPy."""


def one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function so that BLAS and LAPACK have one thread while it runs."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _controller().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited


@cache
def _controller():
    import scipy.linalg  # noqa: F401  (with NumPy: the libraries that are limited)
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()  # finding the libraries takes a millisecond, limiting 0.02
