"""The pressures behind the laws add up to their forces, and the half-angles agree."""

import numpy as np
import pytest

from study.contact import hertz, hyperbolic_winkler, pressure
from study.joint import Joint, force_curve


def force(radius, values, r2_star):
    """Dimensionless force of a pressure over the distance from the axis."""
    return r2_star * np.trapezoid(2 * np.pi * radius * values, radius)


@pytest.mark.parametrize("depth_star", [0.02, 0.5])
@pytest.mark.parametrize("r2_star", [4.0, 200.0])
def test_hertz_pressure_adds_up_to_hertz(depth_star, r2_star):
    radius = pressure.contact_radius(depth_star, r2_star) * np.sin(np.linspace(0, np.pi / 2, 2001))
    values = pressure.hertz_pressure(radius, depth_star, r2_star)
    assert force(radius, values, r2_star) == pytest.approx(hertz(depth_star, r2_star), rel=1e-6)


def test_exact_pressure_tends_to_hertz():
    joint = Joint(2000.0, socket_ratio=3.0)
    curve = force_curve(joint, [0.001], resolution=640)
    peak = pressure.hertz_pressure(0.0, 0.001, joint.r2_star)
    radius = pressure.contact_radius(0.001, joint.r2_star)
    assert curve.peak_pressure_star[0] == pytest.approx(peak, rel=0.05)
    assert np.sin(np.radians(curve.contact_half_angle_deg[0])) == pytest.approx(radius, rel=0.03)


def test_hyperbolic_pressure_adds_up_to_its_law():
    depth, r2_star = 0.5, 200.0
    alpha = np.radians(pressure.contact_half_angle_deg("hyperbolic_winkler", depth, r2_star))
    theta = np.linspace(0, alpha, 2001)
    peak = depth / pressure.foundation_height("hyperbolic_winkler", r2_star)
    values = peak * (1 - (theta / alpha) ** 2)
    vertical = force(theta, values * np.cos(theta), r2_star)  # of rings as a disc has them
    assert vertical == pytest.approx(hyperbolic_winkler(depth, r2_star), rel=1e-5)


def test_half_angles_agree_where_they_must():
    angle = pressure.contact_half_angle_deg("hyperbolic_winkler", 0.5, 20.0)
    assert angle == pytest.approx(np.degrees(1.0))
    assert pressure.contact_half_angle_deg("steuermann", 1.0, 20.0) == pytest.approx(60)
    tiny = [pressure.contact_half_angle_deg(law, 1e-8, 1e6) for law in ("steuermann", "hertz")]
    assert tiny[0] / tiny[1] == pytest.approx(np.sqrt(2), rel=1e-4)
