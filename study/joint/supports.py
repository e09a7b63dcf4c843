"""Supports of ball and socket, as objects, and the opening of the socket.

A support names the boundaries of the meridian's mesh that it holds, and the components of the
displacement that are zero there (`study.joint.modes`). A support may be given as a text, such as
``core:0.2``, and it is written as the same text. Angles are polar angles in deg from the pole,
which is the point of the socket that the ball is pressed into by a load along the axis.
"""

from dataclasses import dataclass, fields
from typing import Any, ClassVar, Literal, get_args

import numpy as np
from numpy.typing import NDArray

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
Floats = NDArray[np.float64]
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


@dataclass(frozen=True)
class BallSupport(_Support):
    """How the ball is held and moved: half a ball by a plate, a whole one otherwise."""

    is_half: ClassVar[bool] = False
    is_symmetric: ClassVar[bool] = False
    """Whether the mirror image about the equator of the ball would be held in the same way."""
    needs_dimensions: ClassVar[bool] = False

    @property
    def largest_opening(self) -> float:
        """Maximum polar angle of the socket's rim, in deg."""
        return 180.0

    @property
    def surface(self) -> tuple[float, float]:
        """Polar angles between which the socket may face the ball's surface, in deg."""
        raise NotImplementedError

    @property
    def meridian(self) -> tuple[float, float]:
        """Polar angles between which the ball's meridian lies, in deg."""
        return (0.0, 180.0)

    @property
    def bore(self) -> float:
        """Radius of a bore along the axis, over the ball's; 0 without a bore."""
        return 0.0

    @property
    def boundaries(self) -> dict[str, Boundary]:
        """Boundaries of the ball's meridian by which it may be held."""
        raise NotImplementedError

    @property
    def corners(self) -> list[tuple[float, float]]:
        """Places (r, z) in the meridian at which stresses may have no bound, over the radius."""
        return []

    @property
    def lowest(self) -> float:
        """Height z in the ball, over its radius, above which its largest stress is sought."""
        return -1.0

    @property
    def edge(self) -> float | None:
        """Polar angle in rad at which stresses on the surface have no bound."""
        return None

    @property
    def inside(self) -> float:
        """Radius over the ball's at which a mesh of concentric rings ends."""
        return 0.0

    def through(self, points: Floats) -> Floats:
        """Points (r, z) of the ball's meridian from those of a mesh of concentric rings."""
        return points

    def holds(self, r: Floats, z: Floats) -> NDArray[np.bool_]:
        """Whether places (r, z) are on what holds a whole ball inside it."""
        return np.zeros(len(r), bool)

    def in_ball(self, radius: float) -> "BallSupport":
        """The support relative to the radius of a ball, which is given in m."""
        return self


class _Plate(BallSupport):
    """A plate at the equatorial plane, which moves half a ball along the axis."""

    is_half, largest_opening, surface, meridian = True, 90.0, (0.0, 90.0), (0.0, 90.0)
    corners: ClassVar[list[tuple[float, float]]] = [(1.0, 0.0)]
    lowest = HEIGHT
    boundaries: ClassVar[dict[str, Boundary]] = {"equator": (0, 1, np.pi / 2, np.pi / 2)}


class GuidedPlate(_Plate):
    """A plate on which the equatorial plane can slide."""

    word, held, is_symmetric = "guided", {"equator": "z"}, True


class ClampedPlate(_Plate):
    """A plate to which the equatorial plane is clamped."""

    word, held = "clamped", {"equator": "rz"}


@dataclass(frozen=True)
class Core(BallSupport):
    """A rigid core that holds a whole ball."""

    radius: float = parameter(
        ..., "radius of the core divided by that of the ball", least=0.05, most=0.8
    )

    word, held, is_symmetric, surface = "core", {"core": "rz"}, True, (0.0, 172.0)

    @property
    def boundaries(self) -> dict[str, Boundary]:  # noqa: D102
        return {"core": (self.radius, self.radius, 0, np.pi)}

    @property
    def inside(self) -> float:  # noqa: D102
        return self.radius

    def holds(self, r: Floats, z: Floats) -> NDArray[np.bool_]:  # noqa: D102
        return np.abs(np.hypot(r, z) - self.radius) < ON


@dataclass(frozen=True)
class Neck(BallSupport):
    """A rigid neck that holds a whole ball at its surface, within an angle from the top."""

    half_angle: float = parameter(..., "half-angle of the neck", "deg", least=5, most=90)

    word, held = "neck", {"neck": "rz"}

    @property
    def largest_opening(self) -> float:  # noqa: D102
        return 180.0 - self.half_angle - CLEAR

    @property
    def surface(self) -> tuple[float, float]:  # noqa: D102
        return 0.0, 180.0 - self.half_angle

    @property
    def boundaries(self) -> dict[str, Boundary]:  # noqa: D102
        return {"neck": (1, 1, self.edge, np.pi)}

    @property
    def corners(self) -> list[tuple[float, float]]:  # noqa: D102
        return [(float(np.sin(self.edge)), float(np.cos(self.edge)))]

    @property
    def lowest(self) -> float:  # noqa: D102
        return float(np.cos(self.edge)) / 2

    @property
    def edge(self) -> float:  # noqa: D102
        return np.pi - np.radians(self.half_angle)


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

    word, held, is_symmetric, inside = "bore", {"bore": "rz"}, True, 0.5

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
    def surface(self) -> tuple[float, float]:  # noqa: D102
        return self.face, 180.0 - self.face

    @property
    def meridian(self) -> tuple[float, float]:  # noqa: D102
        return self.surface

    @property
    def bore(self) -> float:  # noqa: D102
        return self.radius

    @property
    def boundaries(self) -> dict[str, Boundary]:  # noqa: D102
        return {"bore": (0.5, 0.5, 0, np.pi)}  # in the polar coordinates of `through`

    @property
    def corners(self) -> list[tuple[float, float]]:  # noqa: D102
        edge, height = np.sin(np.radians(self.face)), np.cos(np.radians(self.face))
        return [(r, side * height) for r in (self.radius, edge) for side in (1, -1)]

    def through(self, points: Floats) -> Floats:
        """Points (r, z) of the bored ball from those of a shell with radii from 0.5 to 1.

        A ray of the shell becomes a line at one height, from the ball's surface to the bore.
        """
        radius, angle = np.hypot(*points), np.arctan2(*points)
        share = 2 * radius - 1
        return np.array([self.radius + share * (np.sin(angle) - self.radius), np.cos(angle)])

    def holds(self, r: Floats, z: Floats) -> NDArray[np.bool_]:  # noqa: D102
        return np.abs(r - self.radius) < ON


@dataclass(frozen=True)
class Pin(BallSupport):
    """A `Bore` described by its dimensions in m, for a joint with dimensions."""

    radius: float = parameter(..., "radius of the pin", "m", above=0)
    width: float = parameter(..., "width of the ball between its faces", "m", above=0)

    word, held, needs_dimensions = "pin", {"bore": "rz"}, True

    def in_ball(self, radius: float) -> Bore:
        """The bore of a ball of a radius in m."""
        checks.number("width of the ball", self.width, "m", below=2 * radius)
        face = float(np.degrees(np.arccos(self.width / 2 / radius)))
        largest = np.sqrt(radius**2 - self.width**2 / 4) - WALL * radius
        if self.radius > largest:
            raise checks.RangeError(
                f"radius of the pin must be <= {largest:.4g} m in a ball with a radius of "
                f"{radius:.4g} m and a width of {self.width:g} m, got {self.radius:g} m; give "
                "a thinner pin or a narrower ball"
            )
        return Bore(self.radius / radius, face)


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


PLATES = GuidedPlate(), ClampedPlate()
"""Supports of half a ball."""
BALL_SUPPORTS: tuple[type[BallSupport], ...] = (
    GuidedPlate,
    ClampedPlate,
    Core,
    Neck,
    Bore,
    Pin,
)
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
        checks.number("opening", self.last, "deg", least=30, most=170, scalar=True)

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
