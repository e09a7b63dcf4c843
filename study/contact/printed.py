"""A law on paper for any two materials: depth from force by 16 printed numbers.

It is Hertz's law with less depth, because finite bodies are stiffer. At equal force the parts of
ball and socket nearly add up. The ball is radially free (drive ``plane``), the rim a mirror plane.

With Hertz's contact radius x over R2, x^3 = (3/4) P*/sqrt(R2* (R2* - 1)), the share s of the ball
in the compliance, (1 - nu1^2) E*/E1, and the socket ratio q:

- ds = y + (1 - 2 s) y^2/R2*, y = x^2 (1 - F), F = s b + (1 - s) t - s (1 - s) t (c1 b + c2 t);
- the ball's part: b = x [b0 + (b1 + b2 nu1) x];
- the socket's part: 1 - t = (1 - g) [1 + k x^4 (1 - g)^2], g = [(h x)^-n + w^-n]^(-1/n),
  h = h0 (1 - nu2) + 1/[h1 (1 - nu2) (q^1.5 - 1)],
  w = w0 + w1 nu2 + 1/[w2 + (w3 + w4 nu2) q^3];
- the contact half-angle eps: 1/cos(eps) = 1 + [1 + F (1 + 3 s ds)] ds/2;
- the peak pressure: p0 = (3 + p1 F + p2 s ds)/2 times the mean P/(pi R2^2 sin(eps)^2).

Half-angle and peak pressure leave out terms of order 1/R2*.

The numbers are fitted by this study (`study.dataset.printed`). Ciavarella, Strozzi, Baldini and
Giacopini observed that for large R2* the load P*/R2* depends on the depth alone.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact.hertz_correction import share_of_ball
from study.contact.laws import LIMIT_MARGIN, Floats, fitted_coefficients

PRINTED_RANGES = {
    "r2_star": (50, None),
    "socket_ratio": (1.25, 1e6),
    "poisson": (0.2, 0.4),
    "socket_poisson": (0.2, 0.46),
}
"""Where the law on paper is fitted, for depths from 0 to 1 and any ratio of moduli."""
STEPS = 12  # of Newton's method; the last ones change nothing


class PrintedLaw:
    """The law on paper of one joint, over depths d/dR from 0 to 1 (this study, fitted).

    Parameters
    ----------
    r2_star, socket_ratio, poisson, socket_poisson
        R2/dR, the socket ratio, and Poisson's ratios of ball and socket, within `PRINTED_RANGES`.
    modulus_ratio
        Young's modulus of the socket over that of the ball, > 0.

    Raises
    ------
    ValueError
        For a value outside its range, also in the methods.
    """

    def __init__(
        self,
        r2_star: float,
        *,
        socket_ratio: float,
        modulus_ratio: float = 1.0,
        poisson: float = 0.3,
        socket_poisson: float = 0.3,
    ) -> None:
        given = {"r2_star": r2_star, "socket_ratio": socket_ratio}
        given |= {"poisson": poisson, "socket_poisson": socket_poisson}
        for name, (least, most) in PRINTED_RANGES.items():
            least *= 1 - LIMIT_MARGIN
            checks.number(f"{name} on paper", given[name], least=least, most=most, scalar=True)
        checks.number("modulus_ratio", modulus_ratio, above=0, scalar=True)
        self.share = share_of_ball(modulus_ratio, poisson, socket_poisson)
        self.r2_star, self.numbers = r2_star, fitted_coefficients()["printed_hertz"]
        self._of_bodies = self.share, socket_ratio, poisson, socket_poisson, self.numbers

    def depth(self, force_star: ArrayLike) -> Floats:
        """Depth d/dR of forces P/(E* dR^2), from 0 to the force of a depth of 1."""
        most = float(self.force(1.0)) * (1 + LIMIT_MARGIN)
        force = np.asarray(checks.number("force_star", force_star, least=0, most=most))
        x = np.cbrt(0.75 * force / np.sqrt(self.r2_star * (self.r2_star - 1)))
        y = x**2 * (1 - lost_depth(x, *self._of_bodies))
        return _plain(y + (1 - 2 * self.share) * y**2 / self.r2_star)

    def force(self, depth_star: ArrayLike) -> Floats:
        """Force P/(E* dR^2) of depths d/dR: the inverse of `depth`, within 3.5 % of the solution.

        By Newton's method in ln(x), from Hertz's x = sqrt(ds). By hand, seven steps of
        x <- x (ds/ds(x))^0.6 leave an error of 0.1 % of the force.
        """
        radius = self._hertz_radius(_depth(depth_star))
        return _plain(4 / 3 * np.sqrt(self.r2_star * (self.r2_star - 1)) * radius**3)

    def contact_half_angle_deg(self, depth_star: ArrayLike) -> Floats:
        """Polar angle of the contact's edge, in deg, at depths d/dR: within 7 %."""
        return _plain(np.degrees(self._edge(_depth(depth_star))[0]))

    def peak_pressure_star(self, depth_star: ArrayLike) -> Floats:
        """Largest pressure over E* dR/R2, at depths d/dR: within 12 %."""
        depth = _depth(depth_star)
        angle, lost = self._edge(depth)
        p1, p2 = self.numbers["p"]
        area = np.pi * np.sin(np.where(depth > 0, angle, 1)) ** 2
        over_mean = (3 + p1 * lost + p2 * self.share * depth) / 2
        return _plain(over_mean * self.force(depth) / self.r2_star / area)

    def _edge(self, depth):
        """Polar angle of the contact's edge, in rad, and the lost share of Hertz's depth."""
        lost = lost_depth(self._hertz_radius(depth), *self._of_bodies)
        return contact_edge(depth, lost, self.share), lost

    def _hertz_radius(self, depth):
        """Hertz's contact radius x of the force, from y(x) = depth less the term in 1/R2*."""
        first = (1 - 2 * self.share) / self.r2_star
        y = 2 * depth / (1 + np.sqrt(1 + 4 * first * depth))
        x = np.sqrt(y)
        wanted = np.where(y > 0, y, 1)
        for _ in range(STEPS):
            turned = np.where(y > 0, x, 1) * np.exp(1e-20j)  # complex: its angle is the derivative
            found = np.log(turned**2 * (1 - lost_depth(turned, *self._of_bodies)))
            x = x * np.exp((np.log(wanted) - found.real) / (found.imag / 1e-20))
        return x


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
    """Polar angle of the contact's edge, in rad, by the module's formula."""
    return np.arccos(1 / (1 + (1 + lost * (1 + 3 * share * depth)) * depth / 2))


def _depth(depth_star: ArrayLike) -> NDArray[np.float64]:
    checks.depth("depth_star", depth_star)
    most = 1 + LIMIT_MARGIN
    return np.asarray(checks.number("depth_star", depth_star, least=0, most=most))


def _plain(result: Any) -> Floats:
    return float(result) if np.ndim(result) == 0 else result
