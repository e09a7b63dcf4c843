"""What a simulation gives: the motion, the joint, the impacts and the energies, by time."""

from dataclasses import dataclass
from math import ceil

import numpy as np
import pandas as pd

from study import paths
from study.checks import StudyError

COLUMNS = {
    "time": "s",
    "crank_angle": "rad",
    "slider_position": "m",
    "crank_speed": "rad/s",
    "slider_velocity": "m/s",
    "crank_acceleration": "rad/s^2",
    "slider_acceleration": "m/s^2",
    "coupler_angle": "rad",
    "coupler_speed": "rad/s",
    "eccentricity_x": "m",
    "eccentricity_y": "m",
    "depth": "m",
    "normal_force": "N",
    "tangential_force": "N",
    "force_x": "N",
    "force_y": "N",
    "work": "J",
    "kinetic": "J",
    "elastic": "J",
    "lost_damping": "J",
    "lost_friction": "J",
}
IMPACT_COLUMNS = {
    "time": "s",
    "approach_speed": "m/s",
    "peak_force": "N",
    "peak_depth": "m",
    "duration": "s",
    "separation_speed": "m/s",
    "lost": "J",
}


class MechanismError(StudyError):
    """A simulation that cannot go on; says at which time, and what limit was passed."""


# What the models' compiled loops have in common: how they end, and where their state tells of
# the contact and of the number of impacts
FINE, TOO_DEEP, FULL, FAILED = range(4)
CONTACT, IMPACTS = -2, -1


def divide(times, step):
    """Number and length of equal steps, at most ``step``, between equally spaced outputs."""
    spacing = times[0][1] - times[0][0]
    strides = ceil(spacing / step * (1 - 1e-12))
    return strides, spacing / strides


def advance_in_blocks(advance, times, state, scene, clock, failure):
    """Call a model's compiled loop, block by block.

    Parameters
    ----------
    advance : callable
        ``advance(times, rows, impacts)`` fills rows, goes on with the impacts, and returns the
        number of rows filled, how it ended, and a number that belongs to a failure.
    times : list of ndarray
        Outputs, in blocks.
    state : ndarray
        Of the loop.
    scene : study.mechanism.scene.Scene
    clock : callable
        Gives the time reached and the last step, in s.
    failure : callable
        ``failure(number)`` says what failed.

    Yields
    ------
    rows : ndarray, shape (n, 21)
        In the order of `COLUMNS`, one block.
    impacts : ndarray, shape (m, 7)
        All so far, in the order of `IMPACT_COLUMNS`, with the end's time for the duration.
    ended : bool
        Whether the last of them has ended.

    Raises
    ------
    MechanismError
        If the ball goes deeper than one clearance, or the loop fails; says when, and the step.
    """
    impacts = np.zeros((64, 8))
    for block in times:
        rows, done = np.zeros((len(block), len(COLUMNS))), 0
        while done < len(block):
            part, status, number = advance(block[done:], rows[done:], impacts)
            done += part
            if status == FULL:
                impacts = np.vstack([impacts, np.zeros_like(impacts)])
            elif status != FINE:
                what = f"the depth must stay <= one clearance ({scene.clearance:g} m)"
                if status == FAILED:
                    what = failure(number)
                time, step = clock()
                raise MechanismError(f"{what}; stopped at time {time:.9g} s, step {step:.4g} s")
        yield rows, impacts[: int(state[IMPACTS]), :7].copy(), state[CONTACT] == 0


@dataclass(frozen=True)
class Response:
    """Motion of the mechanism at equally spaced times.

    Attributes
    ----------
    motion : pandas.DataFrame
        Columns of `COLUMNS`, SI units. Places of slider and crank count from the crank's axis;
        the eccentricity is the ball's centre from the socket's; ``depth`` is negative in
        flight; ``force_x``, ``force_y`` act on the slider; for an ideal joint ``normal_force``
        is the size of that force. ``work`` is that of drive and gravity since t = 0. In contact
        ``normal_force`` may fall below 0, see ``study.contact.forces.joint_forces``.
    impacts : pandas.DataFrame
        Columns of `IMPACT_COLUMNS`, a row per contact. For one that has not ended,
        ``separation_speed`` is missing (NaN), and ``duration`` and ``lost`` are those so far.
    complete : bool
        False if the simulation was interrupted.
    """

    motion: pd.DataFrame
    impacts: pd.DataFrame
    complete: bool = True

    def __getattr__(self, name):
        if name in COLUMNS:
            return self.motion[name].to_numpy()
        raise AttributeError(name)

    @property
    def energy_error(self):
        """Largest change of work - kinetic - elastic - lost, over the largest of these energies."""
        parts = self.motion[["work", "kinetic", "elastic", "lost_damping", "lost_friction"]]
        rest = parts.work - parts.drop(columns="work").sum(axis=1)
        largest = float(parts.abs().to_numpy().max())
        return float((rest - rest.iloc[0]).abs().max()) / largest if largest > 0 else 0.0

    def save(self, path):
        """Write the motion as CSV, whole or not at all.

        Parameters
        ----------
        path : pathlib.Path
        """
        with paths.whole(path) as temporary:
            self.motion.to_csv(temporary, index=False, float_format="%.12g", lineterminator="\n")


def collect(blocks, impacts, ended, complete):
    """Make a `Response` of rows of numbers.

    Parameters
    ----------
    blocks : list of ndarray, shapes (n, 21)
        Rows in the order of `COLUMNS`.
    impacts : ndarray, shape (m, 7)
        In the order of `IMPACT_COLUMNS`, with the end's time for the duration.
    ended : bool
        Whether the last impact has ended.
    complete : bool
    """
    motion = pd.DataFrame(np.vstack(blocks), columns=list(COLUMNS))
    motion["work"] -= motion["work"].iloc[0]
    table = pd.DataFrame(impacts, columns=list(IMPACT_COLUMNS))
    table["duration"] -= table["time"]
    if not ended:
        table.loc[len(table) - 1, "separation_speed"] = np.nan
    return Response(motion, table, complete)
