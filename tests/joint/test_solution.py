"""What follows from a solution: units, contact area, errors and friction radius."""

import numpy as np
import pytest

from study.joint import Joint
from study.joint.solution import quantities
from study.parameters import READ

BRONZE = Joint(15e-3, 22e-6, 7e-3, "steel", "bronze")
FOUND = Joint.from_ratios(200).solve(depth_star=[0.01, 0.3])


@pytest.fixture(scope="module")
def tilted():
    rod_end = Joint(8e-3, 25e-6, 3e-3, ball_support="bore:0.5,45", opening="55:125")
    return rod_end.solve(force=[500.0, 2000.0])


@pytest.mark.parametrize("dimensions", [True, False])
def test_every_quantity_has_a_known_unit_and_is_there(dimensions, tilted):
    units = {"", "deg", *(["m", "N", "N/m", "m^2", "Pa"] if dimensions else [])}
    along = BRONZE.solve(force=[1e4, 5e2])
    for name, about in quantities(dimensions).items():
        assert about.meaning[0].isupper(), name
        assert about.unit in units, name
        assert about.read == about.unit or about.read in READ, name
        assert np.shape(getattr(tilted, name)) == (2,), name
        values = getattr(along, name)
        of_tilt = ("tilt", "transverse", "peak_angle", "contact_from", "contact_to")
        assert (values is None) == name.startswith((*of_tilt, "specific_load")), name
    scales = {of.unit: of.scale for of in quantities(True).values()}
    assert scales["m"] == 1e-3
    assert scales["m^2"] == 1e-6
    assert scales["Pa"] == scales["N/m"] == 1e6


def test_values_in_si_units_are_those_with_a_star_in_the_units_of_the_joint(tilted):
    for found in (BRONZE.solve(force=1e4), tilted):
        joint = found.joint
        modulus, clearance, radius = joint.composite_modulus, joint.clearance, joint.socket_radius
        units = {
            "depth": clearance,
            "force": modulus * clearance**2,
            "transverse": modulus * clearance**2,
            "stiffness": modulus * clearance,
            "transverse_stiffness": modulus * clearance,
            "peak_pressure": modulus * clearance / radius,
            "pressure": modulus * clearance / radius,
            "contact_area": radius**2,
        }
        for name, unit in units.items():
            star = getattr(found, f"{name}_star")
            if star is None:
                assert getattr(found, name) is None
            else:
                assert getattr(found, name) == pytest.approx(unit * star, rel=1e-14)


def test_the_error_of_a_force_is_its_numerical_one_and_that_of_small_displacements(tilted):
    for found in (FOUND, tilted):
        assert found.force_error == pytest.approx(found.error_estimate + found.formulation_error)
    errors = [Joint.from_ratios(r).solve(depth_star=0.5).formulation_error for r in (20, 2000)]
    assert errors[0] == pytest.approx(100 * errors[1])  # its size: `test_axial`


def test_friction_radius_is_the_mean_distance_from_the_axis_weighted_by_the_pressure():
    """10 kN at a half-angle of 33.8 deg: 5.4 N m at a friction of 0.1, within 5 %."""
    found = BRONZE.solve(force=10e3)
    assert found.contact_half_angle_deg[0] == pytest.approx(33.8, abs=0.5)
    assert 0.1 * 10e3 * found.friction_radius[0] == pytest.approx(5.4, rel=0.05)
    angle, pressure = np.radians(found.angle_deg), found.pressure_star[0]
    torque, force = (
        np.trapezoid(pressure * np.sin(angle) * of(angle), angle) for of in (np.sin, np.cos)
    )
    expected = found.joint.ball_radius * torque / force
    assert found.friction_radius[0] == pytest.approx(expected, rel=2e-3)
