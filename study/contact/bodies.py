"""What a law needs of the two bodies: composite modulus, clearance, largest depth."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from study import checks

SOCKET_RATIO = 1.298
"""Socket ratio, outer over inner radius, of the paper's socket. The paper does not state it: this
value meets its Table 2 best on a fine mesh (notebook 13)."""


def composite_modulus(
    ball_modulus: float, ball_poisson: float, socket_modulus: float, socket_poisson: float
) -> float:
    """Composite modulus E*, in Pa: 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2.

    Young's moduli > 0 are in Pa, Poisson's ratios in (-1, 0.5); else a ``ValueError``.
    """
    bodies = {"ball": (ball_modulus, ball_poisson), "socket": (socket_modulus, socket_poisson)}
    compliance = 0.0
    for body, (modulus, poisson) in bodies.items():
        e = checks.number(f"{body} Young's modulus", modulus, "Pa", above=0, scalar=True)
        nu = checks.poisson(f"{body} Poisson's ratio", poisson)
        compliance += (1 - nu**2) / e
    return 1 / compliance


def hertz_factor(r2_star: ArrayLike) -> Any:
    """Factor of ds^(3/2) in Hertz's law, P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) (Eqs. 4-6)."""
    socket = np.asarray(r2_star, dtype=float)
    return 4 / 3 * np.sqrt(socket * (socket - 1))


def largest_depth(r2_star: float) -> float:
    """Depth d/dR = sqrt(2 R2* - 1) - 1 at which the spheres meet in the ball's equator."""
    return np.sqrt(2 * r2_star - 1) - 1
