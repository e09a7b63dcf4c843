"""Comparing responses at the same times: how far they agree, and which is ahead."""

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.mechanism.response import COLUMNS, Response


def difference(response: Response, truth: Response, column: str) -> float:
    """RMS difference of a column, over the RMS of its change since t = 0 in ``truth``.

    Raises
    ------
    ValueError
        If the times differ.
    """
    _same_times(response=response, truth=truth)
    checks.choice("column", column, tuple(COLUMNS))
    one, other = getattr(response, column), getattr(truth, column)
    if not np.ptp(other) > 0:
        raise checks.RangeError(f"{column} of truth must change, got only {other[0]:g}")
    return float(np.sqrt(np.mean((one - other) ** 2) / np.mean((other - other[0]) ** 2)))


def lead(response: Response, ideal: Response) -> NDArray[np.float64]:
    """How far the crank is ahead of the ideal mechanism's, as time in s, at each output.

    Negative where it is behind, 0 where the ideal one rests.
    """
    _same_times(response=response, ideal=ideal)
    ahead, speed = response.crank_angle - ideal.crank_angle, ideal.crank_speed
    return np.divide(ahead, speed, out=np.zeros_like(ahead), where=speed != 0)


def _same_times(**responses):
    for name, response in responses.items():
        checks.instance(name, response, Response)
    first, second = responses.values()
    if not np.array_equal(first.time, second.time):
        raise ValueError(f"{' and '.join(responses)} must have the same times, got others")
