"""Supports of ball and socket, as objects, and the opening of the socket.

A support names the boundaries of the meridian's mesh that it holds, and the components of the
displacement that are zero there (`study.joint.modes`). A support may be given as a text, such as
``core:0.2``, and it is written as the same text. Angles are polar angles in deg from the pole,
which is the point of the socket that the ball is pressed into by a load along the axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Literal, NamedTuple, get_args

import numpy as np

from study import checks, parameters
from study.parameters import described, parameter

Rim = Literal["mirror", "free"]
RIMS: tuple[Rim, ...] = get_args(Rim)
Kinematics = Literal["small", "linear"]
KINEMATICS: tuple[Kinematics, ...] = get_args(Kinematics)
CLEAR = 5.0
"""Minimum angle between neck and rim, and minimum width of a sector and of half a ring, in deg."""
HEIGHT = 0.1
"""Distance from corners and from the equator of half a ball, in radii, from which on stresses are
sought: they have no bound at the corner of a clamped and a free surface."""
WALL = 0.05
"""Minimum width of a face between its edge and the bore, over the ball's radius."""
ON = 1e-3
"""Distance from a surface, in radii, of places that are on it."""
Boundary = tuple[float, float, float, float]
"""Least and largest radius, over the body's own, and least and largest polar angle in rad."""


@dataclass(frozen=True)
class _Support:
    """A support that is written as its word and its numbers."""

    word: ClassVar[str]
    held: ClassVar[dict[str, str]]
    """Boundary of the mesh -> components of the displacement that are zero there."""

    def __post_init__(self) -> None:
        parameters.take(self, by_meaning=True)

    def __str__(self):
        numbers = ",".join(f"{getattr(self, of.name):.9g}" for of in fields(self))
        return f"{self.word}:{numbers}" if numbers else self.word


class Outline(NamedTuple):
    """What follows from a ball's support for its meridian: lengths over the ball's radius."""

    held: Boundary
    """The boundary that is held."""
    surface: tuple[float, float] = (0.0, 180.0)
    """Polar angles between which the socket may face the ball's surface, in deg."""
    meridian: tuple[float, float] = (0.0, 180.0)
    """Polar angles between which the meridian lies, in deg."""
    largest_opening: float = 180.0
    """Maximum polar angle of the socket's rim, in deg."""
    corners: Sequence[tuple[float, float]] = ()
    """Places (r, z) at which stresses may have no bound."""
    lowest: float = -1.0
    """Height z above which the largest stress is sought."""
    edge: float | None = None
    """Polar angle in rad at which stresses on the surface have no bound."""
    core: float = 0.0
    """Radius of a rigid core, or 0."""
    bore: float = 0.0
    """Radius of a bore along the axis, or 0."""


@dataclass(frozen=True)
class BallSupport(_Support):
    """How the ball is held and moved: half a ball by a plate, a whole one otherwise."""

    is_half: ClassVar[bool] = False
    is_symmetric: ClassVar[bool] = False
    """Whether the equatorial plane of the ball acts as a mirror."""

    @property
    def outline(self) -> Outline:
        """The meridian of a ball with this support."""
        raise NotImplementedError

    def in_ball(self, ball_radius: float | None) -> "BallSupport":
        """The support of a ball with a radius in m, or without dimensions."""
        return self


HALF = Outline(
    held=(0, 1, np.pi / 2, np.pi / 2),
    surface=(0.0, 90.0),
    meridian=(0.0, 90.0),
    largest_opening=90.0,
    corners=((1.0, 0.0),),
    lowest=HEIGHT,
)
"""Outline of half a ball, which is moved by a plate at its equatorial plane."""


class GuidedPlate(BallSupport):
    """A plate that moves the equatorial plane along the axis and on which this plane can slide."""

    word, held, outline, is_half, is_symmetric = "guided", {"equator": "z"}, HALF, True, True


class ClampedPlate(BallSupport):
    """A plate to which the equatorial plane is clamped."""

    word, held, outline, is_half = "clamped", {"equator": "rz"}, HALF, True


@dataclass(frozen=True)
class Core(BallSupport):
    """A rigid core that holds a whole ball."""

    radius: float = parameter(
        ..., "radius of the core divided by that of the ball", least=0.05, most=0.8
    )

    word, held, is_symmetric = "core", {"core": "rz"}, True

    @property
    def outline(self) -> Outline:  # noqa: D102
        held = (self.radius, self.radius, 0, np.pi)
        return Outline(held, surface=(0.0, 172.0), core=self.radius)


@dataclass(frozen=True)
class Neck(BallSupport):
    """A rigid neck that holds a whole ball at its surface, within an angle from the top."""

    half_angle: float = parameter(..., "half-angle of the neck", "deg", least=5, most=90)

    word, held = "neck", {"neck": "rz"}

    @property
    def outline(self) -> Outline:  # noqa: D102
        last = 180.0 - self.half_angle
        edge = np.pi - np.radians(self.half_angle)
        r, z = float(np.sin(edge)), float(np.cos(edge))
        return Outline(
            held=(1, 1, edge, np.pi),
            surface=(0.0, last),
            largest_opening=last - CLEAR,
            corners=((r, z),),
            lowest=z / 2,
            edge=edge,
        )


@dataclass(frozen=True)
class Bore(BallSupport):
    """A cylindrical bore along the axis between flat faces, held over its length by a rigid pin."""

    radius: float = parameter(
        ..., "radius of the bore divided by that of the ball", least=0.05, most=0.9
    )
    face: float = parameter(
        ...,
        "polar angle of the edges of the faces from the axis of the bore",
        "deg",
        least=10,
        most=80,
    )

    word, held, is_symmetric = "bore", {"bore": "rz"}, True

    def __post_init__(self) -> None:
        super().__post_init__()
        edge = float(np.sin(np.radians(self.face)))
        if self.radius > edge - WALL:
            raise checks.RangeError(
                f"radius of the bore must be <= {edge - WALL:.4g} times the radius of the ball for "
                f"faces whose edges are at a polar angle of {self.face:g} deg, got "
                f"{self.radius:g}; reduce the bore or increase the angle of the faces"
            )

    @property
    def outline(self) -> Outline:  # noqa: D102
        between = self.face, 180.0 - self.face
        edge, height = np.sin(np.radians(self.face)), np.cos(np.radians(self.face))
        return Outline(
            held=(0.5, 0.5, 0, np.pi),  # before `study.joint.meridian` bends the mesh to the bore
            surface=between,
            meridian=between,
            corners=[(r, side * height) for r in (self.radius, edge) for side in (1, -1)],
            bore=self.radius,
        )


@dataclass(frozen=True)
class Pin(BallSupport):
    """A `Bore` described by its dimensions in m, for a joint with dimensions."""

    radius: float = parameter(..., "radius of the pin", "m", above=0)
    width: float = parameter(..., "width of the ball between its faces", "m", above=0)

    word, held = "pin", {"bore": "rz"}

    def in_ball(self, ball_radius: float | None) -> Bore:  # noqa: D102
        if ball_radius is None:
            raise checks.RangeError(
                "ball_support pin requires a joint with dimensions; without dimensions use "
                "bore:RADIUS,ANGLE, where RADIUS is the radius of the bore divided by that of "
                "the ball and ANGLE the polar angle of the edges of its faces in deg"
            )
        checks.number("width of the ball", self.width, "m", below=2 * ball_radius)
        face = float(np.degrees(np.arccos(self.width / 2 / ball_radius)))
        largest = np.sqrt(ball_radius**2 - self.width**2 / 4) - WALL * ball_radius
        if self.radius > largest:
            raise checks.RangeError(
                f"radius of the pin must be <= {largest:.4g} m in a ball with a radius of "
                f"{ball_radius:.4g} m and a width of {self.width:g} m, got {self.radius:g} m; give "
                "a thinner pin or a narrower ball"
            )
        return Bore(self.radius / ball_radius, face)


@dataclass(frozen=True)
class SocketSupport(_Support):
    """Where the socket is held rigidly."""

    is_all_round: ClassVar[bool] = False
    """Whether the socket is held all over its outside."""

    @property
    def ends(self) -> tuple[float, ...]:
        """Polar angles in deg between which a part of the outside is held."""
        return ()

    @property
    def is_symmetric(self) -> bool:
        """Whether the mirror image about the equator would be held in the same way."""
        return self.is_all_round or sum(self.ends) == 180


class WholeOutside(SocketSupport):
    """The whole outside of the socket."""

    word, held, is_all_round = "outside", {"outside": "rz"}, True


class RimFace(SocketSupport):
    """The face of the rim only."""

    word, held = "rim", {"rim": "rz"}


@dataclass(frozen=True)
class Sector(SocketSupport):
    """The outside of the socket between two polar angles: a seat at the pole, or a flange."""

    first: float = parameter(..., "first polar angle of the sector", "deg", least=0)
    last: float = parameter(..., "last polar angle of the sector", "deg", most=170)

    word, held = "sector", {"seat": "rz"}

    def __post_init__(self):
        super().__post_init__()
        checks.number("last polar angle of the sector", self.last, "deg", least=self.first + CLEAR)

    @property
    def ends(self) -> tuple[float, ...]:  # noqa: D102
        return self.first, self.last


BALL_SUPPORTS: tuple[type[BallSupport], ...] = GuidedPlate, ClampedPlate, Core, Neck, Bore, Pin
SOCKET_SUPPORTS: tuple[type[SocketSupport], ...] = (WholeOutside, RimFace, Sector)


def _parser(kinds):
    """Parser of a text such as ``core:0.2``, for `study.parameters.Parameter`."""
    known = {kind.word: kind for kind in kinds}
    forms = [":".join([k.word, ",".join("NUMBER" for _ in fields(k))]).rstrip(":") for k in kinds]

    def parse(name: str, text: str) -> Any:
        word, colon, numbers = text.partition(":")
        kind = known.get(word)
        if kind is None or bool(colon) != bool(fields(kind)):
            raise ValueError(f"{name} must be one of {', '.join(forms)}, got {checks.shown(text)}")
        if not colon:
            return kind()
        units = [of.unit for of in described(kind).values()]
        values = checks.read_several(name, numbers, units)
        try:
            return kind(*values)
        except checks.RangeError as error:
            raise checks.RangeError(f"{error}, in {name} {text}") from None

    return parse


read_ball_support, read_socket_support = _parser(BALL_SUPPORTS), _parser(SOCKET_SUPPORTS)


@dataclass(frozen=True)
class Opening:
    """Polar angles in deg where a socket's surface ends: a cup at one rim, a ring at two.

    Written as ``90``, or for a ring as ``55:125``.
    """

    last: float
    first: float = 0.0

    def __post_init__(self) -> None:
        checks.number("first angle of opening", self.first, "deg", least=0, scalar=True)
        if self.is_ring and self.first > self.last - 2 * CLEAR:
            raise checks.RangeError(
                f"opening of a ring must be FIRST:LAST with LAST >= FIRST + {2 * CLEAR:g} deg, for "
                f"example 55:125, got {self}"
            )
        if self.is_ring:
            checks.number("first angle of opening of a ring", self.first, "deg", least=CLEAR)
        checks.number("opening", self.last, "deg", least=20, most=170, scalar=True)

    def __str__(self) -> str:
        return f"{self.first:.9g}:{self.last:.9g}" if self.is_ring else f"{self.last:.9g}"

    @property
    def is_ring(self) -> bool:
        """Whether the socket is open on both sides."""
        return self.first > 0

    @property
    def reach(self) -> float:
        """Maximum polar angle in rad of a contact along the axis: pi/2, or that of the rim."""
        return min(np.pi / 2, float(np.radians(self.last)))

    def faces(self, tilt: float) -> bool:
        """Whether the socket's surface is in a direction at an angle in deg from its axis."""
        return self.first <= tilt < self.last if self.is_ring else tilt < self.last


HEMISPHERE = Opening(90.0)


def read_opening(name: str, text: str) -> Opening:
    """Opening of a text, ``90`` or ``55:125``."""
    first, colon, last = text.rpartition(":")
    if not colon:
        return Opening(checks.read(name, last, unit="deg"))
    return Opening(*(checks.read(name, angle, unit="deg") for angle in (last, first)))
