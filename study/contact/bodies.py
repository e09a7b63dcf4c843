"""Properties of the two bodies that laws use: composite modulus and maximum depth."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from study import checks

SOCKET_RATIO = 1.298
"""Socket ratio (outer radius divided by inner radius) of the reference joint. The paper does not
state it; with this value a fine mesh agrees best with Table 2 (notebook 32)."""


def composite_modulus(
    ball_modulus: float, ball_poisson: float, socket_modulus: float, socket_poisson: float
) -> float:
    """Composite modulus E* in Pa, from 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2.

    Parameters
    ----------
    ball_modulus, socket_modulus
        Young's moduli E1 and E2 in Pa, > 0.
    ball_poisson, socket_poisson
        Poisson's ratios nu1 and nu2, > -1 and < 0.5.

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    >>> print(f"{composite_modulus(2.1e11, 0.3, 1.1e11, 0.34):.4g}")
    8.082e+10
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
    """Depth d/dR = sqrt(2 R2* - 1) - 1 at which the spheres intersect at the ball's equator."""
    return np.sqrt(2 * r2_star - 1) - 1
