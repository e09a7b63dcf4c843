"""Compiled loops: numba, with a cache on disk that depends on all sources of a loop.

numba's own cache checks the file of a function, but not those of the functions that it calls. Here
a module's loops are kept in a folder named by the digest of all code that the module reaches: a
change compiles again what reaches it, and an unchanged study starts at once. A checkout has the
cache in ``build/``, an installed package in the user's cache folder. If the folder cannot be
written to, every process compiles again.
"""

import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba

from study import paths, provenance

CACHE = paths.CACHE / "compiled"


def compiled(function: Callable, **options: bool) -> Any:
    """Compile a function at its first call, without a wrapper for C, and keep the code on disk."""
    source = Path(function.__code__.co_filename)
    keep = source.is_file() and _writable(CACHE)
    before = numba.config.CACHE_DIR
    if keep:
        numba.config.CACHE_DIR = str(folder(source))
    try:
        return numba.njit(cache=keep, error_model="numpy", no_cfunc_wrapper=True, **options)(
            function
        )
    finally:
        numba.config.CACHE_DIR = before


def inner(function: Callable) -> Any:
    """Compile a function that only compiled ones call: without a wrapper for Python."""
    return compiled(function, no_cpython_wrapper=True)


def inlined(function: Callable) -> Any:
    """Compile an `inner` function as a part of those that call it.

    It is for small functions that return tuples: to pass these takes longer than to compute them.
    """
    return compiled(function, forceinline=True, no_cpython_wrapper=True)


@cache
def folder(source: Path) -> Path:
    """Folder that keeps the compiled functions of one source file."""
    return CACHE / provenance.digest(provenance.sources(source), numba.__version__)[:16]


def is_kept(source: Path) -> bool:
    """Whether functions of a source file, as it is now, have been compiled."""
    return any(folder(source).rglob("*.nbi"))


@cache
def _writable(parent):
    try:
        parent.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(parent, os.W_OK)
