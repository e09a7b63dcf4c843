"""A law on paper for any two materials: depth from force by 16 printed numbers.

It is Hertz's law less the depth that finite bodies save. At equal force this adds up over ball and
socket, nearly. It is for a ball driven by its equatorial plane and a socket with a mirror plane at
its rim; other supports, thinner sockets and softer balls are outside of its ranges.

With x the contact radius over R2 that Hertz gives, x^3 = (3/4) P*/sqrt(R2* (R2* - 1)), the share s
of the ball in the compliance, (1 - nu1^2) E*/E1, and the socket ratio q:

- ds = y + (1 - 2 s) y^2/R2*, y = x^2 (1 - F), F = s b + (1 - s) t - s (1 - s) t (c1 b + c2 t);
- the ball's part: b = x [b0 + (b1 + b2 nu1) x];
- the socket's part: 1 - t = (1 - g) [1 + k x^4 (1 - g)^2], g = [(h x)^-n + w^-n]^(-1/n),
  h = h0 (1 - nu2) + 1/[h1 (1 - nu2) (q^1.5 - 1)],
  w = w0 + w1 nu2 + 1/[w2 + (w3 + w4 nu2) q^3];
- the contact half-angle eps: 1/cos(eps) = 1 + [1 + F (1 + 3 s ds)] ds/2;
- the peak pressure: p0 = (3 + p1 F + p2 s ds)/2 times the mean P/(pi R2^2 sin(eps)^2).

Half-angle and peak pressure leave out terms of order 1/R2*.

The numbers are fitted by this study (`study.dataset.printed`). That the load P*/R2*
depends on depth alone for large R2* is Ciavarella, Strozzi, Baldini and Giacopini's observation.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact.laws import LIMIT_MARGIN, Floats, fitted_coefficients
from study.contact.stiffening import share_of_ball

PRINTED_RANGES = {
    "r2_star": (50, None),
    "socket_ratio": (1.25, 1e6),
    "poisson": (0.2, 0.4),
    "socket_poisson": (0.2, 0.46),
}
"""Where the law on paper is fitted, beside depths from 0 to 1 and any ratio of moduli."""
STEPS = 12  # of Newton's method; its last ones change nothing


def printed_depth(
    force_star: ArrayLike,
    r2_star: float,
    *,
    socket_ratio: float,
    modulus_ratio: float = 1.0,
    poisson: float = 0.3,
    socket_poisson: float = 0.3,
) -> Floats:
    """Depth d/dR of a force P/(E* dR^2) by the law on paper (this study, fitted).

    Parameters
    ----------
    force_star
        From 0 to the force of a depth of 1.
    r2_star, socket_ratio, poisson, socket_poisson
        Within `PRINTED_RANGES`: R2/dR, the socket's outer over inner radius, Poisson's ratios of
        ball and socket.
    modulus_ratio
        Young's modulus of the socket over that of the ball, > 0.

    Raises
    ------
    ValueError
        For a value outside its range.
    """
    joint = _Joint(r2_star, socket_ratio, modulus_ratio, poisson, socket_poisson)
    force = np.asarray(checks.number("force_star", force_star, least=0))
    deepest = joint.force(np.ones(1))[0]
    checks.number("force_star", force, most=deepest * (1 + LIMIT_MARGIN))
    return _plain(joint.depth(force))


def printed_force(
    depth_star: ArrayLike,
    r2_star: float,
    *,
    socket_ratio: float,
    modulus_ratio: float = 1.0,
    poisson: float = 0.3,
    socket_poisson: float = 0.3,
) -> Floats:
    """Force P/(E* dR^2) of depths d/dR from 0 to 1: the inverse of `printed_depth`.

    Newton's method in ln(x), from Hertz's x = sqrt(ds). By hand, seven steps of
    x <- x (ds/ds(x))^0.6 leave 0.1 % of the force. The law's error is at most 3.5 %.
    """
    joint = _Joint(r2_star, socket_ratio, modulus_ratio, poisson, socket_poisson)
    return _plain(joint.force(_depth(depth_star)))


def printed_half_angle(
    depth_star: ArrayLike,
    r2_star: float,
    *,
    socket_ratio: float,
    modulus_ratio: float = 1.0,
    poisson: float = 0.3,
    socket_poisson: float = 0.3,
) -> Floats:
    """Polar angle of the contact's edge, in rad, of depths d/dR from 0 to 1: within 7 %."""
    joint = _Joint(r2_star, socket_ratio, modulus_ratio, poisson, socket_poisson)
    return _plain(joint.half_angle(_depth(depth_star))[0])


def printed_peak_pressure(
    depth_star: ArrayLike,
    r2_star: float,
    *,
    socket_ratio: float,
    modulus_ratio: float = 1.0,
    poisson: float = 0.3,
    socket_poisson: float = 0.3,
) -> Floats:
    """Largest pressure over E* dR/R2, of depths d/dR from 0 to 1: within 12 %."""
    joint = _Joint(r2_star, socket_ratio, modulus_ratio, poisson, socket_poisson)
    return _plain(joint.peak_pressure(_depth(depth_star)))


def lost_depth(
    x: Any, share: Any, socket_ratio: Any, poisson: Any, socket_poisson: Any, numbers: dict
) -> Any:
    """Share F of Hertz's depth x^2 that is lost, by the module's formula; all broadcast."""
    (b0, b1, b2), (c1, c2), (k, n) = (numbers[name] for name in ("b", "c", "kn"))
    (h0, h1), (w0, w1, w2, w3, w4) = numbers["h"], numbers["w"]
    ball = x * (b0 + (b1 + b2 * poisson) * x)
    h = h0 * (1 - socket_poisson) + 1 / (h1 * (1 - socket_poisson) * (socket_ratio**1.5 - 1))
    w = w0 + w1 * socket_poisson + 1 / (w2 + (w3 + w4 * socket_poisson) * socket_ratio**3)
    left = 1 - h * x / (1 + (h * x / w) ** n) ** (1 / n)
    socket = 1 - left * (1 + k * (x**2 * left) ** 2)
    cross = share * (1 - share) * socket * (c1 * ball + c2 * socket)
    return share * ball + (1 - share) * socket - cross


def contact_edge(depth: Any, lost: Any, share: Any) -> Any:
    """Polar angle of the contact's edge, by the module's formula."""
    return np.arccos(1 / (1 + (1 + lost * (1 + 3 * share * depth)) * depth / 2))


class _Joint:
    """One joint's law: its checked parameters, and the formulas over arrays of depths."""

    def __init__(self, r2_star, socket_ratio, modulus_ratio, poisson, socket_poisson):
        given = {"r2_star": r2_star, "socket_ratio": socket_ratio}
        given |= {"poisson": poisson, "socket_poisson": socket_poisson}
        for name, (least, most) in PRINTED_RANGES.items():
            least *= 1 - LIMIT_MARGIN
            checks.number(f"{name} on paper", given[name], least=least, most=most, scalar=True)
        checks.number("modulus_ratio", modulus_ratio, above=0, scalar=True)
        self.share = share_of_ball(modulus_ratio, poisson, socket_poisson)
        self.r2_star, self.numbers = r2_star, fitted_coefficients()["printed_hertz"]
        self.of_bodies = self.share, socket_ratio, poisson, socket_poisson, self.numbers

    def depth(self, force):
        x = np.cbrt(0.75 * force / np.sqrt(self.r2_star * (self.r2_star - 1)))
        y = x**2 * (1 - lost_depth(x, *self.of_bodies))
        return y + (1 - 2 * self.share) * y**2 / self.r2_star

    def force(self, depth):
        return 4 / 3 * np.sqrt(self.r2_star * (self.r2_star - 1)) * self._hertz_radius(depth) ** 3

    def half_angle(self, depth):
        lost = lost_depth(self._hertz_radius(depth), *self.of_bodies)
        return contact_edge(depth, lost, self.share), lost

    def peak_pressure(self, depth):
        angle, lost = self.half_angle(depth)
        p1, p2 = self.numbers["p"]
        area = np.pi * np.sin(np.where(depth > 0, angle, 1)) ** 2
        over_mean = (3 + p1 * lost + p2 * self.share * depth) / 2
        return over_mean * self.force(depth) / self.r2_star / area

    def _hertz_radius(self, depth):
        """Hertz's contact radius x of the force: y(x) = depth less its term in 1/R2*."""
        first = (1 - 2 * self.share) / self.r2_star
        y = 2 * depth / (1 + np.sqrt(1 + 4 * first * depth))
        x = np.sqrt(y)
        wanted = np.where(y > 0, y, 1)
        for _ in range(STEPS):
            turned = np.where(y > 0, x, 1) * np.exp(1e-20j)  # whose derivative is its angle
            found = np.log(turned**2 * (1 - lost_depth(turned, *self.of_bodies)))
            x = x * np.exp((np.log(wanted) - found.real) / (found.imag / 1e-20))
        return x


def _depth(depth_star: ArrayLike) -> NDArray[np.float64]:
    checks.depth("depth_star", depth_star)
    most = 1 + LIMIT_MARGIN
    return np.asarray(checks.number("depth_star", depth_star, least=0, most=most))


def _plain(result: Any) -> Floats:
    return float(result) if np.ndim(result) == 0 else result
