"""Shared by the tests: hypothesis without a time limit and reproducible; one thread for BLAS."""

from hypothesis import settings
from threadpoolctl import threadpool_limits

import study.joint  # noqa: F401  (loads the libraries that are limited)

settings.register_profile("study", deadline=None, derandomize=True, database=None)
settings.load_profile("study")
threadpool_limits(1)  # matrices are small: more threads wait for each other more than they do

LONGEST = ("test_pipeline", "test_build", "test_processors")


def pytest_collection_modifyitems(items):
    """Begin with the files that take longest: several workers then end at the same time."""
    items.sort(key=lambda item: item.path.stem not in LONGEST)
