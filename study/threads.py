"""One BLAS thread inside every solve, wherever it is called from.

The matrices here are small: more threads wait for each other longer than they compute, ten times
as long where other processes are busy. What a user's own code does outside is left alone.
"""

from functools import cache, wraps

import scipy.linalg  # noqa: F401  (with NumPy: the libraries that are limited)
from threadpoolctl import ThreadpoolController


def one_thread(function):
    """Decorate a function so that BLAS and LAPACK have one thread while it runs."""

    @wraps(function)
    def limited(*args, **kwargs):
        with _controller().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited


@cache
def _controller():
    return ThreadpoolController()  # finding the libraries takes a millisecond, limiting 0.02
