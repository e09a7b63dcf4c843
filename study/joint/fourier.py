"""Bodies of revolution under pressures that are not: one problem for each Fourier mode.

A pressure p_m(theta) cos(m phi) displaces a body by u_r cos, u_phi sin and u_z cos of m phi, and
asks for one problem in the meridian (Wilson, AIAA J. 3 (1965) 2269). Its strains have m at first
power, so that three assemblies serve every mode. The flexibility changes smoothly with m: some
modes are solved, and those between interpolated. Unknowns are u_r, u_r + u_phi and u_z, each of
which is zero or free on the axis.
"""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    MeshTri,
)

Floats = NDArray[np.float64]
_FIRST, _SOLVED = 5, 10  # modes solved: the first ones, and more up to the last one
_POLAR, _AROUND = 3, 2  # Gauss points of an element
_ON_AXIS = {0: (0, 1), 1: (1, 2)}  # unknowns that are zero on the axis; of higher modes all are
_FELT = 14.0  # a mode that has decayed by exp(-14) is not felt
_CENTRE = 1e-9  # radius
_COMPONENTS = {"r": (0, 1), "z": (2,)}  # unknowns that a held component fixes: u_phi with u_r


class Grid:
    """Nodes of pressure on half a sphere, 0 <= phi <= pi, on rings of equal polar steps.

    A node's function is a hat of the polar angle, times a hat of phi with its mirror image. Towards
    the pole, which is one node if the ``angles`` begin there, rings have fewer nodes. Nodes have the attributes ``ring``,
    ``place`` (phi over the step of the finest ring), ``theta`` and ``phi``, shape (nodes,); their
    functions are whole (``ends`` 1), or halved by the plane of symmetry (1/2).
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

    def values(self, theta: Floats, phi: Floats) -> csr_array:
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
        return csr_array((np.concatenate(values), (rows, np.concatenate(columns))), shape=shape)


    def faces(self, theta: Floats) -> NDArray[np.bool_]:
        """Whether polar angles are between the first and the last ring."""
        first, last = self.angles[[0, -1]]
        return (theta >= first - 1e-12) & (theta <= last * (1 + 1e-12))


class Surface:
    """Flexibility of a body's surface between the nodes of a `Grid`: unit radius, unit modulus.

    Mesh, Lame's parameters and what is held are as for `study.joint.fem.MeshedBody`; the mesh has
    the grid's polar angles. ``areas`` are the integrals of the nodes' functions, shape (nodes,).
    """

    def __init__(self, mesh: MeshTri, lame: tuple, held: dict[str, str], grid: Grid):
        self.grid, last = grid, grid.around
        theta, phi, area = grid.points
        self.areas = area @ grid.values(theta, phi)
        more = np.expm1(np.linspace(0, np.log1p(last), _SOLVED))
        modes = np.union1d(np.arange(_FIRST), np.round(more).astype(int))
        solved = flexibility(mesh, lame, held, modes)
        # it falls about like 1/m, so that its product with m + 1 changes slowly
        every = np.arange(last + 1)
        between = CubicSpline(np.log1p(modes), solved * (modes + 1)[:, None, None])
        flexible = between(np.log1p(every)) / (every + 1)[:, None, None]
        width = 2 * np.pi / grid.around * grid.stride
        hats = width * np.sinc(every[:, None] * width / (2 * np.pi)) ** 2  # their transforms
        if grid.pole == 0:
            hats[:, 0] = np.where(every == 0, 2 * np.pi, 0)
        share = np.where(every == 0, 1, 2) / (2 * np.pi)
        flexible *= share[:, None, None] * hats[:, :, None] * hats[:, None, :]
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


def flexibility(
    mesh: MeshTri, lame: tuple, held: dict[str, str], modes: NDArray[np.intp]
) -> Floats:
    """Integrals of h_i w_j over a meridian's surface, for each mode; (modes, hats, hats).

    w_j cos(m phi) is the inward displacement under the hat function of pressure h_j cos(m phi);
    integrals are per radian of phi. Mesh, Lame's parameters and what is held are as for
    `study.joint.fem.MeshedBody`.
    """
    element = ElementVector(ElementTriP2(), 3)
    basis = Basis(mesh, element, intorder=4)
    at = [_elastic.assemble(basis, mode=m, first=lame[0], second=lame[1]) for m in (0.0, 1.0, -1.0)]
    linear, square = (at[1] - at[2]) / 2, (at[1] + at[2]) / 2 - at[0]
    facets = mesh.boundaries["surface"]
    traction = FacetBasis(mesh, element, facets=facets, intorder=6)
    hats = FacetBasis(mesh, ElementTriP1(), facets=facets, intorder=6)
    vertices = np.unique(mesh.facets[:, facets])  # in order of polar angle
    load = -_pressure.assemble(hats, traction)[:, vertices].toarray()
    fixed = [
        _unknowns(basis, basis.get_dofs(mesh.boundaries[name]), component)
        for name, components in held.items()
        for component in (c for part in components for c in _COMPONENTS[part])
    ]
    # over the logarithm of the radius a mode decays by its number less one, or faster
    depth = np.abs(np.log(np.maximum(np.hypot(*basis.doflocs), _CENTRE)))
    axis = basis.get_dofs(mesh.boundaries.get("axis", np.zeros(0, int)))
    result = np.empty((len(modes), load.shape[1], load.shape[1]))
    for k, m in enumerate(modes):
        on_axis = (_unknowns(basis, axis, c) for c in _ON_AXIS.get(m, (0, 1, 2)))
        unfelt = np.flatnonzero((m - 1) * depth > _FELT)
        free = np.setdiff1d(np.arange(basis.N), np.concatenate([*fixed, *on_axis, unfelt]))
        matrix = (at[0] + m * linear + m * m * square)[free][:, free].tocsc()
        factor = splu(
            matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        result[k] = load[free].T @ factor.solve(load[free])
    return (result + result.swapaxes(1, 2)) / 2


def _unknowns(basis, dofs, component):
    return dofs.all([f"u^{component + 1}"])


@BilinearForm
def _elastic(u, v, w):
    """Elastic energy per radian, of the mode ``w['mode']``, which may be any number."""
    r, m, first, second = w.x[0], w["mode"], w["first"], w["second"]

    def strains(u):
        radial, both, axial = u[0], u[1], u[2]  # u_r, u_r + u_phi, u_z
        d_radial, d_both, d_axial = u.grad[0], u.grad[1], u.grad[2]
        hoop = ((1 - m) * radial + m * both) / r
        around = both - radial  # u_phi
        return (
            d_radial[0],
            hoop,
            d_axial[1],
            d_radial[1] + d_axial[0],
            -m * radial / r + d_both[0] - d_radial[0] - around / r,
            d_both[1] - d_radial[1] - m * axial / r,
        )

    a, b = strains(u), strains(v)
    volume = (a[0] + a[1] + a[2]) * (b[0] + b[1] + b[2])
    normal = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    shear = a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
    return r * (first * volume + second * (2 * normal + shear))


@BilinearForm
def _pressure(p, v, w):
    """Work of a normal pressure against an outward displacement of the surface, per radian."""
    return w.x[0] * p * (w.n[0] * v[0] + w.n[1] * v[2])
