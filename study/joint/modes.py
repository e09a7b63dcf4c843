"""Finite elements of bodies of revolution: one problem in the meridian for each Fourier mode.

A pressure p_m(theta) cos(m phi) displaces a body by u_r cos(m phi), u_phi sin(m phi) and
u_z cos(m phi), so that each mode m is one problem in the meridian (Wilson, AIAA J. 3 (1965) 2269):
for all displacements v, per radian of phi::

    integral of eps_m(u) . D eps_m(v) r dr dz  =  - integral of p_m (n . v) r ds over the surface

D is Hooke's law, and the strains eps_m = eps_0 + m eps_1 are linear in m (`_strains`). The
stiffness of every mode is therefore K_00 + m (K_01 + K_10) + m^2 K_11, with three assemblies.
Unknowns are u_r, u_r + u_phi and u_z, each of which is zero or free on the axis. Mode 0 has no
u_phi and is all that a load along the axis needs (`compliance`); `study.joint.surface` needs all.
"""

from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
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
    MeshTri2,
)
from skfem.mapping import MappingIsoparametric

from study.checks import RangeError
from study.compiled import one_thread
from study.joint import meridian
from study.joint.compliance import RESOLUTION, Ball, Compliance, Socket, surface_angles

Floats = NDArray[np.float64]
_ON_AXIS = {0: (0, 1), 1: (1, 2)}  # unknowns that are zero on the axis; of higher modes all are
DEEPEST = 0.95
"""Depth below the surface, in radii, to which stresses are known off the axis."""
_FELT = 9.0  # a mode that has decayed by exp(-9) changes the surface by exp(-18)
_CENTRE = 1e-9  # radius
_AT_ONCE = 16  # loads that are solved together: what they need stays in the processor's cache
_COMPONENTS = {"r": (0, 1), "z": (2,)}  # unknowns that a held component fixes: u_phi with u_r


class _CurvedMapping(MappingIsoparametric):
    """Curved triangles, whose places are found in flat ones too: skfem clips Newton's steps."""

    def invF(self, x, tind=None, newton_max_iters=50, newton_tol=1e-9):  # noqa: N802
        places = np.full(x.shape, 1 / 3)
        for _ in range(newton_max_iters):
            step = np.einsum("ijkl,jkl->ikl", self.invDF(places, tind), x - self.F(places, tind))
            places = places + step
            if np.abs(step).max() < newton_tol:
                return places
        raise RangeError("elements of a layer are too flat: take a thicker layer or more elements")


class Body:
    """A meshed elastic body of unit radius and unit Young's modulus, for every Fourier mode.

    Lame's parameters ``lame`` are numbers, or arrays of shape (elements, 1). ``held`` maps a
    boundary of the mesh to the components (of ``rz``) of the displacement that are zero there.
    Forces and energies are per radian of phi.
    """

    def __init__(self, mesh: MeshTri, lame: tuple, held: dict[str, str]):
        quadratic = isinstance(mesh, MeshTri2)
        self.mesh, self._lame, self._held = mesh, lame, held
        self._node = ElementTriP2() if quadratic else ElementTriP1()
        self._element = ElementVector(self._node, 3)
        self._basis = Basis(mesh, self._element, intorder=4 if quadratic else 2)
        facets = mesh.boundaries["surface"]
        self._mapping = _CurvedMapping(mesh, mesh.elem(), mesh.bndelem) if quadratic else None
        on_surface = {"facets": facets, "intorder": 6}
        traction = FacetBasis(mesh, self._element, self._mapping, **on_surface)
        hats = FacetBasis(mesh, ElementTriP1(), self._mapping, **on_surface)
        vertices = np.unique(mesh.facets[:, facets])  # in order of polar angle
        self.angles = np.arctan2(*mesh.p[:, vertices])
        self.loads = -_pressure.assemble(hats, traction)[:, vertices]  # of each hat of pressure

    def displacements(self, m: int) -> Floats:
        """Displacements under every hat of pressure in mode m, dense, shape (unknowns, hats)."""
        matrix = self._constant
        if m > 0:
            linear, square = self._growing
            matrix = matrix + m * linear + m * m * square
        # over the logarithm of the radius a mode decays by its number less one, or faster
        depth = np.abs(np.log(np.maximum(np.hypot(*self._basis.doflocs), _CENTRE)))
        free = self._free(m, np.flatnonzero((m - 1) * depth > _FELT))
        displacement = np.zeros(self.loads.shape)
        displacement[free] = _solved(_factor(matrix[free][:, free]), self.loads[free].toarray())
        return displacement

    @cached_property
    def _mode_0(self):
        """Factor of mode 0, its free unknowns, and the matrix that ties u_r + u_phi to u_r."""
        r, both, z = (
            np.concatenate([self._basis.nodal_dofs[c], *self._basis.facet_dofs[c::3]])
            for c in range(3)
        )
        rows, columns = np.concatenate([r, both, z]), np.concatenate([r, r, z])
        tie = csr_array((np.ones(len(rows)), (rows, columns)), shape=(self._basis.N,) * 2)
        free = np.setdiff1d(self._free(0, both), both)
        matrix = tie.T @ self._constant @ tie
        return _factor(csr_array(matrix)[free][:, free]), free, tie

    def axisymmetric(self, load: Floats) -> Floats:
        """Displacements of mode 0 under loads, shape (unknowns, k)."""
        factor, free, tie = self._mode_0
        displacement = np.zeros(load.shape)
        displacement[free] = _solved(factor, (tie.T @ load)[free])
        return tie @ displacement

    @cached_property
    def compliance(self) -> Compliance:
        """`Compliance` of the surface: the body under every axisymmetric hat of pressure."""
        flexibility = 2 * np.pi * (self.loads.T @ self.axisymmetric(self.loads.toarray()))
        return Compliance(self.angles, (flexibility + flexibility.T) / 2)

    def nodal_stresses(self, pressure: Floats, inner: float = 0.0, outer: float = np.inf) -> Floats:
        """Stresses rr, phi phi, zz and rz at the mesh's nodes, means over the elements there.

        They are those of axisymmetric pressures (k, hats), in the pressures' unit; shape (4, k,
        nodes). Elements between the two radii count alone, such as those of a layer; other nodes
        have 0.
        """
        elements = np.flatnonzero((inner < self._middle) & (self._middle < outer))
        points = self._node.doflocs.T, np.ones(len(self._node.doflocs))
        basis = Basis(self.mesh, self._element, elements=elements, quadrature=points)
        nodes, size = self.mesh.dofs.element_dofs[:, elements].T, self.mesh.doflocs.shape[1]
        displacement = self.axisymmetric(self.loads @ pressure.T)
        constant, _ = self.stress_rows(basis, elements)
        local = displacement[basis.element_dofs.T]  # (elements, functions, k)
        share = 1 / np.maximum(np.bincount(nodes.ravel(), minlength=size), 1)[nodes.ravel()]
        at = nodes.ravel(), np.arange(nodes.size)
        mean = csr_array((share, at), shape=(size, nodes.size))
        parts = (rows.transpose(1, 2, 0) @ local for rows in constant[:, :4].swapaxes(0, 1))
        return np.array([(mean @ part.reshape(nodes.size, -1)).T for part in parts])

    def stress_rows(self, basis: Basis, elements: NDArray[np.intp]) -> tuple[Floats, Floats]:
        """Stresses of each function in mode 0, and what m adds: (functions, 6, elements, points).

        The six are rr, phi phi, zz, rz, r phi and z phi.
        """
        lame = tuple(of if np.isscalar(of) else of[elements] for of in self._lame)
        return tuple(_hooke(rates, lame) for rates in _rates(basis))

    def places_of_stress(self) -> tuple[list[Basis], NDArray[np.intp]]:
        """Bases with one point in each place of stress off the axis, and the elements there.

        They are the centroids of elements up to `DEEPEST` from the surface, and middles of edges on
        it, outside and where the body is held.
        """
        mesh = self.mesh
        near = np.flatnonzero(np.abs(self._middle - 1) < DEEPEST)
        on_surfaces = {"surface", "outside", *self._held} & mesh.boundaries.keys()
        edges = np.concatenate([mesh.boundaries[name] for name in sorted(on_surfaces)])
        centroid, middle = ((np.full((d, 1), 1 / (d + 1)), np.ones(1)) for d in (2, 1))
        inside = Basis(mesh, self._element, elements=near, quadrature=centroid)
        on_edges = FacetBasis(mesh, self._element, self._mapping, facets=edges, quadrature=middle)
        return [inside, on_edges], np.append(near, mesh.f2t[0, edges])

    @property
    def _middle(self):
        """Distance of each element's centre from that of the body."""
        return np.hypot(*self.mesh.p[:, self.mesh.t]).mean(axis=0)

    def _free(self, m, unfelt):
        """Unknowns of mode m that are neither held, nor zero on the axis, nor unfelt."""
        axis = self._basis.get_dofs(self.mesh.boundaries.get("axis", np.zeros(0, int)))
        fixed = [unfelt, *(_unknowns(axis, c) for c in _ON_AXIS.get(m, (0, 1, 2)))]
        for name, components in self._held.items():
            dofs = self._basis.get_dofs(self.mesh.boundaries[name])
            fixed += [_unknowns(dofs, c) for part in components for c in _COMPONENTS[part]]
        return np.setdiff1d(np.arange(self._basis.N), np.concatenate(fixed))

    @cached_property
    def _constant(self):
        """K_00, the stiffness of mode 0, per radian."""
        constant, _ = _rates(self._basis)
        return self._assembled(constant, constant)

    @cached_property
    def _growing(self):
        """K_01 + K_10 and K_11, the parts of the stiffness that grow with m and with m^2."""
        constant, growing = _rates(self._basis)
        cross = self._assembled(constant, growing)
        return cross + cross.T, self._assembled(growing, growing)

    def _assembled(self, a, b):
        """Integrals of a . D b r dr dz, of two strains of each pair of functions."""
        basis = self._basis
        weight = basis.dx * basis.global_coordinates()[0]
        pairs = np.einsum("fceq,gceq->efg", weight * _hooke(a, self._lame), b, optimize=True)
        rows = np.repeat(basis.element_dofs.T[:, :, None], pairs.shape[1], axis=2)
        places = rows.ravel(), rows.swapaxes(1, 2).ravel()
        return csr_array((pairs.ravel(), places), shape=(basis.N, basis.N))


@lru_cache(maxsize=4)
@one_thread
def meshed(
    body: Ball | Socket, resolution: int = RESOLUTION["quadratic"], nodes: meridian.Nodes = 6
) -> Body:
    """A ball or a socket for loads along the axis."""
    angles = surface_angles(resolution, body.opening.reach)
    return made(body, angles, meridian.RADIAL_ELEMENTS * resolution, nodes=nodes)


def made(
    body: Ball | Socket,
    angles: Floats,
    rings: float,
    multiple: int = 1,
    nodes: meridian.Nodes = 6,
) -> Body:
    """A ball or a socket with a mesh as of `study.joint.meridian.ball_mesh`."""
    if isinstance(body, Ball):
        mesh = meridian.ball_mesh(body, angles, rings, multiple, nodes)
    else:
        mesh = meridian.socket_mesh(body, angles, rings, multiple, nodes)
    return Body(mesh, meridian.lame_of(body, mesh), body.held)


@lru_cache(maxsize=64)
def compliance(
    body: Ball | Socket, resolution: int = RESOLUTION["quadratic"], nodes: meridian.Nodes = 6
) -> Compliance:
    """`Compliance` of a ball or a socket by finite elements."""
    return meshed(body, resolution, nodes).compliance


def _factor(matrix):
    return splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def _solved(factor, loads):
    """Displacements under loads, a few at once."""
    parts = range(0, loads.shape[1], _AT_ONCE)
    return np.hstack([factor.solve(loads[:, k : k + _AT_ONCE]) for k in parts])


def _unknowns(dofs, component):
    return dofs.all([f"u^{component + 1}"])


def _hooke(strain, lame):
    """Stress of a strain (functions, 6, elements, points), whose last three are shear angles."""
    first, second = lame
    stress = second * strain
    stress[:, :3] += second * strain[:, :3] + first * strain[:, :3].sum(axis=1, keepdims=True)
    return stress


def _rates(basis):
    """eps_0 and eps_1 of each function: (functions, 6, elements, points)."""
    r = basis.global_coordinates()[0]
    of_0, of_1 = (np.stack([_strains(*f, r, m) for f in basis.basis]) for m in (0, 1))
    return of_0, of_1 - of_0


def _strains(u, r, m):
    """Strains rr, phi phi, zz and angles rz, r phi, z phi of mode m; shape (6, elements, points).

    They are u_r,r; (u_r + m u_phi)/r; u_z,z; u_r,z + u_z,r; u_phi,r - (m u_r + u_phi)/r; and
    u_phi,z - m u_z/r, but for the factor of cos(m phi), or of sin(m phi) in the last two.
    """
    radial, both, axial = u  # u_r, u_r + u_phi, u_z
    d_radial, d_both, d_axial = u.grad
    around = both - radial  # u_phi
    on_axis, r = r < _CENTRE, np.maximum(r, _CENTRE)
    # on the axis of mode 0 the strain around it is the radial one
    hoop = np.where(on_axis, d_radial[0], ((1 - m) * radial + m * both) / r)
    return np.array(
        [
            d_radial[0],
            hoop,
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
