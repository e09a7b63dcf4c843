"""Results of a simulation over time: motion, joint, impacts and energies.

Rows at equally spaced times are used to compare simulations. Because impacts are shorter than the
intervals between these times, each impact adds rows at its start, its maximum force and its end.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.contact import SOCKET_RATIO, DimensionalLaw
from study.contact.forces import stored_energy
from study.parameters import Quantity, derived

if TYPE_CHECKING:
    import pandas as pd

    from study.mechanism.scene import Scene

COLUMNS = {
    "time": Quantity("Time", "s"),
    "crank_angle": Quantity("Angle of the crank", "rad"),
    "slider_position": Quantity("Position of the slider, from the axis of the crank", "m"),
    "crank_speed": Quantity("Angular velocity of the crank", "rad/s"),
    "slider_velocity": Quantity("Velocity of the slider", "m/s"),
    "crank_acceleration": Quantity("Angular acceleration of the crank", "rad/s^2"),
    "slider_acceleration": Quantity("Acceleration of the slider", "m/s^2"),
    "coupler_angle": Quantity("Angle of the coupler", "rad"),
    "coupler_speed": Quantity("Angular velocity of the coupler", "rad/s"),
    "eccentricity_x": Quantity("Eccentricity: from the socket's centre to the ball's along x", "m"),
    "eccentricity_y": Quantity("The same along y", "m"),
    "depth": Quantity("Penetration depth; negative without contact", "m"),
    "normal_force": Quantity("Normal force; of an ideal joint the magnitude of the force", "N"),
    "tangential_force": Quantity("Friction force", "N"),
    "force_x": Quantity("Force on the body with the socket, along x", "N"),
    "force_y": Quantity("The same along y", "N"),
    "work": Quantity("Work of drive, gravity and other loads since t = 0", "J"),
    "kinetic": Quantity("Kinetic energy", "J"),
    "elastic": Quantity("Elastic energy of all joints and links", "J"),
    "lost_damping": Quantity("Energy lost by damping in the joints", "J"),
    "lost_friction": Quantity("Energy lost by friction in the joints", "J"),
    "driving_moment": Quantity("Moment of the drive", "N m"),
}
CRANK_COLUMNS = {
    "crank_joint_normal_force": Quantity("Magnitude of the force in the ideal crank joint", "N"),
    "crank_joint_force_x": Quantity("Force on the coupler there, along x", "N"),
    "crank_joint_force_y": Quantity("The same along y", "N"),
}
"""Columns of rigid links only: the ideal joint between crank and coupler. The others are `COLUMNS`
of every response."""
ALL_COLUMNS = COLUMNS | CRANK_COLUMNS
EVENTS = ("start", "peak", "end")
"""Kinds of an impact's own rows: first contact, largest normal force, separation."""
IMPACT_COLUMNS = {
    "time": Quantity("Time of first contact", "s"),
    "approach_speed": Quantity("Normal velocity at first contact", "m/s"),
    "peak_force": Quantity("Maximum normal force", "N"),
    "peak_depth": Quantity("Maximum penetration depth", "m"),
    "duration": Quantity("Duration of the contact, so far if it has not ended", "s"),
    "separation_speed": Quantity("Normal velocity at separation; missing before", "m/s"),
    "lost": Quantity("Energy lost by damping and friction, so far if it has not ended", "J"),
    "free_duration": Quantity("Duration of an elastic impact without other forces", "s"),
}
"""Columns of the contacts, by name."""
ENERGIES = "work", "kinetic", "elastic", "lost_damping", "lost_friction"
LEAST_MOVED = 1e-12  # J; rounding alone moves up to about 1e-20 J in flexible links at rest
LEAST_FRACTION = 1e-3  # of the largest energy, that of a crank which turns freely for example
LEAST_OF_CONTACTS = 3e-5  # of the energy that moved; where a ball rests in its socket it is less
CONTACT_ENERGY_LIMIT = 0.25
"""Threshold of ``contact_energy_error``: the largest one, rounded upwards, of those calibration
runs of notebook 26 whose contact force is right (this study)."""
SUSTAINED = 10.0
OUTPUT = np.dtype([(name, float) for name in ALL_COLUMNS])
"""A row of output; flexible links leave `CRANK_COLUMNS` at 0."""
IMPACT_ROW = np.dtype([("kind", "U9"), *((name, float) for name in IMPACT_COLUMNS)])


@dataclass(frozen=True)
class Response:
    """Motion of the mechanism, as returned by `study.mechanism.simulate`.

    Every name of `columns`, for example ``slider_position``, is also an attribute: an array at the
    n equally spaced output times, in SI units.

    Examples
    --------
    >>> from study.mechanism import simulate
    >>> response = simulate(duration=0.01)
    >>> response.slider_position.shape, response.impacts.kind.iloc[0]
    ((1001,), 'impact')
    """

    rows: NDArray[np.void]
    """A record at each output time, with the fields `columns`; shape (n,)."""
    impact_rows: NDArray[np.void]
    """A record for each contact, with the fields ``kind`` and `IMPACT_COLUMNS`."""
    event_rows: NDArray[np.void]
    """Records like ``rows`` at the start, the maximum normal force and the end of each impact."""
    event_kinds: tuple[str, ...]
    """One of `EVENTS` for each of these records."""
    complete: bool = True
    """False if the simulation was interrupted."""
    law: DimensionalLaw | None = None  # None for an ideal joint
    restitution: float = 1.0  # of the scene
    delivered_restitution: float = 1.0  # of a free impact with the damping model
    tolerance: float | None = None  # None for a model without one

    @property
    def columns(self) -> dict[str, Quantity]:
        """The quantities `COLUMNS`, and for rigid links `CRANK_COLUMNS`."""
        return {name: ALL_COLUMNS[name] for name in self.rows.dtype.names or ()}

    def __getattr__(self, name: str) -> NDArray[np.float64]:
        if name in ALL_COLUMNS and name in self.columns:
            return self.rows[name]
        raise AttributeError(name)

    @cached_property
    def motion(self) -> "pd.DataFrame":
        """Table of the `columns`, in SI units, at the output times and at the events of impacts.

        The last column, ``event``, is empty at output times. At events, which are ends of steps for
        flexible links, it is one of `EVENTS`. The normal force in contact may be negative
        (`study.contact.forces.joint_forces`).
        """
        import pandas as pd

        rows = np.concatenate([self.event_rows, self.rows])
        kinds = np.array(self.event_kinds + ("",) * len(self.rows), dtype=object)
        order = np.argsort(rows["time"], kind="stable")
        return pd.DataFrame(rows[order]).assign(event=kinds[order])

    @cached_property
    def impacts(self) -> "pd.DataFrame":
        """The ``impact_rows`` as a table, with a row for each contact.

        A contact that lasts more than `SUSTAINED` times as long as an elastic impact with the same
        approach speed has the kind ``sustained``, because the forces of the mechanism then press
        the bodies together; any other is an ``impact`` (this study).
        """
        import pandas as pd

        return pd.DataFrame(self.impact_rows)

    @derived("Number of contacts")
    def contacts(self) -> int:  # noqa: D102
        return len(self.impact_rows)

    @derived("Maximum penetration depth", "m", "um")
    def largest_depth(self) -> float:  # noqa: D102
        return float(self.impact_rows["peak_depth"].max(initial=0.0))

    @derived("Maximum normal force in the clearance joint", "N")
    def largest_force(self) -> float:  # noqa: D102
        return float(self.impact_rows["peak_force"].max(initial=0.0))

    @derived("Energy lost by damping and friction in the joint", "J")
    def energy_lost(self) -> float:  # noqa: D102
        return float(self.lost_damping[-1] + self.lost_friction[-1])

    @derived("Time of the last separation of the surfaces; 0 if they never separate", "s")
    def last_separation(self) -> float:  # noqa: D102
        impacts = self.impact_rows
        ended = impacts[~np.isnan(impacts["separation_speed"])]
        return float((ended["time"] + ended["duration"]).max(initial=0.0))

    @derived("Maximum residual of the energy balance, over the energy that moved")
    def energy_error(self) -> float:
        """Maximum change of work - kinetic - elastic - lost, over the maximum change of these.

        The latter is at least `LEAST_FRACTION` of the largest energy, and `LEAST_MOVED`.
        """
        residual, moved = self._residual_and_moved
        return residual / moved

    @derived("The same residual, over the elastic energy that all contacts have stored")
    def contact_energy_error(self) -> float:
        """A large one shows an unstable contact; a small one is no proof; 0 without contacts.

        The stored energy is the sum over all contacts of the elastic energy at their maximum depth,
        and at least `LEAST_OF_CONTACTS` of the energy that moved.
        """
        if self.law is None or not len(self.impact_rows):
            return 0.0
        law, (residual, moved) = self.law.packed(), self._residual_and_moved
        stored = sum(stored_energy(law, depth) for depth in self.impact_rows["peak_depth"])
        return residual / max(stored, LEAST_OF_CONTACTS * moved)

    @cached_property
    def _residual_and_moved(self):
        """Maximum residual of the energy balance, and energy that moved, in J."""
        energies = np.column_stack([self.rows[name] for name in ENERGIES])
        rest = energies[:, 0] - energies[:, 1:].sum(axis=1)
        moved = max(np.abs(energies - energies[0]).max(), LEAST_MOVED)
        residual = np.abs(rest - rest[0]).max()
        return float(residual), float(max(moved, LEAST_FRACTION * np.abs(energies).max()))

    @property
    def energy_warning(self) -> str:
        """Sentence if `contact_energy_error` exceeds `CONTACT_ENERGY_LIMIT`, else an empty text."""
        error = self.contact_energy_error
        if error <= CONTACT_ENERGY_LIMIT:
            return ""
        finer = "a smaller step" if self.tolerance is None else "a smaller tolerance"
        return (
            f"The residual of the energy balance is {error:.2g} of the elastic energy that the "
            f"contacts stored (threshold {CONTACT_ENERGY_LIMIT:g}): the time integration is not "
            "accurate, and the contact force may be wrong by more than 10 %; simulate again with "
            f"{finer}."
        )


def exceeded_limits(
    scene: "Scene", response: Response, socket_ratio: float = SOCKET_RATIO
) -> dict[str, str]:
    """Model limits that the deepest contact exceeds: a key for each, and a sentence.

    The key ``energy`` is for an energy balance that shows an unstable contact, whose force may be
    wrong. Yield is checked if a material has a yield stress, for half a ball on a guided plate and
    a socket with the given ratio of its radii that is held at its whole outside.
    """
    from study.joint import Joint, limits, yielding  # a simulation needs no solver

    deepest = response.largest_depth
    found = {"energy": response.energy_warning} if response.energy_warning else {}
    if deepest == 0:
        return found
    depth_star, (ball, socket) = deepest / scene.clearance, scene.materials
    if response.law:
        law = response.law.law
        found |= limits.law_limit(law.name, law.fitted_to, depth_star)
    found |= limits.modulus_limit({"ball": ball.youngs_modulus, "socket": socket.youngs_modulus})
    try:
        r2_star = scene.socket_radius / scene.clearance
        joint = Joint.from_ratios(r2_star, socket_ratio, ball=ball, socket=socket)
        found |= limits.limits(depth_star, depth=deepest)
        found |= yielding.yield_limit(joint, depth_star)
    except checks.RangeError as error:
        what = "The law was not compared with an elastic solution of this joint"
        found["joint"] = f"{what}: {error}."
    return found
