"""Ball and socket by axisymmetric finite elements.

Triangles have six nodes, or three as in the paper. The mesh has structured rings, finest at the
contact's pole and at the surface; deeper rings have half as many elements. Rings meet the
interfaces of a socket's layers. A body takes one sparse factorisation. The mesh of resolution 2n
halves every length of that of n, so that two meshes give an error estimate. The work of six-node
triangles converges with order 3 to 4. Contact is solved by `study.joint.curve`.
"""

from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshTri,
    MeshTri2,
)
from skfem.helpers import ddot, div, dot, eye, grad, mul, sym_grad, trace, transpose
from skfem.models.elasticity import lame_parameters

from study.joint.compliance import RESOLUTION, Ball, Compliance, Socket, graded, surface_angles
from study.joint.supports import Bore, Core, Neck, Sector
from study.threads import one_thread

Nodes = Literal[6, 3]
"""Nodes of a triangle: with six it follows the rings, with three it has straight edges."""
Floats = NDArray[np.float64]
FINEST_RESOLUTION = 320
"""A curve takes 20 s and 2 GB at this resolution; at 1.5 times it takes 80 s and 5 GB."""
THINNEST_RATIO = 1.02
"""Least ratio of the radii of a socket or layer: thinner elements are too flat to be mapped."""

_DEPTH_SCALE = 0.1  # element size grows from this depth below the surface on, in radii
_RADIAL_ELEMENTS = 0.1  # rings in which the elements' size grows by e, divided by the resolution
_LEAST_GROWTH = 5 / 8  # rings of a thin layer are as many as if its elements grew by exp(5/8)
_AT_ONCE = 16  # loads that are solved together: what they need stays in the processor's cache
_TOGETHER = 8  # elements that are added along the surface: they can be halved three times
_TOUCHING = 1e-9  # rad
_GROWTH = 0.06  # of each of them over the one before
_FEWEST, _FEWEST_HELD = 8, 32  # elements of a ring that is not halved; the same around what holds
_ASPECT = 1.4  # rings are halved once a radial step exceeds this many arc lengths


def ball_mesh(ball: Ball, resolution: int = RESOLUTION["quadratic"], nodes: Nodes = 6) -> MeshTri:
    """Mesh of the ball's meridian: unit radius, centre at the origin, pole on +z.

    Triangles in the (r, z) plane with boundaries ``surface``, where contact may be, ``axis`` and
    those that hold the ball: ``equator``, ``core`` or ``neck``. The surface's vertices come first,
    in order of polar angle. The ``resolution``, elements along ``surface``, is a multiple of 16.
    """
    angles = surface_angles(resolution, ball.opening.reach)
    return meridian_of_ball(ball, angles, _RADIAL_ELEMENTS * resolution, nodes=nodes)


def socket_mesh(
    socket: Socket, resolution: int = RESOLUTION["quadratic"], nodes: Nodes = 6
) -> MeshTri:
    """Mesh of the socket's meridian, of inner radius 1, as `ball_mesh`.

    Its boundaries are ``surface``, ``axis``, ``rim``, ``outside`` and, if it is held in a sector,
    ``seat``. Rings meet the outer radius of every layer, each >= 1.02 of the inner one.
    """
    angles = surface_angles(resolution, socket.opening.reach)
    return meridian_of_socket(socket, angles, _RADIAL_ELEMENTS * resolution, nodes=nodes)


def meridian_of_ball(
    ball: Ball, angles: Floats, rings: float, multiple: int = 1, nodes: Nodes = 6
) -> MeshTri:
    """`ball_mesh` with vertices at given polar angles in rad, where contact may be.

    There are about ``rings`` rings where the elements' size grows by the factor e, and altogether
    a ``multiple``, so that meshes of half and of twice the resolution have half and twice as many.
    """
    support = ball.support
    boundaries = {"surface": (1, 1, angles[0], angles[-1])} | support.boundaries
    if isinstance(support, Bore):
        thickness = 1 - support.radius
        shell = 1.0 - _depths(thickness, 1.0, rings, multiple) / thickness / 2
        mesh = _ring_mesh(shell, angles, nodes, boundaries)
        return replace(mesh, doflocs=support.through_bore(mesh.doflocs))
    if isinstance(support, Core):
        radii = 1.0 - _depths_to_core(support.radius, rings, multiple)
    else:
        radii = 1.0 - _depths(1.0, 1.0, rings, multiple)[:-1]
    everywhere = angles
    if isinstance(support, Neck):  # stresses have no bound at its edge: elements do not grow
        everywhere = _onward(angles, support.edge, growth=1e-6)
    everywhere = _onward(everywhere, np.pi / 2 if support.is_half else np.pi)
    everywhere = -_onward(-everywhere[::-1], 0.0)[::-1]
    return _ring_mesh(radii, everywhere, nodes, boundaries, centre=not isinstance(support, Core))


def meridian_of_socket(
    socket: Socket, angles: Floats, rings: float, multiple: int = 1, nodes: Nodes = 6
) -> MeshTri:
    """`socket_mesh` with vertices at given polar angles in rad, as for `meridian_of_ball`."""
    radii, last = np.ones(1), np.radians(socket.opening.last)
    for outer in socket.layers[0]:
        start, thickness = radii[-1], outer - radii[-1]
        depths = _depths(thickness, start, rings, multiple)
        radii = np.append(radii, start + depths[1:])
    boundaries = {
        "surface": (1, 1, angles[0], angles[-1]),
        "rim": (1, radii[-1], last, last),
        "outside": (radii[-1], radii[-1], angles[0], last),
    }
    everywhere, seat = _onward(angles, last), None
    if isinstance(socket.support, Sector):
        seat = np.radians([socket.support.first, socket.support.last])
        boundaries["seat"] = (radii[-1], radii[-1], *seat)
    return _ring_mesh(radii, everywhere, nodes, boundaries, seat=seat)


def _depths(thickness, start, rings, multiple):
    """Depths of the rings of a body or layer, from its inner surface on, at a radius."""
    scale = abs(start - 1) + _DEPTH_SCALE
    return graded(thickness, scale, _count(np.log1p(thickness / scale), rings, multiple))


def _count(growth, rings, multiple):
    """Number of rings in which the elements' size grows by a factor of exp(growth)."""
    return multiple * round(max(growth, _LEAST_GROWTH) * rings / multiple)


def _depths_to_core(radius, rings, multiple):
    """Depths of the rings of a ball with a core, whose elements shrink towards it as well.

    Their size is that of `_depths`, and towards a small core it is proportional to the radius.
    """
    scale = _DEPTH_SCALE
    growth = np.log1p((1 - radius) / scale) - np.log(radius) / 2
    count = _count(growth, rings, multiple)
    # depths d at which (1 + d / scale)^2 = grown (1 - d): growth is the logarithm of its root
    grown = np.exp(2 * np.linspace(0, growth, count + 1))
    half = 1 / scale + grown / 2
    depths = scale**2 * (np.sqrt(half**2 + (grown - 1) / scale**2) - half)
    depths[[0, -1]] = 0, 1 - radius
    return depths


def _onward(angles, stop, growth=_GROWTH):
    """Polar angles continued to a stop beyond the last, in elements that grow from its size on."""
    length, size = stop - angles[-1], angles[-1] - angles[-2]
    if length < _TOUCHING:
        return angles
    count = np.log1p(growth * length / size) / np.log1p(growth)
    more = graded(length, size / growth, _TOGETHER * int(np.ceil(count / _TOGETHER)))[1:]
    return np.append(angles, np.append(angles[-1] + more[:-1], stop))


def layer_of(mesh: MeshTri, ratios: Floats) -> NDArray[np.intp]:
    """Which layer each element of a `socket_mesh` is in, from 0 inside; shape (elements,)."""
    return np.searchsorted(ratios, np.hypot(*mesh.p[:, mesh.t]).mean(axis=0))


class MeshedBody:
    """An elastic body of unit radius and unit Young's modulus, meshed and factorised.

    Its Lame parameters ``lame`` are numbers, or arrays of shape (elements, 1). ``held`` maps a
    boundary of the mesh, or ``centre``, to the components (of ``rz``) of the displacement that are
    zero there. ``size`` counts all unknowns, fixed ones too. ``angles`` are those of the surface's
    nodes, in rad, and ``surface`` their unknowns, radial and axial.
    """

    def __init__(self, mesh: MeshTri, lame: tuple[ArrayLike, ArrayLike], held: dict[str, str]):
        quadratic = isinstance(mesh, MeshTri2)
        self._element = ElementVector(ElementTriP2() if quadratic else ElementTriP1())
        self._mesh, self._lame = mesh, lame
        self._basis = Basis(mesh, self._element, intorder=4 if quadratic else 2)
        self.size = self._basis.N
        self._stiffness = _elasticity(*self._lame).assemble(self._basis)
        fixed = [_of(self._dofs(name), c) for name, components in held.items() for c in components]
        self._free = np.setdiff1d(np.arange(self.size), np.concatenate(fixed))
        self._factor = splu(
            self._stiffness[self._free][:, self._free].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        radial, axial = (_of(self._dofs("surface"), component) for component in "rz")
        angles = np.arctan2(*self._basis.doflocs[:, radial])
        order = np.argsort(angles)
        self.angles, self.surface = angles[order], np.array([radial[order], axial[order]])

    def _dofs(self, boundary):
        if boundary == "centre":
            return self._basis.get_dofs(nodes=np.flatnonzero(~self._mesh.p.any(axis=0)))
        return self._basis.get_dofs(self._mesh.boundaries[boundary])

    def solve(self, load: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacement under loads of shape (unknowns,) or (unknowns, k)."""
        loads = load.reshape(self.size, -1)
        displacement = np.zeros(loads.shape)
        for first in range(0, loads.shape[1], _AT_ONCE):
            few = slice(first, first + _AT_ONCE)
            displacement[self._free, few] = self._factor.solve(loads[self._free, few])
        return displacement.reshape(load.shape)

    def excess_force(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Internal forces beyond the linear ones, at large displacements.

        The material is that of Saint Venant and Kirchhoff: second Piola-Kirchhoff stress
        proportional to Green's strain, as finite-element programs use for large rotations.
        """
        field = self._basis.interpolate(displacement)
        gradient, hoop = field.grad, field[0] / self._basis.global_coordinates()[0]
        linear = (gradient + transpose(gradient)) / 2
        green = linear + mul(transpose(gradient), gradient) / 2
        small, small_around = self._stress(linear, hoop)
        large, large_around = self._stress(green, hoop + hoop**2 / 2)
        stress = large + mul(gradient, large) - small
        around = (1 + hoop) * large_around - small_around
        return _internal_force.assemble(self._basis, stress=stress, around=around)

    def _stress(self, strain, hoop):
        """Stresses in the meridian's plane and around the axis, of linear elasticity."""
        first, second = self._lame
        volume = trace(strain) + hoop
        in_plane = first * volume * eye(1.0 + 0 * volume, 2) + 2 * second * strain
        return in_plane, first * volume + 2 * second * hoop

    @cached_property
    def compliance(self) -> Compliance:
        """`Compliance` of the surface: the body solved for every hat function of pressure."""
        load = self._hat_loads
        flexibility = load.T @ self.solve(load.toarray())
        angles = np.arctan2(*self._mesh.p[:, : load.shape[1]])
        return Compliance(angles, (flexibility + flexibility.T) / 2)

    @cached_property
    def _hat_loads(self):
        """Nodal forces of every hat function of pressure, sparse."""
        facets = self._mesh.boundaries["surface"]
        traction = FacetBasis(self._mesh, self._element, facets=facets, intorder=6)
        hats = FacetBasis(self._mesh, ElementTriP1(), facets=facets, intorder=6)
        return -_normal_pressure.assemble(hats, traction)[:, : len(facets) + 1]

    @property
    def places(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Radii and polar angles (rad) of the mesh's nodes, each of shape (nodes,)."""
        return np.hypot(*self._mesh.doflocs), np.arctan2(*self._mesh.doflocs)

    def stresses(
        self, pressure: NDArray[np.float64], inner: float = 0.0, outer: float = np.inf
    ) -> NDArray[np.float64]:
        """Radial, polar, azimuthal and shear stress at the nodes, means over the elements there.

        Linear elasticity, in the unit of the pressures (k, hats); shape (4, k, nodes). Elements
        between the two radii count alone, such as those of a layer; other nodes have 0.
        """
        middle = np.hypot(*self._mesh.p[:, self._mesh.t]).mean(axis=0)
        elements = np.flatnonzero((inner < middle) & (middle < outer))
        nodes = self._mesh.dofs.element_dofs.T
        at = np.arange(nodes.size).reshape(nodes.shape)[elements].ravel()
        nodes, size = nodes[elements].ravel(), self._mesh.doflocs.shape[1]
        share = 1 / np.maximum(np.bincount(nodes, minlength=size), 1)[nodes]
        mean = csr_array((share, (nodes, at)), shape=(size, self._mesh.dofs.element_dofs.size))
        displacement = self.solve(self._hat_loads @ pressure.T)
        return np.array([(mean @ (part @ displacement)).T for part in self._stress_rows])

    @cached_property
    def _stress_rows(self):
        """Stresses of `stresses` at each element's own nodes, as sparse rows over the unknowns."""
        corners = (ElementTriP2 if isinstance(self._mesh, MeshTri2) else ElementTriP1).doflocs.T
        basis = Basis(self._mesh, self._element, quadrature=(corners, np.ones(corners.shape[1])))
        r, z = basis.global_coordinates()
        off_axis, angle = r > 1e-12, np.arctan2(r, z)
        sine, cosine = np.sin(angle), np.cos(angle)
        rows, columns, values = np.arange(r.size), [], []
        for (shape,), unknown in zip(basis.basis, basis.element_dofs, strict=True):
            strain = sym_grad(shape)
            hoop = np.where(off_axis, shape[0] / np.where(off_axis, r, 1), strain[0, 0])
            ((rr, rz), (_, zz)), around = self._stress(strain, hoop)
            radial = sine**2 * rr + cosine**2 * zz + 2 * sine * cosine * rz
            shear = sine * cosine * (rr - zz) + (cosine**2 - sine**2) * rz
            values.append(
                [radial.ravel(), (rr + zz - radial).ravel(), around.ravel(), shear.ravel()]
            )
            columns.append(np.repeat(unknown, r.shape[1]))
        places = np.tile(rows, len(columns)), np.concatenate(columns)
        shape = r.size, self.size
        return [csr_array((v, places), shape=shape) for v in np.concatenate(values, axis=1)]


@lru_cache(maxsize=4)
@one_thread
def meshed(
    body: Ball | Socket, resolution: int = RESOLUTION["quadratic"], nodes: Nodes = 6
) -> MeshedBody:
    """A ball or a socket, meshed and factorised; a point load's force depends on the mesh."""
    if isinstance(body, Ball):
        mesh = ball_mesh(body, resolution, nodes)
    else:
        mesh = socket_mesh(body, resolution, nodes)
    return MeshedBody(mesh, lame_of(body, mesh), {"axis": "r"} | body.held)


def lame_of(body: Ball | Socket, mesh: MeshTri) -> tuple:
    """Lame's parameters of a body: numbers, or of every element of a socket, (elements, 1)."""
    if isinstance(body, Ball):
        return lame_parameters(1.0, body.poisson)
    ratios, poissons, moduli = body.layers
    of_layers = lame_parameters(moduli, poissons)
    first, second = (of_layer[layer_of(mesh, ratios)][:, None] for of_layer in of_layers)
    return first, second


@lru_cache(maxsize=64)
def compliance(
    body: Ball | Socket, resolution: int = RESOLUTION["quadratic"], nodes: Nodes = 6
) -> Compliance:
    """`Compliance` of a ball or a socket."""
    return meshed(body, resolution, nodes).compliance


def _of(dofs, component):
    return dofs.all([f"u^{'rz'.index(component) + 1}"])


def _ring_mesh(radii, angles, nodes, boundaries, centre=False, seat=None):
    """Triangulate concentric rings, from the surface (radius 1) to the last radius.

    Boundaries are named by their least and largest radius, and least and largest polar angle. A
    seat's ends become vertices of the last ring.
    """
    fewest = _FEWEST if centre or (seat is None and "core" not in boundaries) else _FEWEST_HELD
    points, triangles, first = [_ring(1.0, angles)], [], 0
    for radius, step in zip(radii[1:], np.abs(np.diff(radii)), strict=True):
        outer = first + np.arange(len(angles))
        first = outer[-1] + 1
        arc = radius * np.sqrt((angles[1] - angles[0]) * (angles[-1] - angles[-2]))
        elements = len(angles) - 1
        if step > _ASPECT * arc and elements % 2 == 0 and elements > fewest:
            angles = angles[::2]
            inner = first + np.arange(len(angles))
            a, b, c = outer[:-2:2], outer[1:-1:2], outer[2::2]
            p, q = inner[:-1], inner[1:]
            triangles += [(a, b, p), (b, q, p), (b, c, q)]
        else:
            inner = first + np.arange(len(angles))
            for start, diagonal in ((0, False), (1, True)):  # diagonals alternate
                a, b = outer[start:-1:2], outer[start + 1 :: 2]
                p, q = inner[start:-1:2], inner[start + 1 :: 2]
                triangles += [(a, b, p), (b, q, p)] if diagonal else [(a, b, q), (a, q, p)]
        points.append(_ring(radius, angles))
    last = first + np.arange(len(angles))
    if centre:
        points.append(np.zeros((2, 1)))
        triangles.append((last[:-1], last[1:], np.full(len(last) - 1, last[-1] + 1)))
    triangles = np.hstack([np.vstack(corners) for corners in triangles])
    points = np.hstack(points)
    if seat is not None:
        points = _moved_to(points, seat, angles, radii[-1])
    linear = MeshTri(np.ascontiguousarray(points), np.ascontiguousarray(triangles))
    named = _boundaries(linear, boundaries, angles[-1])
    mesh = _curved(linear) if nodes == 6 else linear
    return mesh.with_boundaries(named)


def _ring(radius, angles):
    sine = np.where(angles == np.pi, 0.0, np.sin(angles))
    return radius * np.array([sine, np.where(angles == np.pi / 2, 0.0, np.cos(angles))])


def _moved_to(points, seat, angles, outer):
    """Points turned about the centre so that vertices of the outer ring are at a seat's ends.

    The nearest vertices move there; all others move in proportion, less towards the surface.
    """
    radius, angle = np.hypot(*points), np.arctan2(*points)
    nearest = angles[np.abs(angles[:, None] - seat).argmin(axis=0)]
    ends = angles[[0, -1]]
    wanted = np.interp(angle, [ends[0], *nearest, ends[1]], [ends[0], *seat, ends[1]])
    return _ring(radius, angle + (radius - 1) / (outer - 1) * (wanted - angle))


def _boundaries(linear, wanted, last):
    """Edges of each named boundary, and of the axis."""
    radius = np.hypot(*linear.p)
    angle = np.where(radius > 0, np.arctan2(*linear.p), last)  # the centre is on the last ray

    def edges(on_boundary):
        return np.flatnonzero(on_boundary[linear.facets].all(axis=0))

    named = {"axis": edges(linear.p[0] == 0)}
    for name, (inner, outer, low, high) in wanted.items():
        within = (radius >= inner - 1e-9) & (radius <= outer + 1e-9)
        named[name] = edges(within & (angle >= low - 1e-9) & (angle <= high + 1e-9))
    return {name: edges for name, edges in named.items() if edges.size}


def _curved(linear):
    """Quadratic mesh that follows the rings, however thin."""
    radius = np.hypot(*linear.p)
    mesh = MeshTri2.from_mesh(linear)
    locations = mesh.doflocs.copy()
    middles = mesh.dofs.facet_dofs[0]  # at the mean radius of their edge's ends: arcs and spirals
    locations[:, middles] *= radius[linear.facets].mean(axis=0) / np.hypot(*locations[:, middles])
    return replace(mesh, doflocs=locations)


def _elasticity(lame_lambda, lame_mu):
    """Weak form of axisymmetric linear elasticity in (r, z), over the whole circle."""

    @BilinearForm
    def form(u, v, w):
        r = w.x[0]
        hoop_u, hoop_v = u[0] / r, v[0] / r
        shear = ddot(sym_grad(u), sym_grad(v)) + hoop_u * hoop_v
        volume = (div(u) + hoop_u) * (div(v) + hoop_v)
        return 2 * np.pi * r * (2 * lame_mu * shear + lame_lambda * volume)

    return form


@LinearForm
def _internal_force(v, w):
    """Work of given stresses against a displacement."""
    r = w.x[0]
    return 2 * np.pi * r * (ddot(w["stress"], grad(v)) + w["around"] * v[0] / r)


@BilinearForm
def _normal_pressure(p, v, w):
    """Work of a normal pressure against an outward displacement of the surface."""
    return 2 * np.pi * w.x[0] * p * dot(w.n, v)
