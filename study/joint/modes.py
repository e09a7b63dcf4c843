"""Finite elements of bodies of revolution: one problem in the meridian for each Fourier mode.

A pressure p_m(theta) cos(m phi) displaces a body by u_r cos, u_phi sin and u_z cos of m phi, and
asks for one problem in the meridian (Wilson, AIAA J. 3 (1965) 2269). Its strains have m at first
power, so that three assemblies suffice for every mode. Unknowns are u_r, u_r + u_phi and u_z, each
of which is zero or free on the axis. Mode 0 has no u_phi and is all that a load along the axis
needs (`compliance`). Off the axis the flexibility changes smoothly with m: some modes are solved,
and those between interpolated (`Surface`).
"""

from functools import cached_property, lru_cache
from typing import Any

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
    MeshTri2,
)

from study.joint import meridian
from study.joint.compliance import RESOLUTION, Ball, Compliance, Socket, surface_angles
from study.threads import one_thread

Floats = NDArray[np.float64]
_FIRST, _SOLVED = 5, 10  # modes solved: the first ones, and more up to the last one
_POLAR, _AROUND = 3, 2  # Gauss points of an element of pressure
_ON_AXIS = {0: (0, 1), 1: (1, 2)}  # unknowns that are zero on the axis; of higher modes all are
DEEPEST = 0.95
"""Depth below the surface, in radii, to which stresses are known off the axis."""
_FELT = 9.0  # a mode that has decayed by exp(-9) changes the surface by exp(-18)
_CENTRE = 1e-9  # radius
_AT_ONCE = 16  # loads that are solved together: what they need stays in the processor's cache
_COMPONENTS = {"r": (0, 1), "z": (2,)}  # unknowns that a held component fixes: u_phi with u_r


class Body:
    """A meshed elastic body of unit radius and unit Young's modulus, for every Fourier mode.

    Lame's parameters ``lame`` are numbers, or arrays of shape (elements, 1). ``held`` maps a
    boundary of the mesh, or ``centre``, to the components (of ``rz``) of the displacement that are
    zero there. Forces and energies are per radian of phi.
    """

    def __init__(self, mesh: MeshTri, lame: tuple, held: dict[str, str]):
        quadratic = isinstance(mesh, MeshTri2)
        self.mesh, self._lame, self._held = mesh, lame, held
        self._node = ElementTriP2() if quadratic else ElementTriP1()
        self._element = ElementVector(self._node, 3)
        self._basis = Basis(mesh, self._element, intorder=4 if quadratic else 2)
        facets = mesh.boundaries["surface"]
        traction = FacetBasis(mesh, self._element, facets=facets, intorder=6)
        hats = FacetBasis(mesh, ElementTriP1(), facets=facets, intorder=6)
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
        on_edges = FacetBasis(mesh, self._element, facets=edges, quadrature=middle)
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
            if name == "centre":
                dofs = self._basis.get_dofs(nodes=np.flatnonzero(~self.mesh.p.any(axis=0)))
            else:
                dofs = self._basis.get_dofs(self.mesh.boundaries[name])
            fixed += [_unknowns(dofs, c) for part in components for c in _COMPONENTS[part]]
        return np.setdiff1d(np.arange(self._basis.N), np.concatenate(fixed))

    @cached_property
    def _constant(self):
        """Stiffness of mode 0, per radian."""
        constant, _ = _rates(self._basis)
        return self._assembled(constant, constant)

    @cached_property
    def _growing(self):
        """Parts of the stiffness in proportion to m and to its square."""
        constant, growing = _rates(self._basis)
        cross = self._assembled(constant, growing)
        return cross + cross.T, self._assembled(growing, growing)

    def _assembled(self, a, b):
        """Elastic energies of strains, of each element's own functions at once."""
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
    """A ball or a socket for loads along the axis; a point load's force depends on the mesh."""
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
    """The surface of a `Body` under pressures on the nodes of a `Grid`.

    The body's mesh has the grid's polar angles. ``areas`` are the integrals of the nodes'
    functions, shape (nodes,). Stresses are known at ``places``, radii r and heights z of shape (2,
    places), once they are asked for (`Body.places_of_stress`).
    """

    def __init__(self, body: Body, grid: Grid):
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
