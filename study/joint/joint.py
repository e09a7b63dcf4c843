"""A spherical clearance joint: what its force-depth curve depends on.

`Joint` is dimensionless, with its materials and layers. `paper_joint` is the paper's. It is solved
by `study.joint.curve`.
"""

from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from study import checks
from study.contact import SOCKET_RATIO, Material, composite_modulus
from study.joint import supports
from study.joint.compliance import (
    THICKEST_RATIO,
    THINNEST_RATIO,
    layer_ratios,
)
from study.joint.supports import OPENING, RIMS, Rim

Kinematics = Literal["small", "linear", "finite"]
KINEMATICS: tuple[Kinematics, ...] = get_args(Kinematics)
LARGEST_MODULUS_RATIO = 1e9
"""Largest ratio of the bodies' Young's moduli, either way. A stiffer body is rigid, within 1e-9 of
the force. For a much softer socket, the rounded contact matrix is not positive definite."""


@dataclass(frozen=True)
class Layer:
    """A layer of a socket: its outer radius over the socket's inner radius, and its material."""

    outer_ratio: float
    material: Material

    def __post_init__(self):
        checks.plain_numbers(self)
        checks.number("outer_ratio", self.outer_ratio, above=1, most=THICKEST_RATIO, scalar=True)
        checks.instance("material", self.material, Material)


@dataclass(frozen=True)
class Joint:
    """A spherical clearance joint, as far as its force-depth curve depends on it.

    Its default supports are solved exactly, and are the defaults of
    `study.contact.stiffened_hertz`. They are not the paper's (`paper_joint`). A value outside its
    range is a ``ValueError``.

    Attributes
    ----------
    r2_star
        Dimensionless socket radius R2/dR, > 1.
    socket_ratio
        Outer over inner radius, from 1.0001 to 1e6; >= 1.02 for finite elements.
    ball, socket
        Materials; their Young's moduli are within a factor of 1e9.
    layers
        Bonded layers of a socket of several materials, from the inside out: a liner in its housing.
        A layer is at least 0.0001 of its inner radius thick, or 0.02 for finite elements. Layers
        replace ``socket_ratio`` and ``socket``, which are then the outermost ratio and the
        innermost material. The composite modulus E* is that of ball and innermost layer.
    ball_drive
        The half ball's equatorial plane is displaced axially and is radially free (``plane``), or
        fixed (``clamped``); or its centre alone is displaced (``point``), as by a point load. A
        whole ball is held at a rigid core, ``core:0.2`` of its radius (0.05 to 0.8), or at a neck,
        ``neck:30``: its surface within 30 deg of the top (5 to 90).
    rim
        The socket's edge is a mirror plane, or traction-free. The default is a mirror plane for a
        hemispherical socket, fixed all over its outside, and half a ball; all others are free. At
        R2* = 200 and Poisson's ratio 0.3 the two forces differ by less than 1e-5 up to a socket
        ratio of 1.25, by 0.7 % at 2, and by 4 % at 3. At Poisson's ratio 0.45 they differ by 0.4 %
        at a ratio of 1.25, and by 1.6 % at 1.5.
    opening
        Polar angle of the socket's mouth from its pole, from 30 to 170 deg. Half a ball needs 90
        deg at most; a neck must stay out of the mouth.
    backing
        Where the socket is held: its outside all over (``whole``), the face of its rim alone
        (``rim``), or its outside between two polar angles in deg: ``0,30`` is a seat at the pole,
        ``60,90`` a flange. Notebook 01 draws all supports.
    kinematics
        ``small``: points at equal angles from the socket's centre face each other. The gap is the
        exact overlap of the rigid spheres; the force acts on the socket's area. ``linear``: a point
        of the ball faces the point of the socket that it has moved to, and the force acts on the
        ball's area. So does a small-strain analysis that searches contact on the moved surfaces.
        ``finite``: large displacements and rotations, with Saint Venant and Kirchhoff's material.
        They differ by terms of order 1/R2*.
    """

    r2_star: float
    socket_ratio: float = SOCKET_RATIO
    ball: Material = field(default_factory=Material)
    socket: Material = field(default_factory=Material)
    ball_drive: str = "plane"
    rim: Rim | None = None
    kinematics: Kinematics = "linear"
    layers: tuple[Layer, ...] = ()
    opening: float = OPENING
    backing: str = "whole"

    def __post_init__(self):
        checks.plain_numbers(self)
        checks.number("r2_star", self.r2_star, above=1, scalar=True)
        thinnest, thickest = THINNEST_RATIO, THICKEST_RATIO
        checks.number("socket_ratio", self.socket_ratio, least=thinnest, most=thickest, scalar=True)
        for name in ("ball", "socket"):
            checks.instance(name, getattr(self, name), Material)
        self._take_layers()
        name, most = "Young's modulus of the socket over that of the ball", LARGEST_MODULUS_RATIO
        for material in (self.socket, *(layer.material for layer in self.layers)):
            ratio = material.youngs_modulus / self.ball.youngs_modulus
            checks.number(name, ratio, least=1 / most, most=most)
        checks.choice("kinematics", self.kinematics, KINEMATICS)
        self._take_supports()

    def _take_supports(self):
        """Check what holds ball and socket, and choose the rim if it is not given."""
        kind, size = supports.drive(self.ball_drive)
        least, most = supports.OPENINGS
        most = OPENING if kind in supports.HALF_BALLS else most
        name = f"opening beside ball_drive {self.ball_drive}"
        checks.number(name, self.opening, "deg", least=least, most=most, scalar=True)
        if kind == "neck":
            most = 180 - size - supports.CLEAR
            checks.number(name, self.opening, "deg", most=most)
        supports.seat(self.backing, self.opening)
        usual = self.usual_supports
        if self.rim is None:
            object.__setattr__(self, "rim", "mirror" if usual else "free")
        checks.choice("rim", self.rim, RIMS if usual else ("free",))
        if not usual:
            why = "kinematics of other supports than a hemisphere's"
            checks.choice(why, self.kinematics, ("small", "linear"))

    @property
    def usual_supports(self) -> bool:
        """Whether a hemispherical socket, fixed all over its outside, holds half a ball."""
        half = supports.drive(self.ball_drive)[0] in supports.HALF_BALLS
        return half and self.opening == OPENING and self.backing == "whole"

    @property
    def reach(self) -> float:
        """Largest polar angle of a contact along the axis, in rad: pi/2, or the mouth's."""
        return supports.reach(self.opening)

    def _take_layers(self):
        """Check the layers, and set what follows from them."""
        if not isinstance(self.layers, tuple):
            raise ValueError(f"layers must be a tuple of Layer, got {checks.shown(self.layers)}")
        for layer in self.layers:
            checks.instance("each of layers", layer, Layer)
        if not self.layers:
            return
        layer_ratios(self.socket_layers[0])
        follows = {
            "socket_ratio": (SOCKET_RATIO, self.layers[-1].outer_ratio),
            "socket": (Material(), self.layers[0].material),
        }
        for name, (default, of_layers) in follows.items():
            if (given := getattr(self, name)) not in (default, of_layers):
                raise ValueError(f"{name} must be left out beside layers, got {given}")
            object.__setattr__(self, name, of_layers)

    @property
    def socket_layers(self) -> tuple[tuple[float, ...], ...]:
        """Outer ratio, Poisson's ratio and Young's modulus of each layer of the socket.

        From the inside out, as three tuples; the modulus is over the innermost one's.
        """
        layers = self.layers or (Layer(self.socket_ratio, self.socket),)
        unit = layers[0].material.youngs_modulus
        materials = [layer.material for layer in layers]
        return (
            tuple(float(layer.outer_ratio) for layer in layers),
            tuple(float(material.poisson) for material in materials),
            tuple(float(material.youngs_modulus / unit) for material in materials),
        )

    @property
    def materials(self) -> dict[str, Material]:
        """Materials of ``ball`` and ``socket``, or ``layer 1`` and so on, from the inside out."""
        layers = {f"layer {k}": layer.material for k, layer in enumerate(self.layers, 1)}
        return {"ball": self.ball} | (layers or {"socket": self.socket})

    @property
    def ball_radius(self) -> float:
        """Ball radius over socket radius, R1/R2."""
        return 1 - 1 / self.r2_star

    @property
    def modulus_ratio(self) -> float:
        """Young's modulus of the socket over that of the ball."""
        return self.socket.youngs_modulus / self.ball.youngs_modulus

    @property
    def composite_modulus(self) -> float:
        """E*, in Pa."""
        ball, socket = self.ball, self.socket
        return composite_modulus(
            ball.youngs_modulus, ball.poisson, socket.youngs_modulus, socket.poisson
        )

    @property
    def layers_text(self) -> str:
        """Layers as a table holds them, ``1.125:0.0025:0.46;1.5:1:0.3``; empty for one material.

        Outer ratio, Young's modulus over the ball's and Poisson's ratio of each.
        """
        texts = []
        for layer in self.layers:
            modulus = layer.material.youngs_modulus / self.ball.youngs_modulus
            texts.append(f"{layer.outer_ratio:.9g}:{modulus:.9g}:{layer.material.poisson:.9g}")
        return ";".join(texts)

    @property
    def modulus_shares(self) -> tuple[float, float]:
        """E*/E of the ball and of the socket."""
        composite = self.composite_modulus
        return composite / self.ball.youngs_modulus, composite / self.socket.youngs_modulus

    def correction_options(self) -> dict[str, Any]:
        """Options of `study.contact.stiffened_hertz`; ``ValueError`` if it is not for the joint."""
        for unsuited, what in (
            (self.layers, "a socket of layers"),
            (self.ball_drive not in ("plane", "clamped"), f"ball_drive {self.ball_drive}"),
            (self.opening != OPENING, f"an opening of {self.opening:g} deg"),
            (self.backing != "whole", f"backing {self.backing}"),
        ):
            if unsuited:
                raise checks.RangeError(f"stiffened_hertz is not for {what}")
        return {
            "socket_ratio": self.socket_ratio,
            "modulus_ratio": self.modulus_ratio,
            "poisson": self.ball.poisson,
            "socket_poisson": self.socket.poisson,
            "ball_drive": self.ball_drive,
            "rim": self.rim,
        }

    @property
    def series_applies(self) -> bool:
        """Whether the exact series applies: linear bodies that are symmetric about the equator."""
        exact = self.ball_drive == "plane" and self.rim == "mirror"
        return exact and self.kinematics != "finite"


PAPER_SUPPORTS: dict[str, Any] = {"ball_drive": "clamped", "rim": "free"}
"""How the paper's finite elements hold ball and socket: identified from its Table 2."""


def paper_joint(r2_star: float = 200, **changes: Any) -> Joint:
    """The joint of the paper's figures and tables, as far as it can be known.

    Clamped ball, free rim, socket ratio 1.298, linear kinematics and Poisson's ratio 0.3 of both
    bodies. They are identified from Table 2 and Fig. 14 (notebook 13). The rim follows from the
    text alone ("the entire external surface of the socket is fixed"), and changes nothing there.
    R2* = 200 is that of Fig. 10 and Table 2; ``changes`` are other attributes of `Joint`.
    """
    return Joint(r2_star, **(PAPER_SUPPORTS | changes))
