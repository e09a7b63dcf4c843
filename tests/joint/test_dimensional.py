"""Joints with their dimensions: known values, consistency, the limit of Hertz, wrong input."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study import contact
from study.contact import LAWS
from study.joint import (
    DimensionalJoint,
    Joint,
    Layer,
    Material,
    first_yield,
    force_curve,
    stress,
    tilted_contact,
)
from study.joint.dimensional import Liner

BRONZE = DimensionalJoint(12.5e-3, 40e-6, 6e-3, "steel", "bronze")
CUP = DimensionalJoint(16e-3, 0.1e-3, 8e-3, Material(230e9, 0.3), Material(0.8e9, 0.46))
LINED = DimensionalJoint(20e-3, 0.1e-3, 8e-3, "steel", "steel", ("0.5e-3,PTFE", "1e-3,bronze"))
JOINTS = pytest.mark.parametrize("joint", [BRONZE, CUP, LINED], ids=["bronze", "cup", "lined"])
TOGETHER = 2e-6
"""Depths that are solved together decide at which of them the contact's matrix is made. A force
differs by less than this between two such choices, a hundredth of its estimated error."""


@pytest.mark.parametrize(
    ("joint", "force", "depth", "stiffness", "pressure"),
    [
        (BRONZE, 3e3, 4.19e-6, 1.199e9, None),
        (BRONZE, 8e3, 7.54e-6, 1.763e9, 117e6),
        (CUP, 3e3, 48.1e-6, 1.04e8, None),
        (CUP, 8e3, 89.1e-6, 1.35e8, 23.3e6),
    ],
)
def test_known_joints(joint, force, depth, stiffness, pressure):
    """Values worked out by hand from the dimensionless solution, to the digits given."""
    found = joint.solve(force=force)
    assert found.depth[0] == pytest.approx(depth, rel=0.01)
    assert found.stiffness[0] == pytest.approx(stiffness, rel=0.01)
    assert pressure is None or found.peak_pressure[0] == pytest.approx(pressure, rel=0.01)
    assert found.error_estimate[0] < 1e-3


def test_the_joint_without_its_dimensions():
    steel, bronze = Material(2.1e11, 0.3), Material(1.1e11, 0.34)
    assert BRONZE.joint == Joint(312.5, 1.48, steel, bronze)
    layers = Layer(1.025, Material(5e8, 0.46)), Layer(1.075, bronze), Layer(1.4, steel)
    held = LINED.joint
    assert [layer.material for layer in held.layers] == [layer.material for layer in layers]
    ratios = [layer.outer_ratio for layer in layers]
    assert [layer.outer_ratio for layer in held.layers] == pytest.approx(ratios, rel=1e-14)
    assert held.r2_star == pytest.approx(200)
    supported = DimensionalJoint(
        0.01, 1e-4, 3e-3, ball_support="clamped", rim="free", kinematics="small"
    )
    how = {"ball_support": "clamped", "rim": "free", "kinematics": "small"}
    assert supported.joint == Joint(100, 1.3, Material(2.03e11, 0.3), steel, **how)


@JOINTS
def test_results_are_in_the_order_asked_and_those_of_the_solver(joint):
    depth = joint.clearance * np.array([0.3, 0.05, 0.8])
    found, curve = joint.solve(depth=depth), force_curve(joint.joint, [0.3, 0.05, 0.8])
    assert (found.depth == depth).all()
    newton = joint.joint.composite_modulus * joint.clearance**2
    assert found.force == pytest.approx(newton * curve.force_star, rel=5e-4)
    pascal = joint.joint.composite_modulus * joint.clearance / joint.socket_radius
    assert found.peak_pressure == pytest.approx(pascal * curve.peak_pressure_star, rel=1e-6)
    assert found.contact_half_angle_deg == pytest.approx(curve.contact_half_angle_deg, rel=1e-4)
    assert found.von_mises.keys() == joint.materials.keys()
    for body, largest in zip(joint.materials, stress.largest(curve).values(), strict=True):
        assert found.von_mises[body] == pytest.approx(pascal * largest.von_mises, rel=1e-5)
        assert found.von_mises_place[body] == largest.place


@JOINTS
@settings(max_examples=10)
@given(roots=st.lists(st.floats(0.06, 0.99), min_size=1, max_size=3, unique=True))
def test_depth_and_force_are_each_others_inverse(joint, roots):
    found = joint.solve(depth=joint.clearance * np.square(roots))
    back = joint.solve(force=found.force)
    for one, other in (
        (back.depth, found.depth),
        (back.stiffness, found.stiffness),
        (joint.law().force(found.depth), found.force),
    ):
        assert (np.abs(one / other - 1) < found.error_estimate).all()


@JOINTS
def test_stiffness_is_the_slope_of_the_force(joint):
    depth, step = 0.4 * joint.clearance, 1e-6 * joint.clearance
    force = joint.solve(depth=[depth - step, depth + step]).force
    stiffness = joint.solve(depth=depth).stiffness[0]
    assert np.diff(force)[0] / (2 * step) == pytest.approx(stiffness, rel=5 * TOGETHER)


def test_limit_is_hertz():
    """A small load on big bodies: Johnson, Contact Mechanics, 1985, Eqs. 4.22 to 4.24."""
    joint, force = DimensionalJoint(0.05, 5e-3, 5.0, "steel", "aluminium"), 20.0
    found, modulus = joint.solve(force=force), joint.joint.composite_modulus
    radius = 1 / (1 / 0.045 - 1 / 0.05)
    depth = (9 * force**2 / (16 * radius * modulus**2)) ** (1 / 3)
    assert found.depth[0] == pytest.approx(depth, rel=0.01)
    assert found.stiffness[0] == pytest.approx(1.5 * force / depth, rel=0.015)
    peak = (6 * force * modulus**2 / (np.pi**3 * radius**2)) ** (1 / 3)
    assert found.peak_pressure[0] == pytest.approx(peak, rel=0.01)
    assert found.von_mises["ball"][0] == pytest.approx(0.62 * peak, rel=0.01)
    assert joint.law("hertz").depth(force) == pytest.approx(depth, rel=1e-9)


@pytest.mark.parametrize("ratio", [1.03, 1.3, 4.0])
@pytest.mark.parametrize("lined", [False, True])
def test_error_estimate_covers_the_error(ratio, lined):
    wall = 0.02 * (ratio - 1)
    liner = (Liner(0.3 * wall, "POM"),) if lined else ()
    joint = DimensionalJoint(0.02, 1e-4, wall, "CoCr", "brass", liner)
    depth_star = np.array([5e-4, 0.003, 0.02, 0.2, 0.9])
    found = joint.solve(depth=1e-4 * depth_star)
    finest = force_curve(joint.joint, depth_star, 960).force_star
    exact = joint.joint.composite_modulus * 1e-8 * finest
    assert (np.abs(found.force / exact - 1) <= found.error_estimate + 2e-4).all()
    assert (found.error_estimate[2:] < 1e-3).all()


def test_factor_to_yield():
    ball, socket = Material(2.1e11, 0.3, 1e9), Material(1.1e11, 0.34, 2e8)
    joint = DimensionalJoint(12.5e-3, 40e-6, 6e-3, ball, socket)
    first = first_yield(joint.joint)
    found = joint.solve(depth=40e-6 * first.depth_star)
    assert first.body == "socket"
    assert found.yield_factor["socket"][0] == pytest.approx(1, rel=0.005)
    assert found.yield_factor["ball"][0] == pytest.approx(1e9 / found.von_mises["ball"][0])
    assert CUP.solve(force=1e3).yield_factor == {"ball": None, "socket": None}


def test_laws_of_a_joint():
    depth = 4e-6
    exact = BRONZE.law().force(depth)
    assert BRONZE.law("stiffened_hertz").force(depth) == pytest.approx(exact, rel=2e-3)
    assert BRONZE.law("hertz").force(depth) < 0.9 * exact
    for name in LAWS:
        law = BRONZE.law(name)
        assert law.depth(law.force(depth)) == pytest.approx(depth, rel=1e-9)
    with pytest.raises(ValueError, match="stiffened_hertz is not valid for a socket with layers"):
        LINED.law("stiffened_hertz")


def test_depths_beyond_one_clearance_and_up_to_the_rim():
    deep = CUP.solve(depth=3e-4)
    assert 60 < deep.contact_half_angle_deg[0] < 90
    assert CUP.solve(force=deep.force).depth == pytest.approx([3e-4], rel=TOGETHER)
    for asked in ({"force": 1e6}, {"depth": 1.4e-3}):
        with pytest.raises(ValueError, match="(force|depth) must .* rim of the socket"):
            CUP.solve(**asked)


def test_a_contact_too_small_to_resolve():
    assert BRONZE.solve(depth=40e-6 * 3e-5).error_estimate[0] < 0.05  # on finer elements
    with pytest.raises(ValueError, match="depth must be large enough"):
        BRONZE.solve(depth=1e-15)


def test_other_supports():
    clamped = replace(BRONZE, ball_support="clamped", rim="free")
    found, free = clamped.solve(force=3e3), BRONZE.solve(force=3e3)
    assert 0.8 * free.depth[0] < found.depth[0] < 0.999 * free.depth[0]


GOOD = {"socket_radius": 0.01, "clearance": 1e-4, "wall": 3e-3}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"clearance": 0.01}, "clearance must be >= 1e-11 and < 0.01 m, got 0.01 m"),
        ({"clearance": -1e-6}, "clearance must be > 0 m, got -1e-06 m"),
        ({"liner": ("PTFE",)}, "liner must be a thickness in m and a material"),
        (
            {"liner": ("3e-3,PTFE",)},
            "must be > 0.003 m, got 0.003 m",
        ),
    ],
)
def test_wrong_joints(changes, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        DimensionalJoint(**(GOOD | changes))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "depth or force must be given"),
        ({"depth": 1e-6, "force": 1.0}, "depth and force must not both be given"),
        ({"force": [1.0, -3.0]}, "force must be > 0 N, got -3 N"),
        ({"force": []}, "force must be a list of numbers, got shape (0,)"),
    ],
)
def test_wrong_depths_and_forces(given, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        DimensionalJoint(**GOOD).solve(**given)


@pytest.mark.parametrize("law", ["stiffened_hertz", contact.stiffened_hertz])
def test_stiffened_hertz_is_for_linear_kinematics_alone(law):
    assert BRONZE.law(law).force(4e-6) == pytest.approx(BRONZE.law().force(4e-6), rel=2e-3)
    with pytest.raises(ValueError, match="kinematics .* stiffened_hertz must be one of linear"):
        replace(BRONZE, kinematics="finite").law(law)


@pytest.mark.slow
def test_a_rod_end_on_its_pin_is_solved_across_it():
    sizes = {"socket_radius": 8e-3, "clearance": 25e-6, "wall": 3e-3, "socket": "bronze"}
    rod_end = DimensionalJoint(**sizes, ball_support="pin:5e-3,9e-3", opening="57:123")
    assert rod_end.ball_support.radius == pytest.approx(5e-3 / (8e-3 - 25e-6))
    solution = rod_end.solve(force=4000)
    assert solution.tilt == pytest.approx([90], abs=1e-3)
    plain = rod_end.joint
    contact = tilted_contact(plain, solution.depth / 25e-6, 90)
    unit = plain.composite_modulus * 25e-6**2
    assert solution.force == pytest.approx(unit * contact.force_star, rel=1e-4)
    # the table along this direction, read between the depths that were solved for it
    assert rod_end.law().force(solution.depth) == pytest.approx(solution.force, rel=3e-3)
    power = rod_end.power_law()
    assert power.depths == pytest.approx((0.05 * 25e-6, 0.5 * 25e-6))
    assert power.error < 0.06
    assert set(solution.friction_radius) == {"spin", "tilt", "turn"}
    assert all(0 <= error[0] < 0.05 for error in solution.von_mises_error.values())
    with pytest.raises(ValueError, match=r"force_star must be one .* \(force given: 1e\+12 N\)"):
        rod_end.solve(force=1e12)
    with pytest.raises(ValueError, match="law must be the table .* off the axis, got hertz"):
        rod_end.law("hertz")


def test_a_narrow_socket_has_a_table_up_to_its_rim():
    narrow = DimensionalJoint(12.5e-3, 40e-6, 6e-3, opening=40)
    law = narrow.law()
    assert 0.1 * 40e-6 < law.deepest < 40e-6
    depth = law.deepest / 2
    assert narrow.solve(depth=depth).force == pytest.approx([law.force(depth)], rel=2e-3)
    with pytest.raises(ValueError, match="rim of the socket"):
        narrow.solve(depth=30e-6)
