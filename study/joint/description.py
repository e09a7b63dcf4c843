"""A spherical clearance joint as a user describes it, and what follows without a solution.

`JointDescription` has the sizes, materials and supports of a joint. The solvers take it: bodies,
the gap between them, and units of the normalised quantities. `study.joint.joint.Joint` is the same
joint, which can be solved.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from dataclasses import KW_ONLY, dataclass, field, fields
from functools import cached_property
from math import isclose
from typing import Any, NamedTuple
from warnings import warn

import numpy as np

from study import checks, parameters
from study.contact import Material, largest_depth, material
from study.contact.materials import read_material
from study.joint import limits
from study.joint.compliance import THICKEST_RATIO, THINNEST_RATIO, Ball, Socket
from study.joint.supports import (
    HEMISPHERE,
    KINEMATICS,
    RIMS,
    BallSupport,
    GuidedPlate,
    Kinematics,
    Opening,
    Rim,
    SocketSupport,
    WholeOutside,
    read_ball_support,
    read_opening,
    read_socket_support,
)
from study.parameters import parameter

LEAST_R2_STAR, LARGEST_R2_STAR = 10.0, 1e9
"""Range of the socket radius divided by the clearance. Below, a ball in a socket is no clearance
joint: small displacements are wrong by more than 6 %. Above, the clearance is lost when the radii
are rounded."""
LARGEST_MODULUS_RATIO = 1e9
"""Largest ratio of the bodies' Young's moduli, either way. A stiffer body is rigid, within 1e-9 of
the force. For a much softer socket, the rounded contact matrix is not positive definite."""
UNIT = Material().youngs_modulus
"""Young's modulus of the ball of a joint made from ratios, in Pa."""
TOO_LOOSE = (
    "such a loose ball is not in a clearance joint, for which the solution assumes small "
    "displacements"
)


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


def read_layer(name: str, text: str) -> Layer:
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
class JointDescription:
    """Sizes, materials and supports of a joint: see `study.joint.joint.Joint`."""

    socket_radius: float = parameter(..., "Inner radius of the socket", "m", above=0)
    clearance: float = parameter(..., "Radius of the socket less that of the ball", "m")
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
        "(clamped). A whole ball is held by a rigid core, "
        "for example core:0.2, which has 0.2 times the radius of the ball, or by a rigid neck on "
        "its surface, for example neck:30, within 30 deg of the top. A ball with a bore along its "
        "axis is held by a rigid pin over the whole bore; bore:0.5,45 is a bore of 0.5 times the "
        "radius of the ball between flat faces whose edges are at a polar angle of 45 deg. For a "
        "joint with dimensions, pin:6mm,16mm gives the radius of the pin and the width of the ball "
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
        "Socket opening: polar angle of the rim from the pole in deg (20 to 170), for example 110, "
        "or, for a ring that is open on both sides, the polar angles of both rims, as 55:125",
        parse=read_opening,
        kind=Opening,
    )
    socket_support: SocketSupport = parameter(
        WholeOutside(),
        "Socket support: where the socket is held rigidly. It is held at its whole outside "
        "(outside), at the face of its rim only (rim), or at the sector of its outside between two "
        "polar angles in deg, for example sector:0,30 (a seat at the pole) or sector:60,90",
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
                f"socket, got {clearance:g} m; {TOO_LOOSE}"
            )
        limits = {"least": (THINNEST_RATIO - 1) * radius, "most": (THICKEST_RATIO - 1) * radius}
        checks.number("clearance", clearance, "m", least=(1 - 1e-9) * radius / LARGEST_R2_STAR)
        checks.number("wall", self.wall, "m", **limits)
        inside = sum(liner.thickness for liner in self.liner)
        if self.wall <= inside:
            raise checks.RangeError(
                f"wall must be > {inside:g} m, the thickness of its liners, got {self.wall:g} m"
            )
        ball_radius = self.ball_radius if self.has_dimensions else None
        object.__setattr__(self, "ball_support", self.ball_support.in_ball(ball_radius))

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
        most = ball.outline.largest_opening
        checks.number(f"opening with ball_support {ball}", opening.last, "deg", most=most)
        if ends := self.socket_support.ends:
            checks.number("first angle of socket_support", ends[0], "deg", least=opening.first)
            checks.number("last angle of socket_support", ends[1], "deg", most=opening.last)
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
        if not self.has_dimensions:
            return ()
        moduli = {body: of.youngs_modulus for body, of in self.materials.items()}
        return limits.unit_warnings(self.socket_radius, moduli)

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
        return self.socket_support.is_all_round

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
        return not self.opening.is_ring and self.ball_support.outline.surface[0] == 0

    def is_plane_of_symmetry(self, tilt: float) -> bool:
        """Whether the joint is symmetric about a direction at a tilt in deg: its axis or equator.

        A force in this direction displaces the ball in this direction.
        """
        across = isclose(self.opening.first + self.opening.last, 180.0, abs_tol=1e-6)
        across &= self.ball_support.is_symmetric and self.socket_support.is_symmetric
        return tilt == 0 or (tilt == 90 and across)

    @property
    def default_tilt(self) -> float | None:
        """Default tilt of the load: 90 deg for a ring or a bore, else None for the axis."""
        return None if self.has_pole else 90.0

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

    @property
    def default_depth(self) -> float:
        """Default maximum depth in clearances: 1, or less if the spheres cannot be so deep."""
        return float(min(1.0, 0.8 * largest_depth(self.r2_star)))


SUPPORTS = tuple(
    of.name for of in fields(JointDescription) if of.kw_only and of.name != "has_dimensions"
)
"""Names of the arguments that describe supports, opening and kinematics."""


def _rounded(ratio):
    """A ratio of lengths without the rounding of their division."""
    return float(f"{ratio:.12g}")
