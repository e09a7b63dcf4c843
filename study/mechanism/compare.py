"""Comparing responses at the same times: how far they agree, which is ahead, and for how long."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.mechanism.response import COLUMNS, Response

_PREFIXES = ("", "crank_joint_")  # of the columns of slider's and crank's joint
SAME = 0.01
"""Clearances: two places of the ball in its socket that are closer are the same motion."""


class Agreement(NamedTuple):
    """How long two responses are one motion.

    Attributes
    ----------
    until
        Last time of output, in s, up to which both have the ball at the same place (`SAME`), in
        each clearance joint.
    lasts
        Whether that is to the end.
    largest_distance
        Between these places until then, in clearances.
    impacts
        Numbers of impacts that begin until then, in the first and in the second response.
    force_difference
        Largest difference of normal forces until then: of the peaks of impacts that have ended,
        over the peak, and at the times of output, over the largest one.
    """

    until: float
    lasts: bool
    largest_distance: float
    impacts: tuple[int, int]
    force_difference: float


def agreement(first: Response, second: Response, *clearances: float) -> Agreement:
    """How long two responses with the clearances (m) of slider's and crank's joint are one motion.

    Two runs of one scene at other tolerances agree to the end, unless tiny differences grow, as
    they do in chaotic motion (this study). Raises ``ValueError`` if the times differ.
    """
    same_times(first=first, second=second)
    distance = np.zeros(len(first.time))
    for prefix, clearance in zip(_PREFIXES, clearances, strict=False):
        checks.number("clearance", clearance, "m", above=0, scalar=True)
        apart = [
            getattr(first, f"{prefix}eccentricity_{axis}")
            - getattr(second, f"{prefix}eccentricity_{axis}")
            for axis in "xy"
        ]
        distance = np.maximum(distance, np.hypot(*apart) / clearance)
    count = int(np.append(distance <= SAME, False).argmin())
    until = float(first.time[count - 1])
    begun, peaks = [], []
    for response in (first, second):
        columns = response.impact_columns
        begun.append(int(np.count_nonzero(columns["time"] <= until)))
        ended = columns["time"] + columns["duration"] <= until
        peaks.append(columns["peak_force"][ended & np.isfinite(columns["separation_speed"])])
    pairs = zip(*peaks, strict=False)
    changes = [abs(peak - other) / max(peak, other) for peak, other in pairs if peak != other]
    for prefix, _ in zip(_PREFIXES, clearances, strict=False):
        force, other = (getattr(r, f"{prefix}normal_force")[:count] for r in (first, second))
        if force.any():
            changes.append(np.abs(force - other).max() / np.abs(force).max())
    return Agreement(
        until=until,
        lasts=count == len(first.time),
        largest_distance=float(distance[:count].max()),
        impacts=(begun[0], begun[1]),
        force_difference=float(max(changes, default=0.0)),
    )


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
    same_times(truth=truth, response=response)
    checks.choice("column", column, tuple(COLUMNS))
    return normalised_rms(getattr(truth, column), getattr(response, column))


def lead(response: Response, ideal: Response) -> NDArray[np.float64]:
    """How far the crank is ahead of the ideal mechanism's, as time in s, at each output.

    Negative where it is behind, 0 where the ideal one rests.
    """
    same_times(response=response, ideal=ideal)
    ahead, speed = response.crank_angle - ideal.crank_angle, ideal.crank_speed
    return np.divide(ahead, speed, out=np.zeros_like(ahead), where=speed != 0)


def same_times(**responses: Response) -> None:
    """Raise ``ValueError`` for responses at other times; their names are used in the message."""
    for name, response in responses.items():
        checks.instance(name, response, Response)
    first, second = responses.values()
    if not np.array_equal(first.time, second.time):
        raise ValueError(f"{' and '.join(responses)} must have the same times, got others")
