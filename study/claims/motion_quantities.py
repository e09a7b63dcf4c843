"""Numbers with which the paper's statements on Figs. 17 to 21 are compared, from two responses.

The comparison of two models of the links is `study.mechanism.compare.motion_nrms`.
"""

import numpy as np

from study.mechanism.compare import normalised_rms, same_times
from study.mechanism.response import Response

EARLY = 0.01
"""Time in s that counts as the beginning of the motion, for accelerations and impacts."""
WINDOW = 1e-3
"""Length in s of the windows in which the range of the force is evaluated."""
ARC, QUARTER = 5, 90  # deg: parts of the socket's circumference, and a quarter of it
_TINY = 1e-9  # of a window or of the duration: times of output have rounding errors


def motion_quantities(
    response: Response, ideal: Response, end: float | None = None
) -> dict[str, float]:
    """Numbers of a response with clearance, compared with that of an ideal joint, by their names.

    Both responses must be of the same model and the same mechanism. Percentages are of the time
    from 0 to ``end`` in s (at least `WINDOW`; by default the whole duration), unless the name says
    otherwise. A number that does not exist, for example because the surfaces never touched, is NaN.
    Raises ``ValueError`` if the times differ.
    """
    same_times(response=response, ideal=ideal)
    time, times = ideal.time, 1 + _TINY
    end = float(time[-1]) if end is None else end
    part, early = time <= end * times, time <= EARLY * times

    usual, loose = ideal.slider_acceleration, response.slider_acceleration
    difference = 100 * normalised_rms(usual[part], loose[part])
    early_peak = float(np.abs(loose[early]).max() / np.abs(usual[early]).max())

    # a quantity is ahead if it differs in the direction in which the ideal one changes
    ahead = {}
    slopes = ideal.slider_velocity, usual, np.gradient(usual, time)
    for name, slope in zip(("position", "velocity", "acceleration"), slopes, strict=True):
        lead = (response.rows[f"slider_{name}"] - ideal.rows[f"slider_{name}"]) * slope > 0
        ahead[f"time for which the slider's {name} is ahead"] = 100 * float(lead[part].mean())

    # impacts that have ended, and the range of the normal force in each window
    impacts = response.impact_rows
    ended = np.isfinite(impacts["separation_speed"])
    start, peak = impacts["time"][ended], impacts["peak_force"][ended]
    parted = (start + impacts["duration"][ended])[start <= end].max(initial=0.0)
    force, usual_force = response.normal_force, ideal.normal_force
    largest = max(force[part].max(), peak[start <= end].max(initial=0.0)) / usual_force[part].max()
    first = peak[start <= EARLY].max(initial=0.0) / usual_force[early].max()
    window = np.floor(time / WINDOW + _TINY).astype(int)
    begins = np.flatnonzero(np.diff(window, prepend=-1))[: int(end / WINDOW + _TINY) + 1]
    swing, usual_swing = (
        (np.maximum.reduceat(values, begins) - np.minimum.reduceat(values, begins))[:-1]
        for values in (force, usual_force)
    )

    # path of the contact on the circumference of the socket
    touches = (response.depth > 0) & part
    angle = np.degrees(np.arctan2(response.eccentricity_y, response.eccentricity_x))[touches] % 360
    count = np.histogram(angle, np.arange(0, 361, ARC))[0]
    quarters = np.sum([np.roll(count, k) for k in range(QUARTER // ARC)], axis=0)
    most_visited = 100 * float(quarters.max() / len(angle)) if len(angle) else np.nan
    below = np.nan
    for touch in response.event_rows[np.array(response.event_kinds) == "start"][:1]:
        x, y = touch["eccentricity_x"], touch["eccentricity_y"]
        below = float(-100 * y / np.hypot(x, y))
    return ahead | {
        "acceleration, difference of clearance and ideal joint": difference,
        "largest early acceleration over that of the ideal joint": early_peak,
        "force over that of the ideal joint": float(largest),
        "impact force over that of the ideal joint, first 10 ms": float(first),
        "last separation": 100 * float(parted) / end,
        "time in which the force swings": 100 * float((swing > 2 * usual_swing).mean()),
        "time in contact": 100 * float(touches.sum() / part.sum()),
        "arc that the contact covers": float(np.unique(angle // 1).size),
        "time of contact in the most visited quarter": most_visited,
        "first touch below the centre": below,
    }
