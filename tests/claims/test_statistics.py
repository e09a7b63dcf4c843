"""The paper's measures of agreement, from their definitions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import dataset
from study.claims import statistics as stats

TRUTH, PREDICTION = [1.0, 2.0, 4.0, 5.0], [1.0, 3.0, 4.0, 4.0]  # SSE 2, SST 10, mean 3


def test_measures_by_hand():
    assert stats.determination(TRUTH, PREDICTION) == pytest.approx(0.8)
    assert stats.kappa_as_printed(TRUTH, PREDICTION) == 1  # errors 1 and -1 cancel
    assert stats.kappa_as_printed(TRUTH, [2.0, 3.0, 4.0, 4.0]) == pytest.approx(1 - 1 / 10)
    assert stats.adjusted(0.8, 4, 1) == pytest.approx(1 - 0.2 * 3 / 2)
    assert stats.rmse(TRUTH, PREDICTION) == pytest.approx(np.sqrt(0.5))
    assert stats.relative_rmse(TRUTH, PREDICTION) == pytest.approx(np.sqrt(0.5) / 3)


def test_published_adjusted_values_follow_from_the_others():
    for row in dataset.published_table_2().itertuples():
        assert stats.adjusted(row.kappa_as_printed, **stats.AS_PRINTED) == pytest.approx(
            row.kappa_adjusted_as_printed, abs=2e-4
        )
        assert row.kappa_as_printed < 1  # the signs that the paper leaves out


@given(
    st.lists(st.floats(0.1, 10), min_size=4, max_size=30, unique=True),
    st.lists(st.floats(0.5, 2), min_size=30, max_size=30),
)
def test_published_r2_is_that_of_the_mean_error_and_one_sign_makes_it_worse(reference, factors):
    reference = np.array(reference)
    prediction = reference * factors[: reference.size]
    total = np.sum((reference - reference.mean()) ** 2)
    mean = np.mean(prediction - reference)
    found = stats.kappa_as_printed(reference, prediction)
    assert 1 - found == pytest.approx((reference.size * mean) ** 2 / total, rel=1e-9, abs=1e-12)
    low = reference * np.minimum(factors[: reference.size], 1)  # errors of one sign
    worse = stats.kappa_as_printed(reference, low), stats.determination(reference, low)
    assert worse[0] <= worse[1] + 1e-9
