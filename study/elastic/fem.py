"""Compliance of the ball and of the socket by axisymmetric finite elements.

Quadratic triangles on a structured mesh of rings, finest at the contact's pole and at the
surface, halved in number where depth allows; one sparse factorisation per body. The mesh of
resolution 2n halves every length of that of n, so that two meshes give an error estimate.
Contact itself is not solved here: see `study.joint`.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np
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
from skfem.helpers import ddot, div, dot, sym_grad
from skfem.models.elasticity import lame_parameters

from study import checks
from study.elastic import Compliance

DRIVES = ("plane", "clamped")
RIMS = ("free", "mirror")
RESOLUTION = 160
THINNEST_RATIO = 1.02
"""Least ratio of the socket's radii: elements of a thinner shell are too flat to be mapped."""

# Element size grows from these distances on: the polar angle of a small contact (rad), and
# the depth below the surface (radii) that its stresses reach.
_ANGLE_SCALE = 0.157
_DEPTH_SCALE = 0.1
_RADIAL_ELEMENTS = 0.1  # elements per unit of graded depth, as a share of the resolution
_ASPECT = 1.4  # rings are halved once a radial step exceeds this many arc lengths


def surface_angles(resolution=RESOLUTION):
    """Polar angles of the surface's vertices, with spacing proportional to angle + 9 deg.

    Parameters
    ----------
    resolution : int
        Elements along the quarter circle: a multiple of 16, at least 16.

    Returns
    -------
    ndarray, shape (resolution + 1,)
        Angles from 0 to pi/2, in rad.
    """
    if resolution != int(resolution) or resolution < 16 or resolution % 16:
        raise ValueError(f"resolution must be a multiple of 16, >= 16, got {resolution}")
    angles = _graded(np.pi / 2, _ANGLE_SCALE, int(resolution))
    angles[-1] = np.pi / 2
    return angles


def ball_mesh(resolution=RESOLUTION):
    """Mesh of the half ball's meridian: unit radius, centre at the origin, pole on +z.

    Returns
    -------
    skfem.MeshTri2
        Quadratic triangles in the (r, z) plane with boundaries ``surface``, ``axis`` and
        ``equator``; the surface's vertices come first, in order of polar angle.
    """
    layers = max(8, round(_RADIAL_ELEMENTS * resolution * np.log1p(1 / _DEPTH_SCALE)))
    depths = _graded(1.0, _DEPTH_SCALE, layers)[:-1]
    return _ring_mesh(1.0 - depths, surface_angles(resolution), centre=True)


def socket_mesh(ratio, resolution=RESOLUTION):
    """Mesh of the socket's meridian: inner radius 1, outer radius ``ratio``, pole on +z.

    Parameters
    ----------
    ratio : float
        Outer over inner radius, >= 1.02.

    Returns
    -------
    skfem.MeshTri2
        As `ball_mesh`, with the boundary ``outside`` besides.
    """
    thickness = checks.number("socket_ratio", ratio, least=THINNEST_RATIO, scalar=True) - 1.0
    if thickness < 0.05 and resolution < 32:
        raise ValueError(f"resolution must be >= 32 for socket_ratio < 1.05, got {resolution}")
    layers = round(_RADIAL_ELEMENTS * resolution * np.log1p(thickness / _DEPTH_SCALE))
    depths = _graded(thickness, _DEPTH_SCALE, max(resolution // 16, layers, 2))
    return _ring_mesh(1.0 + depths, surface_angles(resolution), centre=False)


@lru_cache(maxsize=32)
def ball_compliance(poisson=0.3, drive="plane", resolution=RESOLUTION):
    """Compliance of a half ball held at its equatorial plane.

    Parameters
    ----------
    poisson : float
        Poisson's ratio, in (-1, 0.5).
    drive : {"plane", "clamped"}
        The equatorial plane is held axially and is radially free (``plane``), or fixed in
        both directions (``clamped``).
    resolution : int
        Elements along the surface.

    Returns
    -------
    Compliance

    Raises
    ------
    ValueError
        For a Poisson's ratio, drive or resolution outside its range.
    """
    poisson = checks.poisson("poisson", poisson)
    checks.choice("ball_drive", drive, DRIVES)
    fixed = {"axis": "r", "equator": "rz" if drive == "clamped" else "z"}
    return _condense(ball_mesh(resolution), poisson, fixed, support="equator")


@lru_cache(maxsize=32)
def socket_compliance(ratio, poisson=0.3, rim="free", resolution=RESOLUTION):
    """Compliance of a hemispherical socket fixed on its outer sphere.

    Parameters
    ----------
    ratio : float
        Outer over inner radius, >= 1.02.
    poisson : float
        Poisson's ratio, in (-1, 0.5).
    rim : {"free", "mirror"}
        The edge at the equator is traction-free, or a mirror plane.
    resolution : int
        Elements along the surface.

    Returns
    -------
    Compliance

    Raises
    ------
    ValueError
        For a ratio, Poisson's ratio, rim or resolution outside its range.
    """
    poisson = checks.poisson("poisson", poisson)
    checks.choice("rim", rim, RIMS)
    fixed = {"axis": "r", "outside": "rz"} | ({"equator": "z"} if rim == "mirror" else {})
    return _condense(socket_mesh(ratio, resolution), poisson, fixed, support="outside")


def _graded(length, scale, count):
    """``count`` steps over ``length``, each proportional to (distance + scale)."""
    return scale * np.expm1(np.linspace(0, np.log1p(length / scale), count + 1))


def _ring_mesh(radii, angles, centre):
    """Triangulate concentric quarter rings, from the surface (radius 1) to the last radius."""
    points, triangles, first = [_ring(1.0, angles)], [], 0
    for radius, step in zip(radii[1:], np.abs(np.diff(radii)), strict=True):
        outer = first + np.arange(len(angles))
        first = outer[-1] + 1
        arc = radius * np.sqrt((angles[1] - angles[0]) * (angles[-1] - angles[-2]))
        elements = len(angles) - 1
        if step > _ASPECT * arc and elements % 2 == 0 and elements > 8:
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
    linear = MeshTri(np.ascontiguousarray(np.hstack(points)), np.ascontiguousarray(triangles))
    return _curved(linear, radii[-1] if not centre else None)


def _ring(radius, angles):
    points = radius * np.array([np.sin(angles), np.cos(angles)])
    points[1, angles == np.pi / 2] = 0.0
    return points


def _curved(linear, outer_radius):
    """Quadratic mesh that follows the rings, however thin, with named boundaries."""
    radius = np.hypot(*linear.p)

    def edges(on_boundary):
        return np.flatnonzero(on_boundary[linear.facets].all(axis=0))

    spheres = {"surface": 1.0} | ({"outside": outer_radius} if outer_radius else {})
    named = {name: edges(np.isclose(radius, r, rtol=1e-12)) for name, r in spheres.items()}
    named |= {"axis": edges(linear.p[0] == 0), "equator": edges(linear.p[1] == 0)}
    mesh = MeshTri2.from_mesh(linear)
    locations = mesh.doflocs.copy()
    middles = mesh.dofs.facet_dofs[0]  # at the mean radius of their edge's ends: arcs and spirals
    locations[:, middles] *= radius[linear.facets].mean(axis=0) / np.hypot(*locations[:, middles])
    return replace(mesh, doflocs=locations).with_boundaries(named)


def _condense(mesh, poisson, fixed, support):
    """Solve the body once for every hat function of pressure on its surface."""
    quadratic = ElementVector(ElementTriP2())
    basis = Basis(mesh, quadratic, intorder=4)
    facets = mesh.boundaries["surface"]
    traction = FacetBasis(mesh, quadratic, facets=facets, intorder=6)
    hats = FacetBasis(mesh, ElementTriP1(), facets=facets, intorder=6)
    count = len(facets) + 1

    stiffness = _elasticity(*lame_parameters(1.0, poisson)).assemble(basis)
    load = -_normal_pressure.assemble(hats, traction)[:, :count].toarray()

    held = np.zeros(basis.N, dtype=bool)
    for name, components in fixed.items():
        dofs = basis.get_dofs(mesh.boundaries[name])
        for component, number in (("r", "1"), ("z", "2")):
            if component in components:
                held[dofs.all([f"u^{number}"])] = True
    free = np.flatnonzero(~held)
    factor = splu(
        stiffness[free][:, free].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    displacement = np.zeros((basis.N, count))
    displacement[free] = factor.solve(load[free])

    flexibility = load.T @ displacement
    axial = basis.get_dofs(mesh.boundaries[support]).all(["u^2"])
    reaction = (stiffness[axial] @ displacement - load[axial]).sum(axis=0)
    compliance = Compliance(
        angles=np.arctan2(*mesh.p[:, :count]),
        flexibility=(flexibility + flexibility.T) / 2,
        reaction=np.abs(reaction),
        unknowns=free.size,
    )
    for array in (compliance.angles, compliance.flexibility, compliance.reaction):
        array.flags.writeable = False  # shared by every caller of the cached functions
    return compliance


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


@BilinearForm
def _normal_pressure(p, v, w):
    """Work of a normal pressure against an outward displacement of the surface."""
    return 2 * np.pi * w.x[0] * p * dot(w.n, v)
