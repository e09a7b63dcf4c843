"""Compliances against exact solutions of elastic spheres, and the mesh itself."""

import numpy as np
import pytest
from helpers.bodies import reaction

from study.joint import fem
from study.joint.compliance import Ball, HatFunctions, Socket
from study.joint.supports import CentrePoint, ClampedPlate


def mean_displacement(compliance):
    """Mean inward normal displacement of the hemisphere under unit uniform pressure."""
    ones = np.ones(len(compliance.angles))
    return ones @ compliance.flexibility @ ones / (2 * np.pi)


@pytest.mark.parametrize("poisson", [-0.5, 0.0, 0.3, 0.49])
def test_ball_under_uniform_pressure_shrinks_as_lame(poisson):
    # a sphere under pressure p: u = -p (1 - 2 nu)/E; its equator stays plane and free
    ball = fem.compliance(Ball(poisson), 64)
    assert mean_displacement(ball) == pytest.approx(1 - 2 * poisson, rel=1e-7)


@pytest.mark.parametrize("ratio", [1.05, 1.19, 2.0, 5.0])
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_socket_under_uniform_pressure_widens_as_lame(ratio, poisson):
    # u = A r + B/r^2 with u(ratio) = 0 and radial stress -1 at r = 1
    lame = poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = 1 / (2 * (1 + poisson))
    system = [[ratio, ratio**-2], [3 * lame + 2 * shear, -4 * shear]]
    expected = np.linalg.solve(system, [0.0, -1.0]).sum()
    coarse, fine = (
        abs(mean_displacement(fem.compliance(Socket(ratio, poisson), n)) / expected - 1)
        for n in (32, 128)
    )
    assert fine < 5e-6
    assert fine < coarse / 4**3  # at least of order 3, as a displacement by quadratic elements


@pytest.mark.parametrize(
    "body",
    [
        Ball(),
        Ball(support=ClampedPlate()),
        Socket(1.19, rim="free"),
    ],
    ids=["guided", "clamped", "socket"],
)
def test_compliance_is_symmetric_positive_and_in_balance(body):
    meshed = fem.meshed(body, 64)
    compliance = meshed.compliance
    flexibility = compliance.flexibility
    assert (flexibility == flexibility.T).all()
    assert np.linalg.eigvalsh(flexibility).min() > 0
    axial = HatFunctions(compliance.angles).integrate(np.cos)
    smooth = np.exp(-(compliance.angles**2))
    assert reaction(meshed) @ smooth == pytest.approx(axial @ smooth, rel=1e-8)


def test_a_point_drive_depends_on_the_mesh():
    # the displacement under a point load grows without bound as the mesh is refined
    works = []
    for n in (32, 64, 128):
        compliance = fem.compliance(Ball(support=CentrePoint()), n)
        ones = np.ones(n + 1)
        works.append(ones @ compliance.flexibility @ ones)
    assert works[2] - works[1] > 1.5 * (works[1] - works[0]) > 0


def test_clamping_and_a_mirror_plane_stiffen():
    free = fem.compliance(Ball(), 32).flexibility
    clamped = fem.compliance(Ball(support=ClampedPlate()), 32).flexibility
    assert np.linalg.eigvalsh(free - clamped).min() > -1e-12
    free = fem.compliance(Socket(1.5, rim="free"), 32).flexibility
    mirror = fem.compliance(Socket(1.5), 32).flexibility
    assert np.linalg.eigvalsh(free - mirror).min() > -1e-12


@pytest.mark.parametrize("mesh", [fem.ball_mesh(Ball(), 64), fem.socket_mesh(Socket(1.19), 64)])
def test_mesh_covers_the_meridian_with_curved_boundaries(mesh):
    from skfem import Basis, ElementTriP2, Functional

    area = Functional(lambda w: 1.0 + 0 * w.x[0]).assemble(Basis(mesh, ElementTriP2()))
    outer = np.hypot(*mesh.p).max()
    expected = np.pi / 4 * (1 if outer < 1.01 else 1.19**2 - 1)
    assert area == pytest.approx(expected, rel=1e-6)
    surface = mesh.dofs.get_facet_dofs(mesh.boundaries["surface"]).flatten()
    assert np.hypot(*mesh.doflocs[:, surface]) == pytest.approx(1, rel=1e-12)


def test_hat_functions_integrate_and_interpolate():
    hats = HatFunctions(fem.surface_angles(32))
    ones = np.ones(33)
    assert hats.integrate(np.cos).sum() == pytest.approx(np.pi, rel=1e-13)
    assert hats.mass() @ ones == pytest.approx(hats.integrate(np.ones_like), rel=1e-13)
    theta = np.array([0.0, 0.3, 1.5])
    assert hats.values(theta) @ hats.angles == pytest.approx(theta, rel=1e-13)
