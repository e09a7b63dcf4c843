"""Compliance of the ball and of the socket by exact Legendre series.

A ball pressed by two mirror-image sockets, each continued by mirror symmetry about the
equator, is a whole sphere and a whole spherical shell under pressures of even Legendre order.
Each order is solved by itself: two displacement modes that are regular at the centre, two
that are singular there (Lur'e, Three-dimensional problems of the theory of elasticity, 1964).
This is the half ball with ``plane`` drive and the socket with ``mirror`` rim of
`study.joint.fem`; what is left of a mesh are the hat functions of the pressure.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.joint.compliance import (
    RESOLUTION,
    THICKEST_RATIO,
    Compliance,
    HatFunctions,
    remembered,
    surface_angles,
)
from study.threads import one_thread

LAST_ORDER = 10_000
MOST_ORDERS = 100_000
THINNEST_RATIO = 1.001


@remembered(maxsize=32)
@one_thread
def ball_compliance(
    poisson: float = 0.3, resolution: int = RESOLUTION["series"], last_order: int = LAST_ORDER
) -> Compliance:
    """Compliance of a solid ball that is symmetric about its equatorial plane.

    The ``resolution`` is the elements of pressure along the quarter circle, a multiple of 16; the
    series ends at the even ``last_order``. A value outside its range is a ``ValueError``.
    """
    return _compliance(ball_receptance(_orders(last_order), poisson), resolution)


@remembered(maxsize=32)
@one_thread
def socket_compliance(
    ratio: float,
    poisson: float = 0.3,
    resolution: int = RESOLUTION["series"],
    last_order: int = LAST_ORDER,
) -> Compliance:
    """Compliance of a shell fixed on its outer sphere, symmetric about the equator.

    As `ball_compliance`; ``ratio`` is the outer over the inner radius, >= 1.001.
    """
    ratio = checks.number(
        "socket_ratio", ratio, least=THINNEST_RATIO, most=THICKEST_RATIO, scalar=True
    )
    return _compliance(socket_receptance(_orders(last_order), ratio, poisson), resolution)


def ball_receptance(orders: ArrayLike, poisson: float) -> NDArray[np.float64]:
    """Inward displacement of a solid ball's surface under the pressure P_n(cos theta).

    Factors of P_n(cos theta) for radius 1 and Young's modulus 1, by the orders n; these are not
    1, whose pressure is not in balance.
    """
    n = np.asarray(orders)
    poisson = checks.poisson("poisson", poisson)
    radial, _, normal, shear = _modes(n, poisson, 1.0)
    amplitudes = _amplitudes([normal[:2], shear[:2]], n, poisson)
    return np.where(n == 0, 1 - 2 * poisson, -(radial[:2] * amplitudes).sum(axis=0))


def socket_receptance(orders: ArrayLike, ratio: float, poisson: float) -> NDArray[np.float64]:
    """Outward displacement of a shell's inner surface under the pressure P_n(cos theta).

    As `ball_receptance`, for inner radius 1; the outer sphere is fixed, its radius ``ratio``.
    """
    n = np.asarray(orders)
    poisson = checks.poisson("poisson", poisson)
    radial, _, normal, shear = _modes(n, poisson, 1.0, ratio)
    outer_radial, outer_polar, _, _ = _modes(n, poisson, ratio, ratio)
    amplitudes = _amplitudes([normal, shear, outer_radial, outer_polar], n, poisson)
    thick = ratio**3 - 1  # order 0: A r + B/r^2, zero at the outer sphere
    uniform = (1 + poisson) * (1 - 2 * poisson) * thick
    uniform /= 1 + poisson + 2 * (1 - 2 * poisson) * ratio**3
    return np.where(n == 0, uniform, (radial * amplitudes).sum(axis=0))


def _modes(orders, poisson, radius, largest_radius=1.0):
    """Radial and polar displacement, normal and shear stress over 2 G at one radius.

    Each of shape (4, m), for the modes r^(n+1) and r^(n-1), which are regular, and r^-n and
    r^-(n+2), which are singular. Radial quantities go with P_n(cos theta), the others with its
    derivative to theta. Regular modes are scaled to the largest radius and singular ones to
    radius 1, so that no power overflows.
    """
    n, nu, r = orders.astype(float), poisson, radius
    inner, outer = (r / largest_radius) ** n, r**-n
    radial = [(n + 1) * (n - 2 + 4 * nu) * r, n / r, n * (n + 3 - 4 * nu), -(n + 1) / r**2]
    polar = [(n + 5 - 4 * nu) * r, 1 / r + 0 * n, 4 - n - 4 * nu, r**-2 + 0 * n]
    normal = [
        (n + 1) * (n * n - n - 2 - 2 * nu),
        n * (n - 1) / r**2,
        -n * (n * n + 3 * n - 2 * nu) / r,
        (n + 1) * (n + 2) / r**3,
    ]
    shear = [
        n * n + 2 * n - 1 + 2 * nu,
        (n - 1) / r**2,
        (n * n - 2 + 2 * nu) / r,
        -(n + 2) / r**3,
    ]
    powers = np.array([inner, inner, outer, outer])
    return tuple(powers * np.array(quantity) for quantity in (radial, polar, normal, shear))


def _amplitudes(conditions, orders, poisson):
    """Modes' amplitudes (0 for order 0) with unit pressure as the first, else zero conditions."""
    system = np.array(conditions).transpose(2, 0, 1)
    right = np.zeros((*system.shape[:2], 1))
    right[:, 0] = -(1 + poisson)  # radial stress over 2 G, with Young's modulus 1
    found = np.zeros(system.shape[:2])
    several = orders > 0
    found[several] = np.linalg.solve(system[several], right[several])[:, :, 0]
    return found.T


def _orders(last_order):
    last = checks.whole("last_order", last_order, least=2, most=MOST_ORDERS)
    if last % 2:
        raise ValueError(f"last_order must be even, got {last}")
    return np.arange(0, last + 1, 2)


def _compliance(receptance, resolution):
    """Compliance from the receptances of the even orders, the first being 0."""
    angles = surface_angles(resolution)
    orders = 2 * np.arange(len(receptance))
    shares = _hat_coefficients(resolution, int(orders[-1]))
    norms = 2 * np.pi / (2 * orders + 1)  # of P_n(cos theta) squared over the hemisphere
    flexibility = (shares.T * (receptance * norms)) @ shares
    reaction = HatFunctions(angles).integrate(np.cos)
    return Compliance(angles, (flexibility + flexibility.T) / 2, reaction)


@lru_cache(maxsize=4)
def _hat_coefficients(resolution, last_order):
    """Legendre coefficients of every hat, continued evenly about the equator: (orders, hats).

    By parts, the integral of h P_n sin(theta) is that of h' (J_(n+1) - J_(n-1))' / (2n + 1),
    where J_n is the integral of P_n(cos theta) over theta from the pole. It obeys
    (n + 1)^2 J_(n+1) = (2n + 1) sin(theta) P_n + n^2 J_(n-1), which damps errors: no
    quadrature, whatever the order.
    """
    angles = surface_angles(resolution)
    sine, cosine = np.sin(angles), np.cos(angles)
    before, here = np.ones_like(angles), cosine  # P_0, P_1
    integral_before, integral = angles, sine  # J_0, J_1
    steps = np.empty((last_order // 2, len(angles)))
    for n in range(1, last_order + 1):
        integral_next = ((2 * n + 1) * sine * here + n * n * integral_before) / (n + 1) ** 2
        if n % 2 == 0:
            steps[n // 2 - 1] = integral_next - integral_before
        integral_before, integral = integral, integral_next
        before, here = here, ((2 * n + 1) * cosine * here - n * before) / (n + 1)
    slopes = np.diff(steps, axis=1) / np.diff(angles)
    coefficients = np.zeros((last_order // 2 + 1, len(angles)))
    coefficients[0] = HatFunctions(angles).integrate(np.ones_like) / (2 * np.pi)
    coefficients[1:, 1:] += slopes
    coefficients[1:, :-1] -= slopes
    return coefficients
