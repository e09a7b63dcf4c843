"""Compiled loops, and one BLAS thread inside every solve.

numba keeps the loops in a folder that is named by one hash of the code, because its own cache
checks the file of a function, but not those of the functions that it calls. A change of any file in
`study.contact` or `study.mechanism` therefore compiles all loops again. A checkout has the cache in
``build/``, an installed package in the user's cache folder.
"""

import os
import sys
from collections.abc import Callable
from functools import cache, wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from study import paths

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable, **options: bool) -> Any:
    """Compile a function at its first call, without a wrapper for C, and keep the code on disk."""
    import numba  # late: a joint needs threads only

    keep = Path(function.__code__.co_filename).is_file() and _is_usable(folder())
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder())
    try:
        njit: Any = numba.njit
        return njit(cache=keep, error_model="numpy", no_cfunc_wrapper=True, **options)(function)
    finally:
        config.CACHE_DIR = before


def inner(function: Callable) -> Any:
    """Compile a function that only compiled ones call: without a wrapper for Python."""
    return compiled(function, no_cpython_wrapper=True)


def inlined(function: Callable) -> Any:
    """Compile an `inner` function into those that call it: to pass a tuple would take longer."""
    return compiled(function, forceinline=True, no_cpython_wrapper=True)


@cache
def folder() -> Path:
    """Folder of the compiled functions of this code and this version of numba."""
    import numba

    sources = paths.sources("contact", "mechanism", suffixes=(".py", ".toml"))
    return paths.CACHE / "compiled" / paths.digest(sources, numba.__version__)


@cache
def _is_usable(kept: Path) -> bool:
    """Whether the cache can be written to; a damaged file is removed, which numba would not read.

    A whole one is a pickle, which begins with 0x80 and ends with a full stop.
    """
    try:
        kept.mkdir(parents=True, exist_ok=True)
        for path in kept.rglob("*.nb[ci]"):
            content = path.read_bytes()
            if content[:1] + content[-1:] != b"\x80.":
                path.unlink(missing_ok=True)
                where = f"{paths.shown(path)} is damaged"
                print(f"study: {where}; the loops are compiled again", file=sys.stderr)
    except OSError:
        return False
    return os.access(kept, os.W_OK)


def one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function so that BLAS and LAPACK have one thread while it runs.

    The matrices are small: several threads wait for each other longer than they compute, and ten
    times as long if other processes are busy. A user's own code outside is not limited.
    """

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
