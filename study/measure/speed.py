"""Speed against accuracy: the kept times of laws, solvers and steppers, and how to read them.

Four charts. ``laws``: a call in a compiled loop, against the curve of the paper's joint.
``solvers``: a curve of 20 depths from nothing, of a radially free ball, against the series.
``steppers``: 0.3 s of the paper's scene with clearance, against the study's stepper at its
smallest tolerance. ``flexible``: flexible links, against particles of a fine mesh. Times depend on
the machine: those drawn are kept in ``data/published/speed.csv``, which `study measure` renews.

What is timed, and how, is in ``tests/benchmarks/`` of the checkout, with what a column means; the
other programs are beside it in ``tests/other_programs/``.
"""

import sys
from collections.abc import Iterator, Sequence
from importlib import import_module
from types import ModuleType
from typing import Literal, get_args

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from study import checks, paths

Chart = Literal["laws", "solvers", "steppers", "flexible"]
CHARTS = get_args(Chart)
OURS = "collocation, events"
"""The study's own stepper, as the charts name it."""
ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
"""Errors of the slider's acceleration at which steppers are compared."""


def measure(chart: list[Chart] | None = None, repeats: int = 5) -> Iterator[pd.DataFrame]:
    """One chart after the other, timed on this machine with what is installed.

    Parameters
    ----------
    chart
        What to time; may be repeated [default: all].
    repeats
        Of each timing, after one not counted. Laws take three times as many.

    Raises
    ------
    study.checks.StudyError
        If the package is installed without its checkout.
    """
    wanted = [checks.choice("chart", name, CHARTS) for name in chart or CHARTS]
    repeats = checks.whole("repeats", repeats, least=1)
    charts = benchmarks()
    return (getattr(charts, name)(3 * repeats if name == "laws" else repeats) for name in wanted)


def benchmarks() -> ModuleType:
    """``tests/benchmarks/charts.py``, which times a chart; `StudyError` without a checkout."""
    folder = paths.ROOT / "tests"
    paths.require_checkout(folder)
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    return import_module("benchmarks.charts")


def pareto_front(rows: pd.DataFrame, error: str = "rms_error", cost: str = "time") -> pd.DataFrame:
    """Rows of a chart that no other row beats in both error and cost, from the cheapest on."""
    ordered = rows.dropna(subset=[cost, error]).sort_values([cost, error])
    return ordered[ordered[error] < ordered[error].cummin().shift(fill_value=np.inf)]


def time_at(rows: pd.DataFrame, errors: ArrayLike) -> NDArray[np.float64]:
    """Time in s that a method needs for given errors, from its rows in a chart.

    Logarithms are interpolated along the `pareto_front`. NaN for an error below that of every row.
    """
    front = pareto_front(rows)[::-1]  # errors ascend
    known = np.log(front[["rms_error", "time"]].to_numpy()).T
    return np.exp(np.interp(np.log(errors), *known, left=np.nan))


def at_equal_error(steppers: pd.DataFrame, errors: Sequence[float] = ERRORS) -> pd.DataFrame:
    """Time of every stepper at given errors, and its ratio to that of the study's own.

    Columns method, called, error, time, ratio; without errors that a stepper does not reach.
    """
    parts = [
        pd.DataFrame(
            {"method": name[0], "called": name[1], "error": errors, "time": time_at(part, errors)}
        )
        for name, part in steppers.groupby(["method", "called"], sort=False)
    ]
    table = pd.concat(parts, ignore_index=True)
    own = table[table.method == OURS].set_index("error").time
    return table.assign(ratio=table.time / table.error.map(own)).dropna(ignore_index=True)
