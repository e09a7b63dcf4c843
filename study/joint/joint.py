"""The spherical clearance joint: what a user describes, and what can be asked of it.

`Joint` is in SI units, or made from ratios. `reference_joint` is the paper's, as far as it can be
known. The elastic solution is found by `study.joint.axial` along the axis of the socket, and by
`study.joint.tilted` in other directions.
"""

from __future__ import annotations  # so that help() shows ArrayLike and not its definition

from dataclasses import KW_ONLY, dataclass, field, fields
from functools import cached_property
from typing import Any, NamedTuple
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike

from study import checks, parameters
from study.contact import (
    SOCKET_RATIO,
    DimensionalLaw,
    Material,
    Table,
    largest_depth,
    material,
)
from study.contact.laws import AnyLaw, find
from study.contact.materials import in_words, read_material
from study.contact.power_fit import DEPTHS, USUAL_RANGE, PowerFit, fit_power
from study.joint import axial, limits, table, tilted
from study.joint.compliance import THICKEST_RATIO, THINNEST_RATIO, Ball, Socket, layer_steps
from study.joint.solution import Solution
from study.joint.supports import (
    CLEAR,
    HEMISPHERE,
    KINEMATICS,
    RIMS,
    BallSupport,
    ClampedPlate,
    GuidedPlate,
    Kinematics,
    Neck,
    Opening,
    Pin,
    Rim,
    Sector,
    SocketSupport,
    WholeOutside,
    read_ball_support,
    read_opening,
    read_socket_support,
)
from study.parameters import Parameter, parameter

LEAST_R2_STAR, LARGEST_R2_STAR = 10.0, 1e9
"""Range of the socket radius divided by the clearance. Below, a ball in a socket is no clearance
joint: small displacements are wrong by more than 6 %. Above, the clearance is lost when the radii
are rounded."""
LARGEST_MODULUS_RATIO = 1e9
"""Largest ratio of the bodies' Young's moduli, either way. A stiffer body is rigid, within 1e-9 of
the force. For a much softer socket, the rounded contact matrix is not positive definite."""
UNIT = Material().youngs_modulus
"""Young's modulus of the ball of a joint made from ratios, in Pa."""
_TOO_LOOSE = (
    "such a loose ball is not in a clearance joint, for which the solution assumes small "
    "displacements"
)
_STEP, _NARROWEST = 1.2, 0.02  # from one maximum depth of a narrow socket to the next; the last one


class Layer(NamedTuple):
    """A layer of a socket: its outer radius over the socket's inner radius, and its material."""

    outer_ratio: float
    material: Material

    def __str__(self):
        """The modulus is over that of a ball of the default material."""
        material = self.material
        numbers = self.outer_ratio, material.youngs_modulus / UNIT, material.poisson
        return ",".join(f"{number:.9g}" for number in numbers)


@dataclass(frozen=True)
class Liner:
    """A liner inside a socket, with its thickness in m and its material."""

    thickness: float = parameter(..., "thickness of liner", "m", above=0)
    material: Material = parameter(..., "material of liner", kind=Material, parse=read_material)

    def __post_init__(self) -> None:
        parameters.take(self)

    def __str__(self) -> str:
        return f"{self.thickness:.9g},{self.material}"


def _read_liner(name: str, text: str) -> Liner:
    """Liner of a text, ``0.5mm,PTFE``."""
    thickness, _, of = text.partition(",")
    try:
        return Liner(checks.read(name, thickness, unit="m"), read_material(name, of.strip()))
    except checks.RangeError:
        raise
    except ValueError as error:
        wanted = f"{name} must be a thickness and a material, for example 0.5mm,PTFE"
        raise ValueError(f"{wanted}, got {text!r}: {error}") from None


def _read_layer(name: str, text: str) -> Layer:
    """Layer of a text, ``1.125,0.0025,0.46``."""
    ratio, modulus, poisson = checks.read_several(name, text, ("", "", ""))
    modulus = UNIT * checks.number(f"modulus of {name}", modulus, above=0)
    return Layer(ratio, Material(modulus, poisson))


def _of_material(default: str, body: str) -> Any:
    return parameter(
        default,
        f"Material of the {body}: a name that study data materials lists, or Young's modulus, "
        "Poisson's ratio and, optionally, yield stress, for example 210GPa,0.3,500MPa",
        kind=Material,
        parse=read_material,
    )


@dataclass(frozen=True)
class Joint:
    """A spherical clearance joint, in SI units.

    `solve` gives the elastic solution at given depths or under given forces, `curve` the
    force-depth curve, `law` a contact law, and `power_law` the constants of F = k d^n.
    `from_ratios` makes a joint without dimensions from ratios.

    Parameters
    ----------
    socket_radius, clearance, wall : float
        Inner radius of the socket, that radius less the radius of the ball, and wall thickness of
        the socket including its liners, in m.
    ball, socket : Material or str, default "bearing steel" and "steel"
        A name, or Young's modulus, Poisson's ratio and yield stress, as in "210GPa,0.3,500MPa".
    liner : tuple of Liner or str, default ()
        Liners from the inside out, as in "0.5mm,PTFE", separated by semicolons in a text.
    ball_support : BallSupport or str, default "guided"
        Half a ball on a plate: "guided", "clamped" or "centre". A whole ball: "core:0.2" (over its
        radius), "neck:30" (deg), "pin:6mm,16mm" (radius, width of the ball) or "bore:0.5,45".
    rim : {"mirror", "free"}, optional
        Edge of the socket. By default "mirror" for half a ball in a hemisphere, else "free".
    kinematics : {"linear", "small"}, default "linear"
        Points of the surfaces that are paired: after the ball has moved, or at equal polar angles.
    opening : Opening, float or str, default 90
        Polar angle of the rim in deg, 30 to 170; or those of both rims of a ring, "55:125".
    socket_support : SocketSupport or str, default "outside"
        Where the socket is held: "outside", "rim", or "sector:0,30" (polar angles in deg).

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    >>> joint = Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")
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
        "Liner inside the socket: its thickness and its material, for example 0.5mm,PTFE; "
        "may be repeated, from the inside out. The rest of the wall is of the socket's material",
        kind=Liner,
        parse=_read_liner,
        several=";",
    )
    _: KW_ONLY
    ball_support: BallSupport = parameter(
        GuidedPlate(),
        "Ball support: how the ball is held and moved. Half a ball is moved along the axis at its "
        "equatorial plane by a plate on which it can slide (guided) or to which it is clamped "
        "(clamped), or at its centre point only (centre). A whole ball is held by a rigid core, "
        "for example of 0.2 times its radius (core:0.2), or by a rigid neck on its surface, for "
        "example within 30 deg of the top (neck:30). A ball with a bore along its axis is held "
        "by a rigid pin over the whole bore; bore:0.5,45 is a bore of 0.5 times the radius of the "
        "ball between flat faces whose edges are at a polar angle of 45 deg. For a joint with "
        "dimensions, pin:6mm,16mm gives the radius of the pin and the width of the ball "
        "instead",
        parse=read_ball_support,
        kind=BallSupport,
    )
    rim: Rim = parameter(
        None,
        "Edge of the socket: in a mirror plane (mirror), or free of traction (free)",
        choices=RIMS,
        otherwise="mirror for half a ball in a hemispherical socket that is held at its whole "
        "outside and loaded along the axis, else free",
    )
    kinematics: Kinematics = parameter(
        "linear",
        "Contact kinematics: which points of the two surfaces are paired. small pairs points at "
        "equal angles from the centre of the socket, and the pressure acts on the area of the "
        "socket. linear pairs each point of the ball with the point of the socket that it has "
        "moved to, as in a small-strain analysis with contact on displaced surfaces, and the "
        "pressure acts on the area of the ball. They differ by terms of order 1/R2*",
        choices=KINEMATICS,
    )
    opening: Opening = parameter(
        HEMISPHERE,
        "Socket opening: polar angle of the rim from the pole in deg (30 to 170), or, for a ring "
        "that is open on both sides, the polar angles of both rims (for example 55:125)",
        parse=read_opening,
        kind=Opening,
    )
    socket_support: SocketSupport = parameter(
        WholeOutside(),
        "Socket support: where the socket is held rigidly. It is held at its whole outside "
        "(outside), at the face of its rim only (rim), or at the sector of its outside between two "
        "polar angles in deg (sector:0,30 is a seat at the pole, sector:60,90 a flange)",
        parse=read_socket_support,
        kind=SocketSupport,
    )
    has_dimensions: bool = field(default=True, compare=False, repr=False)
    """Whether the lengths are those of a real joint, or only their ratios mean something."""

    def __post_init__(self) -> None:
        parameters.take(self)
        self._check_sizes()
        self._check_materials()
        self._check_supports()
        for sentence in self.warnings:
            warn(sentence, checks.UnitWarning, stacklevel=4)

    @classmethod
    @parameters.describe(
        r2_star=Parameter(
            "Radius of the socket divided by the clearance, R2/dR",
            limits={"least": LEAST_R2_STAR, "most": LARGEST_R2_STAR},
            otherwise="200",
        ),
        socket_ratio=Parameter(
            "Outer radius of the socket divided by its inner radius; at least 1.02 for finite "
            "elements",
            limits={"least": THINNEST_RATIO, "most": THICKEST_RATIO},
            otherwise="1.298",
        ),
        modulus_ratio=Parameter(
            "Young's modulus of the socket divided by that of the ball",
            limits={"least": 1 / LARGEST_MODULUS_RATIO, "most": LARGEST_MODULUS_RATIO},
            otherwise="1",
        ),
        poisson=Parameter(
            "Poisson's ratio of the ball", limits={"above": -1, "below": 0.5}, otherwise="0.3"
        ),
        socket_poisson=Parameter(
            "Poisson's ratio of the socket",
            limits={"above": -1, "below": 0.5},
            otherwise="that of the ball",
        ),
        layers=Parameter(
            "Layer of the socket, as three numbers N,N,N: its outer radius divided by R2, its "
            "Young's modulus divided by that of the ball, and its Poisson's ratio; may be repeated "
            "for several layers, from the inside out",
            parse=_read_layer,
            kind=Layer,
            several=";",
        ),
    )
    def from_ratios(
        cls,
        r2_star: float = 200.0,
        socket_ratio: float | None = None,
        *,
        modulus_ratio: float | None = None,
        poisson: float | None = None,
        socket_poisson: float | None = None,
        layers: tuple[Layer, ...] = (),
        ball: Material | None = None,
        socket: Material | None = None,
        **supports: Any,
    ) -> Joint:
        """Joint described by ratios: R2 is 1 m, and Young's modulus of the ball 2e11 Pa.

        Parameters
        ----------
        r2_star : float, default 200
            Radius of the socket divided by the clearance.
        socket_ratio, modulus_ratio : float, default 1.298 and 1
            Outer over inner radius of the socket, and its Young's modulus over that of the ball.
        poisson, socket_poisson : float, default 0.3
            Poisson's ratios of ball and socket; the socket's is that of the ball if not given.
        layers : tuple of Layer or str, default ()
            Layers of the socket instead of its ratios, as in "1.1,0.01,0.4;1.5,1,0.3".
        ball, socket : Material, optional
            Materials that replace the ratios of the materials.
        **supports
            The arguments of `Joint` from ``ball_support`` on.

        Raises
        ------
        ValueError
            If a value is outside its range, or does not apply to a socket with layers.

        Examples
        --------
        >>> joint = Joint.from_ratios(200, modulus_ratio=0.5, ball_support="clamped")
        >>> joint.rim, joint.socket.youngs_modulus
        ('mirror', 100000000000.0)
        """
        if checks.number("r2_star", r2_star, scalar=True) < LEAST_R2_STAR:
            raise checks.RangeError(
                f"r2_star must be >= {LEAST_R2_STAR:g}, got {r2_star:g}; {_TOO_LOOSE}"
            )
        about = parameters.described(cls.from_ratios)
        values = r2_star, socket_ratio, modulus_ratio, poisson, socket_poisson
        given: dict[str, Any] = dict(zip(about, values, strict=False))
        given = {n: about[n].taken(n, value) for n, value in given.items() if value is not None}
        layers = about["layers"].taken("layers", layers)
        for name in ("modulus_ratio", "socket_poisson", "socket_ratio"):
            if layers and name in given:
                raise ValueError(
                    f"{name} does not apply to a joint with layers, which describe the socket; "
                    "remove it"
                )
        if ball is None:
            ball = Material(UNIT, given.get("poisson", 0.3))
        if socket is None:
            modulus = given.get("modulus_ratio", 1.0) * ball.youngs_modulus
            poisson = given.get("socket_poisson", ball.poisson)
            socket = Material(modulus, poisson, ball.yield_stress)
        outer = [given.get("socket_ratio", SOCKET_RATIO)]
        if layers:
            outer, socket = [of.outer_ratio for of in layers], layers[-1].material
            steps = layer_steps(np.array(outer))
            name = "outer radius of a layer divided by its inner radius"
            checks.number(name, steps, least=THINNEST_RATIO, most=THICKEST_RATIO)
        thick = np.diff([1.0, *outer[:-1]]).tolist()
        liner = tuple(Liner(t, of.material) for t, of in zip(thick, layers, strict=False))
        sizes = 1.0, 1 / given["r2_star"], outer[-1] - 1.0
        return cls(*sizes, ball, socket, liner, **supports, has_dimensions=False)

    def _check_sizes(self):
        radius, clearance = self.socket_radius, self.clearance
        if clearance <= 0:
            raise checks.RangeError(
                f"clearance must be > 0 m, got {clearance:g} m; without clearance the ball "
                "touches the socket all round, which is a different problem, so give the minimum "
                "clearance (radius of the socket less radius of the ball) that the tolerances allow"
            )
        if self.r2_star < LEAST_R2_STAR:
            raise checks.RangeError(
                f"clearance must be <= {radius / LEAST_R2_STAR:g} m, a tenth of the radius of the "
                f"socket, got {clearance:g} m; {_TOO_LOOSE}"
            )
        limits = {"least": (THINNEST_RATIO - 1) * radius, "most": (THICKEST_RATIO - 1) * radius}
        checks.number("clearance", clearance, "m", least=(1 - 1e-9) * radius / LARGEST_R2_STAR)
        checks.number("wall", self.wall, "m", **limits)
        inside = sum(liner.thickness for liner in self.liner)
        if self.wall <= inside:
            raise checks.RangeError(
                f"wall must be > {inside:g} m, the thickness of its liners, got {self.wall:g} m"
            )
        if isinstance(self.ball_support, Pin):
            if not self.has_dimensions:
                raise checks.RangeError(
                    "ball_support pin requires a joint with dimensions; without dimensions use "
                    "bore:RADIUS,ANGLE, where RADIUS is the radius of the bore divided by that of "
                    "the ball and ANGLE the polar angle of the edges of its faces in deg"
                )
            object.__setattr__(self, "ball_support", self.ball_support.in_ball(self.ball_radius))

    def _check_materials(self):
        name = "Young's modulus of the socket divided by that of the ball"
        most = LARGEST_MODULUS_RATIO
        for body, of in self.materials.items():
            if self.has_dimensions:
                material(of, body)  # a modulus in GPa or MPa is an error
            ratio = of.youngs_modulus / self.ball.youngs_modulus
            checks.number(name, ratio, least=1 / most, most=most)

    def _check_supports(self):
        """Check supports against each other, and choose the rim if it is not given."""
        ball, opening = self.ball_support, self.opening
        if opening.is_ring and ball.is_half:
            raise checks.RangeError(
                f"ball_support must hold a whole ball if the socket is a ring (opening {opening}), "
                "because a ring touches the ball at its equator; use for example core:0.2 (a rigid "
                f"core), neck:30 (a rigid neck) or bore:0.5,45 (a rigid pin in a bore), got {ball}"
            )
        most = 90.0 if ball.is_half else 180.0
        if isinstance(ball, Neck):
            most = 180 - ball.half_angle - CLEAR
        checks.number(f"opening with ball_support {ball}", opening.last, "deg", most=most)
        if isinstance(self.socket_support, Sector):
            held = self.socket_support
            checks.number("first angle of socket_support", held.first, "deg", least=opening.first)
            checks.number("last angle of socket_support", held.last, "deg", most=opening.last)
        hemisphere = opening == HEMISPHERE and ball.is_half and self.is_held_all_round
        if self.rim is None:
            object.__setattr__(self, "rim", "mirror" if hemisphere else "free")
        if not hemisphere:
            why = "unless half a ball is in a hemispherical socket held at its whole outside"
            checks.choice(f"rim ({why})", self.rim, ("free",))

    @cached_property
    def r2_star(self) -> float:
        """Radius of the socket divided by the clearance, R2*."""
        return _rounded(self.socket_radius / self.clearance)

    @cached_property
    def socket_ratio(self) -> float:
        """Outer radius of the socket divided by its inner radius."""
        return _rounded(1 + self.wall / self.socket_radius)

    @property
    def radius_ratio(self) -> float:
        """Radius of the ball divided by that of the socket, R1/R2."""
        return 1 - 1 / self.r2_star

    @property
    def ball_radius(self) -> float:
        """Radius of the ball in m."""
        return self.socket_radius - self.clearance

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on dimensions and moduli that were probably meant in another unit."""
        return limits.unit_warnings(self) if self.has_dimensions else ()

    @property
    def materials(self) -> dict[str, Material]:
        """Materials of ``ball``, ``liner 1`` and so on from the inside out, and ``socket``."""
        liners = {f"liner {k}": of.material for k, of in enumerate(self.liner, 1)}
        return {"ball": self.ball, **liners, "socket": self.socket}

    @cached_property
    def layers(self) -> tuple[Layer, ...]:
        """Liners and the rest of the socket, from the inside out."""
        inside = np.cumsum([of.thickness for of in self.liner]) / self.socket_radius
        liners = zip(inside.tolist(), self.liner, strict=True)
        return (
            *(Layer(_rounded(1 + outer), of.material) for outer, of in liners),
            Layer(self.socket_ratio, self.socket),
        )

    @property
    def innermost(self) -> Material:
        """Material of the socket where it faces the ball."""
        return self.liner[0].material if self.liner else self.socket

    @property
    def modulus_ratio(self) -> float:
        """Young's modulus of the innermost layer divided by that of the ball."""
        return self.innermost.youngs_modulus / self.ball.youngs_modulus

    @cached_property
    def composite_modulus(self) -> float:
        """Composite modulus E* in Pa, of the ball and the innermost layer."""
        bodies = self.ball, self.innermost
        return 1 / sum((1 - of.poisson**2) / of.youngs_modulus for of in bodies)

    @property
    def modulus_shares(self) -> tuple[float, float]:
        """E*/E of the ball and of the innermost layer."""
        composite = self.composite_modulus
        return composite / self.ball.youngs_modulus, composite / self.innermost.youngs_modulus

    @property
    def force_unit(self) -> float:
        """Unit of the normalised force, E* dR^2, in N."""
        return self.composite_modulus * self.clearance**2

    @property
    def stiffness_unit(self) -> float:
        """Unit of the normalised stiffness, E* dR, in N/m."""
        return self.composite_modulus * self.clearance

    @property
    def pressure_unit(self) -> float:
        """Unit of the normalised pressure, E* dR/R2, in Pa."""
        return self.composite_modulus * self.clearance / self.socket_radius

    @property
    def supports(self) -> dict[str, Any]:
        """Supports, opening and kinematics by the names of the arguments."""
        return {name: getattr(self, name) for name in SUPPORTS}

    @cached_property
    def ball_body(self) -> Ball:
        """The ball as an elastic body."""
        return Ball(float(self.ball.poisson), self.ball_support, self.opening)

    @cached_property
    def socket_body(self) -> Socket:
        """The socket as an elastic body."""
        layers, unit = self.layers, self.innermost.youngs_modulus
        return Socket(
            tuple(float(layer.outer_ratio) for layer in layers),
            tuple(float(layer.material.poisson) for layer in layers),
            tuple(float(layer.material.youngs_modulus / unit) for layer in layers),
            self.rim,
            self.socket_support,
            self.opening,
        )

    @property
    def is_held_all_round(self) -> bool:
        """Whether the socket is held all over its outside."""
        return isinstance(self.socket_support, WholeOutside)

    @property
    def acts_on_ball(self) -> bool:
        """Whether the force acts on the ball's area, whose points move; else on the socket's."""
        return self.kinematics == "linear"

    @property
    def series_applies(self) -> bool:
        """Whether the exact series applies: bodies that are symmetric about the equator."""
        return self.ball_body.by_series and self.socket_body.by_series

    @property
    def has_pole(self) -> bool:
        """Whether ball and socket face each other on the axis, along which they can be pressed."""
        return not self.opening.is_ring and self.ball_support.surface[0] == 0

    @property
    def default_tilt(self) -> float | None:
        """Default tilt of the load: 90 deg for a ring or a bore, else None for the axis."""
        return None if self.has_pole else 90.0

    def arguments(self) -> dict[str, Any]:
        """Arguments of `Joint` or `from_ratios` that are not the default.

        They are texts, and numbers of 9 digits. Materials are given by their numbers, because the
        table of materials may change.
        """
        about, default = parameters.described(Joint), parameters.defaults(Joint)
        if self.has_dimensions:
            given = {name: getattr(self, name) for name in about}
        else:
            given = {"r2_star": self.r2_star, "poisson": self.ball.poisson}
            if self.liner:
                given["layers"] = self.columns()["layers"]
            else:
                given |= {name: getattr(self, name) for name in ("socket_ratio", "modulus_ratio")}
                given["socket_poisson"] = self.socket.poisson
            default = {"r2_star": 200.0, "poisson": 0.3} | {n: default[n] for n in SUPPORTS}
            order = parameters.described(Joint.from_ratios)
            given = {name: given[name] for name in order if name in given} | self.supports
        written: dict[str, Any] = {}
        for name, value in given.items():
            if value is None or value == default.get(name, ...):
                continue
            is_number = isinstance(value, float)
            of = about.get(name, about["rim"])
            written[name] = float(f"{value:.9g}") if is_number else of.written(value)
        return written

    def __str__(self) -> str:
        shown = {name: str(value) for name, value in self.arguments().items()}
        made = "Joint"
        if self.has_dimensions:
            shown |= {name: in_words(getattr(self, name)) for name in ("ball", "socket")}
        else:
            made, shown = "Joint.from_ratios", {"r2_star": f"{self.r2_star:.9g}"} | shown
        return f"{made}({', '.join(f'{name}={text}' for name, text in shown.items())})"

    def columns(self) -> dict[str, Any]:
        """The joint as columns of a table, as in `study.dataset.load`."""
        layers = [
            f"{of.outer_ratio:.9g},{of.material.youngs_modulus / self.ball.youngs_modulus:.9g},"
            f"{of.material.poisson:.9g}"
            for of in self.layers
        ]
        return {
            "r2_star": self.r2_star,
            "socket_ratio": self.socket_ratio,
            "poisson_ball": self.ball.poisson,
            "poisson_socket": self.innermost.poisson,
            "modulus_ratio": self.modulus_ratio,
            "layers": ";".join(layers) if self.liner else "",
            "ball_support": str(self.ball_support),
            "rim": self.rim,
            "kinematics": self.kinematics,
        }

    def solve(
        self,
        *,
        depth: ArrayLike | None = None,
        force: ArrayLike | None = None,
        depth_star: ArrayLike | None = None,
        tilt: ArrayLike | None = None,
        resolution: int | None = None,
        solver: axial.Solver | None = None,
        stresses: bool = False,
    ) -> Solution:
        """Elastic solution at given penetration depths or under given contact forces.

        New bodies take a tenth of a second by the series and some seconds by finite elements. A
        depth then takes some milliseconds along the axis, and a tenth of a second off it.

        Parameters
        ----------
        depth, force, depth_star
            Penetration depths in m, forces in N, or depths divided by the clearance, > 0: one
            number or shape (k,). Exactly one of the three must be given.
        tilt
            Angle in deg between the axis and the displacement, if depths are given, or the force,
            if forces are given, from 0 to 170: one number or shape (k,). The default is a load
            along the axis, or 90 deg for a ring or a ball with a bore.
        resolution
            Elements along a quarter circle. Along the axis it is a multiple of 32, by default 320
            for the series and 160 for finite elements. Off the axis it is a multiple of 16 from 32
            to 96, by default 48. Half of it is solved too.
        solver
            Along the axis: ``series`` for the Legendre series, or finite elements with six-node
            (``quadratic``) or three-node (``linear``) triangles. Forces of three-node triangles,
            which Yao et al. use, are not extrapolated, to show what such a mesh gives. The default
            is the series where it applies (ball support ``guided``, rim ``mirror``), else six-node
            triangles.
        stresses
            Whether the maximum von Mises stress in each body is computed.

        Raises
        ------
        ValueError
            If the contact along the axis would reach the rim of the socket, if it is too small for
            the elements to resolve, if the joint or a value is not suited to the load, or if not
            exactly one of depth, force and depth_star is given.
        study.joint.complementarity.ComplementarityError
            If the contact problem does not converge.

        Examples
        --------
        >>> joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
        >>> joint.solve(depth=[2e-6, 4e-6]).force.round()
        array([ 859., 2730.])
        """
        scales = {"depth": self.clearance, "force": self.force_unit, "depth_star": 1.0}
        values: dict[str, Any] = {"depth": depth, "force": force, "depth_star": depth_star}
        names = [name for name, value in values.items() if value is not None]
        if len(names) != 1:
            raise ValueError(
                "exactly one of depth, force and depth_star must be given, got "
                f"{' and '.join(names) or 'none'}"
            )
        (name,), tilt = names, self.default_tilt if tilt is None else tilt
        unit = {"depth": "m", "force": "N"}.get(name, "")
        asked = np.atleast_1d(checks.number(name, values[name], unit, above=0))
        if asked.ndim != 1 or asked.size == 0:
            raise ValueError(f"{name} must be one number or a list, got shape {asked.shape}")
        star, is_force = asked / scales[name], name == "force"
        if tilt is not None and solver is not None:
            raise ValueError("solver does not apply to a load off the axis; remove it")
        try:
            if tilt is None:
                return axial.solve(self, star, is_force, stresses, resolution, solver)
            return tilted.solve(self, star, is_force, stresses, resolution, tilt)
        except checks.RangeError as error:  # which is in clearances
            text = str(error)
            if name != "depth_star" and not text.startswith(f"{name} must"):
                text += f" ({name} given: {', '.join(f'{one:g}' for one in asked)} {unit})"
            raise type(error)(" ".join([*self.warnings, text])) from None

    def curve(
        self,
        deepest: float | None = None,
        tilt: float | None = None,
        resolution: int | None = None,
        *,
        stresses: bool = False,
    ) -> Solution:
        """Force-depth curve up to a maximum depth, for a table of the force.

        Along the axis there are about 50 depths from about 0.0003 clearances on, at which the edge
        of the contact is a node; the last one may be slightly greater than the maximum. The curve
        takes 30 ms, and new bodies more (`solve`). Off the axis there are 9 depths from a sixteenth
        of the maximum on.

        Parameters
        ----------
        deepest
            Maximum depth in clearances. The default is 1, or less if the contact of a narrow socket
            cannot be so deep.
        tilt, resolution, stresses
            As in `solve`; one tilt.
        """
        tilt = self.default_tilt if tilt is None else tilt
        last = self.default_depth if deepest is None else deepest
        while True:
            try:
                if tilt is None:
                    return axial.curve(self, last, resolution, stresses)
                return tilted.curve(self, float(tilt), last, resolution, stresses)
            except checks.RangeError as error:
                # the rim of a narrow socket may be nearer than one clearance
                is_rim = deepest is None and not isinstance(error, axial.UnresolvedError)
                if not is_rim or last < _NARROWEST:
                    raise
                last /= _STEP

    @property
    def default_depth(self) -> float:
        """Default maximum depth in clearances: 1, or less if the spheres cannot be so deep."""
        return float(min(1.0, 0.8 * largest_depth(self.r2_star)))

    def table(
        self,
        deepest: float | None = None,
        tilt: float | None = None,
        resolution: int | None = None,
    ) -> Table:
        """Table of the elastic solution as a contact law; arguments are those of `curve`.

        The ``error`` of the table is the maximum relative error of its force, relative to the
        elastic solution, at the depths that were checked. Its ``curve`` is the `Solution`.
        """
        return table.checked(self, deepest, tilt, resolution)

    def law(self, law: AnyLaw = "tabulated", tilt: float | None = None) -> DimensionalLaw:
        """Contact law of this joint, in SI units.

        Parameters
        ----------
        law
            Name of a law, or a law itself. By default it is the `table` of the elastic solution of
            this joint. ``stiffened_hertz`` is looked up for the joint and ``power`` fitted to it;
            the coefficients of the other laws are those of the reference joint of the study.
        tilt
            Angle in deg between displacement and axis. The law is then the table of the force along
            a displacement in this direction.

        Examples
        --------
        >>> joint = Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3)
        >>> law = joint.law("stiffened_hertz")
        >>> print(f"{law.force(4e-6):.0f} N, {law.stiffness(4e-6):.3g} N/m")
        3479 N, 1.42e+09 N/m
        """
        tilt = self.default_tilt if tilt is None else tilt
        if tilt is not None and law != "tabulated":
            raise ValueError(
                "law must be the table of the elastic solution for a load off the axis, got "
                f"{law}; remove law, or use the fitted power law of power_law"
            )
        return DimensionalLaw(
            find(law, self) if tilt is None else self.table(tilt=tilt),
            ball_radius=self.ball_radius,
            socket_radius=self.socket_radius,
            composite_modulus=self.composite_modulus,
            joint=self,
        )

    def power_fit(
        self, depths: tuple[float, float] = USUAL_RANGE, tilt: float | None = None
    ) -> PowerFit:
        """Power law P* = k* ds^n, fitted to the elastic solution between two depths in clearances.

        It is dimensionless; `power_law` is the same in SI units.
        """
        low = checks.number("minimum depth_star", depths[0], above=0, scalar=True)
        high = checks.number("maximum depth_star", depths[1], above=low, scalar=True)
        tilt = self.default_tilt if tilt is None else tilt
        law = self.table(tilt=tilt)
        if law.deepest < high:
            law = self.table(high, tilt)
        places = np.geomspace(low, high, DEPTHS)
        return fit_power(places, law(places))

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
        >>> joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
        >>> fit = joint.power_law()
        >>> print(f"k = {fit.coefficient:.3e} N/m^n, n = {fit.exponent:.3f}, {fit.error:.1%}")
        k = 2.272e+12 N/m^n, n = 1.653, 1.0%
        """
        unit = self.clearance
        low, high = depths or (share * unit for share in USUAL_RANGE)
        low = checks.number("minimum depth", low, "m", above=0, scalar=True)
        high = checks.number("maximum depth", high, "m", above=low, scalar=True)
        fit = self.power_fit((low / unit, high / unit), tilt)
        coefficient = fit.coefficient * self.force_unit / unit**fit.exponent
        return fit._replace(coefficient=coefficient, depths=(low, high))


SUPPORTS = tuple(of.name for of in fields(Joint) if of.kw_only and of.name != "has_dimensions")
"""Names of the arguments that describe supports, opening and kinematics."""
REFERENCE_SUPPORTS: dict[str, Any] = {"ball_support": ClampedPlate(), "rim": "free"}
"""How the paper's finite elements hold ball and socket: identified from its Table 2."""


def reference_joint(r2_star: float = 200, **changes: Any) -> Joint:
    """The reference joint: the configuration inferred from Table 2 of Yao et al.

    It has a clamped ball, a free rim, a socket ratio of 1.298, linear kinematics and Poisson's
    ratio 0.3 of both bodies. These were inferred from Table 2 and Fig. 14 (notebook 13), except
    for the rim, which follows from the text ("the entire external surface of the socket is fixed").

    Parameters
    ----------
    r2_star
        Radius of the socket divided by the clearance; 200 in Fig. 10 and Table 2.
    **changes
        Other arguments of `Joint.from_ratios`.
    """
    return Joint.from_ratios(r2_star, **(REFERENCE_SUPPORTS | changes))


def _rounded(ratio):
    """A ratio of lengths without the rounding of their division."""
    return float(f"{ratio:.12g}")
