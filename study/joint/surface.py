"""Surfaces of ball and socket off the axis: pressure on a grid, and the displacement under it.

The displacement of a body of revolution is a sum of Fourier modes (`study.joint.modes`). Its
flexibility changes smoothly with the mode: some modes are solved, and those between interpolated.
"""

from __future__ import annotations  # scikit-fem and SciPy are loaded when they are used

from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from numpy.typing import NDArray

from study.joint.compliance import Ball, Socket

if TYPE_CHECKING:
    from study.joint import modes

Floats = NDArray[np.float64]
_FIRST, _SOLVED = 5, 10  # modes solved: the first ones, and more up to the last one
_POLAR, _AROUND = 3, 2  # Gauss points of an element of pressure
_RADIAL_ELEMENTS = 0.15  # as in `study.joint.meridian`, for elements of equal angles
_MULTIPLE = 8  # of which the resolution of any grid is one
_TOGETHER = 16  # nodes around of which coarser rings leave all but one out


class Grid:
    """Nodes of pressure on half a sphere, 0 <= phi <= pi, on rings of equal polar steps.

    A node's function is a hat of the polar angle, times a hat of phi with its mirror image. Towards
    the pole, which is one node if the ``angles`` begin there, rings have fewer nodes. Nodes have
    the attributes ``ring``, ``place`` (phi over the step of the finest ring), ``theta`` and
    ``phi``, shape (nodes,); their functions are whole (``ends`` 1), or halved by the plane of
    symmetry (1/2).
    """

    def __init__(self, angles: Floats, around: int):
        self.angles, self.around, self.step = angles, around, angles[1] - angles[0]
        self.pole = 0 if angles[0] == 0 else -1  # number of the ring that is one node
        rings = angles[self.pole + 1 :]
        arc = np.sin(rings) * 2 * np.pi / around / self.step  # over the polar step
        halvings = np.floor(np.log2(np.maximum(1.4 / arc, 1)))
        self.stride = np.gcd(around // 2, 2 ** halvings.astype(int))
        counts = around // 2 // self.stride + 1
        if self.pole == 0:
            self.stride, counts = np.append(around, self.stride), np.append(1, counts)
        self.first = np.cumsum(np.append(0, counts))
        self.ring = np.repeat(np.arange(len(angles)), counts)
        self.size = len(self.ring)
        self.place = (np.arange(self.size) - self.first[self.ring]) * self.stride[self.ring]
        self.theta, self.phi = angles[self.ring], 2 * np.pi / around * self.place
        self.ends = np.where(self.place % (around // 2) == 0, 0.5, 1.0)

    @cached_property
    def points(self) -> tuple[Floats, Floats, Floats]:
        """Gauss points: polar angles, angles phi and areas, each of shape (points,)."""
        (x, weight), (y, share) = map(np.polynomial.legendre.leggauss, (_POLAR, _AROUND))
        width, step = self.step, 2 * np.pi / self.around
        theta = (self.angles[:-1, None] + width * (1 + x) / 2).ravel()
        phi = (step * (np.arange(self.around // 2)[:, None] + (1 + y) / 2)).ravel()
        polar = np.tile(weight * width / 2, len(self.angles) - 1) * np.sin(theta)
        area = np.outer(polar, np.tile(share * step / 2, self.around // 2)).ravel()
        return np.repeat(theta, len(phi)), np.tile(phi, len(theta)), area

    def values(self, theta: Floats, phi: Floats) -> scipy.sparse.csr_array:
        """Value of every node's function at points, sparse; 0 beyond the first and last angle."""
        steps = (theta - self.angles[0]) / self.step
        ring = np.clip(steps.astype(int), 0, len(self.angles) - 2)
        upper = steps - ring
        inside = self.faces(theta)
        columns, values = [], []
        for at, share in ((ring, 1 - upper), (ring + 1, upper)):
            places = phi * self.around / (2 * np.pi) / self.stride[at]
            one = at == self.pole
            last = np.where(one, 0, self.around // 2 // self.stride[at] - 1)
            left = np.minimum(places.astype(int), last)
            right = np.where(one, 0.0, places - left)
            for column, part in ((left, 1 - right), (left + ~one, right)):
                columns.append(self.first[at] + column)
                values.append(share * part * inside)
        rows, shape = np.tile(np.arange(len(theta)), 4), (len(theta), self.size)
        return scipy.sparse.csr_array(
            (np.concatenate(values), (rows, np.concatenate(columns))), shape=shape
        )

    def faces(self, theta: Floats) -> NDArray[np.bool_]:
        """Whether polar angles are between the first and the last ring."""
        first, last = self.angles[[0, -1]]
        return (theta >= first - 1e-12) & (theta <= last * (1 + 1e-12))


class Surface:
    """The surface of a `Body` under pressures on the nodes of a `Grid`.

    The body's mesh has the grid's polar angles. With the polar hats h_i, the flexibility of mode m
    is the integral of h_i w_j over the surface, where w_j cos(m phi) is the displacement under the
    pressure h_j cos(m phi). A sum over the modes, with the transforms of the nodes' hats of phi,
    gives the flexibility between two nodes: it depends on their rings and on the distance and the
    sum of their angles phi, because pressure is symmetric about phi = 0.

    ``areas`` are the integrals of the nodes' functions, shape (nodes,). Stresses are known at
    ``places``, radii r and heights z of shape (2, places), once they are asked for
    (`study.joint.modes.Body.places_of_stress`).
    """

    def __init__(self, body: modes.Body, grid: Grid):
        self.body, self.grid, last = body, grid, grid.around
        theta, phi, area = grid.points
        self.areas = area @ grid.values(theta, phi)
        more = np.expm1(np.linspace(0, np.log1p(last), _SOLVED))
        self._modes = np.union1d(np.arange(_FIRST), np.round(more).astype(int))
        self._kernel: Any = None
        self._stresses: Any = None

    def solve(self, stresses: bool) -> None:
        """Solve the modes, and their stresses if they are asked for, unless this is done."""
        if self._kernel is not None and not (stresses and self._stresses is None):
            return
        grid, last, body = self.grid, self.grid.around, self.body
        solved = np.empty((len(self._modes), *(len(body.angles),) * 2))
        if stresses:
            bases, elements = body.places_of_stress()
            self.places = np.hstack([of.global_coordinates()[:, :, 0] for of in bases])
            unknowns = np.hstack([of.element_dofs for of in bases]).T  # (places, functions)
            count = len(bases[0].element_dofs.T)
            rows = zip(
                body.stress_rows(bases[0], elements[:count]),
                body.stress_rows(bases[1], elements[count:]),
                strict=True,
            )
            constant, growing = (np.concatenate(of, axis=2)[..., 0].T for of in rows)
            shape = len(self._modes), 6, len(elements), len(body.angles)
            self._stresses = np.empty(shape, np.float32)
        for k, m in enumerate(self._modes):
            # w_j cos(m phi) is the inward displacement under the hat h_j cos(m phi) of pressure;
            # integrals of h_i w_j over the surface are per radian of phi
            displacement = body.displacements(m)
            flexible = body.loads.T @ displacement
            solved[k] = (flexible + flexible.T) / 2
            if stresses:  # factors of cos(m phi), or of sin(m phi) the last two
                of_place = displacement[unknowns]  # (places, functions, hats)
                self._stresses[k] = ((constant + m * growing) @ of_place).swapaxes(0, 1)
        # it falls about like 1/m, so that its product with m + 1 changes slowly
        every = np.arange(last + 1)
        between = scipy.interpolate.CubicSpline(
            np.log1p(self._modes), solved * (self._modes + 1)[:, None, None]
        )
        flexible = between(np.log1p(every)) / (every + 1)[:, None, None]
        width = 2 * np.pi / grid.around * grid.stride
        hats = width * np.sinc(every[:, None] * width / (2 * np.pi)) ** 2  # their transforms
        if grid.pole == 0:
            hats[:, 0] = np.where(every == 0, 2 * np.pi, 0)
        share = np.where(every == 0, 1, 2) / (2 * np.pi)
        self._to_modes = share[:, None] * hats
        flexible *= self._to_modes[:, :, None] * hats[:, None, :]
        apart = np.arange(grid.around // 2 + 1)
        cosine = np.cos(2 * np.pi / grid.around * (np.outer(apart, every) % grid.around))
        rings = len(grid.angles)
        self._kernel = (cosine @ flexible.reshape(last + 1, -1)).reshape(-1, rings, rings)

    def matrix(self, nodes: NDArray[np.intp]) -> Floats:
        """Flexibility between some nodes: integrals over half the sphere, dense."""
        grid = self.grid
        ring, place, ends = grid.ring[nodes], grid.place[nodes], grid.ends[nodes]
        apart, together = np.abs(place[:, None] - place), place[:, None] + place
        mirrored = np.minimum(together, grid.around - together)
        of_rings = ring[:, None], ring
        both = self._kernel[apart, *of_rings] + self._kernel[mirrored, *of_rings]
        return both * np.outer(ends, ends)

    def stresses(self, pressure: Floats, phi: Floats, at: NDArray[np.intp]) -> Floats:
        """Stresses rr, phi phi, zz, rz, r phi and z phi at some of the `places` and angles phi.

        The ``pressure`` is that of the nodes, shape (nodes,); the result has the shape (6, places,
        angles). Those of the modes that are not solved are interpolated.
        """
        grid, every = self.grid, np.arange(self.grid.around + 1)[:, None]
        waves = np.cos(every * grid.phi) * (2 * grid.ends * pressure)
        amplitudes = self._to_modes * np.add.reduceat(waves, grid.first[:-1], axis=1)
        weights = scipy.interpolate.CubicSpline(np.log1p(self._modes), np.eye(len(self._modes)))(
            np.log1p(every[:, 0])
        )
        result = np.zeros((6, len(at), len(phi)))
        for weight, of_mode in zip(weights.T, self._stresses, strict=True):
            scaled = weight[:, None] * amplitudes
            result[:4] += of_mode[:4, at] @ (scaled.T @ np.cos(every * phi))
            result[4:] += of_mode[4:, at] @ (scaled.T @ np.sin(every * phi))
        return result


@lru_cache(maxsize=6)
def of_socket(socket: Socket, resolution: int) -> Surface:
    """Surface of a socket, at a resolution as of `study.joint.Joint.solve`."""
    angles, around = _angles(socket.opening, resolution)
    return _surface(socket, angles, around, resolution)


@lru_cache(maxsize=6)
def of_ball(ball: Ball, beyond: float, resolution: int) -> Surface:
    """Surface of a ball, whose nodes go on some deg ``beyond`` the socket's rims.

    A bored ball has nodes over its whole surface, because its mesh ends at the faces.
    """
    (angles, around), (first, last) = (
        _angles(ball.opening, resolution),
        ball.support.outline.surface,
    )
    step = np.degrees(angles[1] - angles[0])
    if ball.support.outline.bore:
        elements = 8 * int(np.ceil((last - first) / step / 8))
        return _surface(
            ball, np.radians(np.linspace(first, last, elements + 1)), around, resolution
        )
    low, high = max(first, ball.opening.first - beyond), min(last, ball.opening.last + beyond)
    before = int(max(ball.opening.first - low, 0) / step + 1e-6)
    behind = int(max(high - ball.opening.last, 0) / step + 1e-6)
    every = angles[0] + np.radians(step) * np.arange(-before, len(angles) + behind)
    return _surface(ball, every, around, resolution)


def _surface(body, angles, around, resolution):
    from study.joint import modes

    # the coarser grid has half as many rings
    rings = _RADIAL_ELEMENTS * resolution, resolution // _MULTIPLE
    return Surface(modes.made(body, angles, *rings), Grid(angles, around))


def _angles(opening, resolution):
    """Polar angles of a socket's nodes, and the number of nodes around its largest ring."""
    width = opening.last - opening.first
    count = 2 * round(width / 180 * resolution)
    angles = np.radians(opening.first + width / count * np.arange(count + 1))
    widest = np.sin(angles).max() if not opening.is_ring and opening.last < 90 else 1.0
    around = np.ceil(2 * np.pi * widest / (angles[1] - angles[0]) / _TOGETHER)
    return angles, _TOGETHER * int(around)


def unit_vectors(theta: Floats, phi: Floats) -> Floats:
    """Unit vectors (x, y, z) of polar angles and angles around the axis z, in rad; (n, 3)."""
    sine = np.sin(theta)
    return np.column_stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)])
