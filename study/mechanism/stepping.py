"""What the compiled loops of all models share: a state, rows of output, impacts, and their blocks.

A loop fills rows, whose first column has the times, until all are filled, the table of impacts is
full, or it fails; the state lets the next call go on from there.
"""

from collections.abc import Callable, Iterator
from math import ceil

import numpy as np
from numpy.typing import NDArray

from study.checks import StudyError
from study.compiled import compiled
from study.contact.forces import stored_energy
from study.mechanism.response import COLUMNS
from study.mechanism.scene import Scene

FINE, FULL, TOO_DEEP, FAILED = range(4)
LOST_DAMPING, LOST_FRICTION, CONTACT, APPROACH, IMPACTS, STEPS, TIME, STEP, LIMIT = range(6, 15)
"""Places in every model's state; the others are its own."""
STATE = 18  # numbers in it
# Columns of the impacts while they are computed, after time and approach speed
PEAK_FORCE, PEAK_DEPTH, END, SEPARATION_SPEED, LOST, LOST_BEFORE = range(2, 8)
Block = tuple[NDArray[np.float64], NDArray[np.float64], bool]
"""Rows of output in the order of `COLUMNS`; the impacts so far, with the end's time for the
duration; whether the last of them has ended."""


class MechanismError(StudyError):
    """A simulation that cannot go on; says at which time, and what limit was passed."""


@compiled
def record(row, state, law, crank, slider, coupler, place, forces, energies):
    """Fill a row of output, which has its time already.

    ``crank`` and ``slider`` have places, rates and accelerations, ``coupler`` an angle and its
    rate, ``place`` eccentricity and depth, ``forces`` normal, tangential, x and y; ``energies`` are
    work, kinetic energy and that in the links.
    """
    row[1:5] = crank[0], slider[0], crank[1], slider[1]
    row[5:9] = crank[2], slider[2], coupler[0], coupler[1]
    row[9:12] = place
    row[12:16] = forces
    row[16:19] = energies[0], energies[1], energies[2] + stored_energy(law, place[2])
    row[19:] = state[LOST_DAMPING], state[LOST_FRICTION]


@compiled
def begin_impact(impacts, state, t, approach):
    """Begin a row of the impacts."""
    state[CONTACT], state[APPROACH] = 1.0, approach
    lost = state[LOST_DAMPING] + state[LOST_FRICTION]
    impacts[int(state[IMPACTS])] = t, approach, 0.0, 0.0, t, 0.0, 0.0, lost
    state[IMPACTS] += 1


@compiled
def follow_impact(impacts, state, force, depth):
    """Bring the last impact's peaks, end and energy lost up to date."""
    impact = impacts[int(state[IMPACTS]) - 1]
    impact[PEAK_FORCE] = max(impact[PEAK_FORCE], force)
    impact[PEAK_DEPTH] = max(impact[PEAK_DEPTH], depth)
    impact[END] = state[TIME]
    impact[LOST] = state[LOST_DAMPING] + state[LOST_FRICTION] - impact[LOST_BEFORE]


@compiled
def end_impact(impacts, state, speed):
    """Note when and how fast the surfaces part."""
    impact = impacts[int(state[IMPACTS]) - 1]
    impact[END], impact[SEPARATION_SPEED] = state[TIME], speed
    state[CONTACT] = 0.0


def divide(times: list[NDArray[np.float64]], step: float) -> tuple[int, float]:
    """Number and length of equal steps, at most ``step``, between equally spaced outputs."""
    spacing = times[0][1] - times[0][0]
    strides = ceil(spacing / step * (1 - 1e-12))
    return strides, spacing / strides


def advance_in_blocks(
    advance: Callable, times: list[NDArray[np.float64]], state: NDArray, scene: Scene, failure: str
) -> Iterator[Block]:
    """Blocks of output rows at ``times``, themselves in blocks, from a model's compiled loop.

    ``advance`` is called with rows and impacts, and returns how many rows it filled and how it
    ended. ``failure`` is the error's text if it failed, with ``{}`` for the state's `LIMIT`.
    Raises `MechanismError` then, and if the ball goes deeper than one clearance.
    """
    impacts = np.zeros((64, 8))
    for block in times:
        rows, done = np.zeros((len(block), len(COLUMNS))), 0
        rows[:, 0] = block
        while done < len(block):
            filled, status = advance(rows[done:], impacts)
            done += filled
            if status == FULL:
                impacts = np.vstack([impacts, np.zeros_like(impacts)])
            elif status != FINE:
                what = f"the depth must stay <= one clearance ({scene.clearance:g} m)"
                if status == FAILED:
                    what = failure.format(state[LIMIT])
                at = f"time {state[TIME]:.9g} s, step {state[STEP]:.4g} s"
                raise MechanismError(f"{what}; stopped at {at}")
        yield rows, impacts[: int(state[IMPACTS]), :LOST_BEFORE].copy(), state[CONTACT] == 0
