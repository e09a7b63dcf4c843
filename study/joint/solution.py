"""The elastic solution of a joint at some penetration depths, as data.

Each quantity is described once, by the metadata of its field or property: its meaning, its unit,
and the unit in which a person reads it. `quantities` lists them for printed tables, JSON, and the
columns of parameter studies.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from study import parameters
from study.joint import limits
from study.joint.description import JointDescription
from study.parameters import Quantity, derived, stored

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]
_SHOWN = (
    "depth",
    "tilt",
    "force",
    "stiffness",
    "contact_half_angle_deg",
    "peak_pressure",
    "peak_error",
    "force_error",
)
_FEW = 4  # values of a quantity that are shown, and the last one
_NOT_STORED: Any = None  # of what is asked for, or that a solution read from a table lacks
RENAMED = {"tilt": "displacement_tilt"}
"""Column of a quantity with another name, because a load has a tilt too."""
FORMULATION = 1.5
"""Error of small displacements, relative to the force and to the strain of the bodies, which is the
penetration in each body over its thickness. CalculiX with large displacements gives 0.5 to 2 for 82
contacts (``data/published/large_displacements.csv``, notebook 12)."""


@dataclass(frozen=True)
class LargestStress:
    """Maximum von Mises stress in one body, at each of the k depths of a curve.

    Attributes
    ----------
    von_mises, over_peak
        The stress in units of E* dR/R2, and divided by the peak pressure; shape (k,).
    radius, angle
        Distance of the maximum from the centre of the body, divided by the radius of the surface,
        and its polar angle from the axis of the contact in rad; shape (k,).
    place
        ``at the surface`` of contact; ``outside``, at the socket's outer sphere; ``at an
        interface`` of layers; ``at the core`` or ``at the bore`` that holds the ball; or else
        ``below the surface``; k of them.
    error
        Estimated relative error of the stress, shape (k,); None if it is not estimated.
    """

    von_mises: Floats
    over_peak: Floats
    radius: Floats
    angle: Floats
    place: tuple[str, ...]
    error: Floats | None = None


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Elastic solution of a joint at k penetration depths, along its axis or in other directions.

    Arrays have the shape (k,) unless stated otherwise. Normalised quantities end in ``_star``:
    depths are divided by the clearance dR, forces by E* dR^2, stiffnesses by E* dR, pressures by
    E* dR/R2 and areas by R2^2. The same in SI units are properties without this ending. Quantities
    of contacts off the axis are None along the axis. `quantities` has the meaning of each number.

    Attributes
    ----------
    joint, solver, resolution
        The joint, how it was solved (``series``; ``quadratic`` or ``linear`` elements; ``modes``
        off the axis), and the number of elements along a quarter circle.
    depth_star, tilt
        Displacement of the ball beyond first touch, and its direction.
    error_estimate
        Numerical error of the force, relative to it, from two meshes of which one has twice the
        elements of the other. Along the axis it is the sum of the changes that are due to the ball,
        to the socket and to the contact; off it, the difference of the forces as vectors. The force
        is extrapolated from both meshes, so that its error is smaller, by a factor above 10 for the
        series and about 1 for elements of bodies that are held at a core, a neck or a seat, where
        stresses have no bound. A contact that is a ring, and three-node triangles, have the force
        of the finer mesh.
    peak_pressure_star, peak_error, peak_angle_deg
        The maximum pressure, its numerical error and its place. Where ``peak_at_rim``, these are
        of the middle of the contact instead: a rim is a sharp edge in the model, and between stiff
        bodies the pressure there grows with the resolution.
    stiffness_star, transverse_stiffness_star
        Off the axis within about 1 % of differences of the force, and within 3 % in contacts of few
        elements, at depths of about 0.1 (``tests/joint/test_tilted.py``).
    friction_radius_star
        The ball slides over its whole contact, under the pressure of the frictionless joint, while
        it rotates about the load. A place of the contact at the unit vector n from the ball's
        centre slides along w x n, where w is the direction of the load, so that the torque is mu
        times the integral of p R abs(w x n) dA (this study). For a small contact of the radius a it
        is 3 pi a/16, that of Hertz's pressure.
    reaches_rim, peak_at_rim
        Whether a rim cuts the contact, and whether the pressure is largest there and grows with the
        resolution.
    angle_deg, pressure_star
        Polar angles in deg, shape (n,), and the pressure there, shape (k, n). Along the axis it is
        the pressure on the ball for ``linear`` kinematics; off the axis, angles are signed and in
        the plane of symmetry, and the pressure is that on the socket.
    stress
        Maximum von Mises stress in each body, by its name in ``joint.materials``, if asked for.
    """

    joint: JointDescription = field(repr=False)
    solver: str
    resolution: int | None = None
    depth_star: Floats = stored("Penetration depth divided by the clearance")
    tilt: Floats | None = stored("Angle between the displacement and the axis", "deg", default=None)
    force_star: Floats = stored("Normalised contact force along the displacement")
    transverse_star: Floats | None = stored(
        "Normalised contact force across the displacement, positive towards larger tilt",
        default=None,
    )
    stiffness_star: Floats = stored(
        "Derivative of force_star with respect to depth_star", default=None
    )
    transverse_stiffness_star: Floats | None = stored(
        "Derivative of transverse_star with respect to a displacement across", default=None
    )
    contact_half_angle_deg: Floats = stored(
        "Contact half-angle, in the plane of load and axis", "deg", default=None
    )
    contact_area_star: Floats = stored(
        "Area of contact divided by R2^2; off the axis within about 5 %", default=None
    )
    peak_pressure_star: Floats = stored(
        "Maximum of the normalised contact pressure, or its value at the middle of the contact if "
        "it grows with the resolution at a rim",
        default=None,
    )
    peak_error: Floats = stored("Estimated relative error of peak_pressure", read="%", default=None)
    peak_angle_deg: Floats | None = stored(
        "Signed polar angle of peak_pressure", "deg", default=None
    )
    contact_from_deg: Floats | None = stored(
        "Signed polar angle where the contact begins", "deg", default=None
    )
    contact_to_deg: Floats | None = stored(
        "Signed polar angle where the contact ends", "deg", default=None
    )
    friction_radius_star: Floats | None = stored(
        "Friction torque of a rotation about the load, divided by the coefficient of friction, the "
        "force and R2",
        default=None,
    )
    error_estimate: Floats = stored("Numerical error of the force, relative to it", read="%")
    reaches_rim: NDArray[np.bool_] | None = None
    peak_at_rim: NDArray[np.bool_] | None = None
    angle_deg: Floats = field(default=_NOT_STORED, repr=False)
    pressure_star: Floats = field(default=_NOT_STORED, repr=False)
    stress: dict[str, LargestStress] = field(default=_NOT_STORED, repr=False)

    @derived("Penetration depth", "m", "um")
    def depth(self) -> Floats:  # noqa: D102
        return self.joint.clearance * self.depth_star

    @derived("Contact force along the displacement", "N")
    def force(self) -> Floats:  # noqa: D102
        return self.joint.force_unit * self.force_star

    @derived("Contact force across the displacement, positive towards larger tilt", "N")
    def transverse(self) -> Floats | None:  # noqa: D102
        return _scaled(self.joint.force_unit, self.transverse_star)

    @derived("Derivative of the force with respect to the depth", "N/m", "N/um")
    def stiffness(self) -> Floats:  # noqa: D102
        return self.joint.stiffness_unit * self.stiffness_star

    @derived("Derivative of the force across with respect to a displacement across", "N/m", "N/um")
    def transverse_stiffness(self) -> Floats | None:  # noqa: D102
        return _scaled(self.joint.stiffness_unit, self.transverse_stiffness_star)

    @derived("Area of contact", "m^2", "mm^2")
    def contact_area(self) -> Floats:  # noqa: D102
        return self.joint.socket_radius**2 * self.contact_area_star

    @derived(
        "Maximum contact pressure, or that at the middle of the contact where peak_at_rim",
        "Pa",
        "MPa",
    )
    def peak_pressure(self) -> Floats:  # noqa: D102
        return self.joint.pressure_unit * self.peak_pressure_star

    @derived("Specific load of a ring: force over ring width and ball diameter, normalised")
    def specific_load_star(self) -> Floats | None:  # noqa: D102
        joint, opening = self.joint, self.joint.opening
        if not opening.is_ring:
            return None
        width = -np.diff(np.cos(np.radians([opening.first, opening.last])))  # over R2
        across: Any = self.transverse_star  # which is not None, as no ring is loaded along its axis
        force = np.hypot(self.force_star, across)
        return force / (2 * width * (joint.r2_star - 1))

    @derived("Specific load of a ring: force over ring width and ball diameter", "Pa", "MPa")
    def specific_load(self) -> Floats | None:  # noqa: D102
        return _scaled(self.joint.pressure_unit, self.specific_load_star)

    @derived(
        "Friction torque of a rotation about the load, divided by the coefficient of friction and "
        "the force",
        "m",
        "mm",
    )
    def friction_radius(self) -> Floats | None:  # noqa: D102
        return _scaled(self.joint.socket_radius, self.friction_radius_star)

    @derived("Error of small displacements, estimated, relative to the force", read="%")
    def formulation_error(self) -> Floats:  # noqa: D102
        joint = self.joint
        bodies = zip(joint.modulus_shares, (joint.ball, joint.innermost), strict=True)
        of_ball, of_socket = (share * (1 - of.poisson**2) for share, of in bodies)
        strain = of_ball + of_socket / min(1.0, joint.layers[0].outer_ratio - 1)
        return FORMULATION * strain * self.depth_star / joint.r2_star

    @derived("Relative error of the force: numerical, and of small displacements", read="%")
    def force_error(self) -> Floats:  # noqa: D102
        return self.error_estimate + self.formulation_error

    @property
    def pressure(self) -> Floats:
        """Contact pressure in Pa at ``angle_deg``, shape (k, n)."""
        return self.joint.pressure_unit * self.pressure_star

    @property
    def von_mises(self) -> dict[str, Floats]:
        """Maximum von Mises stress in each body in Pa; none of a joint that has only ratios.

        Raises ``ValueError`` if a joint with dimensions was solved without stresses.
        """
        if self.stress is None and self.joint.has_dimensions:
            raise ValueError(
                "the solution must have stresses for von_mises and yield_factor; solve the joint "
                "with stresses=True, as in joint.solve(force=3000, stresses=True)"
            )
        unit = self.joint.pressure_unit
        return {body: unit * of.von_mises for body, of in (self.stress or {}).items()}

    @property
    def yield_factor(self) -> dict[str, Floats | None]:
        """Yield stress divided by the maximum von Mises stress of each body.

        The body yields if the factor is below 1; None for a material without a yield stress. All
        other numbers are for elastic bodies, also beyond yield. Raises as `von_mises` does.
        """
        strengths = {body: of.yield_stress for body, of in self.joint.materials.items()}
        return {
            body: None if (strength := strengths[body]) is None else strength / stress
            for body, stress in self.von_mises.items()
        }

    def columns(self) -> dict[str, Any]:
        """Quantities by name, in SI units or normalised, each with k values.

        They are those of `quantities` that this contact has, the stresses of each body, and the
        model limits that are exceeded.
        """
        names = quantities(self.joint.has_dimensions)
        every = {RENAMED.get(name, name): getattr(self, name) for name in names}
        for body, stress in (self.von_mises if self.stress else {}).items():
            name = body.replace(" ", "_")
            every |= {f"von_mises_{name}": stress, f"yield_factor_{name}": self.yield_factor[body]}
        every["applicability"] = [limits.in_short(found) for found in self.limits]
        return {name: values for name, values in every.items() if values is not None}

    def table(self) -> pd.DataFrame:
        """Table of the quantities, with a row for each of the k depths: see `columns`.

        Examples
        --------
        >>> from study.joint import Joint
        >>> joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
        >>> table = joint.solve(force=[1e3, 3e3]).table()
        >>> print(table.depth.map("{:.3g}".format).to_list(), table.applicability[0])
        ['2.19e-06', '4.23e-06'] inside
        """
        import pandas as pd  # late: joints need no tables

        return pd.DataFrame(self.columns())

    def __repr__(self) -> str:
        about, lines = quantities(self.joint.has_dimensions), [f"Solution of {self.joint}"]
        for name, of in about.items():
            values = getattr(self, name)
            if values is not None and name.removesuffix("_star") in _SHOWN:
                texts = [f"{value / of.scale:.4g}" for value in values]
                texts[_FEW:-1] = ["..."] * (len(texts) > _FEW + 1)
                head = f"{name.removesuffix('_deg')} {of.read}".ljust(23)
                lines.append("  ".join([head, *texts]))
        exceeded = dict.fromkeys(name for of in self.limits for name in of)
        lines.append(f"model limits that are exceeded: {', '.join(exceeded) or 'none'}")
        return "\n".join(lines)

    @property
    def direction_deg(self) -> float | None:
        """Tilt of the deepest displacement in deg, of 4 digits; None along the axis."""
        return None if self.tilt is None else float(f"{self.tilt[self.depth_star.argmax()]:.4g}")

    @property
    def to_rim_deg(self) -> Floats:
        """Angle from the contact's end to the nearest rim or face, in deg; 0 if it is cut."""
        (first, last), opening = self.joint.ball_support.outline.surface, self.joint.opening
        if self.tilt is None:  # along the axis a contact ends inside the rim
            return np.maximum(opening.last - self.contact_half_angle_deg, 1e-9)
        low, high, cut = map(
            np.asarray, (self.contact_from_deg, self.contact_to_deg, self.reaches_rim)
        )
        to_rim = min(last, opening.last) - np.maximum(np.abs(low), high)
        if not self.joint.has_pole:
            to_rim = np.minimum(to_rim, low - max(first, opening.first))
        return np.where(cut, 0.0, np.maximum(to_rim, 1e-9))

    @property
    def limits(self) -> tuple[limits.Limits, ...]:
        """Model limits that each contact exceeds, as sentences (`study.joint.limits`).

        Yield is checked if the solution has stresses; roughness, strain and the unit of Young's
        moduli if the joint has dimensions.
        """
        joint, found = self.joint, []
        moduli = {body: of.youngs_modulus for body, of in joint.materials.items()}
        factors = self.yield_factor if self.stress else {}
        wall = joint.socket_ratio - 1 if joint.is_held_all_round else None
        for k, depth_star in enumerate(self.depth_star):
            of_sizes: dict[str, Any] = {}
            if joint.has_dimensions:
                strain = self.peak_pressure[k] / min(moduli.values())
                of_sizes = {"depth": self.depth[k], "strain": strain}
            of_contact = limits.limits(
                depth_star,
                to_rim=self.to_rim_deg[k],
                wall=wall,
                half_angle_deg=self.contact_half_angle_deg[k],
                yield_factor={body: of[k] for body, of in factors.items() if of is not None},
                peak_at_rim=self.peak_at_rim is not None and self.peak_at_rim[k],
                **of_sizes,
            )
            of_moduli = limits.modulus_limit(moduli) if joint.has_dimensions else {}
            found.append(of_contact | of_moduli)
        return tuple(found)


def quantities(dimensions: bool) -> dict[str, Quantity]:
    """Quantities of a `Solution` by name, in the order of tables: in SI units or normalised."""
    every, found = parameters.quantities(Solution), {}
    for name, about in every.items():
        plain = name.removesuffix("_star")
        if plain != name and dimensions:
            found[plain] = every[plain]
        elif f"{name}_star" not in every:  # which the table without dimensions has
            found[name] = about
    return found


def _scaled(unit, values):
    return None if values is None else unit * values
