"""Shared by the tests: hypothesis reproducible; one thread for BLAS; compiled once."""

import subprocess
import sys

from hypothesis import settings
from threadpoolctl import threadpool_limits

import study.joint  # noqa: F401  (loads the libraries that are limited)
from study.compiled import CACHE

settings.register_profile("study", deadline=None, derandomize=True, database=None)
settings.load_profile("study")
threadpool_limits(1)  # matrices are small: more threads wait for each other more than they do

LONGEST = ("test_pipeline", "test_build", "test_processors")
COMPILE = (
    "from study.mechanism import simulate; simulate(model='beams', duration=1e-4, outputs=2)",
    "from study.mechanism import simulate\n"
    "for model in ('rigid', 'particles'): simulate(model=model, duration=1e-4, outputs=2)",
)


def pytest_sessionstart(session):
    """Compile the stepping loops once, before the workers begin, which would each do so."""
    many = getattr(session.config.option, "numprocesses", None)
    if many and not any(CACHE.rglob("*.nbi")):
        started = [subprocess.Popen([sys.executable, "-c", code]) for code in COMPILE]
        for process in started:
            process.wait()


def pytest_collection_modifyitems(items):
    """Begin with the files that take longest: several workers then end at the same time."""
    items.sort(key=lambda item: item.path.stem not in LONGEST)
