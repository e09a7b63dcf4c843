"""Friction torque and wear: closed forms, the limit of Hertz, and a sum over the surface."""

from dataclasses import replace

import numpy as np
import pytest

from study.joint import DimensionalJoint, Joint, force_curve
from study.joint.curve import friction_radii

BRONZE = DimensionalJoint(15e-3, 22e-6, 7e-3, "steel", "bronze")
CURVE = force_curve(Joint(200), [0.01, 0.3])
BALL = CURVE.joint.ball_radius


def under(pressure, kinematics="linear"):
    """Friction radii under a pressure that is a function of the polar angle."""
    joint = Joint(200, kinematics=kinematics)
    profile = np.asarray(pressure(CURVE.angles)) * np.ones((2, 1))
    return friction_radii(replace(CURVE, joint=joint, pressure=profile))


def test_uniform_pressure_on_a_hemisphere_turns_alike_about_any_axis():
    for kinematics, radius in (("linear", BALL), ("small", 1.0)):
        for found in under(np.ones_like, kinematics).values():
            assert found == pytest.approx(np.pi / 2 * radius, rel=1e-10)


@pytest.mark.parametrize("node", [40, 150, 250])
def test_uniform_pressure_on_a_cap(node):
    edge = (CURVE.angles[node] + CURVE.angles[node + 1]) / 2  # a hat's slope is half in, half out
    found = under(lambda angle: np.where(angle < edge, 1.0, 0.0))["spin"]
    spin = (edge - np.sin(edge) * np.cos(edge)) / np.sin(edge) ** 2
    assert found == pytest.approx(BALL * spin, rel=1e-3)


def test_pressure_at_a_place_acts_on_its_distance_from_the_axis():
    """A ring of pressure far out, and its sum over places and azimuth."""
    ring = np.zeros_like(CURVE.angles)
    ring[200] = 1.0
    found, angle = under(lambda _: ring), CURVE.angles[200]
    azimuth = 2 * np.pi * np.arange(1000) / 1000
    place = np.array(
        [
            np.sin(angle) * np.cos(azimuth),
            np.sin(angle) * np.sin(azimuth),
            np.full(1000, np.cos(angle)),
        ]
    )
    for motion, axis in (("spin", [0, 0, 1]), ("tilt", [0.6, 0.8, 0])):
        lever = np.linalg.norm(np.cross(axis, place.T), axis=1).mean()
        assert found[motion] == pytest.approx(BALL * lever / np.cos(angle), rel=2e-3)


def test_limit_is_hertz():
    """Under p0 sqrt(1 - r^2/a^2): 3 pi/16 mu N a in spin, mu N R in tilt."""
    joint = DimensionalJoint(0.05, 5e-3, 5.0, "steel", "aluminium")
    found, friction = joint.solve(force=20.0), 0.2
    radius = 1 / (1 / 0.045 - 1 / 0.05)
    contact_radius = (0.75 * 20 * radius / joint.joint.composite_modulus) ** (1 / 3)
    torque = found.friction_torque(friction)
    assert torque["spin"] == pytest.approx(3 * np.pi / 16 * 4 * contact_radius, rel=0.01)
    assert torque["tilt"] == pytest.approx(4 * 0.045, rel=1e-4)


def test_known_joint():
    """10 kN at a half-angle of 33.8 deg: 5.4 N m at a friction of 0.1, within 5 %."""
    found = BRONZE.solve(force=10e3)
    assert found.contact_half_angle_deg[0] == pytest.approx(33.8, abs=0.5)
    assert found.friction_torque(0.1)["spin"][0] == pytest.approx(5.4, rel=0.05)


@pytest.mark.parametrize("kinematics", ["small", "linear"])
def test_pressure_bears_the_force(kinematics):
    found = replace(BRONZE, kinematics=kinematics).solve(force=[1e4, 5e2])
    angle = np.radians(found.angle_deg)
    axial = found.pressure * np.sin(2 * angle)
    force = np.pi * BRONZE.socket_radius**2 * np.trapezoid(axial, angle)
    assert force == pytest.approx([1e4, 5e2], rel=4e-3)
    assert found.pressure.max(axis=1) == pytest.approx(found.peak_pressure)
    assert not found.pressure[:, found.angle_deg > 40].any()


def test_torque_is_in_the_order_asked_and_that_of_the_curve():
    asked, curve = BRONZE.solve(depth=[8e-6, 2e-6]), BRONZE.curve()
    for motion, torque in asked.friction_torque(0.3).items():
        radii = curve.friction_radius[motion]
        radius = np.interp(np.sqrt(asked.depth), np.sqrt(curve.depth), radii)
        assert torque == pytest.approx(0.3 * asked.force * radius, rel=2e-3)
        assert torque[0] > torque[1]
        assert asked.friction_torque(0.0)[motion] == pytest.approx([0, 0])


def test_friction_radii_grow_with_the_contact():
    radii = friction_radii(force_curve(Joint(200), [1e-3, 0.1, 1.0]))
    assert (np.diff(radii["spin"]) > 0).all()
    assert (np.diff(radii["tilt"]) > 0).all()
    assert radii["tilt"][0] == pytest.approx(BALL, rel=1e-3)


def test_wear_is_that_of_archard():
    found = BRONZE.solve(force=[1e4, 3e3])
    depth = found.wear_depth(2e-15, 500.0)
    assert depth.max(axis=1) == pytest.approx(2e-15 * 500 * found.peak_pressure)
    assert depth.shape == found.pressure.shape
    worn = np.trapezoid(depth * np.sin(np.radians(found.angle_deg)), np.radians(found.angle_deg))
    volume = 2 * np.pi * BRONZE.socket_radius**2 * worn
    assert (volume > 2e-15 * 500 * found.force).all()  # k N s, of a flat contact
