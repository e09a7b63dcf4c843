"""Ball and socket as elastic bodies: what their compliance depends on, and no more.

Both have unit radius, and the Young's modulus of the ball or of the innermost layer is the unit.
Bodies are equal, and solved once, for every clearance, depth and modulus.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from study.joint.supports import (
    HEMISPHERE,
    BallSupport,
    GuidedPlate,
    Opening,
    Rim,
    Sector,
    SocketSupport,
    WholeOutside,
)

Layered = float | tuple[float, ...]
"""One number for a socket of one material, or one for each layer, from the inside out."""


@dataclass(frozen=True)
class Ball:
    """Poisson's ratio and support of a ball; contact may be inside the socket's opening."""

    poisson: float = 0.3
    support: BallSupport = GuidedPlate()
    opening: Opening = HEMISPHERE

    @property
    def by_series(self) -> bool:
        """Whether the Legendre series solves it exactly."""
        return isinstance(self.support, GuidedPlate) and self.opening == HEMISPHERE

    @property
    def held(self) -> dict[str, str]:
        """Boundary of the mesh -> components of the displacement that are zero there."""
        return self.support.held

    @property
    def corners(self) -> NDArray[np.float64]:
        """Places (r, z) in the meridian at which stresses may have no bound; shape (n, 2)."""
        return np.reshape(self.support.corners, (-1, 2))


@dataclass(frozen=True)
class Socket:
    """Layers of a socket, and how it is held.

    ``ratio`` is the outer over the innermost radius, ``modulus`` is over that of the innermost
    layer. Each of the three is one number, or a tuple with one for each layer, from the inside out.
    """

    ratio: Layered
    poisson: Layered = 0.3
    modulus: Layered = 1.0
    rim: Rim = "mirror"
    support: SocketSupport = WholeOutside()
    opening: Opening = HEMISPHERE

    @property
    def by_series(self) -> bool:
        """Whether the Legendre series solves it exactly."""
        return self.rim == "mirror"

    @property
    def layers(self) -> NDArray[np.float64]:
        """Outer ratios, Poisson's ratios and Young's moduli; shape (3, layers)."""
        return np.array(np.broadcast_arrays(*map(np.atleast_1d, self.constants)), dtype=float)

    @property
    def constants(self) -> tuple[Layered, Layered, Layered]:
        """The three constants of the layers."""
        return self.ratio, self.poisson, self.modulus

    @property
    def held(self) -> dict[str, str]:
        """Boundary of the mesh -> components of the displacement that are zero there."""
        return ({"rim": "z"} if self.rim == "mirror" else {}) | self.support.held

    @property
    def corners(self) -> NDArray[np.float64]:
        """Places (r, z) in the meridian at which stresses may have no bound; shape (n, 2)."""
        outer = float(self.layers[0, -1])
        rims = [self.opening.last, *([self.opening.first] if self.opening.is_ring else [])]
        places = [(radius, rim) for rim in rims for radius in (1.0, outer)]
        if isinstance(self.support, Sector):
            places += [(outer, angle) for angle in (self.support.first, self.support.last)]
        radius, angle = np.transpose(places)
        return radius[:, None] * np.column_stack(
            [np.sin(np.radians(angle)), np.cos(np.radians(angle))]
        )


def layer_steps(ratios: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outer over inner radius of each layer, from the outer radii over the innermost one."""
    return ratios / np.append(1.0, ratios[:-1])
