"""Runs of other programs for the speed charts; what is not installed is left out."""

from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from itertools import product

import numpy as np
from other_programs import cables, calculix, cvode, multibody, odes

from benchmarks import closed_form
from study.measure import charts, explicit, flexible, timing
from study.measure.timing import COMPILED, PROGRAM, PYTHON, Run
from study.mechanism import Scene

ELEMENTS = (  # CalculiX's, and its resolution
    *(("CAX6", n) for n in (16, 32)),
    *(("CAX6, node to surface", n) for n in (16, 32, 64)),
    *(("CAX3", n) for n in (32, 64, 160)),
)
SMALLEST = {"LSODA": 10, "Radau": 8, "DOP853": 8, "CVODE": 10}
"""Minus the decimal logarithm of the smallest tolerance: smaller ones take many seconds."""
STEPS = (1e-5, 4e-6, 1e-6)  # s, of Exudyn's generalised alpha method
LONGEST_OF_CABLES = 2e-4  # s; with longer steps Newton's method fails on some meshes


def laws() -> Iterator[Run]:
    """The closed form of notebook 25, whose errors are those of the joint of ``solvers``."""
    add, exact = closed_form.program(charts.FREE), charts.finest_curve()
    forces = np.array([add(np.array([depth])) for depth in charts.CURVE_DEPTHS])
    columns = {"program": "notebook 25"}
    call = partial(add, charts.CALLS, charts.SIZES["socket_radius"] - charts.SIZES["ball_radius"])
    yield Run("closed form", "7 steps", call, lambda _: forces / exact - 1, columns)


def solvers() -> Iterator[Run]:
    """CalculiX's elements, by its contact of surfaces or of nodes and surface."""
    if found := calculix.version():
        columns = {"program": "CalculiX", "version": found, "called": PROGRAM}
        for method, n in ELEMENTS:
            how = {"nodes": int(method[3]), "contact": "node" if "node" in method else "surface"}
            call = partial(calculix.force_curve, charts.FREE, charts.CURVE_DEPTHS, n, **how)
            yield charts.solver(method, f"resolution {n}", call, **columns)


def version_of(package: str) -> str:
    """Version of an installed package, or an empty text."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def counted(method: str, setting: str, motion: Callable, **columns: str) -> Run:
    """A row of a function that returns the slider's acceleration and a number of evaluations."""
    _, evaluations = motion()
    return charts.stepper(method, setting, lambda: motion()[0], evaluations=evaluations, **columns)


def steppers() -> Iterator[Run]:
    """CVODE as a compiled C program, integrators called from Python, and Exudyn.

    The evaluations of Exudyn are not counted.
    """
    law = explicit.packed(charts.SCENE, "hertz")
    span = charts.SCENE, law, charts.DURATION, charts.OUTPUTS
    if found := cvode.version():
        flags = " ".join(cvode.FLAGS[:2])
        columns = {"program": "SUNDIALS", "version": f"{found}, gcc {flags}"}
        for coordinates, n in product(cvode.SCALES, range(6, 25)):
            tolerance = 10 ** -(n / 2)
            call = partial(cvode.slider_acceleration, *span, tolerance, coordinates)
            method = f"CVODE in C, {coordinates} coordinates"
            yield counted(method, f"tolerance {tolerance:.2g}", call, **columns)
    odes.slider_acceleration("LSODA", *span[:2], 1e-3, 1, 1e-3)  # compiles what is called by it
    for method, smallest in SMALLEST.items():
        program = "SciPy" if method in odes.SCIPY else "scikit-sundae"
        if found := version_of(program.lower()):
            columns = {"program": program, "version": found, "called": PYTHON}
            for tolerance in (10.0**-n for n in range(4, smallest + 1)):
                call = partial(odes.slider_acceleration, method, *span, tolerance)
                yield counted(method, f"tolerance {tolerance:.2g}", call, **columns)
    if found := version_of("exudyn"):
        columns = {"program": "Exudyn", "version": found, "called": COMPILED}
        for step in STEPS:
            arguments = charts.SCENE, charts.DURATION, charts.OUTPUTS, step
            call = partial(multibody.slider_acceleration, *arguments)
            yield charts.stepper("generalised alpha", f"step {step:g} s", call, **columns)


def flexible_links() -> Iterator[Run]:
    """Exudyn's ANCF cables, which have no shear: theirs is the limit of links without it."""
    if found := version_of("exudyn"):
        for joint in flexible.DURATIONS:
            steps = [step for step in flexible.STEPS[joint] if step <= LONGEST_OF_CABLES]
            for n, step in product(flexible.MESHES[joint], steps):
                columns = {"program": "Exudyn", "version": found}
                at = joint, (n, 2 * n), step
                yield flexible.run("ANCF cables", *at, cable(*at), SHEAR_STIFF, **columns)


def shear_stiff(scene: Scene) -> Scene:
    """Scene with the same joint and links whose shear stiffness is a thousand times as large."""
    ball, socket = scene.materials
    poisson = (1 + scene.poisson) / 1000 - 1
    return scene.replace(poisson=poisson, ball=ball, socket=socket)


SHEAR_STIFF = shear_stiff(flexible.SCENE)


def cable(joint: flexible.Joint, elements: flexible.Elements, step: float) -> timing.Call:
    """A function without arguments that steps cables, which are assembled here."""
    scene, duration = flexible.SCENE, flexible.DURATIONS[joint]
    if joint == "ideal joint":
        return cables.ideal_joint(scene, elements, duration, flexible.OUTPUTS, step)
    return cables.first_impact(scene, elements, duration, step)


OTHERS = {
    "laws": laws,
    "solvers": solvers,
    "steppers": steppers,
    "flexible": flexible_links,
}
"""Chart -> runs of other programs."""
