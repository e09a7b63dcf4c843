"""Tables of Python functions as laws, in and out of the mechanism."""

from math import pi, sqrt

import numpy as np
import pytest
from helpers.laws import packed
from scipy.integrate import quad
from scipy.optimize import brentq

from study import contact
from study.contact import forces, shapes, tables
from study.mechanism import Scene, paper_scene, rigid, simulate

R1, R2, MODULUS = 9.95e-3, 10e-3, 1.1e11
SIZES = {"ball_radius": R1, "socket_radius": R2, "composite_modulus": MODULUS}
DEPTHS, ROOTS = np.geomspace(1e-9, 1, 1999), np.linspace(0.005, 1, 400)


def measured(depth_star):
    """Force between a few measured points, on straight lines."""
    places = np.linspace(0, 1, 20) ** 2
    return np.interp(depth_star, places, 300 * places**1.5)


def kinked(depth_star):
    """A spring that becomes twice as stiff."""
    return 100 * depth_star + 100 * np.maximum(depth_star - 0.25, 0)


def tabulated(function):
    """Table of a function for R2* = 200."""
    return contact.Table.of_values(ROOTS**2, function(ROOTS**2), 200)


@pytest.mark.parametrize("power", [1, 1.5, 2])
def test_powers_of_the_root_of_the_depth_are_exact(power):
    law = tabulated(lambda ds: 200 * ds**power)
    assert law(DEPTHS) == pytest.approx(200 * DEPTHS**power, rel=1e-9, abs=1e-10)
    slope = 200 * power * DEPTHS ** (power - 1)
    assert law(DEPTHS, derivative=True) == pytest.approx(slope, rel=1e-8, abs=1e-10)


@pytest.mark.parametrize(
    ("function", "error"),
    [(measured, 0.04), (kinked, 3e-3), (lambda ds: 200 * ds**1.6, 1e-6)],
)
def test_a_table_of_values_is_near_its_function(function, error):
    law, depths = tabulated(function), DEPTHS[DEPTHS > 1e-3]
    assert law(depths) == pytest.approx(function(depths), rel=error)
    assert (np.diff(law(DEPTHS)) > 0).all()
    assert law(0.0) == law(-0.1) == 0


def test_below_its_first_point_a_soft_contact_is_hertz_in_series_with_a_spring():
    spring, root = 50.0, np.array([0.2, 0.4, 0.6, 0.8, 1.0])

    def force(s):  # P by which ds = (P/h)^(2/3) + P/spring, with Hertz's factor h = 1
        return brentq(lambda p: p ** (2 / 3) + p / spring - s * s, 0.0, s**3, xtol=1e-14)

    constants = tables.of_points(root, np.array([force(s) / s**3 for s in root]))
    for s in (0.05, 0.1, 0.15):
        assert float(shapes.table(np.array(s * s), constants)[0]) == pytest.approx(force(s), 2e-3)


def test_compiled_force_and_energy_are_those_of_the_table():
    law, clearance = packed(tabulated(measured), R1, R2, MODULUS), R2 - R1
    depths = clearance * DEPTHS
    found = np.array([forces.elastic_force(law, d) for d in depths])
    of_joint = contact.DimensionalLaw(tabulated(measured), **SIZES)
    assert found[:, 0] == pytest.approx(of_joint.force(depths), rel=1e-13)
    assert found[:, 1] == pytest.approx(of_joint.stiffness(depths), rel=1e-10)
    knots = clearance * (np.arange(1, 150) / 256) ** 2
    exact = sum(
        quad(lambda d: forces.elastic_force(law, d)[0], low, high, epsrel=1e-12)[0]
        for low, high in zip(np.append(0, knots[:-1]), knots, strict=True)
    )
    assert forces.stored_energy(law, knots[-1]) == pytest.approx(exact, rel=1e-8)


def test_impact_on_a_linear_spring_is_half_an_oscillation():
    scene = Scene(restitution=1.0, friction=0.0)
    spring = tabulated(lambda ds: 1e6 * ds)
    response = simulate(scene, law=spring, duration=0.0018, outputs=2000)
    first = response.impacts.iloc[0]
    p, at = scene.constants(), np.searchsorted(response.time, first.time)
    ex, ey = response.eccentricity_x[at], response.eccentricity_y[at]
    r = np.hypot(ex, ey)
    mass = 1 / rigid.inverse_effective_mass(response.crank_angle[at], ey, ex / r, ey / r, 0.0, p)
    frequency = sqrt(1e6 * scene.composite_modulus * scene.clearance / mass)
    assert first.duration == pytest.approx(pi / frequency, rel=1e-3)
    assert first.peak_depth == pytest.approx(first.approach_speed / frequency, rel=1e-3)
    assert first.separation_speed == pytest.approx(first.approach_speed, rel=1e-3)


@pytest.mark.parametrize(("function", "restitution"), [(kinked, 0.5), (measured, 1.0)])
def test_energy_balance_closes_with_kinks_in_the_law(function, restitution):
    scene = paper_scene(restitution=restitution)
    response = simulate(scene, law=tabulated(function), duration=0.03, outputs=3000)
    assert response.energy_error < 1e-8


def test_slopes_of_a_monotone_spline_are_at_most_three_chords():
    """The bound of Hyman, which is sharp for steps."""
    x, y = np.arange(7.0), np.array([0.0, 0.01, 1.0, 1.01, 2.0, 1.99, 1.0])
    slopes = tables.monotone_spline(x, y)(x, 1)
    assert slopes[1:4] == pytest.approx(0.03, rel=1e-12)
    assert slopes[4] == 0
    assert slopes[5] == pytest.approx(-0.03, rel=1e-12)
