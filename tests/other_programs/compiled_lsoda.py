"""LSODA in compiled code, by the package numbalsoda: rigid links with located impacts.

LSODA is given times and returns states there, without events. A piece, which is a flight or a
contact, is therefore integrated to closely spaced times. Where the surfaces touch or part between
two of them, Newton's method finds the time, from the second of the two: the first may be the time
at which the piece began, where the surfaces touch as well.
"""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from other_programs import peaks
from other_programs.odes import ABSOLUTE
from study import checks
from study.measure import explicit
from study.mechanism import Scene

FLIGHT, BEGUN, LATER = (20, 1e-4), (100, 2e-6), (5000, 2e-5)
"""Number and distance in s of the times in a flight, in a contact that has begun, and later."""
MOST_STEPS, CORRECTIONS = 100_000, 6  # between two times; of Newton's method


def largest_forces(
    scene: Scene, law: np.record, duration: float, rtol: float
) -> NDArray[np.float64]:
    """Maximum normal force, and that of the first contact, in N.

    The law is a record (`study.contact.DimensionalLaw.packed`). Raises `study.checks.StudyError` if
    LSODA fails.
    """
    run, address = _program(scene, law.tobytes(), law.dtype)
    found, fine = run(address, explicit.start_of(scene) / ABSOLUTE, duration, rtol)
    if not fine:
        raise checks.StudyError(f"LSODA failed at {rtol:g}")
    return found


@cache
def _program(scene, numbers, dtype) -> Any:
    """The loop over pieces, and the address of the equations, compiled for a scene and a law."""
    import numba
    from numbalsoda import lsoda, lsoda_sig

    laws, p, scales = np.frombuffer(numbers, dtype), scene.constants(), ABSOLUTE.copy()

    @numba.cfunc(lsoda_sig)
    def slopes(_, u, rates, data):
        u, rates, data = numba.carray(u, 6), numba.carray(rates, 6), numba.carray(data, 16)
        y, work, out, approach = data[1:7], data[7:13], data[13:], data[0]
        for i in range(6):
            y[i] = u[i] * scales[i]
        explicit.acceleration(y, approach > 0, approach, p, laws[0], work, out)
        for i in range(3):
            rates[i], rates[3 + i] = y[3 + i] / scales[i], out[i] / scales[3 + i]

    @numba.njit(error_model="numpy")
    def run(address, u, duration, rtol):
        law, data, found, t, begun, contacts = laws[0], np.zeros(16), np.zeros(2), 0.0, 0.0, 0
        while t < duration:
            contact = data[0] > 0
            number, distance = FLIGHT
            if contact:
                number, distance = BEGUN if t == begun else LATER
            times = np.minimum(distance * np.arange(number + 1), duration - t)
            times = times[: np.searchsorted(times, duration - t) + 1]
            scaled, fine = lsoda(address, u, times, data, rtol, rtol, MOST_STEPS)
            if not fine:
                return found, False
            states, kept = scaled * scales, len(times)
            for k in range(1, len(times)):
                gap, _ = peaks.gap_and_rate(states[k], law.clearance)
                if (gap <= 0) == contact:
                    kept = k
                    break
            if contact:
                reached = min(kept + 1, len(times))
                force = peaks.largest(times[:reached], states[:reached], data[0], p, law)
                found[0] = max(found[0], force)
                if contacts == 1:
                    found[1] = max(found[1], force)
            u, t = scaled[kept - 1], t + times[kept - 1]
            if kept == len(times):
                continue
            wait = times[kept] - times[kept - 1]
            for _ in range(CORRECTIONS):
                ends, fine = lsoda(address, u, np.array([0.0, wait]), data, rtol, rtol, MOST_STEPS)
                gap, rate = peaks.gap_and_rate(ends[1] * scales, law.clearance)
                wait -= gap / rate
            u, t = ends[1], t + wait
            data[0], begun = (0.0 if contact else rate), t
            contacts += not contact
        return found, True

    return run, slopes.address
