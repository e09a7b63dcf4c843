"""A copy of the project, and ``study`` run in it as a user runs it."""

import os
import shutil
import subprocess
import sys

from study import paths


def copy_project(root):
    """Copy what a run needs: no environment, no builds, no tests."""
    ignored = shutil.ignore_patterns(".*", "build", "__pycache__", "pytask.lock", "tests")
    return shutil.copytree(paths.ROOT, root, ignore=ignored)


def environment(root):
    return os.environ | {"PYTHONPATH": str(root)}


def study(root, *words, **more):
    """Run the command line of a copy, with more variables in its environment."""
    command = [sys.executable, "-m", "study.cli", *words]
    return subprocess.run(
        command, cwd=root.parent, env=environment(root) | more, capture_output=True, text=True
    )
