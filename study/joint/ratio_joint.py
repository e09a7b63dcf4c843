"""A joint by ratios, as a command or a table states it: materials relative to the ball's."""

from dataclasses import dataclass
from typing import Any

from study import checks, parameters
from study.contact import Material
from study.joint.compliance import THICKEST_RATIO, THINNEST_RATIO
from study.joint.definition import Joint, Layer
from study.joint.supports import Configuration
from study.parameters import parameter

UNIT = Material().youngs_modulus
"""Young's modulus of the ball, in Pa."""


def _read_layer(name: str, text: str) -> Layer:
    """Layer of a text, ``1.125,0.0025,0.46``."""
    ratio, modulus, poisson = checks.read_several(name, text, 3)
    modulus = UNIT * checks.number(f"modulus of {name}", modulus, above=0)
    return Layer(ratio, Material(modulus, poisson))


@parameters.documented
@dataclass(frozen=True)
class RatioJoint(Configuration):
    """A joint whose materials are relative to the ball's, of Young's modulus 2e11 Pa.

    A ``layer`` replaces the parameters of a socket of one material.
    """

    r2_star: float = parameter(200.0, "Radius of the socket in clearances, R2/dR", above=1)
    socket_ratio: float | None = parameter(
        None,
        "Outer over inner radius of the socket",
        least=THINNEST_RATIO,
        most=THICKEST_RATIO,
        otherwise="1.298",
    )
    modulus_ratio: float | None = parameter(
        None, "Young's modulus of the socket over that of the ball", above=0, otherwise="1"
    )
    poisson: float = parameter(0.3, "Poisson's ratio of the ball", above=-1, below=0.5)
    socket_poisson: float | None = parameter(
        None, "Poisson's ratio of the socket", above=-1, below=0.5, otherwise="that of the ball"
    )
    layer: tuple[Layer, ...] = parameter(
        (),
        "Outer radius over R2, Young's modulus over the ball's and Poisson's ratio of a layer of "
        "the socket, as N,N,N; may be repeated, from the inside out",
        parse=_read_layer,
        kind=Layer,
        several=";",
    )

    def __post_init__(self) -> None:
        parameters.take(self)
        if self.layer:
            for name in ("modulus_ratio", "socket_poisson", "socket_ratio"):
                if getattr(self, name) is not None:
                    raise ValueError(f"{name} must be left out: layer describes the socket")

    def joint(self, yield_stress: float | None = None) -> Joint:
        """The joint, with a yield stress of ball and socket in Pa.

        A ``ValueError`` for a yield stress beside layers, which have others.
        """
        ball = Material(UNIT, self.poisson, yield_stress)
        if self.layer:
            if yield_stress is not None:
                raise ValueError("yield_stress must be left out: layer describes the socket")
            return Joint(self.r2_star, ball=ball, layers=self.layer, **self.configuration)
        poisson = self.poisson if self.socket_poisson is None else self.socket_poisson
        modulus = UNIT * (1.0 if self.modulus_ratio is None else self.modulus_ratio)
        given: dict[str, Any] = (
            {} if self.socket_ratio is None else {"socket_ratio": self.socket_ratio}
        )
        socket = Material(modulus, poisson, yield_stress)
        return Joint(self.r2_star, ball=ball, socket=socket, **given, **self.configuration)
