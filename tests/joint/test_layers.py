"""Sockets of several layers: against one layer, closed forms, elements and limits."""

import numpy as np
import pytest
from helpers.bodies import of_socket

from study.joint import Joint, Layer, Material, series
from study.joint.compliance import Socket

EVEN = np.arange(0, 10_001, 2)
STEEL, PTFE = Material(2e11, 0.3), Material(5e8, 0.46)
HOUSED = Layer(1.125, PTFE), Layer(1.5, STEEL)  # 2 mm in 6 mm, around R2 = 16 mm
RIGID = 1e9
DEPTHS = np.array([0.1, 0.3, 1.0])


def forces(joint, resolution=None, solver=None, depths=DEPTHS):
    return joint.solve(depth_star=depths, resolution=resolution, solver=solver).force_star


@pytest.mark.parametrize("ratios", [(1.25, 1.5), (1.1, 1.5), (1.1, 1.3, 1.5), (1.499, 1.5)])
@pytest.mark.parametrize("poisson", [-0.3, 0.3, 0.49])
def test_layers_of_one_material_are_one_layer(ratios, poisson):
    one = of_socket(EVEN, 1.5, poisson)
    several = of_socket(EVEN, ratios, (poisson,) * len(ratios))
    assert np.abs(several / one - 1).max() < 1e-10


def lame(ratios, poissons, moduli):
    """Displacement of a shell of two layers under unit pressure inside, fixed outside."""
    (q, b), rows, right = ratios, [], [-1.0, 0.0, 0.0, 0.0]
    stress = [  # of A r + B/r^2, over A and over B r^-3
        (e / (1 - 2 * nu), -2 * e / (1 + nu)) for e, nu in zip(moduli, poissons, strict=True)
    ]
    (a1, b1), (a2, b2) = stress
    rows = [[a1, b1, 0, 0], [q, q**-2, -q, -(q**-2)]]
    rows += [[a1, b1 * q**-3, -a2, -b2 * q**-3], [0, 0, b, b**-2]]
    return np.linalg.solve(rows, right)[:2].sum()


@pytest.mark.parametrize("ratios", [(1.00005, 1.0001), (1.1, 1.6), (2.0, 3.0)])
@pytest.mark.parametrize("layers", [((0.2, 0.45), (1.0, 30.0)), ((0.3, 0.3), (1.0, 1.0))])
def test_two_layers_under_uniform_pressure_widen_as_lame(ratios, layers):
    assert of_socket(EVEN[:1], ratios, *layers) == pytest.approx(lame(ratios, *layers))


def test_amplitudes_meet_every_condition():
    body = Socket((1.05, 1.3, 2.0), (0.2, 0.45, 0.3), (1.0, 7.0, 0.2))
    orders = np.array([0, 2, 10, 200])
    sides = []
    for solid in series.socket(orders, body):
        for radius in (solid.inner, solid.outer):
            units = [solid.inner, solid.inner, solid.twice_shear, solid.twice_shear]
            sides.append(solid.state(radius) * np.array(units)[:, None])
    several = np.array([[True], [False], [True], [False]]) | (orders > 0)  # P_0 has no slope
    assert sides[0][2] == pytest.approx(-np.ones(4))
    assert np.abs(sides[0][3][1:]).max() < 1e-12
    for inner, outer in ((sides[1], sides[2]), (sides[3], sides[4])):
        assert inner[several] == pytest.approx(outer[several], rel=1e-9, abs=1e-12)
    assert np.abs(sides[5][:2][several[:2]]).max() < 1e-12


def test_no_order_overflows_however_thin_thick_stiff_or_soft():
    orders = np.arange(0, 100_001, 2)
    assert (series.ball(orders, 0.3).state(1.0)[0] < 0).all()
    for ratios in ((1.0001, 1.0003, 1.5), (1.1, 1e3, 1e6), (1e5, 1.1e5, 1e6)):
        for moduli in ((1.0, 1e9, 1e-9), (1.0, 1e-9, 1e9)):
            found = of_socket(orders, ratios, (0.3, 0.499, -0.5), moduli)
            assert np.isfinite(found).all()
            assert (found > 0).all()


def liner(thickness, poisson, r2_star=1e6):
    """A liner between a rigid ball and a rigid backing."""
    socket = Material(2e11 / RIGID, poisson)
    return Joint.from_ratios(r2_star, 1 + thickness, socket=socket)


def thin_liner_force(depth, r2_star, thickness, poisson):
    """Force of Winkler's springs between a rigid ball and a rigid backing, by quadrature."""
    cosine, weight = np.polynomial.legendre.leggauss(40)
    edge = 1 / (1 + depth[:, None])  # springs are compressed where cos(theta) is above it
    x = edge + (1 - edge) * (1 + cosine) / 2
    pressure = x * (1 + depth[:, None]) - 1
    stiffness = (1 - poisson) * (1 - poisson**2) / ((1 + poisson) * (1 - 2 * poisson) * thickness)
    return np.pi * r2_star * stiffness * ((1 - edge) * pressure * x) @ weight


@pytest.mark.parametrize(("poisson", "expected"), [(0.3, 1.0013), (0.45, 0.992)])
def test_a_thin_liner_is_as_an_independent_series_has_it(poisson, expected):
    depth = np.array([0.2, 0.5, 1.0])
    limit = thin_liner_force(depth, 1e6, 0.01, poisson)
    ratio = forces(liner(0.01, poisson), 640, depths=depth) / limit
    assert ratio == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_a_thin_compressible_liner_goes_to_winklers_springs(poisson):
    depth, errors = np.array([0.1, 0.5, 1.0]), []
    for thickness in (3e-3, 1e-3, 3e-4):
        force = forces(liner(thickness, poisson), 640, depths=depth)
        limit = thin_liner_force(depth, 1e6, thickness, poisson)
        errors.append(np.abs(force / limit - 1).max())
    assert errors[0] > 2 * errors[1] > 4 * errors[2]
    assert errors[2] < 6e-4


def test_a_stiff_housing_is_a_rigid_backing():
    rigid, differences = forces(Joint.from_ratios(200, 1.1, socket=PTFE)), []
    for modulus in (2e11, 2e13, 2e15):
        layers = Layer(1.1, PTFE), Layer(1.4, Material(modulus))
        differences.append(1 - forces(Joint.from_ratios(200, layers=layers)) / rigid)
    assert (differences[0] > 0).all()
    for k in (1, 2):
        assert 100**k * differences[k] == pytest.approx(differences[0], rel=0.1)
