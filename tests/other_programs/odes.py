"""SciPy's and SUNDIALS' integrators on the rigid links' equations, with located impacts.

They step the compiled equations of `study.measure.explicit`, and locate the end of each flight and
contact by their own events. The kinks of the friction law are left to their error control.
"""

from math import hypot, inf

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from other_programs import peaks
from study import checks
from study.measure import explicit
from study.mechanism import Scene

SCIPY = ("LSODA", "Radau", "DOP853")
ABSOLUTE = np.array([1e-2, 1e-6, 1e-6, 1.0, 1e-2, 1e-2])
"""Absolute tolerances of the state, over rtol."""
LONGEST_FLIGHT_STEP = 2e-4  # s: a longer one may miss a short contact
DISARMED = 1e-9  # s after a start, in which the gap is rounding only


def slider_acceleration(
    method: str, scene: Scene, law: np.record, duration: float, outputs: int, rtol: float
) -> tuple[NDArray[np.float64], int]:
    """Slider's acceleration at equally spaced times, in m/s^2, and the number of evaluations.

    The method CVODE is SUNDIALS' through scikit-sundae, any other one SciPy's; the law is a record
    (`study.contact.DimensionalLaw.packed`). A failed integrator raises `study.checks.StudyError`.
    """
    integrate = _sundials if method == "CVODE" else _scipy
    times = duration * np.arange(1, outputs + 1) / outputs
    p, work, out, pulls = scene.constants(), np.zeros(6), np.zeros(3), []
    for contact, speed, _, states, count in _pieces(integrate, method, scene, law, times, rtol):
        pulls += [explicit.acceleration(z, contact, speed, p, law, work, out) for z in states]
        evaluations = count
    return np.array(pulls), evaluations


def largest_forces(
    method: str, scene: Scene, law: np.record, duration: float, rtol: float
) -> NDArray[np.float64]:
    """Maximum normal force, and that of the first contact, in N, by one of SciPy's methods."""
    p, found, end = scene.constants(), [], np.array([duration])
    for contact, speed, times, states, _ in _pieces(_every_step, method, scene, law, end, rtol):
        if contact:
            found.append(peaks.largest(times, states, speed, p, law))
    return np.array([max(found), found[0]])


def _pieces(integrate, method, scene, law, times, rtol):
    """Flights and contacts up to the last of the times.

    Each has whether it is a contact, its approach speed, times and states there, and the number of
    evaluations so far.
    """
    p, y, t, approach = scene.constants(), explicit.start_of(scene), 0.0, 0.0
    work, out, evaluations = np.zeros(6), np.zeros(3), 0
    while True:
        contact, speed = approach > 0, approach or inf

        def slopes(y, rates, contact=contact, speed=speed):
            nonlocal evaluations
            evaluations += 1
            rates[:3] = y[3:]
            explicit.acceleration(y, contact, speed, p, law, work, out)
            rates[3:] = out

        def gap(now, y, start=t, contact=contact):
            if now <= start + DISARMED:
                return 1.0 if contact else -1.0
            return hypot(y[1], y[2]) - scene.clearance

        left = times[t < times]
        seen, states, end = integrate(method, slopes, gap, contact, t, y, left, rtol)
        yield contact, speed, seen, states, evaluations
        if end is None:
            return
        t, y = end
        n = y[1:3] / np.hypot(y[1], y[2])
        approach = 0.0 if contact else float(y[4:] @ n)


def _every_step(*piece):
    """As `_scipy`, but with the ends of the steps instead of given times."""
    return _scipy(*piece, every_step=True)


def _scipy(method, slopes, gap, contact, t, y, times, rtol, every_step=False):
    rates = np.zeros(6)

    def right(_, y):
        slopes(y, rates)
        return rates.copy()

    gap.terminal, gap.direction = True, -1 if contact else 1
    limits = {"rtol": rtol, "atol": rtol * ABSOLUTE}
    limits["max_step"] = inf if contact else LONGEST_FLIGHT_STEP
    limits["t_eval"] = None if every_step else times
    part = solve_ivp(right, (t, times[-1]), y, method, events=gap, **limits)
    if part.status < 0:
        raise checks.StudyError(f"{method} failed after {t:.9g} s: {part.message}")
    end = (part.t_events[0][0], part.y_events[0][0]) if part.status == 1 else None
    return part.t, np.ascontiguousarray(np.transpose(part.y)), end


def _sundials(method, slopes, gap, contact, t, y, times, rtol):
    from sksundae.cvode import CVODE

    def meet(now, y, events):
        events[0] = gap(now, y)

    meet.terminal, meet.direction = [True], [-1 if contact else 1]
    solver = CVODE(
        lambda _, y, out: slopes(y, out),
        rtol=rtol,
        atol=rtol * ABSOLUTE,
        eventsfn=meet,
        num_events=1,
        max_step=0.0 if contact else LONGEST_FLIGHT_STEP,
        max_num_steps=1_000_000,
    )
    part = solver.solve(np.append(t, times), y)
    if not part.success:
        raise checks.StudyError(f"{method} failed after {t:.9g} s: {part.message}")
    inside = part.t > t
    if part.t_events is None or len(part.t_events) == 0:
        return part.t[inside], part.y[inside], None
    end = part.t_events[0], part.y_events[0]
    inside &= part.t < end[0]
    return part.t[inside], part.y[inside], end
