"""Limits of methods: where something begins to fail, found from both sides."""

from collections.abc import Callable, Iterable
from math import sqrt
from typing import Any

import pandas as pd

from study import checks
from study.joint import Joint, force_curve


def table(rows: Iterable[tuple]) -> pd.DataFrame:
    """Table of limits: what fails, condition, predicted, observed (as text), unit, told by."""
    columns = ["what", "condition", "predicted", "observed", "unit", "told_by"]
    limits, numbers = pd.DataFrame(rows, columns=columns), ["predicted", "observed"]
    limits[numbers] = limits[numbers].map(lambda x: x if isinstance(x, str) else f"{x:.3g}")
    return limits


def bisect(fails: Callable[[float], bool], low: float, high: float, times: int = 40) -> float:
    """Smallest value that fails, from ``low`` to ``high``, both > 0, to 4 digits."""
    if not callable(fails):
        raise ValueError(f"fails must be a function, got {checks.shown(fails)}")
    low = checks.number("low", low, above=0, scalar=True)
    high = checks.number("high", high, above=low, scalar=True)
    ends = low, high
    for _ in range(checks.whole("times", times, least=1)):
        middle = sqrt(low * high)
        low, high = (low, middle) if fails(middle) else (middle, high)
    if low == ends[0] or high == ends[1]:
        raise checks.StudyError(f"there is no limit between {ends[0]:g} and {ends[1]:g}")
    return float(f"{high:.4g}")


def refused(joint: Joint, low: float, high: float, times: int = 24, **options: Any) -> float:
    """Last dimensionless depth that is solved, from ``low`` to ``high``, which is refused."""
    low = checks.number("low", low, above=0, scalar=True)
    high = checks.number("high", high, above=0, scalar=True)
    for _ in range(checks.whole("times", times, least=1)):
        middle = sqrt(low * high)
        try:
            force_curve(joint, middle, **options)
            low = middle
        except checks.RangeError:
            high = middle
    return low
