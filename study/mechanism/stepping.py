"""What the compiled loops of all models share: a state, rows of output, impacts, and their blocks.

A loop fills rows, whose first column has the times, until all are filled, the table of impacts is
full, or it fails; the state lets the next call go on from there. Output at equal times hides
impacts, so each of them has three rows of output of its own: at its start, its largest force and
its end.
"""

from collections.abc import Callable, Iterator
from math import ceil
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from study.checks import StudyError
from study.compiled import compiled
from study.contact.forces import stored_energy
from study.mechanism.response import ALL_COLUMNS, COLUMNS, EVENTS

FINE, FULL, TOO_DEEP, FAILED = range(4)
LOST_DAMPING, LOST_FRICTION, CONTACT, APPROACH, IMPACTS, AT_HAND, STEPS, TIME, STEP, LIMIT = range(
    4, 14
)
"""Places in every model's state; the first four are its own. `AT_HAND` is the number of the impact
that is followed, `IMPACTS` how many there were."""
STATE = 14  # numbers in it
PATIENCE = 0.1  # s, that a compiled loop may take until an interruption is heeded
# Columns of the impacts while they are computed, after time and approach speed
PEAK_FORCE, PEAK_DEPTH, DURATION, SEPARATION_SPEED, LOST, LOST_BEFORE, JOINT = range(2, 9)
START, PEAK, END = range(len(EVENTS))
"""Places of an impact's rows of output, in the order of `EVENTS`."""
DEPTH, ELASTIC, CRANK_DEPTH = (
    list(ALL_COLUMNS).index(name) for name in ("depth", "elastic", "crank_joint_depth")
)
Block = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""Rows of output so far, in the order of `COLUMNS`; the impacts, each with its numbers; their own
rows of output, shape (impacts, 3, columns), NaN where an end is still to come."""


class MechanismError(StudyError):
    """A simulation that cannot go on; says at which time, and what limit was passed."""


@compiled
def record(row, crank, slider, coupler, place, forces, energies):
    """Fill a row of output, which has its time already.

    ``crank`` and ``slider`` have places, rates and accelerations, after which ``crank`` has the
    driving moment; ``coupler`` has an angle and its rate, ``place`` eccentricity and depth,
    ``forces`` normal, tangential, x and y; ``energies`` are work, kinetic energy, that in the
    links, and those lost to damping and friction.
    """
    row[1], row[2], row[3], row[4] = crank[0], slider[0], crank[1], slider[1]
    row[5], row[6], row[7], row[8] = crank[2], slider[2], coupler[0], coupler[1]
    row[9], row[10], row[11] = place
    row[12], row[13], row[14], row[15] = forces
    row[16], row[17], row[18], row[19], row[20] = energies
    row[21] = crank[3]  # place by place: compiled code for a slice takes seconds to make


@compiled
def record_crank_joint(row, place, forces):
    """Fill a row's columns of the joint of crank and coupler, as those of the other joint."""
    row[22], row[23], row[24] = place
    row[25], row[26], row[27], row[28] = forces


@compiled
def event_row(events, state, which):
    """Row of output of the impact's `START`, `PEAK` or `END`, with the state's time in it."""
    row = events[int(state[AT_HAND]), which]
    row[0] = state[TIME]
    return row


@compiled
def begin_impact(impacts, state, t, approach):
    """Begin a row of the impacts."""
    state[CONTACT], state[APPROACH] = 1.0, approach
    lost = state[LOST_DAMPING] + state[LOST_FRICTION]
    impact = impacts[int(state[IMPACTS])]
    impact[:] = 0.0
    impact[0], impact[1], impact[SEPARATION_SPEED], impact[LOST_BEFORE] = t, approach, np.nan, lost
    state[AT_HAND] = state[IMPACTS]
    state[IMPACTS] += 1


@compiled
def follow_impact(impacts, state, force, depth):
    """Bring the impact at hand up to date; whether the force is its largest so far."""
    impact = impacts[int(state[AT_HAND])]
    largest = force > impact[PEAK_FORCE]
    impact[PEAK_FORCE] = max(impact[PEAK_FORCE], force)
    impact[PEAK_DEPTH] = max(impact[PEAK_DEPTH], depth)
    impact[DURATION] = state[TIME] - impact[0]
    impact[LOST] = state[LOST_DAMPING] + state[LOST_FRICTION] - impact[LOST_BEFORE]
    return largest


@compiled
def end_impact(impacts, state, speed):
    """Note when and how fast the surfaces part."""
    impact = impacts[int(state[AT_HAND])]
    impact[DURATION], impact[SEPARATION_SPEED] = state[TIME] - impact[0], speed
    state[CONTACT] = 0.0


@compiled
def add_stored_energy(rows, laws):
    """Add what the joints store to the elastic energy in rows of output: not in the loops.

    The laws are those of the clearance joints, slider's and crank's.
    """
    for row in rows:
        row[ELASTIC] += stored_energy(laws[0], row[DEPTH])
        if len(laws) > 1:
            row[ELASTIC] += stored_energy(laws[-1], row[CRANK_DEPTH])


def new_impacts(number: int, columns: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Room for a number of impacts, and for their rows of output, NaN where there is none yet."""
    return np.zeros((number, JOINT + 1)), np.full((number, len(EVENTS), columns), np.nan)


def divide(times: NDArray[np.float64], step: float) -> tuple[int, float]:
    """Number and length of equal steps, at most ``step``, between equally spaced outputs."""
    spacing = times[1] - times[0]
    strides = ceil(spacing / step * (1 - 1e-12))
    return strides, spacing / strides


def advance_in_blocks(
    advance: Callable,
    times: NDArray[np.float64],
    state: NDArray,
    failure: str,
    columns: int = len(COLUMNS),
) -> Iterator[Block]:
    """Rows of output at ``times`` up to now, again and again, from a model's compiled loop.

    ``advance`` is called with rows, impacts and the impacts' rows, and returns how many rows it
    filled and how it ended. It is called for as many rows as take some `PATIENCE`, after which an
    interruption is heeded. ``failure`` is the error's text if it failed, with ``{}`` for the
    state's `LIMIT`. Raises `MechanismError` then, and if a ball goes deeper than one clearance,
    which is then the limit. ``columns`` is the number of them in a row of output.
    """
    impacts, events = new_impacts(64, columns)
    rows = np.zeros((len(times), columns))
    rows[:, 0] = times
    done, some = 0, 1 + len(rows) // 100
    while done < len(rows):
        first, start = done, perf_counter()
        while done < min(first + some, len(rows)):
            filled, status = advance(rows[done : first + some], impacts, events)
            done += filled
            if status == FULL:
                more = zip((impacts, events), new_impacts(len(impacts), columns), strict=True)
                impacts, events = map(np.vstack, more)
            elif status != FINE:
                what = (
                    failure if status == FAILED else "the depth must stay <= one clearance ({:g} m)"
                )
                what = what.format(state[LIMIT])
                at = f"time {state[TIME]:.9g} s, step {state[STEP]:.4g} s"
                raise MechanismError(f"{what}; stopped at {at}")
        some = 1 + int(some * min(10.0, PATIENCE / (perf_counter() - start)))
        number = int(state[IMPACTS])
        yield rows[:done], impacts[:number].copy(), events[:number].copy()
