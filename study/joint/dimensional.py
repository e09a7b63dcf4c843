"""A joint with its dimensions, as an engineer has it: SI units, and materials by name.

`DimensionalJoint` is a `study.joint.Joint` with dimensions. The depth under a force comes from the
table of its solved curve. The joint is solved at every depth.
"""

from dataclasses import dataclass, fields
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
from study.joint.supports import Configuration
from study.joint.tilted import tilted_contact, under_force
from study.parameters import parameter

Floats = NDArray[np.float64]
LEAST_CLEARANCE = 1e-9
"""Over the socket's radius: a smaller clearance is lost in the rounding of the radii."""
_whole_curve = lru_cache(maxsize=16)(whole_curve)  # the same for every yield stress and size
_USUAL, _STEP = 1.0, 1.2  # clearances that a table reaches; how much further the next one does


@dataclass(frozen=True)
class DimensionalSolution:
    """Results of a joint at some depths: arrays in the order asked for, shape (k,), in SI units.

    Attributes
    ----------
    depth, force, stiffness
        In m, N and N/m; the stiffness is the slope of the force over the depth.
    contact_half_angle_deg, peak_pressure
        Polar angle of the contact's edge in deg, and the largest contact pressure in Pa.
    error_estimate
        Estimated relative error of the force, as of `study.joint.ForceCurve`, plus the error of
        the table that gives the depth under a force.
    von_mises
        Largest von Mises stress in each body, in Pa: ``ball``, ``liner 1`` and so on from the
        inside out, and ``socket``.
    von_mises_place
        Where it is, k texts for each body (`study.joint.LargestStress`).
    yield_factor
        Yield stress over largest von Mises stress of each body, which yields below 1; None for a
        material without a yield stress. Beyond yield the other numbers are for elastic bodies.
    limits
        Limits of the solution that each contact exceeds, `study.joint.applicability.limits`.
    angle_deg, pressure
        Polar angles in deg, shape (n,), and the contact pressure there in Pa, shape (k, n).
    friction_radius
        Of a ball that turns about the load (``spin``) or across it (``tilt``) and slides all over
        its contact, in m (`study.joint.curve.friction_radii`).
    law
        Table of the joint's curve that reaches every depth.
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
    law: DimensionalLaw

    def friction_torque(self, friction: float) -> dict[str, Floats]:
        """Torque in N m, as of ``friction_radius``, at a coefficient of friction >= 0; (k,)."""
        mu = checks.number("friction", friction, least=0, scalar=True)
        return {motion: mu * self.force * r for motion, r in self.friction_radius.items()}

    def wear_depth(self, coefficient: float, path: float) -> Floats:
        """Archard's wear depth h = k p s at every angle, in m, shape (k, n).

        The ``coefficient`` k >= 0 is a body's worn volume over force and sliding path, in m^2/N
        (Archard, J. Appl. Phys. 24 (1953) 981-988); all places slide the ``path`` s >= 0, in m. The
        pressure is taken as unchanged. In truth wear widens the contact: h is for little wear.
        """
        k = checks.number("wear coefficient", coefficient, "m^2/N", least=0, scalar=True)
        return k * checks.number("path", path, "m", least=0, scalar=True) * self.pressure


@dataclass(frozen=True)
class TiltedSolution:
    """Results of a joint pressed off its axis: arrays in the order asked for, (k,), in SI units.

    As `study.joint.TiltedContact`, with depths in m, forces in N, stiffness in N/m and pressure in
    Pa. The force is along the displacement, ``transverse`` is across it. The ``limits`` are those
    that each contact exceeds (`study.joint.applicability.limits`).
    """

    depth: Floats
    tilt: Floats
    force: Floats
    transverse: Floats
    stiffness: Floats
    transverse_stiffness: Floats
    peak_pressure: Floats
    peak_angle_deg: Floats
    peak_error: Floats
    contact_edges_deg: Floats
    reaches_rim: NDArray[np.bool_]
    error_estimate: Floats
    limits: tuple[applicability.Limits, ...]


@dataclass(frozen=True)
class Liner:
    """A liner inside a socket: its thickness in m, and its material."""

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
        wanted = f"{name} must be a thickness in m and a material, such as 0.5e-3,PTFE"
        raise ValueError(f"{wanted}, got {text!r}: {error}") from None


def _of_material(default: str, body: str) -> Any:
    return parameter(
        default,
        f"Material of the {body} by its name (listed by study data materials), or by Young's "
        "modulus in Pa, Poisson's ratio and perhaps yield stress in Pa: 210e9,0.3,5e8",
        kind=Material,
        parse=read_material,
    )


@parameters.documented
@dataclass(frozen=True)
class DimensionalJoint(Configuration):
    """A spherical clearance joint with its dimensions, in SI units.

    A value outside its range is a ``ValueError``.

    Examples
    --------
    >>> joint = DimensionalJoint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")
    >>> print(f"{joint.solve(force=3000).depth[0]:.4g} m")
    4.232e-06 m
    """

    socket_radius: float = parameter(..., "Inner radius of the socket", "m", above=0)
    clearance: float = parameter(..., "Radius of the socket less that of the ball", "m")
    wall: float = parameter(
        ..., "Thickness of the socket beyond its inner radius, liners included", "m"
    )
    ball: Material = _of_material("bearing steel", "ball")
    socket: Material = _of_material("steel", "socket")
    liner: tuple[Liner, ...] = parameter(
        (),
        "Thickness in m and material of a liner inside the socket, 0.5e-3,PTFE; may be repeated, "
        "from the inside out. The socket's material makes up the rest of the wall",
        kind=Liner,
        parse=_read_liner,
        several=";",
    )

    def __post_init__(self) -> None:
        parameters.take(self)
        if self.clearance <= 0:
            raise checks.RangeError(
                f"clearance must be > 0 m, got {self.clearance:g} m: without clearance the ball "
                "touches all round, which is another problem; give the least clearance that the "
                "tolerances or wear leave, socket's less ball's radius"
            )
        radius = self.socket_radius
        limits: dict[str, Any] = {"least": LEAST_CLEARANCE * radius, "below": radius}
        checks.number("clearance", self.clearance, "m", **limits)
        limits = {"least": (THINNEST_RATIO - 1) * radius, "most": (THICKEST_RATIO - 1) * radius}
        checks.number("wall", self.wall, "m", **limits)
        inside = sum(liner.thickness for liner in self.liner)
        checks.number("wall around the liner", self.wall, "m", above=inside)
        for body in ("ball", "socket"):
            material(getattr(self, body), body)
        object.__setattr__(self, "rim", self.joint.rim)  # and errors of the joint belong here

    @cached_property
    def joint(self) -> Joint:
        """The joint without its dimensions."""
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

    def law(self, law: AnyLaw | None = None) -> DimensionalLaw:
        """A law of this joint, in SI units: by default the table of its own solved curve.

        The table reaches a depth of at least one clearance, if the joint can. ``stiffened_hertz``
        gets its options from the joint, and ``power`` is fitted to it over the default range of
        `power_law`. The paper's laws have the coefficients of the paper's own joint.
        """
        if law is None:
            return self._table(usual_depth(self.joint))[0]
        law = find(law)
        if law is LAWS["stiffened_hertz"]:
            self.joint.check_linear(law.name)
        return self._in_si_units(law, **law_parameters(law, self.joint))

    def power_law(self, depths: tuple[float, float] | None = None) -> PowerFit:
        """The force as k d^n, fitted to the solved joint (`study.contact.power_fit`).

        The ``depths`` are least and largest, in m; by default 0.05 and 0.5 clearances.
        """
        low, high = depths or (share * self.clearance for share in USUAL_RANGE)
        least = checks.number("least depth", low, "m", above=0, scalar=True)
        most = checks.number("largest depth", high, "m", above=least, scalar=True)
        law = self._reaching("depth", np.array([most]), "m")
        places = np.geomspace(least, most, DEPTHS)
        return fit_power(places, law.force(places))

    def solve(
        self, *, depth: ArrayLike | None = None, force: ArrayLike | None = None
    ) -> DimensionalSolution:
        """Solve the joint at given depths, in m, or under given forces, in N; both > 0.

        A depth or force at which contact would reach the socket's rim, or is too small to be
        resolved, is a ``ValueError``, as is any other number of arguments than one.
        """
        asked, name = self._given(depth, force)
        unit = "m" if name == "depth" else "N"
        law = self._reaching(name, asked, unit)
        depths = asked if force is None else np.asarray(law.depth(asked))
        solved = self._solved(depths / self.clearance, name, asked, unit)
        forces = asked if depth is None else self._force(solved)
        off = np.abs(forces / self._force(solved) - 1)
        return self._solution(law, depths, forces, solved, solved.error_estimate + off)

    def solve_tilted(
        self, tilt: ArrayLike, *, depth: ArrayLike | None = None, force: ArrayLike | None = None
    ) -> TiltedSolution:
        """Solve the joint pressed off its axis: at given depths, in m, or under forces, in N.

        The ``tilt``, in deg off the axis, is the direction of the displacement if depths are given,
        and of the force if forces are. Errors are those of `study.joint.tilted_contact`, and a
        ``ValueError`` unless exactly one of the two is given.
        """
        given, name = self._given(depth, force)
        joint, clearance = self.joint, self.clearance
        modulus = joint.composite_modulus
        if name == "depth":
            contact = tilted_contact(joint, given / clearance, tilt)
        else:
            contact = under_force(joint, given / (modulus * clearance**2), tilt)
        units = {
            "depth": clearance,
            **dict.fromkeys(("force", "transverse"), modulus * clearance**2),
            **dict.fromkeys(("stiffness", "transverse_stiffness"), modulus * clearance),
            "peak_pressure": modulus * clearance / self.socket_radius,
        }
        found = {name: unit * getattr(contact, f"{name}_star") for name, unit in units.items()}
        moduli = {body: material.youngs_modulus for body, material in self.materials.items()}
        soft = applicability.modulus_limit(moduli)
        strains = found["peak_pressure"] / min(moduli.values())
        pairs = zip(found["depth"], strains, strict=True)
        of_each = [{"depth": depth, "strain": strain} for depth, strain in pairs]
        found["limits"] = tuple(each | soft for each in applicability.of_tilted(contact, of_each))
        others = {of.name for of in fields(TiltedSolution)} - found.keys()
        return TiltedSolution(**found, **{name: getattr(contact, name) for name in others})

    @staticmethod
    def _given(depth, force):
        if depth is None and force is None:
            raise ValueError("depth or force must be given")
        if depth is not None and force is not None:
            raise ValueError("either depth or force must be given, not both")
        name, unit = ("depth", "m") if force is None else ("force", "N")
        given: Any = depth if force is None else force
        asked = np.atleast_1d(checks.number(name, given, unit, above=0))
        if asked.ndim != 1 or asked.size == 0:
            raise ValueError(f"{name} must be a list of numbers, got shape {asked.shape}")
        return asked, name

    def curve(self) -> DimensionalSolution:
        """The whole curve, at some 50 depths up to one clearance, if the joint can."""
        law, curve = self._table(usual_depth(self.joint))
        depths = self.clearance * curve.depth_star
        return self._solution(law, depths, self._force(curve), curve, curve.error_estimate)

    def _force(self, curve):
        return self.joint.composite_modulus * self.clearance**2 * curve.force_star

    def _solution(self, law, depths, forces, solved, errors):
        """Stiffness by a law at depths, and all else from the joint solved there."""
        largest = largest_stress(solved)
        modulus, strengths = self.joint.composite_modulus, self.materials
        bodies = dict(zip(self.joint.materials, strengths, strict=True))
        pressure = modulus * self.clearance / self.socket_radius
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
                solved.contact_half_angle_deg[k],
                yield_factor={body: f[k] for body, f in factors.items() if f is not None},
                depth=depth,
                strain=pressure * solved.peak_pressure_star[k] / softest,
            )
            | soft
            for k, depth in enumerate(depths)
        )
        radii = friction_radii(solved)
        return DimensionalSolution(
            depth=depths,
            force=forces,
            stiffness=np.asarray(law.stiffness(depths)),
            contact_half_angle_deg=solved.contact_half_angle_deg,
            peak_pressure=pressure * solved.peak_pressure_star,
            error_estimate=errors,
            von_mises=stresses,
            von_mises_place={bodies[name]: stress.place for name, stress in largest.items()},
            yield_factor=factors,
            limits=limits,
            angle_deg=np.degrees(solved.angles),
            pressure=pressure * solved.pressure,
            friction_radius={motion: self.socket_radius * r for motion, r in radii.items()},
            law=law,
        )

    def _reaching(self, name, asked, unit):
        """Least table that reaches all depths or forces asked for."""
        deepest = usual_depth(self.joint)
        law, _ = self._table(deepest)

        def most():
            return law.deepest if name == "depth" else law.force(law.deepest)

        while most() < asked.max():
            deepest *= _STEP
            try:
                law, _ = self._table(deepest)
            except checks.RangeError:
                raise checks.RangeError(
                    f"{name} must be <= {most():.6g} {unit}, got {asked.max():g} {unit}: just "
                    "beyond, the contact would reach the socket's rim"
                ) from None
        return law

    def _table(self, deepest):
        curve = _whole_curve(self.joint, deepest)
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
            f"{name} must be so large that elements resolve the contact, got {asked.min():g} "
            f"{unit}: Hertz's law holds for such small contacts"
        )


def usual_depth(joint: Joint) -> float:
    """Default largest depth_star of a joint's law: 1, if the joint can."""
    return float(min(_USUAL, 0.8 * largest_depth(joint.r2_star)))
