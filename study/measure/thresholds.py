"""Limits of methods, found by bisection between a value that works and one that fails."""

from collections.abc import Callable, Iterable
from math import sqrt

import pandas as pd

from study.checks import StudyError


def table(rows: Iterable[tuple]) -> pd.DataFrame:
    """Table of limits: what fails, condition, predicted and observed limit, unit, reported by."""
    columns = ["what", "condition", "predicted", "observed", "unit", "reported_by"]
    limits, numbers = pd.DataFrame(rows, columns=columns), ["predicted", "observed"]
    limits[numbers] = limits[numbers].map(lambda x: x if isinstance(x, str) else f"{x:.3g}")
    return limits


def bisect(fails: Callable[[float], bool], low: float, high: float, times: int = 40) -> float:
    """Smallest value that fails, from ``low`` to ``high``, both > 0, to 4 digits."""
    ends = low, high
    for _ in range(times):
        middle = sqrt(low * high)
        low, high = (low, middle) if fails(middle) else (middle, high)
    if low in ends or high in ends:
        raise StudyError("no limit was found between {:g} and {:g}".format(*ends))
    return float(f"{high:.4g}")
