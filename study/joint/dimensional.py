"""A joint with dimensions in SI units, and materials by name.

`DimensionalJoint` is a `study.joint.Joint` with dimensions. The penetration depth under a given
force is found from a table of the solved force-depth curve, and the joint is then solved again at
this depth.
"""

from __future__ import annotations  # so that help() shows ArrayLike and not its definition

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks, parameters
from study.contact import LAWS, DimensionalLaw, Material, largest_depth, material, tabulated
from study.contact.laws import AnyLaw, find
from study.contact.materials import read_material
from study.contact.power_fit import DEPTHS, USUAL_RANGE, PowerFit, fit_power
from study.joint import applicability
from study.joint.compliance import RESOLUTION, THICKEST_RATIO, THINNEST_RATIO
from study.joint.contact_kinematics import UnresolvedError, at_rim
from study.joint.curve import force_curve, friction_radii, whole_curve
from study.joint.definition import Joint, Layer
from study.joint.law_parameters import law_parameters
from study.joint.stress import largest as largest_stress
from study.joint.supports import Configuration, Pin
from study.joint.tilted import tilted_contact, tilted_curve, under_force
from study.joint.tilted_stress import largest_off_axis
from study.parameters import parameter

Floats = NDArray[np.float64]
LEAST_CLEARANCE = 1e-9
"""Minimum clearance divided by the socket radius: a smaller one is lost when radii are rounded."""
_whole_curve = lru_cache(maxsize=16)(whole_curve)  # the same for every yield stress and size
_tilted_curve = lru_cache(maxsize=16)(tilted_curve)
_USUAL, _STEP = 1.0, 1.2  # clearances that a table reaches; how much further the next one does
_NARROWEST = 0.02  # clearances that the table of a narrow socket reaches at least
_SAME: tuple[str, ...] = (
    "tilt",
    "peak_angle_deg",
    "contact_edges_deg",
    "peak_error",
    "reaches_rim",
    "angle_deg",
)
_SAME += ("error_estimate",)  # results off the axis that have no unit of the joint's


@dataclass(frozen=True)
class DimensionalSolution:
    """Solution of a joint at k penetration depths, in SI units.

    Arrays have the order of the given depths or forces and, unless stated otherwise, shape (k,).

    Attributes
    ----------
    depth, force, stiffness
        Penetration depth in m, contact force in N, and the derivative of the force with respect to
        the depth in N/m.
    contact_half_angle_deg, peak_pressure
        Polar angle of the contact's edge in deg, and the largest contact pressure in Pa.
    error_estimate
        Estimated relative error of the force, as in `study.joint.ForceCurve`, plus the error of
        the table that gives the depth under a force.
    von_mises
        Maximum von Mises stress in Pa of each body: ``ball``, ``liner 1`` and so on from the
        inside out, and ``socket``.
    von_mises_place
        Where this maximum is: k texts for each body (`study.joint.LargestStress`).
    yield_factor
        Yield stress divided by the maximum von Mises stress of each body, which yields if the
        factor is below 1; None for a material without a yield stress. All other numbers are for
        elastic bodies, also beyond yield.
    limits
        Model limits that each contact exceeds (`study.joint.applicability.limits`).
    angle_deg, pressure
        Polar angles in deg, shape (n,), and the contact pressure there in Pa, shape (k, n).
    friction_radius
        Friction torque in m, divided by the coefficient of friction and the force, of a ball that
        slides over its whole contact while it rotates about the load (``spin``) or about an axis
        perpendicular to it (``tilt``); see `study.joint.curve.friction_radii`.
    """

    depth: Floats
    force: Floats
    stiffness: Floats
    contact_half_angle_deg: Floats
    peak_pressure: Floats
    error_estimate: Floats
    von_mises: dict[str, Floats]
    von_mises_place: dict[str, tuple[str, ...]]
    yield_factor: dict[str, Floats | None]
    limits: tuple[applicability.Limits, ...]
    angle_deg: Floats
    pressure: Floats
    friction_radius: dict[str, Floats]

    def friction_torque(self, friction: float) -> dict[str, Floats]:
        """Friction torques in N m, shape (k,), by the rotations of ``friction_radius``.

        Parameters
        ----------
        friction
            Coefficient of friction, >= 0.
        """
        mu = checks.number("friction", friction, least=0, scalar=True)
        return {motion: mu * self.force * r for motion, r in self.friction_radius.items()}

    def wear_depth(self, coefficient: float, path: float) -> Floats:
        """Archard's wear depth h = k p s at every polar angle, in m, shape (k, n).

        Because wear widens the contact but the pressure p is assumed to be unchanged, the result is
        valid for small wear only.

        Parameters
        ----------
        coefficient
            Wear coefficient k >= 0 in m^2/N: the worn volume of a body divided by force and sliding
            distance (Archard, J. Appl. Phys. 24 (1953) 981-988).
        path
            Sliding distance s >= 0 in m, the same at all points.
        """
        k = checks.number("wear coefficient", coefficient, "m^2/N", least=0, scalar=True)
        return k * checks.number("path", path, "m", least=0, scalar=True) * self.pressure


@dataclass(frozen=True)
class TiltedSolution(DimensionalSolution):
    """Solution of a joint whose ball is pressed off the axis.

    It has the attributes of `DimensionalSolution` and further arrays of shape (k,). Force and
    stiffness are the components along the displacement. The contact half-angle is half the angle
    between the ends of the contact in the plane of symmetry, in which ``angle_deg`` are signed
    polar angles. The ball may also ``turn`` about the axis in this plane that is perpendicular to
    the force.

    Attributes
    ----------
    tilt
        Angle between displacement and axis, in deg.
    transverse, transverse_stiffness
        Force in N perpendicular to the displacement, positive towards larger tilt, and its
        derivative in N/m with respect to a displacement in this direction.
    peak_angle_deg, contact_edges_deg
        Signed polar angles of the peak pressure, and of both ends of the contact, shape (2, k).
    peak_error
        Estimated relative error of the peak pressure (`study.joint.TiltedContact`).
    reaches_rim
        Whether a rim, or the edge of a ball's face, cuts the contact.
    von_mises_error
        Estimated relative error of the von Mises stress in each body.
    """

    tilt: Floats
    transverse: Floats
    transverse_stiffness: Floats
    peak_angle_deg: Floats
    contact_edges_deg: Floats
    peak_error: Floats
    reaches_rim: NDArray[np.bool_]
    von_mises_error: dict[str, Floats]


@dataclass(frozen=True)
class Liner:
    """A liner inside a socket, with its thickness in m and its material."""

    thickness: float = parameter(..., "thickness of liner", "m", above=0)
    material: Material = parameter(..., "material of liner", kind=Material, parse=read_material)

    def __post_init__(self) -> None:
        parameters.take(self)
        material(self.material, "liner")

    def __str__(self) -> str:
        return f"{self.thickness:.9g},{self.material}"


def _read_liner(name: str, text: str) -> Liner:
    """Liner of a text, ``0.5e-3,PTFE``."""
    thickness, _, of = text.partition(",")
    try:
        return Liner(checks.read(name, thickness), read_material(name, of.strip()))
    except checks.RangeError:
        raise
    except ValueError as error:
        wanted = f"{name} must be a thickness in m and a material, for example 0.5e-3,PTFE"
        raise ValueError(f"{wanted}, got {text!r}: {error}") from None


def _of_material(default: str, body: str) -> Any:
    return parameter(
        default,
        f"Material of the {body}: a name that study data materials lists, or Young's modulus in "
        "Pa, Poisson's ratio and, optionally, yield stress in Pa, for example 210e9,0.3,5e8",
        kind=Material,
        parse=read_material,
    )


@parameters.documented
@dataclass(frozen=True)
class DimensionalJoint(Configuration):
    """A spherical clearance joint with dimensions, in SI units.

    Materials and supports may be given as objects or as texts. `solve` gives the state under given
    forces or at given depths, `law` a contact law, and `power_law` the coefficients of F = k d^n.
    Raises ``ValueError`` for a value outside its range.

    Examples
    --------
    >>> joint = DimensionalJoint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")
    >>> solution = joint.solve(force=3000)
    >>> print(f"{solution.depth[0]:.4g} m, {solution.peak_pressure[0] / 1e6:.4g} MPa")
    4.232e-06 m, 74.38 MPa
    """

    socket_radius: float = parameter(..., "Inner radius of the socket", "m", above=0)
    clearance: float = parameter(..., "Clearance: radius of the socket less that of the ball", "m")
    wall: float = parameter(..., "Wall thickness of the socket, including its liners", "m")
    ball: Material = _of_material("bearing steel", "ball")
    socket: Material = _of_material("steel", "socket")
    liner: tuple[Liner, ...] = parameter(
        (),
        "Liner inside the socket: its thickness in m and its material, for example 0.5e-3,PTFE; "
        "may be repeated, from the inside out. The rest of the wall is of the socket's material",
        kind=Liner,
        parse=_read_liner,
        several=";",
    )

    def __post_init__(self) -> None:
        parameters.take(self)
        if self.clearance <= 0:
            raise checks.RangeError(
                f"clearance must be > 0 m, got {self.clearance:g} m; without clearance the ball "
                "touches the socket all round, which is a different problem, so give the minimum "
                "clearance (radius of the socket less radius of the ball) that the tolerances allow"
            )
        radius = self.socket_radius
        limits: dict[str, Any] = {"least": LEAST_CLEARANCE * radius, "below": radius}
        checks.number("clearance", self.clearance, "m", **limits)
        limits = {"least": (THINNEST_RATIO - 1) * radius, "most": (THICKEST_RATIO - 1) * radius}
        checks.number("wall", self.wall, "m", **limits)
        inside = sum(liner.thickness for liner in self.liner)
        checks.number("wall (which includes the liners)", self.wall, "m", above=inside)
        for body in ("ball", "socket"):
            material(getattr(self, body), body)
        if isinstance(self.ball_support, Pin):
            bore = self.ball_support.in_ball(radius - self.clearance)
            object.__setattr__(self, "ball_support", bore)
        object.__setattr__(self, "rim", self.joint.rim)  # and errors of the joint belong here

    @cached_property
    def joint(self) -> Joint:
        """The same joint without dimensions."""
        ratio, given = 1 + self.wall / self.socket_radius, self.configuration
        if self.liner:
            inside = np.cumsum([liner.thickness for liner in self.liner]) / self.socket_radius
            pairs = zip(1 + inside, self.liner, strict=True)
            liners = [Layer(outer, liner.material) for outer, liner in pairs]
            given["layers"] = (*liners, Layer(ratio, self.socket))
        else:
            given |= {"socket_ratio": ratio, "socket": self.socket}
        return Joint(self.socket_radius / self.clearance, ball=self.ball, **given)

    @property
    def materials(self) -> dict[str, Material]:
        """Materials of ``ball``, ``liner 1`` and so on from the inside out, and ``socket``."""
        liners = [f"liner {k}" for k in range(1, len(self.liner) + 1)]
        values = self.joint.materials.values()
        return dict(zip(["ball", *liners, "socket"], values, strict=True))

    def law(self, law: AnyLaw | None = None, tilt: float | None = None) -> DimensionalLaw:
        """Contact law of this joint, in SI units.

        Parameters
        ----------
        law
            Name of a law, a law itself, or a function (`study.contact.sampled`). By default it is
            a table of the elastic solution of this joint, which reaches a depth of at least one
            clearance if the contact can be so deep. ``stiffened_hertz`` gets its options from the
            joint and ``power`` is fitted to it over the default range of `power_law`; the
            coefficients of the other laws are those of the reference joint of the study.
        tilt
            Angle in deg between displacement and axis. The law is then the table of the force along
            a displacement in this direction.

        Examples
        --------
        >>> joint = DimensionalJoint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3)
        >>> law = joint.law("stiffened_hertz")
        >>> print(f"{law.force(4e-6):.0f} N, {law.stiffness(4e-6):.3g} N/m")
        3479 N, 1.42e+09 N/m
        """
        tilt = self._direction(tilt)
        if law is None:
            return self._reaching("depth", np.zeros(1), "m", tilt)[0]
        if tilt is not None:
            raise ValueError(
                "law must be the table of the elastic solution for a load off the axis, got "
                f"{law}; remove law, or use the fitted power law of power_law"
            )
        law = find(law)
        if law is LAWS["stiffened_hertz"]:
            self.joint.check_linear(law.name)
        return self._in_si_units(law, **law_parameters(law, self.joint))

    def power_law(
        self, depths: tuple[float, float] | None = None, tilt: float | None = None
    ) -> PowerFit:
        """Power law F = k d^n, fitted to the elastic solution (`study.contact.power_fit`).

        Parameters
        ----------
        depths
            Minimum and maximum penetration depth in m. The default is 0.05 and 0.5 clearances.
        tilt
            Angle in deg between displacement and axis; F is then the force along the displacement.

        Examples
        --------
        >>> joint = DimensionalJoint(12.5e-3, 40e-6, 6e-3, socket="bronze")
        >>> fit = joint.power_law()
        >>> print(f"k = {fit.coefficient:.3e} N/m^n, n = {fit.exponent:.3f}, {fit.error:.1%}")
        k = 2.272e+12 N/m^n, n = 1.653, 1.0%
        """
        low, high = depths or (share * self.clearance for share in USUAL_RANGE)
        least = checks.number("minimum depth", low, "m", above=0, scalar=True)
        most = checks.number("maximum depth", high, "m", above=least, scalar=True)
        law, _ = self._reaching("depth", np.array([most]), "m", self._direction(tilt))
        places = np.geomspace(least, most, DEPTHS)
        return fit_power(places, law.force(places))

    def solve(
        self,
        *,
        depth: ArrayLike | None = None,
        force: ArrayLike | None = None,
        tilt: ArrayLike | None = None,
    ) -> DimensionalSolution:
        """Solve the joint at given penetration depths or under given contact forces.

        Parameters
        ----------
        depth, force
            Depths in m or forces in N, > 0: one number or shape (k,). Exactly one of the two must
            be given.
        tilt
            Angle in deg between the axis and the displacement, if depths are given, or the force,
            if forces are given: one number or shape (k,). The default is a load along the axis,
            or 90 deg for a ring or a ball with a bore.

        Returns
        -------
        DimensionalSolution
            With a tilt, a `TiltedSolution`.

        Raises
        ------
        ValueError
            If the contact along the axis would reach the rim of the socket, if it is too small for
            the elements to resolve, or if not exactly one of ``depth`` and ``force`` is given.

        Examples
        --------
        >>> joint = DimensionalJoint(12.5e-3, 40e-6, 6e-3, socket="bronze")
        >>> joint.solve(depth=[2e-6, 4e-6]).force.round()
        array([ 859., 2730.])
        """
        asked, name = self._given(depth, force)
        tilt = self._direction(tilt)
        if tilt is not None:
            star = asked / (self.clearance if name == "depth" else self._force_unit)
            solve = tilted_contact if name == "depth" else under_force
            try:
                contact = solve(self.joint, star, tilt)
            except checks.RangeError as error:  # which is in clearances and E* dR^2
                given = ", ".join(f"{value:g}" for value in asked)
                unit = "m" if name == "depth" else "N"
                raise type(error)(f"{error} ({name} given: {given} {unit})") from None
            return self._off_axis(contact)
        unit = "m" if name == "depth" else "N"
        law, _ = self._reaching(name, asked, unit)
        depths = asked if force is None else np.asarray(law.depth(asked))
        solved = self._solved(depths / self.clearance, name, asked, unit)
        forces = asked if depth is None else self._force_unit * solved.force_star
        off = np.abs(forces / (self._force_unit * solved.force_star) - 1)
        return self._on_axis(law, depths, forces, solved, solved.error_estimate + off)

    def _direction(self, tilt):
        return self.default_tilt if tilt is None else tilt

    @staticmethod
    def _given(depth, force):
        if depth is None and force is None:
            raise ValueError("depth or force must be given, got neither")
        if depth is not None and force is not None:
            raise ValueError("depth and force must not both be given; remove one of them")
        name, unit = ("depth", "m") if force is None else ("force", "N")
        given: Any = depth if force is None else force
        asked = np.atleast_1d(checks.number(name, given, unit, above=0))
        if asked.ndim != 1 or asked.size == 0:
            raise ValueError(f"{name} must be a list of numbers, got shape {asked.shape}")
        return asked, name

    def curve(self) -> DimensionalSolution:
        """Force-depth curve along the axis, at about 50 depths up to one clearance if possible."""
        law, curve = self._reaching("depth", np.zeros(1), "m")
        depths, forces = self.clearance * curve.depth_star, self._force_unit * curve.force_star
        return self._on_axis(law, depths, forces, curve, curve.error_estimate)

    @property
    def _force_unit(self):
        return self.joint.composite_modulus * self.clearance**2

    @property
    def _pressure_unit(self):
        return self.joint.composite_modulus * self.clearance / self.socket_radius

    def _on_axis(self, law, depths, forces, solved, errors):
        """Stiffness by a law at depths, and all else from the joint solved there."""
        to_rim = self.opening.last - solved.contact_half_angle_deg
        return DimensionalSolution(
            depth=depths,
            force=forces,
            stiffness=np.asarray(law.stiffness(depths)),
            error_estimate=errors,
            angle_deg=np.degrees(solved.angles),
            pressure=self._pressure_unit * solved.pressure,
            **self._shared(
                depths,
                solved.contact_half_angle_deg,
                np.maximum(to_rim, 1e-9),  # along the axis a contact ends inside the rim
                solved.peak_pressure_star,
                largest_stress(solved),
                friction_radii(solved),
            ),
        )

    def _off_axis(self, contact):
        """Results of a contact off the axis, in SI units."""
        depths = self.clearance * contact.depth_star
        stiffness = self._force_unit / self.clearance
        largest = largest_off_axis(contact)
        errors = (stress.error for stress in largest.values())
        return TiltedSolution(
            depth=depths,
            force=self._force_unit * contact.force_star,
            transverse=self._force_unit * contact.transverse_star,
            stiffness=stiffness * contact.stiffness_star,
            transverse_stiffness=stiffness * contact.transverse_stiffness_star,
            pressure=self._pressure_unit * contact.pressure_star,
            von_mises_error=dict(zip(self.materials, errors, strict=True)),
            **{name: getattr(contact, name) for name in _SAME},
            **self._shared(
                depths,
                contact.contact_half_angle_deg,
                contact.to_rim_deg,
                contact.peak_pressure_star,
                largest,
                contact.friction_radius_star,
            ),
        )

    def _shared(self, depths, half_angles, to_rim, peaks, largest, radii):
        """Results that a joint has both on and off its axis, by their names."""
        strengths, pressure = self.materials, self._pressure_unit
        bodies = dict(zip(self.joint.materials, strengths, strict=True))
        stresses = {bodies[name]: pressure * stress.von_mises for name, stress in largest.items()}
        factors = {
            body: strength / stress if (strength := strengths[body].yield_stress) else None
            for body, stress in stresses.items()
        }
        moduli = {body: material.youngs_modulus for body, material in strengths.items()}
        soft, softest = applicability.modulus_limit(moduli), min(moduli.values())
        limits = tuple(
            applicability.limits(
                self.joint,
                depth / self.clearance,
                half_angles[k],
                to_rim=to_rim[k],
                yield_factor={body: f[k] for body, f in factors.items() if f is not None},
                depth=depth,
                strain=pressure * peaks[k] / softest,
            )
            | soft
            for k, depth in enumerate(depths)
        )
        return {
            "contact_half_angle_deg": half_angles,
            "peak_pressure": pressure * peaks,
            "von_mises": stresses,
            "von_mises_place": {bodies[name]: stress.place for name, stress in largest.items()},
            "yield_factor": factors,
            "limits": limits,
            "friction_radius": {motion: self.socket_radius * r for motion, r in radii.items()},
        }

    def _reaching(self, name, asked, unit, tilt=None):
        """Least table that reaches all depths or forces asked for, and its solved curve."""
        deepest, law = usual_depth(self.joint), None
        while law is None:
            try:
                law, curve = self._table(deepest, tilt)
            except UnresolvedError:
                raise
            except checks.RangeError:  # a narrow socket, whose rim is nearer than one clearance
                if deepest < _NARROWEST:
                    raise
                deepest /= _STEP

        def most():
            return law.deepest if name == "depth" else law.force(law.deepest)

        while most() < asked.max():
            deepest *= _STEP
            try:
                law, curve = self._table(deepest, tilt)
            except checks.RangeError:
                raise checks.RangeError(
                    f"{name} must be <= {most():.6g} {unit}, got {asked.max():g} {unit}; beyond "
                    "this the contact would reach the rim of the socket"
                ) from None
        return law, curve

    def _table(self, deepest, tilt=None):
        if tilt is None:
            curve = _whole_curve(self.joint, deepest)
        else:
            curve = _tilted_curve(self.joint, float(tilt), deepest)
        return self._in_si_units(tabulated(curve)), curve

    def _in_si_units(self, law, **options):
        in_si_units = DimensionalLaw(
            law,
            ball_radius=self.socket_radius - self.clearance,
            socket_radius=self.socket_radius,
            composite_modulus=self.joint.composite_modulus,
            **options,
        )
        in_si_units.joint = self
        return in_si_units

    def _solved(self, depth_star, name, asked, unit):
        """The joint solved at depths, on finer elements where a contact is very small."""
        finer = 2 * RESOLUTION["series"]
        resolutions = (None, finer) if self.joint.series_applies else (None,)
        for resolution in resolutions:
            try:
                return force_curve(self.joint, depth_star, resolution)
            except UnresolvedError:
                continue
            except checks.RangeError:
                raise at_rim(name, self.joint, f"{asked.max():g} {unit}") from None
        raise UnresolvedError(
            f"{name} must be large enough for the elements to resolve the contact, got "
            f"{asked.min():g} {unit}; use Hertz's law, which is valid for such small contacts"
        )


def usual_depth(joint: Joint) -> float:
    """Default maximum depth_star of a joint's law: 1, or less if the contact cannot be so deep."""
    return float(min(_USUAL, 0.8 * largest_depth(joint.r2_star)))
