"""Timing of calls on one thread, charts of their times and errors, and how these are read.

Times depend on the machine: those drawn are kept in ``data/published/speed.csv``, which
``make speed`` renews.
"""

import os
import platform
import re
from collections.abc import Callable, Sequence
from datetime import date
from functools import cache
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

Call = Callable[[], NDArray[np.float64]]
COMPILED, PYTHON, PROGRAM = "compiled", "from Python", "as a program"
"""How a method is called: in a compiled loop, from Python, or as a separate program."""
OURS = "collocation, events"
"""Name of the time integration of this study in the charts."""
ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
"""Errors of the slider's acceleration at which methods of time integration are compared."""
ENOUGH = 2.0  # total time in s of the calls of a function after which it is not called again


class Run(NamedTuple):
    """One method at one setting, the error of the result of ``call``, and columns of its row."""

    method: str
    setting: str
    call: Call
    error: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    columns: dict[str, Any]


def timed(function: Callable[[], Any], repeats: int) -> tuple[NDArray[np.float64], Any]:
    """Times of a call in s, and its result, as in `timed_by_turns`."""
    return timed_by_turns([function], repeats)[0]


def timed_by_turns(
    functions: Sequence[Callable[[], Any]], repeats: int
) -> list[tuple[NDArray[np.float64], Any]]:
    """Times of calls in s, on one thread and in turns, with each function's result.

    A function is not called again when its calls have taken `ENOUGH`. Its first call is left out
    unless it is the only one.
    """
    times: list[list[float]] = [[] for _ in functions]
    results = [None] * len(functions)
    with threadpool_limits(limits=1):
        for _ in range(repeats + 1):
            for n, (function, taken) in enumerate(zip(functions, times, strict=True)):
                if sum(taken) < ENOUGH:
                    start = perf_counter()
                    results[n] = function()
                    taken.append(perf_counter() - start)
    counted = [np.array(taken[1:] or taken) for taken in times]
    return list(zip(counted, results, strict=True))


def chart(name: str, runs: Sequence[Run], repeats: int) -> pd.DataFrame:
    """Rows of a chart whose runs are timed in turn; times are also relative to the first run."""
    measured = timed_by_turns([run.call for run in runs], repeats)
    return table(
        [
            row(name, run.method, run.setting, times, run.error(value), **run.columns)
            for run, (times, value) in zip(runs, measured, strict=True)
        ]
    )


def row(
    chart: str,
    method: str,
    setting: str,
    times: NDArray[np.float64],
    error: NDArray[np.float64],
    **columns: Any,
) -> dict[str, Any]:
    """A row of a chart, with all columns of ``data/published/speed.csv``; others may be given."""
    return {
        "chart": chart,
        "program": "ours",
        "version": version("spherical-clearance-joint-study"),
        "method": method,
        "called": COMPILED,
        "setting": setting,
        **spread("time", times),
        "repeats": len(times),
        "relative": 1.0,
        **spread("setup", np.zeros(1)),
        "evaluations": 0,
        "largest_error": float(np.abs(error).max()),
        "rms_error": float(np.sqrt(np.mean(error**2))),
        "first_impact_error": 0.0,
        "date": date.today().isoformat(),
        "machine": machine(),
    } | columns


def spread(name: str, times: NDArray[np.float64]) -> dict[str, float]:
    """Median and quartiles of times, as the columns ``name``, ``name_low`` and ``name_high``."""
    low, middle, high = np.quantile(times, [0.25, 0.5, 0.75])
    return {name: middle, f"{name}_low": low, f"{name}_high": high}


def table(rows: list[dict[str, Any]]) -> pd.DataFrame:
    """A chart: rows with their times, also relative to the first row."""
    frame = pd.DataFrame(rows)
    frame["relative"] = frame["time"] / frame["time"].iloc[0]
    return frame


@cache
def machine() -> str:
    """Processor, its number of cores, and the versions of Python, NumPy and Numba, as text."""
    model, described = platform.processor() or platform.machine(), Path("/proc/cpuinfo")
    if described.is_file():  # Linux
        names = re.findall(r"^model name\s*: *(.+)", described.read_text(), re.M)
        model = names[0].strip() if names else model
    python = f"Python {platform.python_version()}, NumPy {version('numpy')}"
    return f"{model}, {os.cpu_count()} cores, {python}, Numba {version('numba')}"


def time_at(rows: pd.DataFrame, errors: ArrayLike, cost: str = "time") -> NDArray[np.float64]:
    """Time in s, or another cost, that a method needs for given errors, from its rows in a chart.

    Logarithms are interpolated between the rows for which no other row has both a smaller error and
    a lower cost. NaN for an error below that of every row.
    """
    ordered = rows.sort_values([cost, "rms_error"])
    front = ordered[ordered.rms_error < ordered.rms_error.cummin().shift(fill_value=np.inf)]
    known = np.log(front[["rms_error", cost]].to_numpy()[::-1]).T  # errors ascend
    return np.exp(np.interp(np.log(errors), known[0], known[1], left=np.nan))


def at_equal_error(steppers: pd.DataFrame, errors: Sequence[float] = ERRORS) -> pd.DataFrame:
    """Time of every method of time integration at given errors, relative to that of this study.

    The columns are method, called, error, time and ratio. Errors that a method does not reach are
    left out.
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
