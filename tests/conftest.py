"""Shared by the tests: hypothesis reproducible; one thread for BLAS; compiled once."""

import subprocess
import sys

import pytest
from hypothesis import settings
from threadpoolctl import threadpool_limits

import study.joint  # noqa: F401  (loads the libraries that are limited)
from study import compiled

settings.register_profile("study", deadline=None, derandomize=True, database=None)
settings.load_profile("study")
threadpool_limits(1)  # matrices are small: more threads wait for each other more than they do

LONGEST = ("test_workflow", "test_processors")
LONGEST += ("test_axial", "test_calculix", "test_joint", "test_tilted")


def pytest_sessionstart(session):
    """Compile the stepping loops once, before the workers begin, which would each do so."""
    many = getattr(session.config.option, "numprocesses", None)
    if many and not any(compiled.folder().rglob("*.nbc")):
        subprocess.run([sys.executable, "-m", "study.mechanism"], check=True)


def pytest_collection_modifyitems(items):
    """Begin with the files that take longest: several workers then end at the same time.

    By itself xdist begins with the files that have most tests.
    """
    items.sort(key=lambda item: item.path.stem not in LONGEST)


@pytest.fixture
def run(capsys):
    """Run a command: status, standard output and error."""
    from study import cli

    def run(*words):
        with pytest.raises(SystemExit) as stop:
            cli.main([*map(str, words)], prog_name="study")
        out, err = capsys.readouterr()
        return stop.value.code, out, err

    return run
