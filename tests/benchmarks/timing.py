"""Timing of calls on one thread, rows of a chart from them, and the machine that they belong to."""

import os
import platform
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from importlib import metadata
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

COMPILED, PYTHON, PROGRAM = "compiled", "from Python", "as a program"
"""How a method is called: in a compiled loop, by a loop in Python, or as a process of its own."""
COLUMNS = {
    "chart": "laws, solvers, steppers or flexible",
    "program": "ours, or the other program's name",
    "version": "Version of the program",
    "method": "Law, elements or stepper",
    "called": "compiled (its whole loop), from Python, or as a program (with its start)",
    "setting": "Its resolution, orders, tolerance or step",
    "time": "Median of the repeats, per call, curve or scene",
    "time_low": "First quartile of the repeats",
    "time_high": "Third quartile of the repeats",
    "repeats": "Number of calls that count; the first does only where it is the only one",
    "relative": "Time over that of the chart's first row",
    "vectorised": "Laws: time per element of an array of 10,000, over that of Hertz's law; else 0",
    "largest_error": "Largest relative error of the force; of a stepper the same as rms_error",
    "rms_error": "RMS relative error of the force, or NRMS error of the slider's acceleration",
    "compile_time": "Time to compile, once per machine; 0 for what is not compiled on use",
    "machine": "Processor and Python",
}
"""Of a chart, and of ``data/published/speed.csv``."""
ENOUGH = 2.0  # s in calls of a function, after which it is not called again
_COMPILING = """
import pathlib, sys, time
import numpy as np
from study import paths
paths.BUILD = paths.CACHE = pathlib.Path(sys.argv[1])
sys.path.insert(0, sys.argv[2])
from study.contact import hertz
from study.measure import explicit
from study.mechanism import Scene, law_in_scene, simulate
law = law_in_scene.in_joint(Scene(), hertz, Scene().clearance).packed()
{prepare}
start = time.perf_counter()
{call}
middle = time.perf_counter()
{call}
print(middle - start - (time.perf_counter() - middle))
"""


def timed(function: Callable[[], Any], repeats: int) -> tuple[NDArray[np.float64], Any]:
    """Times of a call in s, and its result, as of `timed_by_turns`."""
    return timed_by_turns([function], repeats)[0]


def timed_by_turns(
    functions: Sequence[Callable[[], Any]], repeats: int
) -> list[tuple[NDArray[np.float64], Any]]:
    """Times of calls in s, on one thread and in turns, with each function's result.

    A function is not called again once its calls took `ENOUGH`. Its first call counts only if it
    is the only one.
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


def compile_time(call: str, prepare: str = "") -> float:
    """Seconds that a compiled call takes longer in a new process with an empty cache."""
    code = _COMPILING.format(call=call, prepare=prepare)
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", code, folder, str(Path(__file__).parents[1])]
        done = subprocess.run(command, capture_output=True, check=True, text=True)
    return float(done.stdout)


def row(
    chart: str,
    method: str,
    setting: str,
    times: NDArray[np.float64],
    error: NDArray[np.float64],
    **columns: Any,
) -> dict[str, Any]:
    """A row of a chart: quartiles of the times, the errors, and other columns that are given."""
    low, middle, high = np.quantile(times, [0.25, 0.5, 0.75])
    return {
        "chart": chart,
        "program": "ours",
        "version": version("spherical-clearance-joint-study"),
        "method": method,
        "called": COMPILED,
        "setting": setting,
        "time": middle,
        "time_low": low,
        "time_high": high,
        "repeats": len(times),
        "vectorised": 0.0,
        "largest_error": float(np.abs(error).max()),
        "rms_error": float(np.sqrt(np.mean(error**2))),
        "compile_time": 0.0,
        "machine": machine(),
    } | columns


def table(rows: list[dict[str, Any]]) -> pd.DataFrame:
    """A chart: rows with their times over that of the first."""
    frame = pd.DataFrame(rows, columns=list(COLUMNS))
    frame["relative"] = frame["time"] / frame["time"].iloc[0]
    return frame


def version(package: str) -> str:
    """Version of an installed package, or an empty text."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""


@cache
def machine() -> str:
    """Processor, its number of cores, Python and NumPy, in words."""
    model, described = platform.processor() or platform.machine(), Path("/proc/cpuinfo")
    if described.is_file():  # Linux
        names = re.findall(r"^model name\s*: *(.+)", described.read_text(), re.M)
        model = names[0].strip() if names else model
    python = f"Python {platform.python_version()}, NumPy {version('numpy')}"
    return f"{model}, {os.cpu_count()} cores, {python}, Numba {version('numba')}"
