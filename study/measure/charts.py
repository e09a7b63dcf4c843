"""Four charts of ``make speed``: laws, solvers, steppers and flexible links, timed.

- ``laws``: a call of each law in a compiled loop, and making the law for a joint; errors are
  relative to the elastic solution of the reference joint.
- ``solvers``: a whole curve of 20 depths for a ball on a guided plate, including the bodies; errors
  are relative to a fine series.
- ``steppers``: 0.3 s of the paper's mechanism with clearance, and how often each method evaluates
  the equations of motion; errors are relative to the method of this study with a very small
  tolerance.
- ``flexible``: flexible links; errors are relative to the mean of both models on a finer mesh.

A new method needs its run in `solvers` or `steppers`, and its style in ``study/pages/looks.csv``.
Other programs are timed by ``tests/benchmarks`` of the checkout, in the same process and in turn
with the methods of this study. A fifth chart, ``second``, is there too.
"""

from collections.abc import Iterator, Sequence
from functools import cache, partial
from typing import Literal, get_args

import numpy as np
import pandas as pd

from study.compiled import compiled
from study.contact import LAWS, DimensionalLaw, stiffening
from study.contact.forces import elastic_force
from study.joint import Joint, Solver, kinematics, modes, reference_joint, series
from study.joint.compliance import FINEST_RESOLUTION, RESOLUTION
from study.joint.joint import table_of
from study.measure import explicit, flexible, timing
from study.measure.timing import OURS, PYTHON, Run
from study.mechanism import events, paper_scene, simulate, stepping
from study.mechanism.compare import normalised_rms

Chart = Literal["laws", "solvers", "steppers", "flexible"]
CHARTS = get_args(Chart)
SIZES = {"ball_radius": 9.95e-3, "socket_radius": 10e-3, "composite_modulus": 1.1e11}  # of laws
REFERENCE = reference_joint()  # of the laws
FINEST = 224  # elements along the surface of the curve that the laws are compared with
FREE = Joint.from_ratios(200, 1.3)  # of the solvers: the Legendre series is exact for it
SOLVED = "power", "tabulated"  # laws that need the elastic solution of a joint
CURVE_DEPTHS = np.linspace(0.025, 0.5, 20)
CALLS = np.random.default_rng(0).uniform(1e-7, 5e-5, 10_000)  # depths of calls of laws, in m
SCENE, DURATION, OUTPUTS = paper_scene(), 0.3, 3000
SOLVERS: dict[str, tuple[Solver, tuple[int, ...]]] = {
    "series": ("series", (320, 32, 64, 160, 640)),
    "six-node triangles": ("quadratic", (32, 64, 96, 160, 224)),
    "three-node triangles": ("linear", (32, 64, 96, 160, 320)),
}
"""Method -> solver and resolutions; the times of the chart are relative to the first of these."""
STEPS = (4e-6, 2e-6, 1e-6, 5e-7, 2e-7)
LONGEST_STEPS = {"velocity Verlet": 1e-6, "RK4": 1e-6}
"""Maximum steps in s; with longer ones the penetration depth becomes too large (notebook 19)."""
TOLERANCES = (1e-8, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10)  # of the study's stepper


def timed(chart: Chart, others: Sequence[Run] = (), repeats: int = 5) -> pd.DataFrame:
    """Rows of a chart, timed on this machine, with those of the runs of other programs.

    Each call is timed some times, three times as often for laws, after one that is not counted.
    """
    if chart == "laws":
        return laws(3 * repeats, others)
    runs = {"solvers": solvers, "steppers": steppers, "flexible": flexible.runs}[chart]()
    return timing.chart(chart, [*runs, *others], repeats)


def laws(repeats: int, others: Sequence[Run] = ()) -> pd.DataFrame:
    """Time and error of the laws and of the elastic solution; Hertz's law is first.

    ``setup`` is the time to make the law of a joint. The elastic solution is timed for one depth,
    and its ``setup`` is the time of the bodies, which `SOLVED` laws need as well. The calls of
    ``others`` are at `CALLS` too.
    """
    exact = REFERENCE.solve(depth_star=CURVE_DEPTHS, resolution=FINEST).force_star
    add_law(DimensionalLaw("hertz", **SIZES).packed(), CALLS[:2])  # compiled here, not counted
    first, _ = timing.timed(partial(_first_force, bodies_too=True), repeats)
    solving, _ = timing.timed(_first_force, repeats)
    bodies, rows = first - np.median(solving), []
    for name, kind in LAWS.items():
        making, law = timing.timed(partial(_made, kind), repeats)
        packed = DimensionalLaw(law, **SIZES).packed()
        times, _ = timing.timed(partial(add_law, packed, CALLS), repeats)
        setup = making + (np.median(bodies) if name in SOLVED else 0)
        columns = timing.spread("setup", setup)
        error = law(CURVE_DEPTHS, 200.0) / exact - 1
        rows.append(timing.row("laws", name, "", times / CALLS.size, error, **columns))
    setting = f"six-node triangles, resolution {RESOLUTION['quadratic']}"
    of_bodies = timing.spread("setup", bodies) | {"called": PYTHON}
    error = REFERENCE.solve(depth_star=CURVE_DEPTHS).force_star / exact - 1
    rows.append(timing.row("laws", "solver", setting, solving, error, **of_bodies))
    for run in others:
        times, total = timing.timed(run.call, repeats)
        given = "laws", run.method, run.setting, times / CALLS.size, run.error(total)
        rows.append(timing.row(*given, **run.columns))
    return timing.table(rows)


def _first_force(bodies_too=False):
    if bodies_too:
        _forget_bodies()
    return REFERENCE.solve(depth_star=0.25)


def _made(kind):
    """A law of the reference joint, whose bodies may be known, but not the law."""
    table_of.cache_clear()
    stiffening._in_r2_star.cache_clear()
    return kind.of(REFERENCE)


def solvers() -> Iterator[Run]:
    """Curves of 20 depths, including the bodies, by every method and resolution of `SOLVERS`."""
    FREE.solve(depth_star=CURVE_DEPTHS[:1], resolution=32)  # imports
    for method, (name, resolutions) in SOLVERS.items():
        for n in resolutions:
            orders = f", {series.ORDERS * n} orders" if method == "series" else ""
            run = partial(_curve, name, n)
            yield solver(method, f"resolution {n}{orders}", run, called=PYTHON)


def solver(method: str, setting: str, call: timing.Call, **columns: str) -> Run:
    """A row of the chart: ``call`` returns the forces of `FREE` at `CURVE_DEPTHS`."""
    return Run(method, setting, call, lambda force: force / finest_curve() - 1, columns)


@cache
def finest_curve():
    """Forces of `FREE` at `CURVE_DEPTHS`, by a fine series."""
    return FREE.solve(depth_star=CURVE_DEPTHS, resolution=FINEST_RESOLUTION).force_star


def _curve(name, n):
    """Forces of this study's solution, with new bodies at this resolution and at half of it."""
    _forget_bodies()
    return FREE.solve(depth_star=CURVE_DEPTHS, resolution=n, solver=name).force_star


def _forget_bodies():
    made = modes.meshed, modes.compliance, series.compliance, series.hat_coefficients
    for function in (*made, kinematics._pairs):
        function.cache_clear()


def steppers() -> Iterator[Run]:
    """Time integration by this study, with its default first, and by explicit schemes."""
    _ours(1e-2)  # compiles
    for tolerance in TOLERANCES:
        run, count = partial(_ours, tolerance), evaluations(tolerance)
        yield stepper(OURS, f"tolerance {tolerance:.2g}", run, evaluations=count)
    law = explicit.packed(SCENE, "hertz")
    explicit.integrate(SCENE, law, 1e-5, 1, 1e-6, "RK4")  # compiles
    for scheme, stages in zip(explicit.SCHEMES, explicit.STAGES, strict=True):
        for step in STEPS:
            if step <= LONGEST_STEPS.get(scheme, STEPS[0]):
                run, count = partial(_explicit, law, step, scheme), round(DURATION / step)
                yield stepper(scheme, f"step {step:g} s", run, evaluations=stages * count)


def stepper(method: str, setting: str, call: timing.Call, **columns: str | float) -> Run:
    """A row of the chart: ``call`` returns the slider's acceleration at the `OUTPUTS`."""

    def error(value):  # NRMS; the slider begins at rest
        return np.array([normalised_rms(_finest_motion(), np.append(0.0, value))])

    return Run(method, setting, call, error, columns)


@cache
def _finest_motion():
    return np.append(0.0, _ours(1e-11))


def _ours(tolerance):
    options = {"duration": DURATION, "outputs": OUTPUTS, "tolerance": tolerance}
    return simulate(SCENE, law="hertz", **options).slider_acceleration[1:]


def evaluations(tolerance):
    """Evaluations of the equations of motion by this study's time integration, without outputs."""
    law, times = explicit.packed(SCENE, "hertz"), np.array([0.0, DURATION])
    state, loop = events.stepper(SCENE, law, DURATION, tolerance)
    for _ in stepping.advance_in_blocks(loop, times, state, f"it failed at {tolerance:g}"):
        pass
    work = loop.args[1]
    return int(work.evaluations)


def _explicit(law, step, scheme):
    rows = explicit.integrate(SCENE, law, DURATION, OUTPUTS, step, scheme, guarded=False)
    return rows["slider_acceleration"][1:]


@compiled
def add_law(law, depths):
    """Sum of a law's forces and stiffnesses: nothing is optimised away."""
    total = 0.0
    for depth in depths:
        force, stiffness = elastic_force(law, depth)
        total += force + stiffness
    return total
