"""Comparing responses at the same times: how far they agree, which is ahead, and for how long."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.mechanism.response import Response
from study.mechanism.simulate import LEAST_TOLERANCE

SAME = 0.01  # clearances: two eccentricities that differ by less are the same motion
FINER = 100  # times, the tolerance of a second run


class Agreement(NamedTuple):
    """How long two responses are one motion."""

    until: float
    """Last output time in s up to which both have the same eccentricity (`SAME`)."""
    lasts: bool
    """Whether that is to the end."""
    largest_distance: float
    """Between these eccentricities until then, in clearances."""
    impacts: tuple[int, int]
    """Numbers of impacts that begin until then, in each response."""
    force_difference: float
    """Largest relative difference of normal forces until then: of the peaks of impacts that have
    ended, and at the output times, over the largest force."""


def agreement(first: Response, second: Response) -> Agreement:
    """How long two responses are one motion.

    Two runs of one scene at other tolerances agree to the end, unless tiny differences grow, as
    they do in chaotic motion (this study). Raises ``ValueError`` if the times differ.
    """
    same_times(first=first, second=second)
    apart = (first.rows[name] - second.rows[name] for name in ("eccentricity_x", "eccentricity_y"))
    distance = np.hypot(*apart)
    if first.law is not None:
        distance /= first.law.clearance
    count = int(np.append(distance <= SAME, False).argmin())
    until = float(first.time[count - 1])
    both, peaks = (first.impact_rows, second.impact_rows), []
    begun, begun_too = (int(np.count_nonzero(rows["time"] <= until)) for rows in both)
    for rows in both:
        ended = rows["time"] + rows["duration"] <= until
        peaks.append(rows["peak_force"][ended & np.isfinite(rows["separation_speed"])])
    pairs = zip(*peaks, strict=False)
    changes = [abs(peak - other) / max(peak, other) for peak, other in pairs if peak != other]
    force, other = (r.rows["normal_force"][:count] for r in (first, second))
    if force.any():
        changes.append(np.abs(force - other).max() / np.abs(force).max())
    lasts, farthest = count == len(first.time), float(distance[:count].max())
    return Agreement(until, lasts, farthest, (begun, begun_too), float(max(changes, default=0.0)))


def second_run(response: Response, run: Callable[..., Response]) -> Agreement | None:
    """How long a run at another tolerance is the same motion: how far to trust a response.

    ``run`` simulates the same again at a given ``tolerance``. None for a model without one, or
    after an interruption. Ctrl-C in the second run is a ``KeyboardInterrupt``.
    """
    tolerance = response.tolerance
    if tolerance is None or not response.complete:
        return None
    finer = tolerance >= LEAST_TOLERANCE * FINER
    second = run(tolerance=tolerance / FINER if finer else tolerance * FINER)
    if not second.complete:
        raise KeyboardInterrupt
    return agreement(response, second)


def normalised_rms(reference: ArrayLike, values: ArrayLike) -> float:
    """RMS difference of two series, divided by the RMS change of the reference since its start.

    Raises `study.checks.RangeError` if the reference does not change.
    """
    reference, values = np.asarray(reference), np.asarray(values)
    if not np.ptp(reference) > 0:
        raise checks.RangeError(
            f"the motion must change with time, got only {reference[0]:g}; take a longer duration"
        )
    change = np.mean((reference - reference[0]) ** 2)
    return float(np.sqrt(np.mean((values - reference) ** 2) / change))


def motion_nrms(reference: Response, response: Response, column: str) -> float:
    """`normalised_rms` of one column of two responses at the same times."""
    same_times(reference=reference, response=response)
    return normalised_rms(reference.rows[column], response.rows[column])


def phase_lead(response: Response, ideal: Response) -> NDArray[np.float64]:
    """Phase lead of the crank over the ideal one's in s; < 0 for a lag, 0 where that one rests."""
    same_times(response=response, ideal=ideal)
    ahead, speed = response.crank_angle - ideal.crank_angle, ideal.crank_speed
    return np.divide(ahead, speed, out=np.zeros_like(ahead), where=speed != 0)


def same_times(**responses: Response) -> None:
    """Raise ``ValueError`` for responses at other times; their names are used in the message."""
    first, second = responses.values()
    if not np.array_equal(first.time, second.time):
        raise ValueError(f"{' and '.join(responses)} must have the same output times")
