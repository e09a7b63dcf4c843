"""What a law takes from the two bodies: composite modulus, and the socket ratio of the paper."""

from study import checks

SOCKET_RATIO = 1.298
"""Outer over inner radius of the paper's socket, which the paper does not state: the value with
which its Table 2 is met best on a fine mesh (notebook 13). It was perhaps drawn as 1.3."""


def composite_modulus(ball_modulus, ball_poisson, socket_modulus, socket_poisson):
    """Composite modulus E* of two bodies: 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2.

    Parameters
    ----------
    ball_modulus, socket_modulus : float
        Young's moduli, > 0, in Pa.
    ball_poisson, socket_poisson : float
        Poisson's ratios, in (-1, 0.5).

    Returns
    -------
    float
        Composite modulus, in Pa.

    Raises
    ------
    ValueError
        For a value outside its range.
    """
    moduli = [
        checks.number(f"{body} Young's modulus", value, "Pa", above=0, scalar=True)
        for body, value in (("ball", ball_modulus), ("socket", socket_modulus))
    ]
    ratios = [
        checks.poisson(f"{body} Poisson's ratio", value)
        for body, value in (("ball", ball_poisson), ("socket", socket_poisson))
    ]
    return 1 / sum((1 - nu**2) / e for e, nu in zip(moduli, ratios, strict=True))
