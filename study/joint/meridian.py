"""Meshes of the meridians of ball and socket, for the finite elements of `study.joint.modes`.

Triangles have six nodes, or three as in the paper. The mesh has structured rings, finest at the
pole and at the surface; deeper rings have half as many elements. Rings meet the interfaces of a
socket's layers. The mesh of twice the resolution halves every length, so that two meshes give an
error estimate.
"""

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from skfem import MeshTri, MeshTri2
from skfem.models.elasticity import lame_parameters

from study.joint.compliance import Ball, Socket, graded

Nodes = Literal[6, 3]
"""Nodes of a triangle: with six it follows the rings, with three it has straight edges."""
Floats = NDArray[np.float64]
FINEST_RESOLUTION = 320
"""A curve takes 20 s and 2 GB at this resolution; at 1.5 times it takes 80 s and 5 GB."""
RADIAL_ELEMENTS = 0.1
"""Rings in which the elements' size grows by the factor e, divided by the resolution."""
_DEPTH_SCALE = 0.1  # element size grows from this depth below the surface on, in radii
_LEAST_GROWTH = 5 / 8  # rings of a thin layer are as many as if its elements grew by exp(5/8)
_TOGETHER = 8  # elements that are added along the surface: they can be halved three times
_TOUCHING = 1e-9  # rad
_GROWTH = 0.06  # of each of them over the one before
_FEWEST, _FEWEST_HELD = 8, 32  # elements of a ring that is not halved; the same around what holds
_ASPECT = 1.4  # rings are halved once a radial step exceeds this many arc lengths


def ball_mesh(
    ball: Ball, angles: Floats, rings: float, multiple: int = 1, nodes: Nodes = 6
) -> MeshTri:
    """Mesh of the ball's meridian: unit radius, centre at the origin, pole on +z.

    Triangles in the (r, z) plane with boundaries ``surface``, where contact may be, ``axis`` and
    those that hold the ball: ``equator``, ``core``, ``neck`` or ``bore``. The surface's vertices
    come first, at the given polar ``angles`` in rad. There are about ``rings`` rings where the
    elements' size grows by the factor e, and altogether a ``multiple``, so that meshes of half and
    of twice the resolution have half and twice as many.
    """
    outline, (name,) = ball.support.outline, ball.held
    first, last = np.radians(outline.meridian)
    boundaries = {"surface": (1, 1, angles[0], angles[-1]), name: outline.held}
    if outline.bore:  # a shell, which is bent to the bore
        thickness = 1 - outline.bore
        radii = 1.0 - _depths(thickness, 1.0, rings, multiple) / thickness / 2
    elif outline.core:
        radii = 1.0 - _depths_to_core(outline.core, rings, multiple)
    else:
        radii = 1.0 - _depths(1.0, 1.0, rings, multiple)[:-1]
    everywhere = angles
    if outline.edge is not None:  # stresses have no bound there: elements do not grow up to it
        everywhere = _onward(angles, outline.edge, growth=1e-6)
    everywhere = _onward(everywhere, last)
    everywhere = -_onward(-everywhere[::-1], -first)[::-1]
    centre = not (outline.core or outline.bore)
    mesh = _ring_mesh(radii, everywhere, nodes, boundaries, centre)
    if not outline.bore:
        return mesh
    # rays of the shell, at radii from 1 to 1/2, become lines at one height, up to the bore
    radius, angle = np.hypot(*mesh.doflocs), np.arctan2(*mesh.doflocs)
    r = outline.bore + (2 * radius - 1) * (np.sin(angle) - outline.bore)
    return replace(mesh, doflocs=np.array([r, np.cos(angle)]))


def socket_mesh(
    socket: Socket, angles: Floats, rings: float, multiple: int = 1, nodes: Nodes = 6
) -> MeshTri:
    """Mesh of the socket's meridian, of inner radius 1, as `ball_mesh`.

    Its boundaries are ``surface``, ``axis``, ``rim``, ``outside`` and, if it is held in a sector,
    ``seat``. Rings meet the outer radius of every layer.
    """
    radii, last = np.ones(1), np.radians(socket.opening.last)
    for outer in socket.layers[0]:
        start, thickness = radii[-1], outer - radii[-1]
        radii = np.append(radii, start + _depths(thickness, start, rings, multiple)[1:])
    boundaries = {
        "surface": (1, 1, angles[0], angles[-1]),
        "rim": (1, radii[-1], last, last),
        "outside": (radii[-1], radii[-1], angles[0], last),
    }
    seat = np.radians(socket.support.ends)
    if len(seat):
        boundaries["seat"] = (radii[-1], radii[-1], *seat)
    return _ring_mesh(radii, _onward(angles, last), nodes, boundaries, seat=seat)


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


def lame_of(body: Ball | Socket, mesh: MeshTri) -> tuple:
    """Lame's parameters of a body: numbers, or of every element of a socket, (elements, 1)."""
    if isinstance(body, Ball):
        return lame_parameters(1.0, body.poisson)
    ratios, poissons, moduli = body.layers
    of_layers = lame_parameters(moduli, poissons)
    first, second = (of_layer[layer_of(mesh, ratios)][:, None] for of_layer in of_layers)
    return first, second


def _ring_mesh(radii, angles, nodes, boundaries, centre=False, seat=()):
    """Triangulate concentric rings, from the surface (radius 1) to the last radius.

    Boundaries are named by their least and largest radius, and least and largest polar angle. A
    seat's ends become vertices of the last ring.
    """
    is_held = not centre and (len(seat) > 0 or "core" in boundaries)
    fewest = _FEWEST_HELD if is_held else _FEWEST
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
    if len(seat):
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
