"""Times at equal error, from rows of a chart."""

import numpy as np
import pandas as pd
import pytest

from study import dataset
from study.measure import charts, timing
from study.mechanism import MechanismError


def rows_of(method, errors, times, called="compiled"):
    columns = {"method": method, "called": called, "rms_error": errors, "time": times}
    return pd.DataFrame(columns)


@pytest.mark.parametrize(
    ("errors", "times", "asked", "expected"),
    [
        ([1e-9, 1e-3, 1e-5], [4e3, 4.0, 40.0], [1e-4, 1e-7], [160**0.5, 4e2]),  # on a power
        ([1e-2, 1e-3, 1e-4, 1e-4], [1, 5, 4, 6], [1e-2, 1e-3, 1e-4], [1, 2, 4]),  # two are beaten
        ([1e-3, 1e-5], [1.0, 3.0], [1.0, 1e-6], [1.0, np.nan]),  # beyond the rows
    ],
)
def test_time_at_an_error(errors, times, asked, expected):
    found = timing.time_at(rows_of("any", errors, times), asked)
    assert found == pytest.approx(expected, nan_ok=True)


def test_ratios_are_to_our_stepper():
    ours = rows_of(timing.OURS, [1e-3, 1e-9], [1.0, 8.0])
    other = rows_of("other", [1e-2, 1e-5], [3.0, 12.0], "from Python")
    table = timing.at_equal_error(pd.concat([ours, other]), [1e-5, 1e-7])
    assert table.method.tolist() == [timing.OURS, timing.OURS, "other"]
    assert table.ratio.tolist() == pytest.approx([1, 1, 12 / 2])
    assert table.called.iloc[-1] == "from Python"


def test_calls_by_turns_count_but_for_the_first(monkeypatch):
    order = []
    functions = [lambda: order.append("a") or 1, lambda: order.append("b") or 2]
    (first, first_result), (second, second_result) = timing.timed_by_turns(functions, 3)
    assert order == ["a", "b"] * 4
    assert (len(first), len(second), first_result, second_result) == (3, 3, 1, 2)
    for clock, counted in ([0, 1.5, 1.5, 4], [2.5]), ([0, 4], [4]):  # 2 s are enough
        times = iter(clock)
        monkeypatch.setattr(timing, "perf_counter", lambda times=times: next(times))
        assert timing.timed(lambda: 0, 5)[0].tolist() == counted


def test_a_stepper_that_fails_is_not_dropped_from_its_chart():
    def too_deep():
        raise MechanismError("too deep")

    run = charts.stepper("RK4", "step 4e-06 s", too_deep)
    with pytest.raises(MechanismError, match="too deep"):
        timing.chart("steppers", [run], 1)


def test_stored_evaluations_are_those_of_this_code():
    rows = dataset.measured("steppers").set_index(["method", "setting"])
    stored = rows.evaluations[timing.OURS, "tolerance 1e-08"]
    assert charts.evaluations(1e-8) == pytest.approx(stored, rel=0.01)
