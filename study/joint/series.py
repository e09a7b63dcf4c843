"""Compliance of the ball and of the socket by exact Legendre series.

Mirrored about the equator, ball and socket are a whole sphere and a whole spherical shell under
pressures of even Legendre order. Each order is solved alone. Two of its displacement modes are
regular at the centre, and two are singular there (Lur'e, Three-dimensional problems of the theory
of elasticity, 1964). The layers of a shell are bonded, and joined by the flexibility of those
outside. The bodies are those of `study.joint.modes` with a ``guided`` ball and a ``mirror`` rim.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study.compiled import one_thread
from study.joint.compliance import (
    RESOLUTION,
    Ball,
    Compliance,
    HatFunctions,
    Socket,
    layer_steps,
    surface_angles,
)

ORDERS = 16
"""Orders per element: more change the force by less than 1e-6, the peak pressure by 1e-5."""


@dataclass(frozen=True)
class Solid:
    """A ball, or one layer of a socket, under the pressures P_n(cos theta) on the contact's sphere.

    The ``orders`` n have shape (m,), for a ball without 1, whose pressure is not in balance. Radii
    are over that of the contact's sphere; a ball's ``inner`` one is 0. ``twice_shear`` is 2 G over
    the Young's modulus of the ball or of the innermost layer. ``amplitudes`` are those of the first
    two or of all four `modes`, shape (2 or 4, m).
    """

    orders: NDArray[np.float64]
    inner: float
    outer: float
    poisson: float
    twice_shear: float
    amplitudes: NDArray[np.float64]

    def state(self, radius: float, count: int | None = None) -> NDArray[np.float64]:
        """Displacements over ``inner`` (1 for a ball) and stresses over 2 G at a radius, (4, m).

        The quantities are those of `modes`; of the first ``count`` orders, or of all.
        """
        inner, amplitudes = self.inner or 1.0, self.amplitudes[:, :count]
        at_radius = modes(self.orders[:count], self.poisson, radius / inner, self.outer / inner)
        return (at_radius[:, : len(amplitudes)] * amplitudes).sum(axis=1)


@lru_cache(maxsize=64)
@one_thread
def compliance(body: Ball | Socket, resolution: int = RESOLUTION["series"]) -> Compliance:
    """Compliance of a solid ball, or of a shell fixed on its outer sphere.

    The ``resolution`` is the number of pressure elements along the quarter circle, a multiple of
    16. The series ends after `ORDERS` per element.
    """
    angles = surface_angles(resolution)
    last_order = ORDERS * (len(angles) - 1)
    orders = np.arange(0, last_order + 1, 2)
    if isinstance(body, Ball):
        receptance = -ball(orders, body.poisson).state(1.0)[0]
    else:
        receptance = socket(orders, body)[0].state(1.0)[0]
    norms = 2 * np.pi / (2 * orders + 1)  # of P_n(cos theta) squared over the hemisphere
    roots = np.sqrt(receptance * norms)[:, None] * hat_coefficients(resolution, last_order)
    return Compliance(angles, roots.T @ roots)


def ball(orders: ArrayLike, poisson: float) -> Solid:
    """A solid ball, in which only the two regular `modes` occur."""
    n, nu = np.asarray(orders, dtype=float), poisson
    pressure = np.array([[-(1 + nu)], [0.0]])  # radial stress over 2 G, and shear
    surface = modes(n, nu, 1.0)[2:, :2].transpose(2, 0, 1)
    return Solid(n, 0.0, 1.0, nu, 1 / (1 + nu), np.linalg.solve(surface, pressure)[:, :, 0].T)


def socket(orders: ArrayLike, body: Socket) -> list[Solid]:
    """The layers of a socket from the inside out, under the pressure inside and fixed outside.

    The flexibility of a sphere is a 2x2 matrix of displacement over radius per stress. From the
    outside in, that of a layer's inner sphere follows from that of its outer one; the fixed sphere
    has none. Stresses then lead from the inside out.
    """
    n = np.asarray(orders, dtype=float)
    ratios, poissons, moduli = body.layers
    flexibility, passed_on = np.zeros((2, 2)), []
    layers = list(zip(layer_steps(ratios), poissons, moduli / (1 + poissons), strict=True))
    for step, nu, twice_shear in reversed(layers):
        inner, outer = (modes(n, nu, r, step).transpose(2, 0, 1) for r in (1.0, step))
        held = outer[:, :2] - step * twice_shear * flexibility @ outer[:, 2:]
        by_stress = np.linalg.solve(np.hstack([inner[:, 2:], held]), np.eye(4)[:, :2])
        flexibility = inner[:, :2] @ by_stress / twice_shear
        passed_on.append((by_stress / twice_shear, twice_shear * outer[:, 2:]))
    stress, solids = np.array([[-1.0], [0.0]]), []  # normal and shear, at an inner sphere
    radii = np.append(1.0, ratios)
    for k, (by_stress, outer_stress) in enumerate(reversed(passed_on)):
        amplitudes = by_stress @ stress
        stress = outer_stress @ amplitudes
        _, nu, twice_shear = layers[k]
        solids.append(Solid(n, radii[k], radii[k + 1], nu, twice_shear, amplitudes[..., 0].T))
    return solids


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


@lru_cache(maxsize=4)
def hat_coefficients(resolution: int, last_order: int) -> NDArray[np.float64]:
    """Legendre coefficients of every hat, continued evenly about the equator: (orders, hats).

    Orders are even, up to the last. By parts, the integral of h P_n sin(theta) is that of
    h' (J_(n+1) - J_(n-1))' / (2n + 1), where J_n is the integral of P_n(cos theta) over theta from
    the pole. It obeys (n + 1)^2 J_(n+1) = (2n + 1) sin(theta) P_n + n^2 J_(n-1), which damps
    errors: no quadrature, whatever the order.
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
