"""Results of a simulation over time: motion, joint, impacts and energies.

Rows at equally spaced times are used to compare simulations. Because impacts are shorter than the
intervals between these times, each impact adds rows at its start, its maximum force and its end.
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
    """Motion of the mechanism, as returned by `study.mechanism.simulate`.

    Every name of `columns`, for example ``slider_position``, is also an attribute: an array at the
    n equally spaced output times, in SI units.

    Attributes
    ----------
    rows : shape (n,)
        A record at each output time, with the fields `columns`.
    impact_rows : shape (m,)
        A record for each contact, with the fields ``joint``, ``kind`` and `IMPACT_COLUMNS`.
    event_rows : shape (e,)
        Records like ``rows`` at the start, the maximum normal force and the end of each impact.
    event_kinds
        One of `EVENTS` for each of these records, with ``crank`` before it for the joint between
        crank and coupler.
    complete
        False if the simulation was interrupted.
    law
        The contact law and all of its options, as a text.
    restitution, delivered_restitution
        Coefficient of restitution of a free impact: the given one, and that of the damping model.
    tolerance
        Tolerance of the time integration; None for a model without one.
    clearances
        Clearances in m of the joints at the slider and at the crank, if they are clearance joints.

    Examples
    --------
    >>> from study.mechanism import simulate
    >>> response = simulate(duration=0.01)
    >>> response.slider_position.shape, response.impacts.kind.iloc[0]
    ((1001,), 'impact')
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
        """Table of the `columns`, in SI units, at the output times and at the events of impacts.

        The last column, ``event``, is empty at output times. At events it is one of `EVENTS`, for
        example ``peak`` for the joint at the slider and ``crank peak`` for the joint at the crank.
        A contact that has not ended has no end. For links of particles and beams the events are the
        first step in contact, the step of the maximum force, and the first step out of contact.

        Positions are measured from the axis of the crank. The eccentricity is the vector from the
        centre of the socket to the centre of the ball. ``depth`` is negative without contact.
        ``force_x`` and ``force_y`` act on the body with the socket (slider or coupler);
        ``normal_force`` of an ideal joint is the magnitude of this force, and in contact it may be
        negative (`study.contact.forces.joint_forces`). ``work`` is the work of drive and gravity
        since t = 0. ``elastic`` and the losses are sums over all joints and links.
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
        """The ``impact_rows`` as a table, with a row for each contact.

        For a contact that has not ended, ``separation_speed`` is missing (NaN), and ``duration``
        and ``lost`` are the values so far. ``free_duration`` is the duration of an elastic impact
        with the same approach speed between the same rigid links, without other forces. A contact
        that lasts more than `SUSTAINED` times as long has the kind ``sustained``, because the
        forces of the mechanism then press the bodies together; any other is an ``impact`` (this
        study).
        """
        import pandas as pd

        return pd.DataFrame(self.impact_rows)

    @property
    def energy_error(self) -> float:
        """Maximum change of work - kinetic - elastic - lost, divided by the maximum of these."""
        lost = self.lost_damping, self.lost_friction
        energies = np.column_stack([self.work, self.kinetic, self.elastic, *lost])
        rest = self.work - energies[:, 1:].sum(axis=1)
        largest = float(np.abs(energies).max())
        return float(np.abs(rest - rest[0]).max()) / largest if largest > 0 else 0.0

    @property
    def last_separation(self) -> float:
        """Time of the last separation of the surfaces, in s; 0 if they never separate."""
        impacts = self.impact_rows
        ended = impacts[~np.isnan(impacts["separation_speed"])]
        return float((ended["time"] + ended["duration"]).max(initial=0.0))

    def save(self, path: Path) -> None:
        """Write the `motion` to a CSV file, completely or not at all; pandas is not needed."""
        with paths.whole(path) as temporary, open(temporary, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([*self.columns, "event"])
            for row, kind in zip(*self._in_order_of_time(), strict=True):
                numbers = ("" if np.isnan(number) else f"{number:.12g}" for number in row)
                writer.writerow([*numbers, kind])
