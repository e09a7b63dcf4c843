"""The laws beside curves of known laws, and what is fitted to them."""

import re
from dataclasses import replace

import numpy as np
import pytest

from study.choose import fit_curve, fitted_forces
from study.contact import LAWS, Winkler
from study.contact.power_fit import fit_power
from study.joint import Joint, Material, reference_joint

DRAWN = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
DEPTH = np.linspace(0.5e-6, 20e-6, 40)  # m
FORCE = DRAWN.law().force(DEPTH)


def by_law(*given):
    return fit_curve(*given).set_index("law")


def test_measures_are_those_of_the_forces():
    table = fit_curve(DEPTH[::-1], FORCE[::-1], DRAWN)
    assert table.law[:2].tolist() == ["tabulated", "stiffened_hertz"]
    assert {*table.law} == LAWS.keys()
    assert table.max_relative_error[0] < 1e-6
    assert table.max_relative_error[1] < 2e-3
    forces = fitted_forces(table, DEPTH, DRAWN)
    for row in table.itertuples():
        off = forces[row.law] - FORCE
        assert row.rmse == pytest.approx(np.sqrt(np.mean(off**2)))
        assert row.max_error == pytest.approx(np.abs(off).max())
        assert row.determination == pytest.approx(1 - np.sum(off**2) / FORCE.var() / 40)
    winkler = forces["winkler"]  # by its normal equation
    assert winkler @ (winkler - FORCE) == pytest.approx(0, abs=1e-6 * FORCE @ FORCE)
    assert by_law(DEPTH, FORCE / 1000, DRAWN).max_relative_error["hertz"] > 100  # kN


def test_the_power_law_is_that_of_a_solved_joint_unless_there_is_noise():
    (row,) = fit_curve(DEPTH, FORCE).itertuples()
    fit = fit_power(DEPTH, FORCE)
    assert (row.law, row.coefficient, row.exponent) == ("power", *fit[:2])
    assert row.max_relative_error == pytest.approx(fit.error)
    rng = np.random.default_rng(1)
    depth = np.linspace(0, 20e-6, 400)
    noisy = 2e12 * depth**1.6 + rng.uniform(-200, 200, 400)
    assert fit_curve(depth, noisy).exponent[0] == pytest.approx(1.6, abs=0.02)
    (row,) = fit_curve(depth + 3e-6, noisy, fit=["offset"]).itertuples()
    for value, true in (("exponent", 1.6), ("offset", 3e-6)):
        error = getattr(row, f"{value}_error")
        assert abs(getattr(row, value) - true) < 3 * error < 0.1 * true


@pytest.mark.parametrize("fit", [("clearance",), ("modulus",), ("clearance", "modulus")])
@pytest.mark.parametrize("law", ["tabulated", "stiffened_hertz"])
def test_known_parameters_are_found_within_three_standard_errors(law, fit):
    clearance = 44e-6 if "clearance" in fit else 40e-6
    factor = 0.9 if "modulus" in fit else 1.0
    rng = np.random.default_rng(2)
    force = factor * replace(DRAWN, clearance=clearance).law().force(DEPTH - 1.5e-6)
    force = force + rng.normal(0, 40, DEPTH.size)
    row = by_law(DEPTH, force, DRAWN, (*fit, "offset")).loc[law]
    true = {"offset": 1.5e-6, "clearance": clearance}
    # the clearance leaves the materials, hence E*, as they are
    true["modulus"] = factor * DRAWN.composite_modulus
    for name in (*fit, "offset"):
        assert abs(row[name] - true[name]) < 3 * row[f"{name}_error"] < 0.36 * true[name]
    assert row.rmse == pytest.approx(40, rel=0.4)


def test_degenerate_fits_are_left_out():
    table = by_law(DEPTH, FORCE, DRAWN, ["clearance", "modulus"])
    assert "clearance, modulus cannot be identified together" in table.warnings["hertz"]
    assert np.isnan(table.modulus["winkler"])  # its coefficient contains it
    far = by_law(DEPTH, FORCE / 20, DRAWN, ["clearance"])
    assert "clearance is outside the search range, 1.33e-05" in far.warnings["stiffened_hertz"]


def test_a_curve_without_dimensions_and_what_a_law_is_not_for():
    joint, depth = reference_joint(), np.linspace(0.05, 1.0, 20)
    force = Winkler(1500.0)(depth, 200)
    assert by_law(depth, force, joint).coefficient["winkler"] == pytest.approx(1500)
    warnings = by_law(2 * depth, force, replace(joint, ball_support="core:0.2")).warnings
    assert "is not valid for ball_support core:0.2" in warnings["stiffened_hertz"]
    left_out = "hyperbolic_winkler is left out: depth_star of hyperbolic_winkler must be <="
    assert warnings["hyperbolic_winkler"].startswith(left_out)


@pytest.mark.parametrize(
    ("length", "load", "words"), [(1e3, 1, "stiffer"), (1, 1e3, "softer"), (1, 1e-3, "stiffer")]
)
def test_a_wrong_unit_is_named_for_each_law(length, load, words):
    table = by_law(length * DEPTH, load * FORCE, DRAWN)
    forces = fitted_forces(table.reset_index(), length * DEPTH, DRAWN)
    large = FORCE / FORCE.max() > 0.1
    for name in ("hertz", "liu", "steuermann"):
        pattern = rf"{name} is ([\d,]+) times {words} than the curve: check the units of depth"
        (times,) = re.match(pattern, table.warnings[name]).groups()
        factor = np.median((forces[name] / FORCE / load)[large])
        factor = factor if words == "stiffer" else 1 / factor
        assert float(times.replace(",", "")) == pytest.approx(factor, rel=0.05)
    assert table.warnings[["power", "winkler"]].isna().all()


def test_a_law_that_is_far_too_soft_has_a_warning():
    thin = replace(DRAWN, wall=0.6e-3, socket=Material(3e9, 0.3))
    table = by_law(DEPTH, thin.law().force(DEPTH), thin)
    assert re.match(r"hertz is \d\d times softer than the curve: check", table.warnings["hertz"])
    assert table.warnings[["tabulated", "power"]].isna().all()
    assert "warnings" not in by_law(DEPTH, FORCE, DRAWN)


def test_a_law_without_force_at_the_fitted_offset_has_a_warning():
    table = by_law(1e3 * DEPTH, FORCE, DRAWN, ["offset"])
    sentence = "hertz is without force at most depths of the curve"
    assert table.warnings["hertz"].startswith(sentence)


BAD = {
    "for 3 points": (DEPTH[:3], FORCE[:3], DRAWN, (), "must be lists of the same length >= 4"),
    "for 5 points": (DEPTH[:5], FORCE[:5], DRAWN, ("offset", "modulus"), "the same length >= 6"),
    "for a name": (DEPTH, FORCE, DRAWN, ("wall",), "fit must be one of clearance, modulus, offset"),
    "for NaN": (DEPTH, FORCE * np.nan, DRAWN, (), "force must be finite, got nan"),
    "for a sign": (DEPTH, -FORCE, DRAWN, (), "force must be >= 0 and increase with depth, got -3"),
    "for a depth": (-DEPTH, FORCE, DRAWN, (), "depth from first touch must be >= 0, got -5e-07"),
    "for zeros": (DEPTH, 0 * FORCE, DRAWN, (), "> 0 at two or more different depths"),
    "for one depth": (0 * DEPTH + 1e-6, FORCE, DRAWN, (), "at two or more different depths"),
    "for falling": (DEPTH, FORCE[::-1], DRAWN, (), "got 89.84.* at a depth of 2e-05 after 38598"),
    "without sizes": (DEPTH, FORCE, None, ("clearance",), "only be fitted to a joint with dim"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input(case):
    *given, message = BAD[case]
    with pytest.raises(ValueError, match=message):
        fit_curve(*given)
