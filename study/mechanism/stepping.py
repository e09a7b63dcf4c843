"""What the compiled loops of all models share: a state, rows of output, impacts, and their blocks.

A loop fills rows, whose first column has the times. It ends when all are filled, after a number of
steps, when the table of impacts is full, or when it fails; the next call goes on from the state.
Each impact has three rows of output of its own, as output at equal times hides impacts.
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
LOST_DAMPING, LOST_FRICTION, CONTACT, APPROACH, IMPACTS, AT_HAND = range(4, 10)
STEPS, UNTIL, TIME, STEP, LIMIT = range(10, 15)
"""Places in every model's state; the first four are the model's own. `AT_HAND` is the number of the
impact that is followed, `IMPACTS` the number of impacts so far. A loop returns when `STEPS`, the
number of steps so far, is `UNTIL`."""
_STATE = 15  # numbers in it
PATIENCE = 0.1  # s, after which a compiled loop returns, so that an interruption is noticed
# Columns of the impacts while they are computed, after time and approach speed
PEAK_FORCE, PEAK_DEPTH, DURATION, SEPARATION_SPEED, LOST, LOST_BEFORE, JOINT = range(2, 9)
START, PEAK, END = np.arange(len(EVENTS))
"""Places of an impact's rows of output, in the order of `EVENTS`; from NumPy, as in `locating`."""
DEPTH, ELASTIC, CRANK_DEPTH = (
    list(ALL_COLUMNS).index(name) for name in ("depth", "elastic", "crank_joint_depth")
)
Block = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""Rows of output so far, in the order of `COLUMNS`; the impacts' numbers; and their own rows of
output, shape (impacts, 3, columns), NaN for an end that is still to come."""


class MechanismError(StudyError):
    """A simulation that cannot go on; says when, and which limit was passed."""


@compiled
def record(row, crank, slider, coupler, place, forces, energies):
    """Fill a row of output, which has its time already.

    ``crank`` and ``slider`` are place, rate and acceleration, and for the crank the driving moment.
    ``coupler`` is its angle and rate, ``place`` the eccentricity and depth, ``forces`` the normal
    and tangential force and the components along x and y. ``energies`` are the work, the kinetic
    energy, the elastic energy of the links, and the losses to damping and friction.
    """
    row[1], row[2], row[3], row[4] = crank[0], slider[0], crank[1], slider[1]
    row[5], row[6], row[7], row[8] = crank[2], slider[2], coupler[0], coupler[1]
    row[9], row[10], row[11] = place
    row[12], row[13], row[14], row[15] = forces
    row[16], row[17], row[18], row[19], row[20] = energies
    row[21] = crank[3]  # one by one: a slice takes seconds to compile


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
    """Bring the current impact up to date; say if the force is its largest so far."""
    impact = impacts[int(state[AT_HAND])]
    largest = force > impact[PEAK_FORCE]
    impact[PEAK_FORCE] = max(impact[PEAK_FORCE], force)
    impact[PEAK_DEPTH] = max(impact[PEAK_DEPTH], depth)
    impact[DURATION] = state[TIME] - impact[0]
    impact[LOST] = state[LOST_DAMPING] + state[LOST_FRICTION] - impact[LOST_BEFORE]
    return largest


@compiled
def end_impact(impacts, state, speed):
    """Keep when and how fast the surfaces part."""
    impact = impacts[int(state[AT_HAND])]
    impact[DURATION], impact[SEPARATION_SPEED] = state[TIME] - impact[0], speed
    state[CONTACT] = 0.0


@compiled
def add_stored_energy(rows, laws):
    """Add the joints' elastic energy to rows of output, after the loops.

    The laws are those of the clearance joints, slider's and crank's.
    """
    for row in rows:
        row[ELASTIC] += stored_energy(laws[0], row[DEPTH])
        if len(laws) > 1:
            row[ELASTIC] += stored_energy(laws[-1], row[CRANK_DEPTH])


def new_impacts(number: int, columns: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Empty tables for a number of impacts, and for their rows of output (NaN)."""
    return np.zeros((number, JOINT + 1)), np.full((number, len(EVENTS), columns), np.nan)


def divide(times: NDArray[np.float64], step: float) -> tuple[int, float]:
    """Number and length of equal steps, at most ``step``, between equally spaced outputs."""
    spacing = times[1] - times[0]
    strides = ceil(spacing / step * (1 - 1e-12))
    return strides, spacing / strides


def new_state() -> NDArray[np.float64]:
    """A model's state at the start; its loop goes on until all rows are filled."""
    state = np.zeros(_STATE)
    state[UNTIL] = np.inf
    return state


def advance_in_blocks(
    advance: Callable,
    times: NDArray[np.float64],
    state: NDArray,
    failure: str,
    columns: int = len(COLUMNS),
) -> Iterator[Block]:
    """Growing blocks of the rows of output at ``times``, from a model's compiled loop.

    ``advance`` takes rows, impacts and the impacts' rows, and returns how many rows it filled and
    how it ended. It is called for as many steps as take about `PATIENCE`, so that an interruption
    is noticed. ``columns`` is their number in a row. Raises `MechanismError` with the text
    ``failure``, in which ``{}`` stands for the state's `LIMIT`, if ``advance`` failed; and with
    another text if a ball goes deeper than one clearance.
    """
    impacts, events = new_impacts(64, columns)
    rows = np.zeros((len(times), columns))
    rows[:, 0] = times
    done, some = 0, 10
    while done < len(rows):
        start, state[UNTIL] = perf_counter(), state[STEPS] + some
        filled, status = advance(rows[done:], impacts, events)
        done += filled
        if status == FULL:
            more = zip((impacts, events), new_impacts(len(impacts), columns), strict=True)
            impacts, events = map(np.vstack, more)
            continue
        if status != FINE:
            deep = "the depth must stay <= one clearance ({:g} m)"
            what = (failure if status == FAILED else deep).format(state[LIMIT])
            at = f"time {state[TIME]:.9g} s, step {state[STEP]:.4g} s"
            raise MechanismError(f"{what}; stopped at {at}")
        some = 1 + int(some * min(10.0, PATIENCE / (perf_counter() - start)))
        number = int(state[IMPACTS])
        yield rows[:done], impacts[:number].copy(), events[:number].copy()
