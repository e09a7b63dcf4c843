"""What the compiled loops of all models share: a state, rows of output, impacts, and their blocks.

A loop fills rows, which have their times. It ends when all are filled, after a number of steps,
when the table of impacts is full, or when it fails; the next call goes on from the state.
"""

from collections import namedtuple
from collections.abc import Callable, Iterator
from math import ceil
from time import perf_counter
from typing import Any

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured
from numpy.typing import NDArray

from study.checks import StudyError
from study.compiled import compiled
from study.contact.forces import stored_energy
from study.mechanism.response import EVENTS, IMPACT_COLUMNS, OUTPUT

FINE, FULL, TOO_DEEP, FAILED = range(4)  # how a loop ends
PATIENCE = 0.1  # s, after which a compiled loop returns, so that an interruption is noticed
START, PEAK, END = np.arange(len(EVENTS))
"""Places of an impact's rows of output, in the order of `EVENTS`; from NumPy, as in `events`."""
IMPACT = np.dtype([(name, float) for name in (*IMPACT_COLUMNS, "lost_before")])
STATE = [
    *((name, float) for name in ("time", "step", "until", "limit", "approach")),
    *((name, float) for name in ("lost_damping", "lost_friction", "holding", "power", "work")),
    *((name, np.int64) for name in ("steps", "impacts", "current_impact")),
    ("contact", bool),
]
"""Fields of every model's state. A loop returns when ``steps``, the number of steps so far, is
``until``. ``holding`` is the moment that holds a constant crank speed; ``power`` and ``work`` are
those of the loads without their energies. ``limit`` is what a failure passed, ``impacts`` the
number of impacts so far, and ``current_impact`` the number of the one that is followed."""
Block = tuple[NDArray[np.void], NDArray[np.void], NDArray[np.void]]
"""Rows of output so far; the impacts' numbers (`IMPACT`); and their own rows of output, shape
(impacts, 3), NaN for an end that is still to come."""


class MechanismError(StudyError):
    """A simulation that cannot go on; says when, and which limit was passed.

    Its ``response`` has the results up to then; None if there are none.
    """

    response: Any = None


JointOutput = namedtuple(
    "JointOutput", "eccentricity_x eccentricity_y depth normal tangential force_x force_y"
)
"""What a row of output has of a joint."""


@compiled
def write_joint(row, joint):
    """Fill a row's columns of the joint of coupler and slider."""
    row.eccentricity_x, row.eccentricity_y = joint.eccentricity_x, joint.eccentricity_y
    row.depth, row.normal_force, row.tangential_force = joint.depth, joint.normal, joint.tangential
    row.force_x, row.force_y = joint.force_x, joint.force_y


@compiled
def event_row(events, state, which):
    """Row of output of the impact's `START`, `PEAK` or `END`, with the state's time in it."""
    row = events[state.current_impact, which]
    row.time = state.time
    return row


@compiled
def begin_impact(impacts, state, t, approach):
    """Begin a row of the impacts."""
    state.contact, state.approach = True, approach
    impact = impacts[state.impacts]
    impact.time, impact.approach_speed, impact.separation_speed = t, approach, np.nan
    impact.lost_before = state.lost_damping + state.lost_friction
    state.current_impact = state.impacts
    state.impacts += 1


@compiled
def follow_impact(impacts, state, force, depth):
    """Bring the current impact up to date; say if the force is its largest so far."""
    impact = impacts[state.current_impact]
    largest = force > impact.peak_force
    impact.peak_force = max(impact.peak_force, force)
    impact.peak_depth = max(impact.peak_depth, depth)
    impact.duration = state.time - impact.time
    impact.lost = state.lost_damping + state.lost_friction - impact.lost_before
    return largest


@compiled
def end_impact(impacts, state, speed):
    """Keep when and how fast the surfaces part."""
    impact = impacts[state.current_impact]
    impact.duration, impact.separation_speed = state.time - impact.time, speed
    state.contact = False


@compiled
def add_work(state, power, h):
    """Add the work of the loads in a step by the trapezoidal rule, and keep their power."""
    state.work += 0.5 * h * (state.power + power)
    state.power = power


@compiled
def add_stored_energy(rows, law):
    """Add the joint's elastic energy to rows of output, after the loops."""
    for row in rows:
        row.elastic += stored_energy(law, row.depth)


def new_impacts(number: int) -> tuple[NDArray[np.void], NDArray[np.void]]:
    """Empty tables for a number of impacts, and for their rows of output (NaN)."""
    return np.zeros(number, IMPACT), np.full((number, len(EVENTS)), np.nan, OUTPUT)


def divide(times: NDArray[np.float64], step: float) -> tuple[int, float]:
    """Number and length of equal steps, at most ``step``, between equally spaced outputs."""
    spacing = times[1] - times[0]
    strides = ceil(spacing / step * (1 - 1e-12))
    return strides, spacing / strides


def new_state(*own: str) -> np.recarray:
    """A model's state at the start, with the numbers of the model; its loop fills all rows."""
    # own fields first: else numba takes loops of a model without any for those of all models
    fields = np.dtype([*((name, float) for name in own), *STATE], align=True)
    (state,) = np.zeros(1, fields).view(np.recarray)
    state.until = np.inf
    return state


def advance_in_blocks(
    advance: Callable, times: NDArray[np.float64], state: np.recarray, failure: str
) -> Iterator[Block]:
    """Growing blocks of the rows of output at ``times``, from a model's compiled loop.

    ``advance`` takes rows, impacts and the impacts' rows, and returns how many rows it filled and
    how it ended. It is called for as many steps as take about `PATIENCE`. If it failed, or filled a
    row with something that is not a finite number, the rows before are the last block, and a
    `MechanismError` follows. Its text is ``failure``, in which ``{}`` is the state's limit.
    """
    impacts, events = new_impacts(64)
    rows = np.zeros(len(times), OUTPUT)
    rows["time"] = times
    done, some = 0, 10
    while done < len(rows):
        start, state.until = perf_counter(), state.steps + some
        tables = (table.view(np.recarray) for table in (rows[done:], impacts, events))
        filled, status = advance(*tables)
        new = structured_to_unstructured(rows[done : done + filled])
        finite = np.isfinite(new).all(axis=1)
        done += int(np.append(finite, False).argmin())
        taken = perf_counter() - start
        if status == FULL and finite.all():
            more = zip((impacts, events), new_impacts(len(impacts)), strict=True)
            impacts, events = map(np.concatenate, more)
            continue
        failed = status != FINE or not finite.all()
        if done > 0 or not failed:
            yield rows[:done], impacts[: state.impacts].copy(), events[: state.impacts].copy()
        if failed:
            time = state.time if finite.all() else rows["time"][done]
            what = f"the penetration depth must stay <= one clearance ({state.limit:g} m)"
            if not finite.all():
                what = "a result is not a finite number"
            elif status == FAILED:
                what = failure.format(state.limit)
            raise MechanismError(
                f"{what}; the simulation stopped at {time:.9g} s with a step of {state.step:.4g} s"
            )
        some = 1 + int(some * min(10.0, PATIENCE / taken))
