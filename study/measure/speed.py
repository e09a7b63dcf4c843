"""Speed against accuracy: every law, solver and stepper timed and judged in one process.

Four charts. ``laws``: a call in a compiled loop, against the curve of the paper's joint.
``solvers``: a curve of 20 depths from nothing, of a radially free ball, against the series.
``steppers``: 0.3 s of the paper's scene with clearance, against the study's stepper at its
smallest tolerance. ``flexible``: flexible links, as of `study.measure.flexible`. Times depend on
the machine: those drawn are kept in ``data/published/peers.csv``, which `study measure` writes.

A new method needs its entry in `SOLVERS` or `STEPPERS`, its run beside the others, and its look in
`study.pages.figures.METHOD_LOOKS`. The kept times are one machine's: measure a whole chart there,
with the other programs installed, or write elsewhere with ``--output``.
"""

import os
import platform
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from importlib import metadata
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, get_args

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits

from study import checks
from study.choose.law import law_options
from study.compiled import compiled
from study.contact import LAWS, tabulated
from study.contact.forces import elastic_force, pack
from study.joint import (
    Joint,
    contact_kinematics,
    fem,
    force_curve,
    paper_joint,
    series,
    whole_curve,
)
from study.joint.compliance import FINEST_RESOLUTION, RESOLUTION
from study.measure import explicit, flexible
from study.measure.peers import calculix, cvode, multibody, odes
from study.mechanism import Scene, simulate

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
RADII = (9.95e-3, 10e-3, 1.1e11)  # of the laws' calls: R1, R2 in m, E* in Pa
PAPER = paper_joint()  # of the laws
FINEST = 224  # elements along the surface of the curve that the laws are judged by
FREE = Joint(200, 1.3)  # of the solvers: a radially free ball, for which the series is exact
LAW_DEPTHS = np.linspace(0.025, 1, 40)
CURVE_DEPTHS = np.linspace(0.025, 0.5, 20)
SCENE, DURATION, OUTPUTS = Scene(), 0.3, 3000
Chart = Literal["laws", "solvers", "steppers", "flexible"]
CHARTS = get_args(Chart)
COMPILED, PYTHON, PROGRAM = "compiled", "from Python", "as a program"
"""How a method is called: in a compiled loop, by a loop in Python, or as a process of its own."""
ENOUGH = 2.0  # s in calls of a function, after which it is not called again

SOLVERS = (  # method and its resolution
    *(("series", n) for n in (320, 32, 64, 160, 640)),
    *(("six-node triangles", n) for n in (32, 64, 96, 160, 224)),
    *(("three-node triangles", n) for n in (32, 64, 96, 160, 320)),
    *(("CAX6", n) for n in (16, 32)),
    *(("CAX6, node to surface", n) for n in (16, 32, 64)),
    *(("CAX3", n) for n in (32, 64, 160)),
)
STEPS = (4e-6, 2e-6, 1e-6, 5e-7, 2e-7)
LONGEST_STEPS = {"centred": 2e-6, "velocity Verlet": 1e-6, "RK4": 1e-6}
"""In s: with longer ones the ball goes too deep (notebook 17)."""
LAST = {"LSODA": 10, "Radau": 8, "DOP853": 8, "CVODE": 10}
"""Minus the decimal logarithm of the smallest tolerance: smaller ones take many seconds."""
STEPPERS = (  # method and its tolerance or step
    *(("collocation, events", t) for t in (1e-8, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10)),
    *((s, h) for s in explicit.SCHEMES for h in STEPS if h <= LONGEST_STEPS.get(s, STEPS[0])),
    *((f"CVODE in C, {c} coordinates", 10 ** -(n / 2)) for c in cvode.SCALES for n in range(6, 25)),
    *((method, 10.0**-n) for method, most in LAST.items() for n in range(4, most + 1)),
    *(("generalised alpha", h) for h in (1e-5, 4e-6, 1e-6)),
)
OURS = STEPPERS[0][0]
ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
"""Errors of the slider's acceleration at which steppers are compared."""


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
            for n, (function, own) in enumerate(zip(functions, times, strict=True)):
                if sum(own) < ENOUGH:
                    start = perf_counter()
                    results[n] = function()
                    own.append(perf_counter() - start)
    counted = [np.array(own[1:] or own) for own in times]
    return list(zip(counted, results, strict=True))


def measure(chart: list[Chart] | None = None, repeats: int = 5) -> Iterator[pd.DataFrame]:
    """One chart after the other, with what is installed: columns of `COLUMNS`.

    Parameters
    ----------
    chart
        What to time; may be repeated [default: all].
    repeats
        Of each timing, after one not counted. Laws take three times as many.
    """
    wanted = [checks.choice("chart", name, CHARTS) for name in chart or CHARTS]
    repeats = checks.whole("repeats", repeats, least=1)
    functions = {"laws": partial(laws, 3 * repeats), "solvers": partial(solvers, repeats)}
    functions |= {"steppers": partial(steppers, repeats), "flexible": partial(flexibles, repeats)}
    return (functions[name]() for name in wanted)


def laws(repeats: int = 15, compile_times: bool = True) -> pd.DataFrame:
    """Cost and error of every law, `tabulated` and the direct solution; Hertz's law first.

    ``compile_times`` are measured as well, which takes some seconds; else they are 0.
    """
    table = tabulated(whole_curve(PAPER))
    exact = force_curve(PAPER, LAW_DEPTHS, FINEST).force_star
    depths = np.random.default_rng(0).uniform(1e-7, 5e-5, 10_000)
    prepare = "from study.measure.speed import _add; depths = np.ones(2) * 1e-6"
    seconds = _compile_time("_add(law, depths)", prepare) if compile_times else 0.0
    _add(pack("hertz", *RADII), depths[:2])  # compiled here: a first call may be the one counted
    rows = []
    for name, law in (LAWS | {"tabulated": table}).items():
        options = law_options(name, PAPER)
        times, _ = timed(partial(_add, pack(law, *RADII, **options), depths), repeats)
        elements, _ = timed(partial(law, depths / 5e-5, 200.0, **options), repeats)
        others = {"vectorised": np.median(elements), "compile_time": seconds}
        error = law(LAW_DEPTHS, 200.0, **options) / exact - 1
        rows.append(_row("laws", name, "", times / depths.size, error, **others))
    times, curve = timed(partial(force_curve, PAPER, LAW_DEPTHS), repeats)
    times /= LAW_DEPTHS.size
    setting = f"six-node triangles, resolution {RESOLUTION['quadratic']}"
    others = {"vectorised": np.median(times) * depths.size, "called": PYTHON}
    rows.append(_row("laws", "solver", setting, times, curve.force_star / exact - 1, **others))
    frame = _frame(rows)
    frame["vectorised"] /= frame["vectorised"].iloc[0]
    return frame


def solvers(repeats: int = 3, chosen: Sequence[tuple[str, int]] = SOLVERS) -> pd.DataFrame:
    """Time and error of a curve of 20 depths, bodies included; the usual series first.

    Some of `SOLVERS` are chosen; CalculiX's are left out without ``ccx``.
    """
    exact, rows = force_curve(FREE, CURVE_DEPTHS, FINEST_RESOLUTION).force_star, []
    ccx = calculix.version()
    force_curve(FREE, CURVE_DEPTHS[:1], resolution=32)  # imports
    for method, n in chosen:
        run, setting, others = partial(_curve, method, n), f"resolution {n}", {"called": PYTHON}
        if method == "series":
            setting += f", {series.ORDERS * n} orders"
        elif method.startswith("CAX"):
            if ccx is None:
                continue
            how = {"nodes": int(method[3]), "contact": "node" if "node" in method else "surface"}
            run = partial(calculix.force_curve, FREE, CURVE_DEPTHS, n, **how)
            others = {"program": "CalculiX", "version": ccx, "called": PROGRAM}
        times, force = timed(run, repeats)
        rows.append(_row("solvers", method, setting, times, force / exact - 1, **others))
    return _frame(rows)


def _curve(method, n):
    """One solution of our own, bodies and all, at one resolution and without error estimate."""
    kept = [fem.ball, fem.socket, fem.ball_compliance, fem.socket_compliance]
    kept += [series.ball_compliance, series.socket_compliance, series.hat_coefficients]
    kept.append(contact_kinematics._pairs)
    for function in kept:
        function.cache_clear()
    if method == "series":
        ball = series.ball_compliance(0.3, n)
        socket = series.socket_compliance(FREE.socket_ratio, 0.3, n)
    else:
        mesh = n, 6 if method.startswith("six") else 3
        ball = fem.ball_compliance(0.3, "plane", *mesh)
        socket = fem.socket_compliance(FREE.socket_ratio, 0.3, "mirror", *mesh)
    return contact_kinematics.solve(
        FREE, CURVE_DEPTHS, *contact_kinematics.linear(FREE, ball, socket)
    )[1][0]


def steppers(
    repeats: int = 3, chosen: Sequence[tuple[str, float]] = STEPPERS, compile_times: bool = True
) -> pd.DataFrame:
    """Time and error of 0.3 s of the mechanism; the study's stepper at its default first.

    Parameters
    ----------
    chosen
        Some of `STEPPERS`; programs that are not installed are left out.
    compile_times
        As for `laws`.
    """
    law = pack("hertz", SCENE.ball_radius, SCENE.socket_radius, SCENE.composite_modulus)
    found = [(method, setting, _stepper(method, setting, law)) for method, setting in chosen]
    found = [row for row in found if row[-1] is not None]
    truth, seconds = _ours(1e-11), {}
    if compile_times:
        seconds[OURS] = _compile_time("simulate(duration=1e-5, outputs=1)")
        call = "explicit.integrate(Scene(), law, 1e-5, 1, 1e-6, 'RK4')"
        seconds |= dict.fromkeys(explicit.SCHEMES, _compile_time(call))
    explicit.integrate(SCENE, law, 1e-5, 1, 1e-6, "RK4")  # compiles, as what calls from Python
    odes.slider_acceleration("LSODA", SCENE, law, 1e-3, 1, 1e-3)
    rows, measured = [], timed_by_turns([run for _, _, (run, _) in found], repeats)
    for (method, setting, (_, others)), (times, value) in zip(found, measured, strict=True):
        by_step = method in (*explicit.SCHEMES, "generalised alpha")
        text = f"step {setting:g} s" if by_step else f"tolerance {setting:.2g}"
        nrms = np.sqrt(np.mean((value - truth) ** 2, keepdims=True) / np.mean(truth**2))
        others = {"compile_time": seconds.get(method, 0.0)} | others
        rows.append(_row("steppers", method, text, times, nrms, **others))
    return _frame(rows)


def _stepper(method, setting, law):
    """A run of one of `STEPPERS`, and how it is called; None without its program."""
    if method == OURS:
        return partial(_ours, setting), {}
    if method in explicit.SCHEMES:
        return partial(_explicit, law, setting, method), {}
    given = SCENE, law, DURATION, OUTPUTS, setting
    if method.startswith("CVODE in C"):
        version = cvode.version()
        others = {"version": f"{version}, gcc {' '.join(cvode.FLAGS[:2])}", "program": "SUNDIALS"}
        run = partial(cvode.slider_acceleration, *given, method.split()[-2])
        return (run, others) if version else None
    if method in odes.METHODS:
        program = "SciPy" if method in odes.SCIPY else "scikit-sundae"
        run, how = partial(odes.slider_acceleration, method, *given), PYTHON
    else:
        program, how = "Exudyn", COMPILED
        run = partial(multibody.slider_acceleration, SCENE, DURATION, OUTPUTS, setting)
    version = _version(program.lower())
    return (run, {"program": program, "version": version, "called": how}) if version else None


def flexibles(repeats: int = 3, chosen: Sequence[flexible.Run] | None = None) -> pd.DataFrame:
    """Time and error of flexible links, some of `study.measure.flexible.runs` or all."""
    found = list(flexible.runs() if chosen is None else chosen)
    for joint in flexible.DURATIONS:  # compiles
        flexible.truth(joint)
        flexible.found("beams", joint, (2, 4), 4e-6)
    rows, measured = [], timed_by_turns([run.call for run in found], repeats)
    for run, (times, value) in zip(found, measured, strict=True):
        cables = {"program": "Exudyn", "version": _version("exudyn")}
        others = cables if run.method == "ANCF cables" else {}
        row = "flexible", run.method, run.setting, times, run.error(value)
        rows.append(_row(*row, **others))
    return _frame(rows)


def time_at(rows: pd.DataFrame, errors: ArrayLike) -> NDArray[np.float64]:
    """Time in s that a method needs for given errors, from its rows in a chart.

    Logarithms are interpolated between the rows that no other one beats in both error and time.
    NaN for an error below that of every row.
    """
    ordered = rows.sort_values(["time", "rms_error"])
    front = ordered[ordered.rms_error < ordered.rms_error.cummin().shift(fill_value=np.inf)][::-1]
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


def _ours(tolerance):
    options = {"duration": DURATION, "outputs": OUTPUTS, "tolerance": tolerance}
    return simulate(SCENE, **options).slider_acceleration[1:]


def _explicit(law, step, scheme):
    return explicit.integrate(SCENE, law, DURATION, OUTPUTS, step, scheme, guarded=False)[0][1:]


@compiled
def _add(law, depths):
    """Sum of a law's forces and stiffnesses: nothing is optimised away."""
    total = 0.0
    for depth in depths:
        force, stiffness = elastic_force(law, depth)
        total += force + stiffness
    return total


def least(repeats: int = 15) -> float:
    """Time in s of the cheapest possible law, in the loop of the chart of laws.

    It has force and stiffness of Hertz's law: a square root and four products.
    """
    depths = np.random.default_rng(0).uniform(1e-7, 5e-5, 10_000)
    add_least(depths[:2], 2.0)  # compiled here
    return float(np.median(timed(partial(add_least, depths, 2.0), repeats)[0])) / depths.size


@compiled
def add_least(depths, scale):
    """Sum of the forces and stiffnesses that `least` times."""
    total = 0.0
    for depth in depths:
        root = np.sqrt(depth)
        total += scale * (depth * root) + 1.5 * root
    return total


def _compile_time(call, prepare=""):
    """Seconds that a compiled call takes longer in a new process with an empty cache."""
    code = f"""
import pathlib, sys, time
import numpy as np
from study import paths
paths.BUILD = pathlib.Path(sys.argv[1])
from study.contact.forces import pack
from study.measure import explicit, flexible
from study.mechanism import Scene, simulate
law = pack("hertz", 9.95e-3, 1e-2, 1e11)
{prepare}
start = time.perf_counter()
{call}
middle = time.perf_counter()
{call}
print(middle - start - (time.perf_counter() - middle))
"""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-c", code, folder]
        done = subprocess.run(command, capture_output=True, check=True, text=True)
    return float(done.stdout)


def _version(package):
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""


def _row(chart, method, setting, times, error, **others):
    low, middle, high = np.quantile(times, [0.25, 0.5, 0.75])
    return {
        "chart": chart,
        "program": "ours",
        "version": _version("spherical-clearance-joint-study"),
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
    } | others


def _frame(rows):
    frame = pd.DataFrame(rows, columns=list(COLUMNS))
    frame["relative"] = frame["time"] / frame["time"].iloc[0]
    return frame


@cache
def machine():
    """Processor, its number of cores, Python and NumPy, in words."""
    model, described = platform.processor() or platform.machine(), Path("/proc/cpuinfo")
    if described.is_file():  # Linux
        names = re.findall(r"^model name\s*: *(.+)", described.read_text(), re.M)
        model = names[0].strip() if names else model
    python = f"Python {platform.python_version()}, NumPy {_version('numpy')}"
    return f"{model}, {os.cpu_count()} cores, {python}, Numba {_version('numba')}"
