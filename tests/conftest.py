"""Shared by the tests: hypothesis without a time limit, reproducible, and cheap joint solutions."""

from hypothesis import settings

settings.register_profile("study", deadline=None, derandomize=True, database=None)
settings.load_profile("study")
