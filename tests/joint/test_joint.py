"""The joint with its dimensions and by its ratios: known values, consistency, wrong input."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study import contact
from study.joint import Joint, Layer, Material, first_yield, reference_joint, stress

BRONZE = Joint(12.5e-3, 40e-6, 6e-3, "steel", "bronze")
CUP = Joint(16e-3, 0.1e-3, 8e-3, Material(230e9, 0.3), Material(0.8e9, 0.46))
LINED = Joint(20e-3, 0.1e-3, 8e-3, "steel", "steel", ("0.5e-3,PTFE", "1e-3,bronze"))
CUT = Joint(0.01, 5e-5, 2.98e-3, "steel", ball_support="core:0.2", opening=70)
"""Pressed towards 60 deg, its contact is cut by the rim."""
JOINTS = pytest.mark.parametrize("joint", [BRONZE, CUP, LINED], ids=["bronze", "cup", "lined"])
TOGETHER = 2e-6
"""Relative change of a force by the depths that are solved together, which share a matrix."""
THIN = {"socket_radius": 10e-3, "clearance": 1e-4, "socket_support": "rim"}
THIN_DEPTHS = [3e-7, 5e-7, 1e-6, 5e-6]


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
    """Values worked out by hand from the normalised solution, to the digits given."""
    found = joint.solve(force=force)
    assert found.depth[0] == pytest.approx(depth, rel=0.01)
    assert found.stiffness[0] == pytest.approx(stiffness, rel=0.01)
    assert pressure is None or found.peak_pressure[0] == pytest.approx(pressure, rel=0.01)
    assert found.error_estimate[0] < 1e-3


@pytest.mark.parametrize(
    ("joint", "depth", "force", "stiffness"),
    [
        (  # a socket that bends under the shallowest contacts
            Joint(wall=0.3e-3, **THIN),
            THIN_DEPTHS,
            [1.170, 2.036, 4.472, 48.67],
            [4.20e6, 4.47e6, 5.37e6, 16.8e6],
        ),
        (
            Joint(wall=0.6e-3, **THIN),
            THIN_DEPTHS,
            [3.742, 6.641, 14.53, 115.0],
            [14.1e6, 14.9e6, 16.6e6, 35.0e6],
        ),
        (  # a nearly incompressible ball that is softer than its socket, up to the rim
            Joint(10e-3, 50e-6, 2.98e-3, "1e7,0.499", "steel"),
            [0.5 * 50e-6, 0.9 * 50e-6, 0.95 * 50e-6, 0.97 * 50e-6],
            [4.598, 18.86, 24.79, 29.22],
            [0.3466e6, 1.719e6, 3.425e6, 5.886e6],
        ),
    ],
    ids=["thin", "less thin", "soft ball"],
)
def test_joints_whose_table_is_hard(joint, depth, force, stiffness):
    """Forces to their four digits, and stiffnesses by their differences, at a finer resolution."""
    found, law = joint.solve(depth=depth), joint.law()
    off = np.abs(found.force / force - 1)
    assert (off < 1e-3 + found.error_estimate / 3).all()
    assert off.max() < 7e-3
    off = np.abs(found.stiffness / stiffness - 1)
    assert (off < 6e-3 + 4 * found.error_estimate).all()  # of the shallowest contacts
    assert law.deepest > depth[-1]
    assert law.force(depth) == pytest.approx(found.force, rel=1e-4)
    places = np.geomspace(1e-4 * joint.clearance, law.deepest, 400)
    assert (law.stiffness(places) > 0).all()
    assert (np.diff(law.force(places)) > 0).all()
    assert law.law.error < 6e-3


@pytest.mark.slow
def test_a_first_guess_that_is_not_resolved_does_not_fail_a_force():
    supports = {"ball_support": "neck:17", "opening": "98", "socket_support": "rim"}
    found = Joint(10e-3, 3e-5, 0.9e-3, **supports).solve(force=129.764, tilt=27.864)
    assert found.depth == pytest.approx([3e-6], rel=1e-4)
    assert found.tilt == pytest.approx([29], abs=1e-3)


@pytest.mark.slow
def test_a_hip_liner_is_as_in_calculix():
    hip = Joint(14.1e-3, 100e-6, 8e-3, "CoCr", "1e9,0.4", ball_support="core:0.5")
    found = hip.solve(force=3000)
    assert found.depth == pytest.approx([59.08e-6], rel=1e-3)
    at_depth = hip.solve(depth=59.08e-6)
    assert at_depth.force == pytest.approx([2999.2], rel=1e-3)
    assert (at_depth.force_error > np.abs(at_depth.force / 2999.2 - 1)).all()


def test_ratios_and_dimensions_make_the_same_joint_in_other_units():
    softer = {"ball": Material(2.1, 0.3), "socket": Material(1.1, 0.34)}  # by 1e11
    by_ratios = Joint.from_ratios(312.5, 1.48, **softer)
    assert (by_ratios.has_dimensions, BRONZE.has_dimensions) == (False, True)
    for name in ("r2_star", "socket_ratio", "modulus_ratio", "radius_ratio"):
        assert getattr(by_ratios, name) == pytest.approx(getattr(BRONZE, name), rel=1e-14)
    assert by_ratios.columns() == BRONZE.columns()
    one, other = by_ratios.solve(depth_star=[0.1, 0.4]), BRONZE.solve(depth=[4e-6, 16e-6])
    for name in ("force", "stiffness", "peak_pressure", "contact_area"):
        stars = [getattr(of, f"{name}_star") for of in (one, other)]
        assert stars[1] == pytest.approx(stars[0], rel=1e-9)
    assert by_ratios.force_unit == pytest.approx(BRONZE.composite_modulus / 1e11 / 312.5**2)
    assert (by_ratios.socket_radius, by_ratios.clearance) == (1, 1 / 312.5)


def test_layers_of_ratios_are_liners():
    layers = Layer(1.025, Material(5e8, 0.46)), Layer(1.075, Material(1.1e11, 0.34))
    layers = (*layers, Layer(1.4, Material(2.1e11)))
    by_ratios = Joint.from_ratios(200, layers=layers, ball=Material(2.1e11))
    assert by_ratios.modulus_ratio == pytest.approx(5e8 / 2.1e11)
    assert by_ratios.socket_body.layers[2] == pytest.approx([1, 220, 420])
    for joint in (by_ratios, LINED):
        assert [of.material for of in joint.layers] == [of.material for of in layers]
        ratios = [of.outer_ratio for of in joint.layers]
        assert ratios == pytest.approx([of.outer_ratio for of in layers], rel=1e-14)
        assert list(joint.materials) == ["ball", "liner 1", "liner 2", "socket"]
        assert joint.innermost == layers[0].material
    assert by_ratios.columns() == LINED.columns()


def test_a_joint_with_something_replaced():
    wider = replace(BRONZE, clearance=80e-6, ball_support="clamped", rim="free")
    supports = {"ball_support": "clamped", "rim": "free"}
    assert wider == Joint(12.5e-3, 80e-6, 6e-3, "steel", "bronze", **supports)
    assert wider != replace(wider, ball="aluminium")
    loose = replace(Joint.from_ratios(200), clearance=0.02)
    assert (loose.r2_star, loose.has_dimensions) == (50, False)
    assert loose == Joint.from_ratios(50)
    assert reference_joint(60) == Joint.from_ratios(60, 1.298, **supports)


@JOINTS
@settings(max_examples=10)
@given(roots=st.lists(st.floats(0.06, 0.99), min_size=1, max_size=3, unique=True))
def test_depth_and_force_are_each_others_inverse(joint, roots):
    found = joint.solve(depth=joint.clearance * np.square(roots))
    back = joint.solve(force=found.force)
    assert back.force == pytest.approx(found.force, rel=TOGETHER)
    assert back.depth == pytest.approx(found.depth, rel=TOGETHER)
    for one, other in (
        (back.stiffness, found.stiffness),
        (joint.law().force(found.depth), found.force),
    ):
        assert (np.abs(one / other - 1) < found.error_estimate + 1e-5).all()


@pytest.mark.parametrize(
    "joint",
    [BRONZE, LINED, replace(BRONZE, ball_support="clamped"), CUT],
    ids=["series", "lined", "elements", "core"],
)
def test_stiffness_is_the_slope_of_the_force(joint):
    depth, step = np.array([0.05, 0.4, 0.8]), 2e-3
    near = joint.solve(depth_star=np.ravel([depth * (1 - step), depth * (1 + step)]))
    slope = np.diff(near.force_star.reshape(2, -1), axis=0)[0] / (2 * step * depth)
    found = joint.solve(depth_star=depth)
    assert found.stiffness_star == pytest.approx(slope, rel=2e-3)
    assert found.stiffness == pytest.approx(joint.stiffness_unit * found.stiffness_star)


def test_limit_is_hertz():
    """A small load on big bodies: Johnson, Contact Mechanics, 1985, Eqs. 4.22 to 4.24.

    The friction torque under p0 sqrt(1 - r^2/a^2) is 3 pi/16 mu N a.
    """
    joint, force = Joint(0.05, 5e-3, 5.0, "steel", "aluminium"), 20.0
    found, modulus = joint.solve(force=force, stresses=True), joint.composite_modulus
    radius = 1 / (1 / 0.045 - 1 / 0.05)
    depth = (9 * force**2 / (16 * radius * modulus**2)) ** (1 / 3)
    assert found.depth[0] == pytest.approx(depth, rel=0.01)
    assert found.stiffness[0] == pytest.approx(1.5 * force / depth, rel=0.015)
    peak = (6 * force * modulus**2 / (np.pi**3 * radius**2)) ** (1 / 3)
    assert found.peak_pressure[0] == pytest.approx(peak, rel=0.01)
    assert found.von_mises["ball"][0] == pytest.approx(0.62 * peak, rel=0.01)
    assert found.friction_radius == pytest.approx(
        3 * np.pi / 16 * (radius * depth) ** 0.5, rel=0.01
    )
    assert joint.law("hertz").depth(force) == pytest.approx(depth, rel=1e-9)


def test_factor_to_yield():
    ball, socket = Material(2.1e11, 0.3, 1e9), Material(1.1e11, 0.34, 2e8)
    joint = replace(BRONZE, ball=ball, socket=socket)
    first = first_yield(joint)
    found = joint.solve(depth_star=first.depth_star, stresses=True)
    assert first.body == "socket"
    assert found.yield_factor["socket"][0] == pytest.approx(1, rel=0.005)
    assert found.yield_factor["ball"][0] == pytest.approx(1e9 / found.von_mises["ball"][0])
    assert CUP.solve(force=1e3, stresses=True).yield_factor == {"ball": None, "socket": None}


@JOINTS
def test_stresses_are_those_of_the_solution_and_none_unless_asked_for(joint):
    plain = joint.solve(depth_star=[0.3, 0.05])
    assert plain.stress is None
    for name in ("von_mises", "yield_factor"):
        with pytest.raises(ValueError, match="solve the joint with stresses=True"):
            getattr(plain, name)
    found = joint.solve(depth_star=[0.3, 0.05], stresses=True)
    assert found.von_mises.keys() == joint.materials.keys()
    for body, largest in stress.added(plain).stress.items():
        assert found.von_mises[body] == pytest.approx(joint.pressure_unit * largest.von_mises)
        assert found.stress[body].place == largest.place


def test_laws_of_a_joint():
    depth = 4e-6
    exact = BRONZE.law().force(depth)
    for law in ("stiffened_hertz", contact.StiffenedHertz):
        assert BRONZE.law(law).force(depth) == pytest.approx(exact, rel=2e-3)
    assert BRONZE.law("hertz").force(depth) < 0.9 * exact
    for name in contact.LAWS:
        law = BRONZE.law(name)
        assert law.depth(law.force(depth)) == pytest.approx(depth, rel=1e-9)
    fit = BRONZE.power_law()
    places = 40e-6 * np.array([0.05, 0.2, 0.5])
    found = fit.coefficient * places**fit.exponent
    assert found == pytest.approx(BRONZE.law().force(places), rel=1.01 * fit.error)
    assert BRONZE.law("power").force(places) == pytest.approx(found, rel=1e-3)


def test_depths_beyond_one_clearance_and_up_to_the_rim():
    deep = CUP.solve(depth=3e-4)
    assert 60 < deep.contact_half_angle_deg[0] < 90
    assert CUP.solve(force=deep.force).depth == pytest.approx([3e-4], rel=TOGETHER)
    with pytest.raises(ValueError, match=r"depth_star must .* rim of the socket .*0.0014 m"):
        CUP.solve(depth=1.4e-3)
    with pytest.raises(ValueError, match=r"force must be <= \S+ N, got 1e\+06 N;") as error:
        CUP.solve(force=1e6)
    most = float(re.search(r"<= (\S+) N", str(error.value))[1])
    assert CUP.solve(force=0.99 * most).contact_half_angle_deg[0] > 80


def test_a_small_contact_is_solved_on_finer_elements():
    assert BRONZE.solve(depth=40e-6 * 3e-5).error_estimate[0] < 0.05


def test_a_thin_liner_in_metal_has_enough_depths_for_its_table():
    joint = Joint(10e-3, 100e-6, 5e-3, socket="UHMWPE", liner="0.1mm,CoCr")
    assert joint.solve(force=100).error_estimate[0] < 0.1
    assert joint.power_law().error > 0
    assert joint.table() is not None


PEAKS = [
    ((9.9668e-3, 382.4e-6, 0.21544e-3, "PTFE", "UHMWPE"), 0.1195),
    ((2.0805e-3, 107.268e-6, 0.87671e-3, "steel", "UHMWPE"), 0.03),
    ((53.838e-3, 3.17888e-3, 0.35942e-3, "PTFE", "PTFE"), 0.95),
]


@pytest.mark.parametrize(("sizes", "depth_star"), PEAKS)
def test_the_error_of_a_peak_pressure_covers_its_change_on_finer_elements(sizes, depth_star):
    joint = Joint(*sizes)
    found, fine = (joint.solve(depth_star=depth_star, resolution=n) for n in (None, 960))
    assert found.peak_error >= abs(found.peak_pressure_star / fine.peak_pressure_star - 1)


def test_a_narrow_socket_has_a_table_up_to_its_rim():
    narrow = Joint(12.5e-3, 40e-6, 6e-3, opening=40)
    law = narrow.law()
    assert 0.1 * 40e-6 < law.deepest < 40e-6
    depth = law.deepest / 2
    assert narrow.solve(depth=depth).force == pytest.approx([law.force(depth)], rel=2e-3)


@pytest.mark.slow
def test_a_rod_end_on_its_pin_is_solved_across_it():
    sizes = {"socket_radius": 8e-3, "clearance": 25e-6, "wall": 3e-3, "socket": "bronze"}
    rod_end = Joint(**sizes, ball_support="pin:5e-3,9e-3", opening="57:123")
    assert rod_end.ball_support.radius == pytest.approx(5e-3 / (8e-3 - 25e-6))
    solution = rod_end.solve(force=4000, stresses=True)
    assert solution.tilt == pytest.approx([90], abs=1e-3)
    # the table along this direction, read between the depths that were solved for it
    assert rod_end.law().force(solution.depth) == pytest.approx(solution.force, rel=3e-3)
    power = rod_end.power_law()
    assert power.depths == pytest.approx((0.05 * 25e-6, 0.5 * 25e-6))
    assert power.error < 0.06
    assert 0 < solution.friction_radius[0] < 8e-3
    assert all(0 <= of.error[0] < 0.05 for of in solution.stress.values())
    with pytest.raises(ValueError, match="force must be one .* got .* N at a tilt of 90"):
        rod_end.solve(force=1e12)
    with pytest.raises(ValueError, match="law must be the table .* off the axis, got hertz"):
        rod_end.law("hertz")
