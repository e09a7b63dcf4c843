"""What a simulation gives: the motion, the joint, the impacts and the energies, by time."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from study import paths

if TYPE_CHECKING:
    import pandas as pd

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


@dataclass(frozen=True)
class Response:
    """Motion of the mechanism at equally spaced times; every column of `motion` is an attribute.

    Attributes
    ----------
    rows : shape (n, 21)
        In the order of `COLUMNS`.
    impact_rows : shape (m, 7)
        In the order of `IMPACT_COLUMNS`.
    complete
        False if the simulation was interrupted.
    """

    rows: NDArray[np.float64]
    impact_rows: NDArray[np.float64]
    complete: bool = True

    @cached_property
    def motion(self) -> "pd.DataFrame":
        """Columns of `COLUMNS`, SI units.

        Places of slider and crank count from the crank's axis; the eccentricity is the ball's
        centre from the socket's; ``depth`` is negative in flight; ``force_x``, ``force_y`` act
        on the slider; for an ideal joint ``normal_force`` is the size of that force. ``work`` is
        that of drive and gravity since t = 0. In contact ``normal_force`` may fall below 0, see
        ``study.contact.forces.joint_forces``.
        """
        import pandas as pd

        return pd.DataFrame(self.rows, columns=list(COLUMNS))

    @cached_property
    def impacts(self) -> "pd.DataFrame":
        """Columns of `IMPACT_COLUMNS`, a row per contact.

        For one that has not ended, ``separation_speed`` is missing (NaN), and ``duration`` and
        ``lost`` are those so far.
        """
        import pandas as pd

        return pd.DataFrame(self.impact_rows, columns=list(IMPACT_COLUMNS))

    def __getattr__(self, name: str) -> NDArray[np.float64]:
        if name in COLUMNS:
            return self.rows[:, list(COLUMNS).index(name)]
        raise AttributeError(name)

    @property
    def energy_error(self) -> float:
        """Largest change of work - kinetic - elastic - lost, over the largest of these energies."""
        energies = self.rows[:, list(COLUMNS).index("work") :]
        rest = energies[:, 0] - energies[:, 1:].sum(axis=1)
        largest = float(np.abs(energies).max())
        return float(np.abs(rest - rest[0]).max()) / largest if largest > 0 else 0.0

    @property
    def last_separation(self) -> float:
        """Time at which the surfaces part for the last time, in s; 0 if they never do."""
        start, _, _, _, duration, separation_speed, _ = self.impact_rows.T
        return float((start + duration)[~np.isnan(separation_speed)].max(initial=0.0))

    def save(self, path: Path) -> None:
        """Write the motion as CSV, whole or not at all."""
        with paths.whole(path) as temporary:
            self.motion.to_csv(temporary, index=False, float_format="%.12g", lineterminator="\n")
