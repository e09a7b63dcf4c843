"""Compiled loops: numba, with a cache on disk that depends on the sources of all loops.

numba's own cache checks the file of a function, but not those of the functions that it calls. Here
the cache's folder is named by a hash of every compiled source: a change of one compiles all again,
and an unchanged study starts at once. A checkout has the cache in ``build/``, an installed package
in the user's cache folder. If the folder cannot be written to, every process compiles again.
"""

import hashlib
import os

import numba
import platformdirs

from study import paths

_FOLDERS = tuple(paths.ROOT / "study" / room for room in ("contact", "mechanism", "measure"))


def _digest():
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(p for folder in _FOLDERS for p in folder.glob("*.py")):
        digest.update(source.name.encode() + source.read_bytes())
    return digest.hexdigest()[:16]


def _writable(folder):
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


_PARENT = (
    paths.BUILD
    if paths.IS_CHECKOUT
    else platformdirs.user_cache_path("spherical-clearance-joint-study")
)
CACHE = _PARENT / "compiled" / _digest()
numba.config.CACHE_DIR = str(CACHE)

compiled = numba.njit(cache=_writable(CACHE), error_model="numpy")
