"""Finite elements: mode 0 against exact spheres, higher modes, meshes of every support."""

import numpy as np
import pytest
from helpers.bodies import reaction
from skfem import Basis, ElementTriP2, Functional

from study.joint import meridian, modes, series, surface
from study.joint.compliance import Ball, HatFunctions, Socket, surface_angles
from study.joint.supports import Bore, ClampedPlate, Core, Neck, Opening, Sector

FREE = Socket(1.19, rim="free")
WIDE, RING = Opening(120.0), Opening(125.0, 55.0)
BODIES = {
    "guided": Ball(),
    "clamped": Ball(support=ClampedPlate()),
    "core": Ball(support=Core(0.2), opening=WIDE),
    "neck": Ball(support=Neck(30), opening=WIDE),
    "bore": Ball(support=Bore(0.5, 45), opening=RING),
    "socket": FREE,
    "layers": Socket((1.05, 1.3), (0.45, 0.3), (1.0, 50.0), rim="free"),
    "sector": Socket(1.3, rim="free", support=Sector(20, 50)),
    "ring": Socket(1.3, rim="free", opening=RING),
}
OF_BODIES = pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)


def meshed(body, count=32):
    """A body on a surface of equal elements, as off the axis."""
    first, last = body.opening.first, body.opening.last
    if isinstance(body, Ball) and body.support.outline.bore:
        first, last = body.support.outline.surface
    return modes.made(body, np.radians(np.linspace(first, last, count + 1)), 0.1 * count)


def work(compliance):
    """Work of one smooth pressure, interpolated by the hats, against its displacement."""
    pressure = np.exp(-(compliance.angles**2) / 0.05)
    return pressure @ compliance.flexibility @ pressure


@pytest.mark.parametrize(
    "body",
    [
        Ball(),
        Ball(0.0),
        Socket(1.2),
        Socket(1.05, 0.45),
        Socket(5.0, 0.0),
        Socket((1.02, 1.3), (0.46, 0.3), (1.0, 400.0)),  # a liner of PTFE
        Socket((1.3, 1.5), (0.3, 0.46), (1.0, 0.0025)),
    ],
)
@pytest.mark.parametrize(("nodes", "order"), [(6, 2.8), (3, 1.7)])
def test_mode_0_converges_to_the_series(body, nodes, order):
    # work has twice the energy norm's order: 4 for quadratic displacements, less the kinks of
    # the load, and 2 for linear ones
    errors = []
    for n in (64, 128):
        exact, found = series.compliance(body, n), modes.compliance(body, n, nodes)
        errors.append(abs(work(found) / work(exact) - 1))
    assert np.log2(errors[0] / errors[1]) > order
    assert errors[-1] < (2e-5 if nodes == 6 else 5e-3)


@OF_BODIES
def test_the_work_of_a_pressure_converges_whatever_holds_the_body(body):
    # of order 2, as the hats interpolate the pressure; less where a support ends
    found = []
    for count in (16, 32, 64):
        of = meshed(body, count)
        pressure = np.cos(of.angles - of.angles[[0, -1]].mean()) ** 4
        found.append(pressure @ (of.loads.T @ of.displacements(2)) @ pressure)
    apart = np.abs(np.diff(found)) / found[-1]
    at_seat = isinstance(body, Socket) and "seat" in body.held
    assert apart[1] < apart[0] / (1 if at_seat else 2)
    assert apart[1] < (0.02 if at_seat else 2e-3)


@OF_BODIES
def test_compliance_is_symmetric_positive_and_in_balance(body):
    of = meshed(body)
    held_across = 1 if "r" in "".join(body.held.values()) else 2
    for flexibility in (of.compliance.flexibility, of.loads.T @ of.displacements(held_across)):
        assert flexibility == pytest.approx(flexibility.T, abs=1e-12 * flexibility.max())
        assert np.linalg.eigvalsh(flexibility).min() > 0
    # the supports bear the axial force of a pressure: that of 1 here, and that of its hats
    force = np.pi * np.diff(np.sin(of.angles[[0, -1]]) ** 2)[0]
    assert abs(reaction(of).sum()) == pytest.approx(force, abs=1e-5)


@pytest.mark.parametrize("body", [Ball(), Ball(support=Core(0.2)), FREE])
def test_one_mode_is_the_same_by_both_ways(body):
    of = modes.meshed(body, 32)
    expected = of.compliance.flexibility
    by_modes = 2 * np.pi * (of.loads.T @ of.displacements(0))
    if body.held != {"equator": "z"}:  # which is free to turn about the axis
        assert by_modes == pytest.approx(expected, abs=1e-12 * expected.max())
    axial = HatFunctions(of.angles).integrate(np.cos)
    smooth = np.exp(-(of.angles**2))
    assert abs(reaction(of) @ smooth) == pytest.approx(axial @ smooth, rel=1e-8)


def test_turned_pressures_do_the_same_work_in_every_mode():
    # a ball on a core is the same in every direction, so that harmonics of one order are equal
    theta = np.linspace(0, np.pi, 65)
    of = modes.made(Ball(support=Core(0.2)), theta, rings=6.4)
    of_modes = [of.loads.T @ of.displacements(m) for m in range(3)]
    sine, cosine = np.sin(theta), np.cos(theta)
    # work over the integral of the squared harmonic; that over phi is 2 pi for mode 0, else pi
    orders = [
        [(0, cosine, 2 / 3), (1, sine, 4 / 3)],
        [(0, (3 * cosine**2 - 1) / 2, 2 / 5), (1, sine * cosine, 4 / 15), (2, sine**2, 16 / 15)],
    ]
    for order in orders:
        works = [pressure @ of_modes[m] @ pressure / square for m, pressure, square in order]
        assert works == pytest.approx([works[0]] * len(works), rel=2e-3)  # the hats' own error


def test_rigid_motions_have_no_energy():
    of = modes.meshed(Ball(support=Core(0.2)), 16)
    unknowns = of._basis.split_indices()  # of u_r, u_r + u_phi, u_z
    r, z = of._basis.doflocs[:, unknowns[0]]
    none, one = 0 * r, 1 + 0 * r
    linear, square = of._growing
    for mode, parts, rigid in (
        (0, (none, none, one), True),  # along the axis
        (0, (none, r, none), True),  # about the axis
        (1, (one, none, none), True),  # across the axis
        (1, (z, none, -r), True),  # about a line across the axis
        (1, (z, none, r), False),
        (0, (one, none, none), False),
    ):
        displacement = np.zeros(of._basis.N)
        for places, part in zip(unknowns, parts, strict=True):
            displacement[places] = part
        of_mode = of._constant + mode * linear + mode**2 * square
        assert (abs(displacement @ of_mode @ displacement) < 1e-12) == rigid


@pytest.mark.parametrize(
    ("free", "held"),
    [(Ball(), Ball(support=ClampedPlate())), (Socket(1.5, rim="free"), Socket(1.5))],
)
def test_clamping_and_a_mirror_plane_stiffen(free, held):
    difference = modes.compliance(free, 32).flexibility - modes.compliance(held, 32).flexibility
    assert np.linalg.eigvalsh(difference).min() > -1e-12


def area_of(mesh, elements=None):
    basis = Basis(mesh, ElementTriP2(), elements=elements)
    return Functional(lambda w: 1.0 + 0 * w.x[0]).assemble(basis)


@OF_BODIES
def test_mesh_covers_the_meridian_with_curved_boundaries(body):
    mesh = meshed(body, 64).mesh
    if isinstance(body, Socket):
        half, ratios = np.radians(body.opening.last - body.opening.first) / 2, body.layers[0]
        layer = meridian.layer_of(mesh, ratios)
        areas = [area_of(mesh, np.flatnonzero(layer == k)) for k in range(len(ratios))]
        each = half * np.diff(ratios**2, prepend=1.0)
        assert areas == pytest.approx(each, rel=1e-6)
        expected = each.sum()
    elif isinstance(body.support, Bore):
        half = np.cos(np.radians(body.support.face))  # of the width: lens beside a rectangle
        expected = half * np.sqrt(0.5) + np.pi / 4 - 2 * half * body.support.radius
    else:
        core = body.support.radius if isinstance(body.support, Core) else 0.0
        expected = np.pi / (4 if body.support.is_half else 2) * (1 - core**2)
    assert area_of(mesh) == pytest.approx(expected, rel=1e-6)
    surface = mesh.dofs.get_facet_dofs(mesh.boundaries["surface"]).flatten()
    assert np.hypot(*mesh.doflocs[:, surface]) == pytest.approx(1, rel=1e-12)
    assert set(body.held) <= mesh.boundaries.keys()


def test_a_seat_ends_at_vertices_and_a_neck_at_its_angle():
    for body, part, radius, ends in (
        ("sector", "seat", 1.3, (20, 50)),
        ("neck", "neck", 1, (150, 180)),
    ):
        mesh = meshed(BODIES[body]).mesh
        held = mesh.p[:, np.unique(mesh.facets[:, mesh.boundaries[part]])]
        assert np.hypot(*held) == pytest.approx(radius)
        angles = np.degrees(np.arctan2(*held))
        assert (angles.min(), angles.max()) == pytest.approx(ends)


@pytest.mark.parametrize("around", [64, 80, 96, 144])
def test_functions_of_the_nodes_sum_to_one_and_mirror_each_other(around):
    grid = surface.Grid(np.linspace(0, 1.5, 33), around)
    theta, phi, area = grid.points
    values = grid.values(theta, phi)
    assert values.sum(axis=1) == pytest.approx(1)
    assert values.data.min() >= 0
    assert area.sum() == pytest.approx(np.pi * (1 - np.cos(1.5)))
    for ring in range(1, 33):
        places = grid.phi[grid.ring == ring]
        assert places == pytest.approx(np.pi - places[::-1])


def test_hat_functions_integrate_and_interpolate():
    hats, ones = HatFunctions(surface_angles(32)), np.ones(33)
    assert hats.integrate(np.cos).sum() == pytest.approx(np.pi, rel=1e-13)
    assert hats.mass() @ ones == pytest.approx(hats.integrate(np.ones_like), rel=1e-13)
    theta = np.array([0.0, 0.3, 1.5])
    assert hats.values(theta) @ hats.angles == pytest.approx(theta, rel=1e-13)
