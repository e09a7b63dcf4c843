"""A copy of the project, and ``study`` run in it as a user runs it."""

import os
import shutil
import subprocess
import sys

from numba.core.caching import UserProvidedCacheLocator

from study import paths
from study.compiled import CACHE


def copy_project(root):
    """Copy what a run needs: no environment, no builds; but what is compiled."""
    ignored = shutil.ignore_patterns(".*", "build", "__pycache__", "pytask.lock")
    shutil.copytree(paths.ROOT, root, ignore=ignored)
    share_compiled(root, root / "build/compiled")
    return root


def share_compiled(root, kept):
    """Copy what is compiled to the cache ``kept`` of a package in ``root``.

    numba names a folder of its cache by the path of the sources.
    """
    for room in ("contact", "mechanism", "measure"):
        here, there = (
            UserProvidedCacheLocator.get_suitable_cache_subpath(parent / "study" / room / "x.py")
            for parent in (paths.ROOT, root)
        )
        if (CACHE / here).is_dir():
            shutil.copytree(CACHE / here, kept / CACHE.name / there)


def environment(root):
    return os.environ | {"PYTHONPATH": str(root)}


def study(root, *words, **more):
    """Run the command line of a copy, with more variables in its environment."""
    command = [sys.executable, "-m", "study.cli", *words]
    return subprocess.run(
        command, cwd=root.parent, env=environment(root) | more, capture_output=True, text=True
    )
