"""How the charts of speed against accuracy are read.

`study.measure.charts` times what they show. Times depend on the machine: those drawn are kept in
``data/published/speed.csv``, which `study measure` renews.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

OURS = "collocation, events"
"""The study's own stepper, as the charts name it."""
ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
"""Errors of the slider's acceleration at which steppers are compared."""


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
