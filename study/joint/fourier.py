"""Bodies of revolution under pressures that are not: one problem for each Fourier mode.

A pressure p_m(theta) cos(m phi) displaces a body by u_r cos, u_phi sin and u_z cos of m phi, and
asks for one problem in the meridian (Wilson, AIAA J. 3 (1965) 2269). Its strains have m at first
power, so that three assemblies suffice for every mode. The flexibility changes smoothly with m:
some modes are solved, and those between interpolated. Unknowns are u_r, u_r + u_phi and u_z, each
of which is zero or free on the axis.
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
DEEPEST = 0.95
"""Depth below the surface, in radii, to which stresses are known."""
_FELT = 9.0  # a mode that has decayed by exp(-9) changes the surface by exp(-18)
_CENTRE = 1e-9  # radius
_COMPONENTS = {"r": (0, 1), "z": (2,)}  # unknowns that a held component fixes: u_phi with u_r


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

    def points_between(self, low: Floats, high: Floats) -> tuple[Floats, Floats, Floats]:
        """Gauss points as `points`, of those parts of elements between two polar angles.

        The angles ``low`` and ``high`` belong to the angles phi of `points`, each once. An element
        outside them keeps its points, whose areas are 0.
        """
        whole, phi, area = (of.reshape(-1, _POLAR, self.around) for of in self.points)
        ends = np.clip(self.angles[:, None, None], low, high)
        start, share = ends[:-1], np.diff(ends, axis=0) / self.step
        theta = start + share * (whole - self.angles[:-1, None, None])
        area = area * share * np.sin(theta) / np.sin(whole)
        return theta.ravel(), phi.ravel(), area.ravel()

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
    """A body under pressures on the nodes of a `Grid`: unit radius, unit modulus.

    Mesh, Lame's parameters and what is held are as for `study.joint.fem.MeshedBody`; the mesh has
    the grid's polar angles. ``areas`` are the integrals of the nodes' functions, shape (nodes,).
    Stresses are known at ``places``, radii r and heights z of shape (2, places): the centroids of
    elements up to `DEEPEST` from the surface, and middles of edges on it, outside and where the
    body is held.
    """

    def __init__(self, mesh: MeshTri, lame: tuple, held: dict[str, str], grid: Grid):
        self.grid, last = grid, grid.around
        theta, phi, area = grid.points
        self.areas = area @ grid.values(theta, phi)
        more = np.expm1(np.linspace(0, np.log1p(last), _SOLVED))
        self._modes = np.union1d(np.arange(_FIRST), np.round(more).astype(int))
        solved, self.places, self._stresses = solve_modes(mesh, lame, held, self._modes)
        # it falls about like 1/m, so that its product with m + 1 changes slowly
        every = np.arange(last + 1)
        between = CubicSpline(np.log1p(self._modes), solved * (self._modes + 1)[:, None, None])
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
        weights = CubicSpline(np.log1p(self._modes), np.eye(len(self._modes)))(
            np.log1p(every[:, 0])
        )
        result = np.zeros((6, len(at), len(phi)))
        for weight, of_mode in zip(weights.T, self._stresses, strict=True):
            scaled = weight[:, None] * amplitudes
            result[:4] += of_mode[:4, at] @ (scaled.T @ np.cos(every * phi))
            result[4:] += of_mode[4:, at] @ (scaled.T @ np.sin(every * phi))
        return result


def solve_modes(
    mesh: MeshTri, lame: tuple, held: dict[str, str], modes: NDArray[np.intp]
) -> tuple[Floats, Floats, NDArray[np.float32]]:
    """Flexibility of a meridian's surface for each mode, places, and stresses at them.

    The flexibility, of shape (modes, hats, hats), has the integrals of h_i w_j over the surface:
    w_j cos(m phi) is the inward displacement under the hat function of pressure h_j cos(m phi);
    integrals are per radian of phi. Stresses, of shape (modes, 6, places, hats), have the factors
    of cos(m phi), or of sin(m phi) the last two (`Surface.stresses`). Mesh, Lame's parameters and
    what is held are as for `study.joint.fem.MeshedBody`.
    """
    element = ElementVector(ElementTriP2(), 3)
    basis = Basis(mesh, element, intorder=4)
    constant, linear, square = _elastic(basis, lame)
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
    near = np.flatnonzero(np.abs(np.hypot(*mesh.p[:, mesh.t]).mean(axis=0) - 1) < DEEPEST)
    on_surfaces = {"surface", "outside", *held} & mesh.boundaries.keys()
    edges = np.concatenate([mesh.boundaries[name] for name in sorted(on_surfaces)])
    bases = [
        Basis(mesh, element, elements=near, quadrature=(np.full((2, 1), 1 / 3), np.ones(1))),
        FacetBasis(mesh, element, facets=edges, quadrature=(np.full((1, 1), 1 / 2), np.ones(1))),
    ]
    elements = np.append(near, mesh.f2t[0, edges])
    unknowns = np.hstack([of.element_dofs for of in bases]).T  # (places, functions)
    rates = (np.concatenate(rate, axis=2) for rate in zip(*map(_rates, bases), strict=True))
    moduli = [of if np.isscalar(of) else of[elements] for of in lame]
    constant_stress, growing_stress = (_hooke(rate, moduli)[..., 0].T for rate in rates)
    result = np.empty((len(modes), load.shape[1], load.shape[1]))
    stresses = np.empty((len(modes), 6, len(elements), load.shape[1]), np.float32)
    for k, m in enumerate(modes):
        on_axis = (_unknowns(basis, axis, c) for c in _ON_AXIS.get(m, (0, 1, 2)))
        unfelt = np.flatnonzero((m - 1) * depth > _FELT)
        free = np.setdiff1d(np.arange(basis.N), np.concatenate([*fixed, *on_axis, unfelt]))
        matrix = (constant + m * linear + m * m * square)[free][:, free].tocsc()
        factor = splu(
            matrix,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        displacement = np.zeros(load.shape)
        displacement[free] = factor.solve(load[free])
        result[k] = load.T @ displacement
        of_place = displacement[unknowns]  # (places, functions, hats)
        stresses[k] = ((constant_stress + m * growing_stress) @ of_place).swapaxes(0, 1)
    places = np.hstack([of.global_coordinates().value[:, :, 0] for of in bases])
    return (result + result.swapaxes(1, 2)) / 2, places, stresses


def _unknowns(basis, dofs, component):
    return dofs.all([f"u^{component + 1}"])


def _elastic(basis, lame):
    """Stiffness per radian of mode 0, and its parts in proportion to m and to its square.

    Strains are of every element's own functions at once, so that they are evaluated once for all
    modes and not once for each pair of functions.
    """
    constant, growing = _rates(basis)
    weight = basis.dx * basis.global_coordinates()[0]

    def energy(a, b):
        """Elastic energies of each element's pairs of functions, shape (elements, f, f)."""
        return np.einsum("fceq,gceq->efg", weight * _hooke(a, lame), b, optimize=True)

    cross = energy(constant, growing)
    rows = np.repeat(basis.element_dofs.T[:, :, None], len(basis.basis), axis=2)
    places = rows.ravel(), rows.swapaxes(1, 2).ravel()
    return [
        csr_array((part.ravel(), places), shape=(basis.N, basis.N))
        for part in (
            energy(constant, constant),
            cross + cross.swapaxes(1, 2),
            energy(growing, growing),
        )
    ]


def _hooke(strain, lame):
    """Stress of a strain (functions, 6, elements, points), whose last three are shear angles."""
    first, second = lame
    stress = second * strain
    stress[:, :3] += second * strain[:, :3] + first * strain[:, :3].sum(axis=1, keepdims=True)
    return stress


def _rates(basis):
    """Strains of each function in mode 0, and what m adds: (functions, 6, elements, points)."""
    r = basis.global_coordinates()[0]
    of_0, of_1 = (np.stack([_strains(*f, r, m) for f in basis.basis]) for m in (0, 1))
    return of_0, of_1 - of_0


def _strains(u, r, m):
    """Strains rr, phi phi, zz, rz, r phi and z phi of mode m; shape (6, elements, points)."""
    radial, both, axial = u  # u_r, u_r + u_phi, u_z
    d_radial, d_both, d_axial = u.grad
    around = both - radial  # u_phi
    return np.array(
        [
            d_radial[0],
            ((1 - m) * radial + m * both) / r,
            d_axial[1],
            d_radial[1] + d_axial[0],
            -m * radial / r + d_both[0] - d_radial[0] - around / r,
            d_both[1] - d_radial[1] - m * axial / r,
        ]
    )


@BilinearForm
def _pressure(p, v, w):
    """Work of a normal pressure against an outward displacement of the surface, per radian."""
    return w.x[0] * p * (w.n[0] * v[0] + w.n[1] * v[2])
