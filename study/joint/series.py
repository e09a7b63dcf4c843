"""Compliance of the ball and of the socket by exact Legendre series.

Mirrored about the equator, ball and socket are a whole sphere and a whole spherical shell under
pressures of even Legendre order. Each order is solved alone. Two of its displacement modes are
regular at the centre, and two are singular there (Lur'e, Three-dimensional problems of the theory
of elasticity, 1964). The layers of a shell are bonded, and joined by the flexibility of those
outside. The bodies are those of `study.joint.fem` with ``plane`` drive and ``mirror`` rim. Only the
hat functions of the pressure are left of a mesh.
"""

from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.joint.compliance import (
    RESOLUTION,
    Compliance,
    HatFunctions,
    Layered,
    layer_steps,
    layered,
    remembered,
    surface_angles,
)
from study.threads import one_thread

ORDERS = 16
"""Orders per element: more change the force by less than 1e-6, the peak pressure by 1e-5."""
MOST_ORDERS = 100_000


@remembered(maxsize=32)
@one_thread
def ball_compliance(
    poisson: float = 0.3, resolution: int = RESOLUTION["series"], last_order: int | None = None
) -> Compliance:
    """Compliance of a solid ball that is symmetric about its equatorial plane.

    The ``resolution`` is the number of pressure elements along the quarter circle, a multiple of
    16. The series ends at the even ``last_order``, by default at `ORDERS` per element. A value
    outside its range is a ``ValueError``.
    """
    return _compliance(partial(ball_receptance, poisson=poisson), resolution, last_order)


@remembered(maxsize=32)
@one_thread
def socket_compliance(
    ratio: Layered,
    poisson: Layered = 0.3,
    resolution: int = RESOLUTION["series"],
    last_order: int | None = None,
    modulus: Layered = 1.0,
) -> Compliance:
    """Compliance of a shell fixed on its outer sphere, symmetric about the equator.

    As `ball_compliance`; ``ratio`` is the outer over the inner radius, >= 1.0001. Each layer, from
    the inside out, has its ratio to the innermost radius, Poisson's ratio and Young's ``modulus``;
    a first modulus of 1 makes it the unit.
    """
    receptance = partial(socket_receptance, ratio=ratio, poisson=poisson, modulus=modulus)
    return _compliance(receptance, resolution, last_order)


def ball_receptance(orders: ArrayLike, poisson: float) -> NDArray[np.float64]:
    """Inward displacement of a solid ball's surface under the pressure P_n(cos theta).

    Factors of P_n(cos theta) for radius 1 and Young's modulus 1, by the orders n. The pressure of
    order 1 is not in balance: it must not be among them.
    """
    amplitudes = ball_amplitudes(orders, poisson)
    return -(modes(orders, poisson, 1.0)[0, :2] * amplitudes).sum(axis=0)


def socket_receptance(
    orders: ArrayLike, ratio: Layered, poisson: Layered, modulus: Layered = 1.0
) -> NDArray[np.float64]:
    """Outward displacement of a shell's inner surface under the pressure P_n(cos theta).

    As `ball_receptance`, for inner radius 1; the outer sphere is fixed, its radius ``ratio``.
    Layers are as for `socket_compliance`.
    """
    ratios, poissons, _ = layered(ratio, poisson, modulus)
    radial = modes(orders, poissons[0], 1.0, ratios[0])[0]
    return (radial * socket_amplitudes(orders, ratio, poisson, modulus)[0]).sum(axis=0)


def ball_amplitudes(orders: ArrayLike, poisson: float) -> NDArray[np.float64]:
    """Amplitudes of the two regular `modes` in a ball under the pressure P_n(cos theta).

    For radius 1 and Young's modulus 1; shape (2, m), by the orders, without 1. At the radius r,
    ``modes(orders, poisson, r)[:, :2]`` times them, summed over the two, is the displacement and
    the stress over 2 G.
    """
    surface = modes(orders, checks.poisson("poisson", poisson), 1.0)
    pressure = np.array([[-(1 + poisson)], [0.0]])  # radial stress over 2 G, and shear
    return np.linalg.solve(surface[2:, :2].transpose(2, 0, 1), pressure)[:, :, 0].T


def socket_amplitudes(
    orders: ArrayLike, ratio: Layered, poisson: Layered, modulus: Layered = 1.0
) -> NDArray[np.float64]:
    """Amplitudes of the four `modes` in every layer under the pressure P_n(cos theta) inside.

    Shape (layers, 4, m), from the inside out; ratios, Poisson's ratios and moduli as for
    `socket_compliance`. In a layer from radius a to b (over the innermost, so that the first has
    a = 1), with its Poisson's ratio nu and shear modulus G: ``modes(orders, nu, r/a, b/a)`` times
    them, summed over the four, is the displacement over a and the stress over 2 G.

    The flexibility of a sphere is a 2x2 matrix of displacement over a per stress. From the outside
    in, that of a layer's inner sphere follows from that of its outer one; the fixed sphere has
    none.
    """
    ratios, poissons, moduli = layered(ratio, poisson, modulus)
    each = np.column_stack([layer_steps(ratios), poissons, moduli / (1 + poissons)])
    flexibility, layers = np.zeros((2, 2)), []
    for q, nu, g in each[::-1]:  # outer over inner radius, Poisson's ratio, 2 G
        inner, outer = (modes(orders, nu, r, q).transpose(2, 0, 1) for r in (1.0, q))
        held = outer[:, :2] - q * g * flexibility @ outer[:, 2:]
        by_stress = np.linalg.solve(np.hstack([inner[:, 2:], held]), np.eye(4)[:, :2])
        flexibility = inner[:, :2] @ by_stress / g
        layers.append((by_stress / g, g * outer[:, 2:]))
    stress, amplitudes = np.array([[-1.0], [0.0]]), []  # normal and shear, at an inner sphere
    for by_stress, outer_stress in reversed(layers):
        amplitudes.append(by_stress @ stress)
        stress = outer_stress @ amplitudes[-1]
    return np.array(amplitudes)[..., 0].transpose(0, 2, 1)


def modes(
    orders: ArrayLike, poisson: float, radius: float, largest_radius: float = 1.0
) -> NDArray[np.float64]:
    """Radial and polar displacement, normal and shear stress over 2 G of four modes at a radius.

    Shape (4 quantities, 4 modes, m). The modes vary as r^(n+1) and r^(n-1), which are regular, and
    r^-n and r^-(n+2), which are singular. Radial quantities are factors of P_n(cos theta), the
    others of its derivative by theta. Regular modes are scaled to the largest radius and singular
    ones to radius 1, so that no power overflows.
    """
    n, nu, r = np.asarray(orders, dtype=float), poisson, radius
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
    return np.array([inner, inner, outer, outer]) * np.array([radial, polar, normal, shear])


def _compliance(receptance, resolution, last_order):
    """Compliance from the receptance of an order, a function."""
    angles = surface_angles(resolution)
    last = ORDERS * resolution if last_order is None else last_order
    last = checks.whole("last_order", last, least=2, most=MOST_ORDERS)
    if last % 2:
        raise ValueError(f"last_order must be even, got {last}")
    orders = np.arange(0, last + 1, 2)
    norms = 2 * np.pi / (2 * orders + 1)  # of P_n(cos theta) squared over the hemisphere
    roots = np.sqrt(receptance(orders) * norms)[:, None] * hat_coefficients(resolution, last)
    return Compliance(angles, roots.T @ roots, HatFunctions(angles).integrate(np.cos))


@lru_cache(maxsize=4)
def hat_coefficients(resolution: int, last_order: int) -> NDArray[np.float64]:
    """Legendre coefficients of every hat, continued evenly about the equator: (orders, hats).

    For the even orders up to the last, and hats at the nodes of `surface_angles`.

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
