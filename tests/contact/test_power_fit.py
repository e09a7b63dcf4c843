"""The power law k d^n: its fit, its error, and its units."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from study.contact import Power
from study.contact.power_fit import USUAL_RANGE, fit_power
from study.joint import Joint, reference_joint

BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")


@pytest.mark.parametrize(
    ("depths", "exponent", "error"),
    [((0.05, 0.5), 1.654, 0.0048), ((0.01, 0.1), 1.641, 0.0097), ((0.1, 1), 1.628, 0.0195)],
)
def test_the_papers_joint(depths, exponent, error):
    """Numbers of an independent fit to an independent solution."""
    depth = np.geomspace(*depths, 60)
    fit = fit_power(depth, reference_joint().table()(depth))
    assert fit.exponent == pytest.approx(exponent, abs=6e-4)
    assert fit.error == pytest.approx(error, rel=0.02)
    if depths == USUAL_RANGE:
        assert fit.coefficient == pytest.approx(644.0, abs=0.2)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(0.5, 2.0), min_size=3, max_size=9), st.floats(1.0, 2.5))
def test_no_other_power_has_a_smaller_largest_error(factors, exponent):
    depth = np.geomspace(1.0, 10.0, len(factors))
    force = depth**exponent * factors
    fit = fit_power(depth, force)
    exact = fit_power(depth, 3 * depth**exponent)
    assert exact[:2] == pytest.approx((3, exponent))
    assert exact.error < 1e-12

    def largest(numbers):
        return np.abs(np.exp(numbers[0]) * depth ** numbers[1] / force - 1).max()

    start = [np.log(fit.coefficient), fit.exponent]
    assert largest(start) == pytest.approx(fit.error, rel=1e-9, abs=1e-12)
    better = minimize(largest, start, method="Nelder-Mead").fun
    assert better >= fit.error - 1e-9


def test_numbers_in_metres_and_in_millimetres_are_one_law():
    law = BRONZE.power_law()
    depth = np.geomspace(*law.depths, 7)
    force = law.coefficient * depth**law.exponent
    assert law.coefficient_mm * (1e3 * depth) ** law.exponent == pytest.approx(force, rel=1e-12)
    assert np.abs(force / BRONZE.law().force(depth) - 1).max() < 1.0001 * law.error
    assert BRONZE.law("power").force(depth) == pytest.approx(force, rel=1e-4)


def test_the_default_is_the_paper_s_joint():
    for r2_star in (20, 60, 200, 300):
        depth = np.geomspace(*USUAL_RANGE, 60)
        joint = reference_joint(r2_star)
        exact = joint.table()(depth)
        assert np.abs(Power()(depth, r2_star) / exact - 1).max() < 0.012
        assert np.abs(Power.of(joint)(depth, r2_star) / exact - 1).max() < 0.006
