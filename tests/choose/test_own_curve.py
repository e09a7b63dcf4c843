"""Which law follows a given curve, and what is fitted to it, for curves of known laws."""

from dataclasses import replace

import numpy as np
import pytest

from study.choose import fit_curve
from study.contact import LAWS, Winkler
from study.contact.power_fit import fit_power
from study.joint import Joint, reference_joint

DRAWN = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
DEPTH = np.linspace(0.5e-6, 20e-6, 40)  # m
FORCE = DRAWN.law().force(DEPTH)


def by_law(found):
    return {of.law: of for of in found.laws}


def test_the_joints_own_solution_follows_its_curve_exactly():
    found = fit_curve(DEPTH[::-1], FORCE[::-1], DRAWN)
    assert [of.law for of in found.laws[:2]] == ["tabulated", "stiffened_hertz"]
    assert found.laws[0].max_relative_error < 1e-12
    assert found.laws[1].max_relative_error < 2e-3
    assert by_law(found).keys() == LAWS.keys()
    assert (found.left_out, found.notes) == ({}, ())


def test_measures_and_the_number_of_fitted_parameters():
    found = by_law(fit_curve(DEPTH, FORCE, DRAWN))
    for name, law in found.items():
        off = law.force - FORCE
        assert law.rmse == pytest.approx(np.sqrt(np.mean(off**2)))
        assert law.max_error == pytest.approx(np.abs(off).max())
        assert law.determination == pytest.approx(1 - np.sum(off**2) / FORCE.var() / 40)
        count = len(LAWS[name].fitted_constants)
        assert tuple(law.parameters) == LAWS[name].fitted_constants
        adjusted = 1 - (1 - law.determination) * 39 / (39 - count)
        assert law.determination_adjusted == pytest.approx(adjusted)
    winkler = found["winkler"]  # by its normal equation
    assert winkler.force @ (winkler.force - FORCE) == pytest.approx(0, abs=1e-6 * FORCE @ FORCE)


def test_the_power_law_is_that_of_a_solved_joint_unless_there_is_noise():
    found = fit_curve(DEPTH, FORCE)
    assert found.power == fit_power(DEPTH, FORCE)
    assert [of.law for of in found.laws] == ["power"]
    assert found.left_out.keys() == LAWS.keys() - {"power"}
    rng = np.random.default_rng(1)
    depth = np.linspace(0, 20e-6, 400)
    noisy = fit_curve(depth, 2e12 * depth**1.6 + rng.uniform(0, 200, 400), fit=["offset"])
    (law,) = noisy.laws
    assert law.parameters["exponent"] == pytest.approx(1.6, abs=0.02)
    assert "0.25 %" in noisy.notes[0]


@pytest.mark.parametrize("fit", [("clearance",), ("modulus",), ("clearance", "modulus")])
@pytest.mark.parametrize("law", ["tabulated", "stiffened_hertz"])
def test_what_was_changed_is_found_within_three_standard_errors(law, fit):
    clearance = 44e-6 if "clearance" in fit else 40e-6
    factor = 0.9 if "modulus" in fit else 1.0
    rng = np.random.default_rng(2)
    force = factor * replace(DRAWN, clearance=clearance).law().force(DEPTH - 1.5e-6)
    force = force + rng.normal(0, 40, DEPTH.size)
    found = by_law(fit_curve(DEPTH, force, DRAWN, (*fit, "offset")))[law]
    true = {"offset": 1.5e-6, "clearance": clearance}
    # the clearance leaves the materials, hence E*, as they are
    true["modulus"] = factor * DRAWN.composite_modulus
    assert found.parameters.keys() == {*fit, "offset"}
    for name, value in found.parameters.items():
        assert abs(value - true[name]) < 3 * found.standard_errors[name]
        assert found.standard_errors[name] < 0.12 * true[name]
    assert found.rmse == pytest.approx(40, rel=0.4)


@pytest.mark.slow
def test_standard_errors_are_the_spread_of_repeated_fits():
    rng, found = np.random.default_rng(3), []
    for _ in range(60):
        force = FORCE + rng.normal(0, 100, DEPTH.size)
        found.append(by_law(fit_curve(DEPTH + 1e-6, force, DRAWN, ["offset"]))["stiffened_hertz"])
    spread = np.std([of.parameters["offset"] for of in found])
    told = np.mean([of.standard_errors["offset"] for of in found])
    assert spread == pytest.approx(told, rel=0.3)


def test_parameters_that_cannot_be_told_apart_are_said_to_be_so():
    found = fit_curve(DEPTH, FORCE, DRAWN, ["clearance", "modulus"])
    assert "fit only one of them" in found.left_out["hertz"]
    assert "no modulus to fit" in found.notes[0]
    far = fit_curve(DEPTH, FORCE / 20, DRAWN, ["clearance"])
    assert "0.333 to 3 times" in far.left_out["stiffened_hertz"]


@pytest.mark.slow
def test_a_curve_without_dimensions_and_what_a_law_is_not_for():
    joint, depth = reference_joint(), np.linspace(0.05, 1.0, 20)
    force = Winkler(1500.0)(depth, 200)
    found = fit_curve(depth, force, joint)
    assert by_law(found)["winkler"].parameters["coefficient"] == pytest.approx(1500)
    left_out = fit_curve(2 * depth, force, replace(joint, ball_support="core:0.2")).left_out
    assert "is not valid for ball_support core:0.2" in left_out["stiffened_hertz"]
    assert left_out["hyperbolic_winkler"].startswith("depth_star of hyperbolic_winkler must be <=")


def test_a_curve_far_from_every_prediction_is_pointed_out():
    (note,) = fit_curve(DEPTH, FORCE / 1000, DRAWN).notes  # kN
    assert "Check units" in note


BAD = {
    "for 3 points": (DEPTH[:3], FORCE[:3], DRAWN, (), "must be lists of the same length >= 4"),
    "for 5 points": (DEPTH[:5], FORCE[:5], DRAWN, ("offset", "modulus"), "the same length >= 6"),
    "for a name": (DEPTH, FORCE, DRAWN, ("wall",), "fit must be one of clearance, modulus, offset"),
    "for NaN": (DEPTH, FORCE * np.nan, DRAWN, (), "force must be finite N, got nan N"),
    "for a sign": (DEPTH, -FORCE, DRAWN, (), "must be >= 0, got .*change the sign"),
    "for a depth": (-DEPTH, FORCE, DRAWN, (), "depth must be >= 0, got -2e-05"),
    "for zeros": (DEPTH, 0 * FORCE, DRAWN, (), "must be > 0 at two or more different depths"),
    "for one depth": (0 * DEPTH + 1e-6, FORCE, DRAWN, (), "at two or more different depths"),
    "for falling": (DEPTH, FORCE[::-1], DRAWN, (), "force must increase with depth, got 3"),
    "for mm": (1e6 * DEPTH, FORCE, DRAWN, (), "depth must be >= 4e-09 m .* 20 m; check the unit"),
    "for km": (1e-6 * DEPTH, FORCE, DRAWN, (), "depth must be >= 4e-09 m .* check the unit"),
    "without sizes": (DEPTH, FORCE, None, ("clearance",), "only be fitted to a curve with units"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input(case):
    *given, message = BAD[case]
    with pytest.raises(ValueError, match=message):
        fit_curve(*given)
