"""Compliance of an elastic body: how its spherical surface deforms under normal pressure.

Contact needs no more of a body than its `Compliance`, and this depends on no more than `Ball` or
`Socket`. It is computed once for every clearance, depth and modulus: bodies have unit
radius, and the Young's modulus of the ball or of the innermost layer is the unit.
"""

from __future__ import annotations  # SciPy's packages are loaded when they are used

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from study.joint.supports import (
    HEMISPHERE,
    BallSupport,
    GuidedPlate,
    Opening,
    Rim,
    SocketSupport,
    WholeOutside,
)

RESOLUTION = {"series": 320, "quadratic": 160, "linear": 160}
"""Default elements along the quarter circle: series, and triangles with six or three nodes."""
FINEST_RESOLUTION = 1280
"""Finer hat functions are too similar for the series, and finer meshes take gigabytes."""
THINNEST_RATIO = 1.0001
"""Least socket ratio, and least ratio of a layer's radii: thinner ones cost the series digits. At
1.0001 its error is 1e-11 for a Poisson's ratio of 0.3, and 2e-9 for 0.4999."""
THICKEST_RATIO = 1e6
"""Largest socket ratio: a thicker socket changes the force by less than 1e-6, and takes more rings
of elements."""
_ANGLE_SCALE = 0.157  # rad: spacing of the surface's nodes grows from this polar angle on
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
        return self.support.is_half and self.support.is_symmetric and self.opening == HEMISPHERE

    @property
    def held(self) -> dict[str, str]:
        """Boundary of the mesh -> components of the displacement that are zero there."""
        return self.support.held

    @property
    def corners(self) -> NDArray[np.float64]:
        """Places (r, z) in the meridian at which stresses may have no bound; shape (n, 2)."""
        return np.reshape(self.support.outline.corners, (-1, 2))


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
        constants = map(np.atleast_1d, (self.ratio, self.poisson, self.modulus))
        return np.array(np.broadcast_arrays(*constants), dtype=float)

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
        places += [(outer, angle) for angle in self.support.ends]
        radius, angle = np.transpose(places)
        directions = np.column_stack([np.sin(np.radians(angle)), np.cos(np.radians(angle))])
        return radius[:, None] * directions


def layer_steps(ratios: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outer over inner radius of each layer, from the outer radii over the innermost one."""
    return ratios / np.append(1.0, ratios[:-1])


def graded(length: float, scale: float, count: int) -> NDArray[np.float64]:
    """Places of ``count`` steps over ``length``, each proportional to (distance + scale)."""
    return scale * np.expm1(np.linspace(0, np.log1p(length / scale), count + 1))


def surface_angles(resolution: int, last: float = np.pi / 2) -> NDArray[np.float64]:
    """Polar angles of the surface's nodes, from 0 to the last one, in rad; (resolution + 1,).

    Their spacing is proportional to angle + 9 deg. The resolution is a multiple of 16.
    """
    angles = graded(last, _ANGLE_SCALE, resolution)
    angles[-1] = last
    return angles


@dataclass(frozen=True)
class Compliance:
    """Inward normal displacement of a unit sphere's surface under axisymmetric pressure.

    Pressure is piecewise linear between nodes at the polar ``angles`` from 0 on, in rad, (n,): a
    sum of hat functions h_i. The ``flexibility`` is the integral of h_i w_j over the surface, where
    w_j is the displacement under h_j: symmetric and positive definite, (n, n). For radius R and
    modulus E it scales by R/E. All callers share the arrays, read-only.
    """

    angles: NDArray[np.float64]
    flexibility: NDArray[np.float64]

    def __post_init__(self):
        for array in (self.angles, self.flexibility):
            array.flags.writeable = False

    @cached_property
    def between_nodes(self) -> NDArray[np.float64]:
        """The flexibility in terms of the hats' values, not of their integrals; shape (n, n)."""
        mass = HatFunctions(self.angles).mass()
        bands = np.array([np.append(0, np.diag(mass, 1)), np.diag(mass)])
        return scipy.linalg.solveh_banded(
            bands, scipy.linalg.solveh_banded(bands, self.flexibility).T
        )

    @cached_property
    def coarser(self) -> Compliance:
        """The same body under the hats of every second node, which are sums of its hats."""
        angles = self.angles[::2]
        sums = HatFunctions(angles).values(self.angles).T
        return Compliance(angles, sums @ (sums @ self.flexibility).T)


class HatFunctions:
    """Hat functions of the polar angle on a unit hemisphere, which interpolate pressures.

    The n ``angles`` of the nodes increase, in rad. Gauss's points have the polar angles ``points``
    and the ``areas``, of shape (8 (n - 1),).
    """

    _POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(8)

    def __init__(self, angles: NDArray[np.float64]):
        self.angles = angles
        width = np.diff(angles)[:, None]
        self._right = (1 + self._POINTS) / 2  # value of an element's right hat; left is 1 - it
        self._theta = angles[:-1, None] + width * self._right
        self._area = np.pi * np.sin(self._theta) * width * self._WEIGHTS  # 2 pi sin / 2
        self.points, self.areas = self._theta.ravel(), self._area.ravel()

    def integrate(self, function: Callable) -> NDArray[np.float64]:
        """Integral of ``function(theta)`` times each hat over the unit sphere, shape (n,)."""
        density = self._area * function(self._theta)
        return self._to_nodes((density * (1 - self._right)).sum(1), (density * self._right).sum(1))

    def mass(self) -> NDArray[np.float64]:
        """Integrals of products of two hats over the unit sphere, shape (n, n)."""
        left, right = 1 - self._right, self._right
        diagonal = self._to_nodes((self._area * left**2).sum(1), (self._area * right**2).sum(1))
        beside = (self._area * left * right).sum(1)
        return np.diag(diagonal) + np.diag(beside, 1) + np.diag(beside, -1)

    def values(self, theta: NDArray[np.float64]) -> scipy.sparse.csr_array:
        """Value of every hat at every angle of ``theta``, sparse, shape (len(theta), n)."""
        element = np.clip(np.searchsorted(self.angles, theta) - 1, 0, len(self.angles) - 2)
        right = (theta - self.angles[element]) / np.diff(self.angles)[element]
        values, columns = np.stack([1 - right, right], 1), np.stack([element, element + 1], 1)
        rows = 2 * np.arange(len(theta) + 1)
        shape = len(theta), len(self.angles)
        return scipy.sparse.csr_array((values.ravel(), columns.ravel(), rows), shape=shape)

    @staticmethod
    def _to_nodes(left, right):
        nodes = np.zeros(len(left) + 1)
        nodes[:-1] += left
        nodes[1:] += right
        return nodes
