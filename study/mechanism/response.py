"""Results of a simulation over time: motion, joint, impacts and energies.

Rows at equal times serve comparisons. They hide impacts, which are short: so each impact adds rows
at its start, its largest force and its end.
"""

import csv
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from study import paths

if TYPE_CHECKING:
    import pandas as pd

_OF_JOINT = {
    "eccentricity_x": "m",
    "eccentricity_y": "m",
    "depth": "m",
    "normal_force": "N",
    "tangential_force": "N",
    "force_x": "N",
    "force_y": "N",
}
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
    **_OF_JOINT,
    "work": "J",
    "kinetic": "J",
    "elastic": "J",
    "lost_damping": "J",
    "lost_friction": "J",
    "driving_moment": "N m",
}
CRANK_COLUMNS = {f"crank_joint_{name}": unit for name, unit in _OF_JOINT.items()}
"""Columns of rigid links only: the joint between crank and coupler, which may be ideal."""
ALL_COLUMNS = COLUMNS | CRANK_COLUMNS
EVENTS = ("start", "peak", "end")
"""Kinds of an impact's own rows: first contact, largest normal force, separation."""
JOINTS = ("slider", "crank")
"""Clearance joints, by what they join to the coupler."""
IMPACT_COLUMNS = {
    "time": "s",
    "approach_speed": "m/s",
    "peak_force": "N",
    "peak_depth": "m",
    "duration": "s",
    "separation_speed": "m/s",
    "lost": "J",
    "free_duration": "s",
}
SUSTAINED = 10.0
"""A contact that lasts this many times a free impact of its approach speed is not an impact."""
OUTPUT = np.dtype([(name, float) for name in ALL_COLUMNS])
"""A row of output; flexible links leave `CRANK_COLUMNS` at 0."""
IMPACT_ROW = np.dtype(
    [("joint", "U6"), ("kind", "U9"), *((name, float) for name in IMPACT_COLUMNS)]
)


@dataclass(frozen=True)
class Response:
    """Motion of the mechanism; every column is an attribute, at equally spaced times.

    Attributes
    ----------
    rows : shape (n,)
        A record at each time, with the fields `columns`.
    impact_rows : shape (m,)
        A record for each contact, with the fields ``joint``, ``kind`` and `IMPACT_COLUMNS`.
    event_rows : shape (e,)
        At each impact's start, largest normal force and end, as ``rows``.
    event_kinds
        One of `EVENTS` for each of these, after ``crank`` for the joint of crank and coupler.
    complete
        False if the simulation was interrupted.
    law
        The contact law and all of its options, in words.
    restitution, delivered_restitution
        Of a free impact: asked for in the scene, and what its damping delivers.
    tolerance
        Of the steps; None for a model without one.
    clearances
        Of slider's and crank's joint, in m, where they have one.
    """

    rows: NDArray[np.void]
    impact_rows: NDArray[np.void]
    event_rows: NDArray[np.void]
    event_kinds: tuple[str, ...]
    complete: bool = True
    law: str = ""
    restitution: float = 1.0
    delivered_restitution: float = 1.0
    tolerance: float | None = None
    clearances: tuple[float, ...] = ()

    @property
    def columns(self) -> dict[str, str]:
        """Columns and their units: `COLUMNS`, and for rigid links `CRANK_COLUMNS`."""
        return {name: ALL_COLUMNS[name] for name in self.rows.dtype.names or ()}

    def __getattr__(self, name: str) -> NDArray[np.float64]:
        if name in ALL_COLUMNS and name in self.columns:
            return self.rows[name]
        raise AttributeError(name)

    @cached_property
    def motion(self) -> "pd.DataFrame":
        """The `columns`, SI units, at equally spaced times and at each impact's events.

        The last column, ``event``, is empty at equally spaced times. Else it is one of `EVENTS`:
        ``peak`` for the slider's joint, ``crank peak`` for the crank's. A contact that goes on has
        no end. Links of particles and beams give the first step in contact, the step of the largest
        force, and the first step out of contact.

        Places are measured from the crank's axis. The eccentricity is the vector from the socket's
        centre to the ball's. ``depth`` is negative in flight. ``force_x`` and ``force_y`` act on
        the body with the socket, slider or coupler; ``normal_force`` of an ideal joint is the size
        of that force, and in contact it may fall below 0 (`study.contact.forces.joint_forces`).
        ``work`` is that of drive and gravity since t = 0. ``elastic`` and losses are sums over all
        joints and links.
        """
        import pandas as pd

        rows, kinds = self._in_order_of_time()
        return pd.DataFrame(rows).assign(event=kinds)

    def _in_order_of_time(self):
        """Rows of events and of equally spaced times, and the kind of each."""
        rows = np.concatenate([self.event_rows, self.rows])
        kinds = np.array(self.event_kinds + ("",) * len(self.rows), dtype=object)
        order = np.argsort(rows["time"], kind="stable")
        return rows[order], kinds[order]

    @cached_property
    def impacts(self) -> "pd.DataFrame":
        """The ``impact_rows`` as a table, a row for each contact.

        For one that has not ended, ``separation_speed`` is missing (NaN), and ``duration`` and
        ``lost`` are those so far. ``free_duration`` is that of an elastic impact of the same
        approach speed between the same rigid links, without other forces. A contact more than
        `SUSTAINED` times as long has the kind ``sustained``: the mechanism's forces then press the
        bodies together. Any other is an ``impact`` (this study).
        """
        import pandas as pd

        return pd.DataFrame(self.impact_rows)

    @property
    def energy_error(self) -> float:
        """Largest change of work - kinetic - elastic - lost, over the largest of these."""
        lost = self.lost_damping, self.lost_friction
        energies = np.column_stack([self.work, self.kinetic, self.elastic, *lost])
        rest = self.work - energies[:, 1:].sum(axis=1)
        largest = float(np.abs(energies).max())
        return float(np.abs(rest - rest[0]).max()) / largest if largest > 0 else 0.0

    @property
    def last_separation(self) -> float:
        """Time at which the surfaces part for the last time, in s; 0 if they never do."""
        impacts = self.impact_rows
        ended = impacts[~np.isnan(impacts["separation_speed"])]
        return float((ended["time"] + ended["duration"]).max(initial=0.0))

    def save(self, path: Path) -> None:
        """Write the motion as CSV, whole or not at all; without pandas, which may be missing."""
        with paths.whole(path) as temporary, open(temporary, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([*self.columns, "event"])
            for row, kind in zip(*self._in_order_of_time(), strict=True):
                numbers = ("" if np.isnan(number) else f"{number:.12g}" for number in row)
                writer.writerow([*numbers, kind])
