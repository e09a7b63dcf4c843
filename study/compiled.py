"""Compiled loops: numba, with a cache on disk in a folder that is named by one hash of the code.

numba's own cache checks the file of a function, but not those of the functions that it calls. A
change of any file in `study.contact` or `study.mechanism` therefore compiles all loops again. A
checkout has the cache in ``build/``, an installed package in the user's cache folder. If the folder
cannot be written to, every process compiles.
"""

import os
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba

from study import paths


def compiled(function: Callable, **options: bool) -> Any:
    """Compile a function at its first call, without a wrapper for C, and keep the code on disk."""
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
    """Compile an `inner` function as a part of those that call it.

    It is for small functions that return tuples: to pass these takes longer than to compute them.
    """
    return compiled(function, forceinline=True, no_cpython_wrapper=True)


@cache
def folder() -> Path:
    """Folder of the compiled functions of this code and this version of numba."""
    sources = paths.sources("contact", "mechanism", suffixes=(".py", ".toml"))
    return paths.CACHE / "compiled" / paths.digest(sources, numba.__version__)


@cache
def _is_usable(kept: Path) -> bool:
    """Whether the cache can be written to; a damaged one is removed, which numba would not read.

    Its files are pickles, which begin with 0x80 and end with a full stop. Files that were cut off
    or overwritten do not.
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
