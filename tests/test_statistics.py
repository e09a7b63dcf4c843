"""The paper's measures of agreement, from their definitions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import dataset
from study import statistics as stats

TRUTH, PREDICTION = [1.0, 2.0, 4.0, 5.0], [1.0, 3.0, 4.0, 4.0]  # SSE 2, SST 10, mean 3


def test_measures_by_hand():
    assert stats.r_squared(TRUTH, PREDICTION) == pytest.approx(0.8)
    assert stats.adjusted_r_squared(TRUTH, PREDICTION) == pytest.approx(1 - 0.2 * 3 / 2)
    assert stats.rmse(TRUTH, PREDICTION) == pytest.approx(np.sqrt(0.5))
    assert stats.relative_rmse(TRUTH, PREDICTION) == pytest.approx(np.sqrt(0.5) / 3)
    assert stats.relative_error(TRUTH, PREDICTION) == pytest.approx([0, 0.5, 0, -0.2])


def test_published_adjusted_values_have_20_samples_and_one_predictor():
    table = dataset.published("Table 2")
    for law in ("hertz", "steuermann", "liu", "winkler", "proposed"):
        sign = -1 if table[law, "R2"] > 1 else 1  # printed without its sign
        ratio = (1 - sign * table[law, "R2_adj"]) / (1 - sign * table[law, "R2"])
        assert ratio == pytest.approx(19 / 18, abs=1e-3)


@given(st.lists(st.floats(0.1, 10), min_size=4, max_size=30, unique=True), st.floats(0.1, 10))
def test_measures_scale_with_the_data(truth, factor):
    truth = np.array(truth)
    prediction = truth * 1.1
    scaled = stats.agreement(truth * factor, prediction * factor)
    plain = stats.agreement(truth, prediction)
    assert scaled["R2"] == pytest.approx(plain["R2"], rel=1e-6, abs=1e-9)
    assert scaled["RMSE"] == pytest.approx(factor * plain["RMSE"])
    assert scaled["relative_RMSE"] == pytest.approx(plain["relative_RMSE"])
    assert stats.agreement(truth, truth)["R2"] == 1


def test_last_crossing_interpolates():
    assert stats.last_crossing([0, 1, 2, 3], [1, -1, -1, 3]) == pytest.approx(2.25)
    assert stats.last_crossing([0.5, 1], [1, 2]) == 0.5
    with pytest.raises(ValueError, match="positive at the end"):
        stats.last_crossing([0, 1], [1, -1])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: stats.rmse([1, 2], [1, 2, 3]), "lists of the same length"),
        (lambda: stats.rmse([1, np.nan], [1, 2]), "must be finite"),
        (lambda: stats.r_squared([2, 2], [1, 2]), "truth must vary, got only 2"),
        (lambda: stats.relative_error([0, 1], [1, 2]), "non-zero"),
        (lambda: stats.adjusted_r_squared([1, 2], [1, 2]), "predictors must be >= 0 and < 1"),
    ],
)
def test_bad_input_is_one_clear_error(call, message):
    with pytest.raises(ValueError, match=message):
        call()
