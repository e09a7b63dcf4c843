"""The four charts of `study measure`: laws, solvers and steppers, timed in one process.

`study.measure.speed` says what each chart shows. A new method needs its entry in `SOLVERS` or
`STEPPERS`, its run beside the others, and its look in `study.pages.figures.METHOD_LOOKS`. The kept
times are one machine's: measure a whole chart there, with the other programs installed, or write
elsewhere with ``--output``.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np
import pandas as pd
from other_programs import calculix, cvode, multibody, odes

from benchmarks import flexible_links, timing
from benchmarks.timing import COMPILED, PROGRAM, PYTHON
from study.compiled import compiled
from study.contact import LAWS, DimensionalLaw, tabulated
from study.contact.forces import elastic_force
from study.joint import (
    Joint,
    contact_kinematics,
    fem,
    force_curve,
    nested_contact,
    paper_joint,
    series,
    whole_curve,
)
from study.joint.compliance import FINEST_RESOLUTION, RESOLUTION
from study.joint.law_parameters import law_parameters
from study.measure import explicit
from study.measure.speed import OURS
from study.mechanism import paper_scene, simulate
from study.mechanism.compare import normalised_rms
from study.mechanism.law_in_scene import in_joint

SIZES = {"ball_radius": 9.95e-3, "socket_radius": 10e-3, "composite_modulus": 1.1e11}  # of laws
PAPER = paper_joint()  # of the laws
FINEST = 224  # elements along the surface of the curve that the laws are judged by
FREE = Joint(200, 1.3)  # of the solvers: a radially free ball, for which the series is exact
LAW_DEPTHS = np.linspace(0.025, 1, 40)
CURVE_DEPTHS = np.linspace(0.025, 0.5, 20)
SCENE, DURATION, OUTPUTS = paper_scene(), 0.3, 3000
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
    *((OURS, t) for t in (1e-8, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10)),
    *((s, h) for s in explicit.SCHEMES for h in STEPS if h <= LONGEST_STEPS.get(s, STEPS[0])),
    *((f"CVODE in C, {c} coordinates", 10 ** -(n / 2)) for c in cvode.SCALES for n in range(6, 25)),
    *((method, 10.0**-n) for method, most in LAST.items() for n in range(4, most + 1)),
    *(("generalised alpha", h) for h in (1e-5, 4e-6, 1e-6)),
)


def laws(repeats: int = 15, compile_times: bool = True) -> pd.DataFrame:
    """Cost and error of every law, `tabulated` and the direct solution; Hertz's law first.

    ``compile_times`` are measured as well, which takes some seconds; else they are 0.
    """
    solved = tabulated(whole_curve(PAPER))
    exact = force_curve(PAPER, LAW_DEPTHS, FINEST).force_star
    depths = np.random.default_rng(0).uniform(1e-7, 5e-5, 10_000)
    prepare = "from benchmarks.charts import add_law; depths = np.ones(2) * 1e-6"
    seconds = timing.compile_time("add_law(law, depths)", prepare) if compile_times else 0.0
    compiled_here = DimensionalLaw("hertz", **SIZES).packed()  # a first call may be the one counted
    add_law(compiled_here, depths[:2])
    rows = []
    for name, law in (LAWS | {"tabulated": solved}).items():
        options = law_parameters(law, PAPER)
        packed = DimensionalLaw(law, **SIZES, **options).packed()
        times, _ = timing.timed(partial(add_law, packed, depths), repeats)
        elements, _ = timing.timed(partial(law, depths / 5e-5, 200.0, **options), repeats)
        columns = {"vectorised": np.median(elements), "compile_time": seconds}
        error = law(LAW_DEPTHS, 200.0, **options) / exact - 1
        rows.append(timing.row("laws", name, "", times / depths.size, error, **columns))
    times, curve = timing.timed(partial(force_curve, PAPER, LAW_DEPTHS), repeats)
    times /= LAW_DEPTHS.size
    setting = f"six-node triangles, resolution {RESOLUTION['quadratic']}"
    columns = {"vectorised": np.median(times) * depths.size, "called": PYTHON}
    error = curve.force_star / exact - 1
    rows.append(timing.row("laws", "solver", setting, times, error, **columns))
    frame = timing.table(rows)
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
        run, setting, columns = partial(_curve, method, n), f"resolution {n}", {"called": PYTHON}
        if method == "series":
            setting += f", {series.ORDERS * n} orders"
        elif method.startswith("CAX"):
            if ccx is None:
                continue
            how = {"nodes": int(method[3]), "contact": "node" if "node" in method else "surface"}
            run = partial(calculix.force_curve, FREE, CURVE_DEPTHS, n, **how)
            columns = {"program": "CalculiX", "version": ccx, "called": PROGRAM}
        times, force = timing.timed(run, repeats)
        rows.append(timing.row("solvers", method, setting, times, force / exact - 1, **columns))
    return timing.table(rows)


def _curve(method, n):
    """One solution of our own, bodies and all, at one resolution and without error estimate."""
    cached = fem.meshed, fem.compliance, series.compliance, series.hat_coefficients
    for function in (*cached, contact_kinematics._pairs):
        function.cache_clear()
    bodies = FREE.ball_body, FREE.socket_body
    if method == "series":
        compliances = [series.compliance(body, n) for body in bodies]
    else:
        nodes = 6 if method.startswith("six") else 3
        compliances = [fem.compliance(body, n, nodes) for body in bodies]
    _, axial = contact_kinematics.linear(FREE, *compliances)
    eccentricities = 1 + max(CURVE_DEPTHS) * np.array([0, 0.5, 1])
    contacts = nested_contact.NestedContacts(FREE, *compliances, np.pi, eccentricities)
    pressure = np.array([contacts.pressure(depth) for depth in CURVE_DEPTHS])
    return FREE.r2_star * pressure @ axial


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
    law = in_joint(SCENE, LAWS["hertz"], SCENE.clearance).packed()
    runs = [(method, setting, _stepper(method, setting, law)) for method, setting in chosen]
    runs = [run for run in runs if run[-1] is not None]
    truth, seconds = _ours(1e-11), {}
    if compile_times:
        seconds[OURS] = timing.compile_time("simulate(law='hertz', duration=1e-5, outputs=1)")
        call = "explicit.integrate(Scene(), law, 1e-5, 1, 1e-6, 'RK4')"
        seconds |= dict.fromkeys(explicit.SCHEMES, timing.compile_time(call))
    explicit.integrate(SCENE, law, 1e-5, 1, 1e-6, "RK4")  # compiles, as what calls from Python
    odes.slider_acceleration("LSODA", SCENE, law, 1e-3, 1, 1e-3)
    rows, measured = [], timing.timed_by_turns([call for _, _, (call, _) in runs], repeats)
    for (method, setting, (_, columns)), (times, value) in zip(runs, measured, strict=True):
        by_step = method in (*explicit.SCHEMES, "generalised alpha")
        text = f"step {setting:g} s" if by_step else f"tolerance {setting:.2g}"
        nrms = normalised_rms(np.append(0.0, truth), np.append(0.0, value))  # it begins at rest
        columns = {"compile_time": seconds.get(method, 0.0)} | columns
        rows.append(timing.row("steppers", method, text, times, np.array([nrms]), **columns))
    return timing.table(rows)


def _stepper(method, setting, law):
    """A call of one of `STEPPERS`, and its columns in the chart; None without its program."""
    if method == OURS:
        return partial(_ours, setting), {}
    if method in explicit.SCHEMES:
        return partial(_explicit, law, setting, method), {}
    arguments = SCENE, law, DURATION, OUTPUTS, setting
    if method.startswith("CVODE in C"):
        version = cvode.version()
        flags = " ".join(cvode.FLAGS[:2])
        columns = {"version": f"{version}, gcc {flags}", "program": "SUNDIALS"}
        run = partial(cvode.slider_acceleration, *arguments, method.split()[-2])
        return (run, columns) if version else None
    if method in odes.METHODS:
        program = "SciPy" if method in odes.SCIPY else "scikit-sundae"
        run, how = partial(odes.slider_acceleration, method, *arguments), PYTHON
    else:
        program, how = "Exudyn", COMPILED
        run = partial(multibody.slider_acceleration, SCENE, DURATION, OUTPUTS, setting)
    version = timing.version(program.lower())
    return (run, {"program": program, "version": version, "called": how}) if version else None


def flexible(repeats: int = 3, chosen: Sequence[flexible_links.Run] | None = None) -> pd.DataFrame:
    """Time and error of flexible links, some of `flexible_links.runs` or all."""
    runs = list(flexible_links.runs() if chosen is None else chosen)
    for joint in flexible_links.DURATIONS:  # compiles
        flexible_links.truth(joint)
        flexible_links.judged("beams", joint, (2, 4), 4e-6)
    rows, measured = [], timing.timed_by_turns([run.call for run in runs], repeats)
    exudyn = {"program": "Exudyn", "version": timing.version("exudyn")}
    for run, (times, value) in zip(runs, measured, strict=True):
        columns = exudyn if run.method == "ANCF cables" else {}
        error = run.error(value)
        rows.append(timing.row("flexible", run.method, run.setting, times, error, **columns))
    return timing.table(rows)


def _ours(tolerance):
    options = {"duration": DURATION, "outputs": OUTPUTS, "tolerance": tolerance}
    return simulate(SCENE, law="hertz", **options).slider_acceleration[1:]


def _explicit(law, step, scheme):
    return explicit.integrate(SCENE, law, DURATION, OUTPUTS, step, scheme, guarded=False)[0][1:]


@compiled
def add_law(law, depths):
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
    return float(np.median(timing.timed(partial(add_least, depths, 2.0), repeats)[0])) / depths.size


@compiled
def add_least(depths, scale):
    """Sum of the forces and stiffnesses that `least` times."""
    total = 0.0
    for depth in depths:
        root = np.sqrt(depth)
        total += scale * (depth * root) + 1.5 * root
    return total
