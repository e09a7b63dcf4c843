"""Coefficients by least squares, and what the study must find with them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import contact, dataset, fitting
from study import statistics as stats

laws = pytest.mark.parametrize("law", fitting.FITTED_LAWS)


@laws
@given(st.floats(0.1, 1e4))
def test_coefficient_of_a_law_is_found_again(law, value):
    depth = np.linspace(0.05, 0.5, 10)
    force = contact.LAWS[law](depth, 200, coefficient=value)
    assert fitting.coefficient(law, depth, force) == pytest.approx(value)


@laws
def test_coefficient_is_the_best_one(law):
    curve = dataset.paper_curves(r2_star=200)
    best = fitting.coefficient(law, curve.depth_star, curve.force_star)

    def error(value):
        force = contact.LAWS[law](curve.depth_star, 200, coefficient=value)
        return stats.rmse(curve.force_star, force)

    assert error(best) < min(error(0.999 * best), error(1.001 * best))


def test_surrogate_is_the_line():
    line = fitting.surrogate([20, 100, 300], [1, 5, 15])
    assert line == pytest.approx({"slope": 0.05, "intercept": 0}, abs=1e-12)


def test_surrogate_agrees_as_table_1_says():
    cases = fitting.coefficients_by_case("hyperbolic_winkler", dataset.paper_curves())
    cases = cases[cases.r2_star <= 300]
    assert len(cases) == 15
    line = fitting.surrogate(cases.r2_star, cases.f1)
    surrogate = line["slope"] * cases.r2_star + line["intercept"]
    assert stats.adjusted_r_squared(cases.f1, surrogate) >= 0.99995
    assert np.abs(stats.relative_error(cases.f1, surrogate)).max() < 3e-4
    assert stats.rmse(cases.f1, surrogate) < dataset.published("Table 1")["f1", "RMSE"]


@pytest.mark.parametrize("law", ["hertz", "steuermann"])
def test_table_2_comes_back(law):
    curve = dataset.paper_curves(r2_star=200)
    curve = curve[curve.depth_star <= 0.5]
    assert len(curve) == 20
    published = dataset.published("Table 2")[law, "RMSE"]
    ours = stats.rmse(curve.force_star, contact.LAWS[law](curve.depth_star, 200))
    assert ours == pytest.approx(published, rel=0.01)


def test_relative_rmse_rises_and_stays_below_the_published_limit():
    limit = dataset.published("Fig. 14")["proposed", "relative_RMSE_limit_percent"]
    curves = dataset.paper_curves()
    curves = curves[curves.depth_star <= 0.5]
    error = [
        100 * stats.relative_rmse(case.force_star, contact.hyperbolic_winkler(case.depth_star, r2))
        for r2, case in curves.groupby("r2_star")
    ]
    assert (np.diff(error) > 0).all()
    assert max(error) < limit
