"""Coefficients by least squares, and what the study must find with them."""

import numpy as np
import pytest

from study import contact, dataset
from study.claims import statistics as stats
from study.dataset import fitting


@pytest.mark.parametrize("law", fitting.FITTED_LAWS)
def test_coefficient_is_the_best_one(law):
    curve = dataset.paper_curves(r2_star=200)
    best = fitting.coefficient(law, curve.depth_star, curve.force_star)
    unit = fitting.FITTED_LAWS[law](curve.depth_star, 200)
    errors = [stats.rmse(curve.force_star, of * best * unit) for of in (1, 0.999, 1.001)]
    assert errors[0] < min(errors[1:])
    assert fitting.coefficient(law, curve.depth_star, 7 * unit) == pytest.approx(7)


def test_surrogate_agrees_as_table_1_says():
    cases = fitting.coefficients_by_case("hyperbolic_winkler", dataset.paper_curves())
    cases = cases[cases.r2_star <= 300]
    assert len(cases) == 15
    line = fitting.surrogate(cases.r2_star, cases.f1)
    surrogate = line["slope"] * cases.r2_star + line["intercept"]
    assert stats.adjusted(stats.determination(cases.f1, surrogate), len(cases), 1) >= 0.99995
    assert np.abs(surrogate / cases.f1 - 1).max() < 5e-4
    assert stats.rmse(cases.f1, surrogate) < dataset.published("Table 1")["f1", "RMSE"]


def test_fig_14_follows():
    stated = dataset.published("Fig. 14")["proposed"]
    found = {
        r2_star: stats.goodness_of_fit(
            fitting.sampled(case), contact.HyperbolicWinkler()(fitting.SAMPLE, r2_star)
        )
        for r2_star, case in dataset.paper_curves().groupby("r2_star")
    }
    error = [100 * measures["relative_RMSE"] for measures in found.values()]
    square = np.array([measures["kappa_adjusted_as_printed"] for measures in found.values()])
    inside = np.array(list(found)) <= 300
    assert (np.diff(error) > 0).all()
    assert max(error) < stated["relative_RMSE_limit_percent"]
    assert (np.diff(square) < 0).all()
    assert square[inside].min() > stated["determination_min_inside_20_to_300"] > square[-1]
    assert square.min() > stated["determination_min_beyond"]


def test_liu_has_the_published_r2_by_construction_and_its_rmse_by_its_form():
    force = fitting.sampled(dataset.paper_curves(r2_star=200))
    published = dataset.published_table_2().loc["liu"]
    law = contact.Liu()(fitting.SAMPLE, 200)
    assert stats.kappa_as_printed(force, law) == pytest.approx(published.kappa_as_printed, rel=1e-6)
    assert stats.rmse(force, law) == pytest.approx(published.RMSE, rel=3e-3)
