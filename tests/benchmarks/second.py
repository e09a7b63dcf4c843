"""The chart ``second``: one second of the paper's crank-slider, and two of its forces.

Hertz's law is in the joint. The forces are the maximum normal force after `SETTLED`, when rigid
links have no impacts any more, and that of the first impact. Rigid links are compared with the
method of this study at a very small tolerance, and flexible links with flexible links on a finer
mesh: the first force of particles with that of particles, the second with the mean of both models.
"""

from collections.abc import Callable, Iterator
from functools import cache, partial

import numpy as np
import pandas as pd
from other_programs import compiled_lsoda, cvode, multibody, odes

from benchmarks.others import STEPS, version_of
from study.measure import charts, explicit, flexible, impulses, timing
from study.measure.timing import OURS, PYTHON, Run
from study.mechanism import simulate

SCENE, SECOND, SETTLED = charts.SCENE, 1.0, 0.1
MESHES = {  # elements of the crank, step in s and simulated time in s
    "particles": ((2, None, SECOND), (4, None, SECOND), (8, None, SECOND)),
    "beams": ((2, 1e-5, 0.5), (4, 4e-6, 0.5), (8, 4e-6, 0.5)),
}
"""Beams end with an error at 0.92 s: they take half a second, and have no maximum of the second."""
FINEST_MESH = (16, 32)  # of particles


def timed(repeats: int = 5) -> pd.DataFrame:
    """Rows of the chart, that of this study with its default tolerance first."""
    runs = [*own(), *others()]
    rows, measured = [], timing.timed_by_turns([run.call for run in runs], repeats)
    for run, (times, forces) in zip(runs, measured, strict=True):
        rows.append(row_of(run, times, forces))
    return timing.table(rows)


def row_of(run: Run, times: np.ndarray, forces: np.ndarray) -> dict:
    """A row, in which the error of the first impact has a column of its own."""
    late, first = abs(run.error(forces))
    columns = {"first_impact_error": first} | run.columns
    return timing.row("second", run.method, run.setting, times, late, **columns)


def run(
    method: str, setting: str, call: Callable, exact: Callable | None = None, **columns: str
) -> Run:
    """A run whose ``call`` returns both forces in N; one that is not reached is NaN."""
    return Run(method, setting, call, lambda forces: forces / (exact or finest)() - 1, columns)


def own() -> Iterator[Run]:
    """Runs by this study's methods, and by impulses on a rigid contact."""
    for tolerance in (1e-8, 1e-2, 1e-4, 1e-6, 1e-10):
        yield run(OURS, f"tolerance {tolerance:.2g}", partial(_forces, tolerance=tolerance))
    impulses.integrate(SCENE, 1e-3, 10)  # compiles
    for step in (1e-4, 1e-5, 1e-6):
        yield run("impulses", f"step {step:g} s", partial(_impulses, step))
    for model, meshes in MESHES.items():
        for n, step, duration in meshes:
            options = {"model": model, "elements": (n, 2 * n), "step": step}
            _forces(2e-3, **options)  # compiles
            setting = f"{n} and {2 * n} elements, {duration:g} s"
            yield run(model, setting, partial(_forces, duration, **options), finest_links)


def _forces(duration=SECOND, **options):
    impacts = simulate(SCENE, law="hertz", duration=duration, outputs=1, **options).impact_rows
    late = impacts["time"] + impacts["duration"] > SETTLED
    largest = impacts["peak_force"][late].max() if duration == SECOND else np.nan
    return np.array([largest, impacts["peak_force"][0]])


def _impulses(step):
    forces, _ = impulses.integrate(SCENE, SECOND, round(SECOND / step))
    return np.array([forces[round(SETTLED / step) :].max(), forces[forces > 0][0]])


@cache
def finest() -> np.ndarray:
    """Both forces of rigid links."""
    return _forces(tolerance=1e-11)


@cache
def finest_links() -> np.ndarray:
    """Both forces of flexible links."""
    largest, _ = _forces(model="particles", elements=FINEST_MESH)
    return np.array([largest, flexible.reference("first impact")[1]])


def others() -> Iterator[Run]:
    """CVODE in C, LSODA in compiled code and from Python, and Exudyn."""
    law = explicit.packed(charts.SCENE, "hertz")
    span = charts.SCENE, law, SECOND
    if found := cvode.version():
        columns = {"program": "SUNDIALS", "version": f"{found}, gcc {' '.join(cvode.FLAGS[:2])}"}
        for tolerance in (10.0**-n for n in range(3, 11)):
            call = partial(cvode.largest_forces, *span, tolerance)
            method = "CVODE in C, contact coordinates"
            yield run(method, f"tolerance {tolerance:.2g}", call, **columns)
    if found := version_of("numbalsoda"):
        compiled_lsoda.largest_forces(*span[:2], 1e-3, 1e-3)  # compiles
        columns = {"program": "numbalsoda", "version": found}
        for tolerance in (10.0**-n for n in range(4, 10)):
            call = partial(compiled_lsoda.largest_forces, *span, tolerance)
            yield run("LSODA, compiled", f"tolerance {tolerance:.2g}", call, **columns)
    odes.largest_forces("LSODA", *span[:2], 3e-3, 1e-3)  # compiles what is called by it
    columns = {"program": "SciPy", "version": version_of("scipy"), "called": PYTHON}
    for tolerance in (1e-4, 1e-6, 1e-8):
        call = partial(odes.largest_forces, "LSODA", *span, tolerance)
        yield run("LSODA", f"tolerance {tolerance:.2g}", call, **columns)
    if found := version_of("exudyn"):
        columns = {"program": "Exudyn", "version": found}
        for step in STEPS:
            arguments = charts.SCENE, SECOND, step, SETTLED
            call = partial(multibody.largest_forces, *arguments)
            yield run("generalised alpha", f"step {step:g} s", call, **columns)
