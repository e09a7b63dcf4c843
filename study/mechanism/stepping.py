"""What the compiled loops of all models share: a state, rows of output, impacts, and their blocks.

A loop ``advance(times, rows, impacts)`` fills rows until all are filled, the table of impacts is
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
def record(row, t, crank, slider, coupler, place, forces, energies, law, lost):
    """Fill a row of output.

    ``crank`` and ``slider`` have places, rates and accelerations, ``coupler`` an angle and its
    rate, ``place`` eccentricity and depth, ``forces`` normal, tangential, x and y; ``energies`` are
    work, kinetic energy and that in the links.
    """
    row[:5] = t, crank[0], slider[0], crank[1], slider[1]
    row[5:9] = crank[2], slider[2], coupler[0], coupler[1]
    row[9:12] = place
    row[12:16] = forces
    row[16:19] = energies[0], energies[1], energies[2] + stored_energy(law, place[2])
    row[19:] = lost


@compiled
def begin_impact(impacts, state, t, approach):
    """Begin a row of the impacts."""
    state[CONTACT], state[APPROACH] = 1.0, approach
    lost = state[LOST_DAMPING] + state[LOST_FRICTION]
    impacts[int(state[IMPACTS])] = t, approach, 0.0, 0.0, t, 0.0, 0.0, lost
    state[IMPACTS] += 1


@compiled
def follow_impact(impacts, state, t, force, depth):
    """Bring the last impact's peaks, end and energy lost up to date."""
    impact = impacts[int(state[IMPACTS]) - 1]
    impact[PEAK_FORCE] = max(impact[PEAK_FORCE], force)
    impact[PEAK_DEPTH] = max(impact[PEAK_DEPTH], depth)
    impact[END] = t
    impact[LOST] = state[LOST_DAMPING] + state[LOST_FRICTION] - impact[LOST_BEFORE]


@compiled
def end_impact(impacts, state, t, speed):
    """Note when and how fast the surfaces part."""
    impact = impacts[int(state[IMPACTS]) - 1]
    impact[END], impact[SEPARATION_SPEED] = t, speed
    state[CONTACT] = 0.0


def divide(times: list[NDArray[np.float64]], step: float) -> tuple[int, float]:
    """Number and length of equal steps, at most ``step``, between equally spaced outputs."""
    spacing = times[0][1] - times[0][0]
    strides = ceil(spacing / step * (1 - 1e-12))
    return strides, spacing / strides


def advance_in_blocks(
    advance: Callable, times: list[NDArray[np.float64]], state: NDArray, scene: Scene, failure: str
) -> Iterator[Block]:
    """Call a model's compiled loop block by block.

    Parameters
    ----------
    advance
        Called with times, rows and impacts; returns how many rows it filled and how it ended.
    times
        Outputs, in blocks.
    state
        Of the loop.
    failure
        What failed, with ``{}`` for the state's `LIMIT`.

    Yields
    ------
    `Block`

    Raises
    ------
    MechanismError
        If the ball goes deeper than one clearance, or the loop fails; says when, and the step.
    """
    impacts = np.zeros((64, 8))
    for block in times:
        rows, done = np.zeros((len(block), len(COLUMNS))), 0
        while done < len(block):
            filled, status = advance(block[done:], rows[done:], impacts)
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
