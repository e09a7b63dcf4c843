"""Compiled loops: numba, with a cache on disk that knows the sources of all of them.

numba's own cache looks at the file of a function only, not at those of the functions that it
calls; here the cache's folder is named by a hash of every source that is compiled, so that a
change of any of them compiles all anew, and an unchanged study starts at once.
"""

import hashlib

import numba

from study import paths

_FOLDERS = tuple(paths.ROOT / "study" / room for room in ("contact", "mechanism", "measure"))


def _digest():
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(p for folder in _FOLDERS for p in folder.glob("*.py")):
        digest.update(source.name.encode() + source.read_bytes())
    return digest.hexdigest()[:16]


CACHE = paths.BUILD / "compiled" / _digest()
numba.config.CACHE_DIR = str(CACHE)

compiled = numba.njit(cache=True, error_model="numpy")
