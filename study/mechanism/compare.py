"""Comparing responses at the same times: how far they agree, and which is ahead."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.mechanism.response import COLUMNS, Response


def normalised_rms(truth: ArrayLike, values: ArrayLike) -> float:
    """RMS difference of two series of numbers, over the RMS of the truth's change since its start.

    Raises
    ------
    ValueError
        For lists of different lengths.
    study.checks.RangeError
        If the truth does not change.
    """
    truth, values = checks.same_length(2, truth=truth, values=values)
    if not np.ptp(truth) > 0:
        raise checks.RangeError(f"truth must change, got only {truth[0]:g}")
    return float(np.sqrt(np.mean((values - truth) ** 2) / np.mean((truth - truth[0]) ** 2)))


def motion_nrms(truth: Response, response: Response, column: str) -> float:
    """`normalised_rms` of one column of two responses, such as ``slider_position``.

    Raises
    ------
    ValueError
        If the times differ.
    study.checks.RangeError
        If the column of the truth does not change.
    """
    _same_times(truth=truth, response=response)
    checks.choice("column", column, tuple(COLUMNS))
    return normalised_rms(getattr(truth, column), getattr(response, column))


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
