"""A copy of the project, and ``study`` run in it as a user runs it."""

import os
import shutil
import subprocess
import sys

from numba.core.caching import UserProvidedCacheLocator

from study import compiled, paths

LOOPS = [p for room in ("contact", "mechanism") for p in (paths.ROOT / "study" / room).glob("*.py")]


def copy_project(root):
    """Copy what a run needs: no environment, no builds; but what is compiled."""
    ignored = shutil.ignore_patterns(".*", "build", "__pycache__", "pytask.lock")
    shutil.copytree(paths.ROOT, root, ignore=ignored)
    share_compiled(root, root / "build/compiled")
    return root


def change(root, path, *changes):
    """Replace texts in a file of a copy, each of which is there once."""
    text = (root / path).read_text()
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    (root / path).write_text(text)


def describe(root):
    """Describe the data of a copy as made by its code."""
    code = "from study.dataset import production; production.write_description()"
    command = [sys.executable, "-c", code]
    subprocess.run(command, cwd=root, env=environment(root), check=True)


def share_compiled(root, kept):
    """Copy what is compiled to the cache ``kept`` of a package in ``root``.

    numba names a folder of its cache by the path of the sources.
    """
    here, there = (
        [UserProvidedCacheLocator.get_suitable_cache_subpath(source) for source in sources]
        for sources in (LOOPS, [root / source.relative_to(paths.ROOT) for source in LOOPS])
    )
    for source, old, new in zip(LOOPS, here, there, strict=True):
        folder = compiled.folder(source)
        if (folder / old).is_dir():
            shutil.copytree(folder / old, kept / folder.name / new, dirs_exist_ok=True)


def environment(root):
    return os.environ | {"PYTHONPATH": str(root)}


def study(root, *words, **more):
    """Run the command line of a copy, with more variables in its environment."""
    command = [sys.executable, "-m", "study.cli", *words]
    return subprocess.run(
        command, cwd=root.parent, env=environment(root) | more, capture_output=True, text=True
    )
