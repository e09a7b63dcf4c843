"""A spherical clearance joint: what its force-depth curve depends on.

`Joint` is dimensionless, with its materials and layers; `RatioJoint` states it by ratios, as
commands and tables do. `paper_joint` is the paper's, as far as it can be known. A joint is solved
by `study.joint.curve`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from study import checks, parameters
from study.contact import SOCKET_RATIO, Material, composite_modulus
from study.contact.materials import read_material
from study.joint.compliance import THICKEST_RATIO, THINNEST_RATIO, Ball, Socket, layer_steps
from study.joint.supports import HEMISPHERE, ClampedPlate, Configuration, WholeOutside
from study.parameters import parameter

LARGEST_MODULUS_RATIO = 1e9
"""Largest ratio of the bodies' Young's moduli, either way. A stiffer body is rigid, within 1e-9 of
the force. For a much softer socket, the rounded contact matrix is not positive definite."""
UNIT = Material().youngs_modulus
"""Young's modulus of the ball, in Pa."""


@dataclass(frozen=True)
class Layer:
    """A layer of a socket: its outer radius over the socket's inner radius, and its material."""

    outer_ratio: float = parameter(
        ..., "outer radius of a layer divided by R2", above=1, most=THICKEST_RATIO
    )
    material: Material = parameter(..., "material of a layer", kind=Material, parse=read_material)

    def __post_init__(self):
        parameters.take(self)

    def __str__(self):
        """The modulus is over that of a ball of the default material."""
        material = self.material
        numbers = self.outer_ratio, material.youngs_modulus / UNIT, material.poisson
        return ",".join(f"{number:.9g}" for number in numbers)


@parameters.documented
@dataclass(frozen=True)
class Joint(Configuration):
    """A spherical clearance joint without dimensions.

    It has everything that the normalised force-depth curve depends on. Supports may be given as
    objects of `study.joint.supports` or as texts. The default supports are those of
    `study.contact.stiffened_hertz`, for which the Legendre series applies; those of the reference
    joint of the study are different (`paper_joint`). Raises ``ValueError`` for a value outside its
    range.

    Young's moduli of the materials may differ by a factor of at most 1e9. Layers replace
    ``socket_ratio`` and ``socket``, which are then the ratio of the outermost layer and the
    material of the innermost one; E* is that of the ball and the innermost layer. The minimum
    thickness of a layer is 0.0001 times its inner radius, or 0.02 times for finite elements.

    At R2* = 200 and Poisson's ratio 0.3 a free rim, instead of a mirror plane, changes the force by
    less than 1e-5 up to a socket ratio of 1.25, by 0.7 % at 2 and by 4 % at 3; at Poisson's ratio
    0.45 it changes the force by 0.4 % at a ratio of 1.25 and by 1.6 % at 1.5. Notebook 01 draws all
    supports.

    Examples
    --------
    >>> joint = Joint(r2_star=200, socket=Material(1.1e11, 0.34), ball_support="clamped")
    >>> joint.rim, round(joint.composite_modulus / 1e9, 1)
    ('mirror', 79.4)
    """

    r2_star: float = parameter(..., "Radius of the socket divided by the clearance, R2/dR", above=1)
    socket_ratio: float = parameter(
        SOCKET_RATIO,
        "Outer radius of the socket divided by its inner radius; at least 1.02 for finite elements",
        least=THINNEST_RATIO,
        most=THICKEST_RATIO,
    )
    ball: Material = parameter(
        Material(), "Material of the ball", kind=Material, parse=read_material
    )
    socket: Material = parameter(
        Material(), "Material of the socket", kind=Material, parse=read_material
    )
    layers: tuple[Layer, ...] = parameter(
        (), "Bonded layers of the socket, from the inside out", kind=Layer, several=";"
    )

    def __post_init__(self):
        parameters.take(self)
        self._take_layers()
        name = "Young's modulus of the socket divided by that of the ball"
        most = LARGEST_MODULUS_RATIO
        for material in (self.socket, *(layer.material for layer in self.layers)):
            ratio = material.youngs_modulus / self.ball.youngs_modulus
            checks.number(name, ratio, least=1 / most, most=most)
        self._check_configuration()

    def _take_layers(self):
        if not self.layers:
            return
        steps = layer_steps(np.array([layer.outer_ratio for layer in self.layers]))
        limits = {"least": THINNEST_RATIO, "most": THICKEST_RATIO}
        checks.number("outer radius of a layer divided by its inner radius", steps, **limits)
        follows = {
            "socket_ratio": (SOCKET_RATIO, self.layers[-1].outer_ratio),
            "socket": (Material(), self.layers[0].material),
        }
        for name, (default, of_layers) in follows.items():
            if (given := getattr(self, name)) not in (default, of_layers):
                raise ValueError(
                    f"{name} does not apply to a joint with layers, which describe the socket; "
                    f"remove it (got {given})"
                )
            object.__setattr__(self, name, of_layers)

    @property
    def ball_body(self) -> Ball:
        """The ball as an elastic body."""
        return Ball(float(self.ball.poisson), self.ball_support, self.opening)

    @property
    def socket_body(self) -> Socket:
        """The socket as an elastic body."""
        layers = self.layers or (Layer(self.socket_ratio, self.socket),)
        materials = [layer.material for layer in layers]
        unit = materials[0].youngs_modulus
        return Socket(
            tuple(float(layer.outer_ratio) for layer in layers),
            tuple(float(material.poisson) for material in materials),
            tuple(float(material.youngs_modulus / unit) for material in materials),
            self.rim,
            self.socket_support,
            self.opening,
        )

    @property
    def is_held_all_round(self) -> bool:
        """Whether the socket is held all over its outside."""
        return isinstance(self.socket_support, WholeOutside)

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
    def modulus_shares(self) -> tuple[float, float]:
        """E*/E of the ball and of the socket."""
        composite = self.composite_modulus
        return composite / self.ball.youngs_modulus, composite / self.socket.youngs_modulus

    def correction_options(self) -> dict[str, Any]:
        """Options of `study.contact.stiffened_hertz`; ``ValueError`` if it is not for the joint."""
        for unsuited, what in (
            (self.layers, "a socket with layers"),
            (not self.ball_support.by_plane, f"ball_support {self.ball_support}"),
            (self.opening != HEMISPHERE, f"an opening of {self.opening} deg"),
            (not self.is_held_all_round, f"socket_support {self.socket_support}"),
        ):
            if unsuited:
                raise checks.RangeError(
                    f"the law stiffened_hertz is not valid for {what}; use tabulated, a table of "
                    "the joint's elastic solution"
                )
        return {
            "socket_ratio": self.socket_ratio,
            "modulus_ratio": self.modulus_ratio,
            "poisson": self.ball.poisson,
            "socket_poisson": self.socket.poisson,
            "ball_support": str(self.ball_support),
            "rim": self.rim,
        }

    def columns(self) -> dict[str, Any]:
        """The joint as columns of a table, as in `study.dataset.load`."""
        ratios = RatioJoint.of(self)
        return {
            "r2_star": self.r2_star,
            "socket_ratio": self.socket_ratio,
            "poisson_ball": self.ball.poisson,
            "poisson_socket": self.socket.poisson,
            "modulus_ratio": self.modulus_ratio,
            "layers": ";".join(map(str, ratios.layer)),
            "ball_support": str(self.ball_support),
            "rim": self.rim,
            "kinematics": self.kinematics,
        }

    def check_linear(self, what: str) -> None:
        """Raise ``ValueError`` for kinematics other than linear, which ``what`` requires."""
        checks.choice(f"kinematics for {what}", self.kinematics, ("linear",))

    @property
    def acts_on_ball(self) -> bool:
        """Whether the force acts on the ball's area, whose points move; else on the socket's."""
        return self.kinematics != "small"

    @property
    def series_applies(self) -> bool:
        """Whether the exact series applies: linear bodies that are symmetric about the equator."""
        by_series = self.ball_body.by_series and self.socket_body.by_series
        return by_series and not self.has_large_displacements

    def check_series(self) -> None:
        """Raise ``ValueError`` for a joint to which the Legendre series does not apply."""
        if not self.series_applies:
            raise ValueError(
                "solver must be quadratic or linear for this joint, because the series requires "
                "ball_support guided, rim mirror, a hemispherical socket held at its whole outside "
                f"and small displacements, got {', '.join(map(str, self.configuration.values()))}"
            )


PAPER_SUPPORTS: dict[str, Any] = {"ball_support": ClampedPlate(), "rim": "free"}
"""How the paper's finite elements hold ball and socket: identified from its Table 2."""


def paper_joint(r2_star: float = 200, **changes: Any) -> Joint:
    """The reference joint: the configuration inferred from Table 2 of Yao et al.

    It has a clamped ball, a free rim, a socket ratio of 1.298, linear kinematics and Poisson's
    ratio 0.3 of both bodies. These were inferred from Table 2 and Fig. 14 (notebook 32), except
    for the rim, which follows from the text ("the entire external surface of the socket is fixed").

    Parameters
    ----------
    r2_star
        Radius of the socket divided by the clearance; 200 in Fig. 10 and Table 2.
    **changes
        Other attributes of `Joint`.
    """
    return Joint(r2_star, **(PAPER_SUPPORTS | changes))


def _read_layer(name: str, text: str) -> Layer:
    """Layer of a text, ``1.125,0.0025,0.46``."""
    ratio, modulus, poisson = checks.read_several(name, text, 3)
    modulus = UNIT * checks.number(f"modulus of {name}", modulus, above=0)
    return Layer(ratio, Material(modulus, poisson))


@parameters.documented
@dataclass(frozen=True)
class RatioJoint(Configuration):
    """A joint without dimensions, described by ratios as on the command line and in tables.

    Young's modulus of the ball is 2e11 Pa. If a ``layer`` is given, layers replace the parameters
    of a socket of one material. The method `joint` gives the `Joint`.

    Examples
    --------
    >>> RatioJoint(r2_star=200, modulus_ratio=0.5).joint().socket.youngs_modulus
    100000000000.0
    """

    r2_star: float = parameter(
        200.0, "Radius of the socket divided by the clearance, R2/dR", above=1
    )
    socket_ratio: float | None = parameter(
        None,
        "Outer radius of the socket divided by its inner radius",
        least=THINNEST_RATIO,
        most=THICKEST_RATIO,
        otherwise="1.298",
    )
    modulus_ratio: float | None = parameter(
        None,
        "Young's modulus of the socket divided by that of the ball",
        above=0,
        otherwise="1",
    )
    poisson: float = parameter(0.3, "Poisson's ratio of the ball", above=-1, below=0.5)
    socket_poisson: float | None = parameter(
        None, "Poisson's ratio of the socket", above=-1, below=0.5, otherwise="that of the ball"
    )
    layer: tuple[Layer, ...] = parameter(
        (),
        "Layer of the socket, as three numbers N,N,N: its outer radius divided by R2, its Young's "
        "modulus divided by that of the ball, and its Poisson's ratio; may be repeated for several "
        "layers, from the inside out",
        parse=_read_layer,
        kind=Layer,
        several=";",
    )

    def __post_init__(self) -> None:
        parameters.take(self)
        if self.layer:
            for name in ("modulus_ratio", "socket_poisson", "socket_ratio"):
                if getattr(self, name) is not None:
                    raise ValueError(
                        f"{name} does not apply to a joint with layers, which describe the socket; "
                        "remove it"
                    )

    @classmethod
    def of(cls, joint: Joint) -> "RatioJoint":
        """A joint by its ratios, without its yield stresses."""
        relative = UNIT / joint.ball.youngs_modulus
        layers = tuple(
            Layer(
                of.outer_ratio, Material(relative * of.material.youngs_modulus, of.material.poisson)
            )
            for of in joint.layers
        )
        given: dict[str, Any] = (
            {"layer": layers}
            if layers
            else {
                "socket_ratio": joint.socket_ratio,
                "modulus_ratio": joint.modulus_ratio,
                "socket_poisson": joint.socket.poisson,
            }
        )
        return cls(joint.r2_star, poisson=joint.ball.poisson, **given, **joint.configuration)

    def joint(self, yield_stress: float | None = None) -> Joint:
        """The joint, with a yield stress of ball and socket in Pa; layers have none."""
        ball = Material(UNIT, self.poisson, yield_stress)
        if self.layer:
            if yield_stress is not None:
                raise ValueError(
                    "yield_stress does not apply to a joint with layers; remove it, or describe "
                    "the joint with its dimensions, whose materials have yield stresses"
                )
            return Joint(self.r2_star, ball=ball, layers=self.layer, **self.configuration)
        poisson = self.poisson if self.socket_poisson is None else self.socket_poisson
        modulus = UNIT * (1.0 if self.modulus_ratio is None else self.modulus_ratio)
        given: dict[str, Any] = (
            {} if self.socket_ratio is None else {"socket_ratio": self.socket_ratio}
        )
        socket = Material(modulus, poisson, yield_stress)
        return Joint(self.r2_star, ball=ball, socket=socket, **given, **self.configuration)
