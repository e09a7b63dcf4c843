"""Speed of the steppers: run with ``make bench``. Nothing fails for being slow.

At equal accuracy, beside other programs: ``make speed``, drawn in notebook 16.
"""

import subprocess
import sys
from functools import partial

import numpy as np
import pytest
from benchmarks import others
from other_programs import cvode, odes

from study.joint import DimensionalJoint
from study.measure import charts, explicit, flexible, timing
from study.mechanism import simulate
from study.mechanism.spatial import ClearanceJoint

LAW = explicit.packed(charts.SCENE, "hertz")
SPAN = (charts.DURATION, charts.OUTPUTS)
RUNS = {
    "this study, 1e-8": partial(
        simulate, charts.SCENE, law="hertz", duration=SPAN[0], outputs=SPAN[1]
    ),
    "LSODA, 1e-7": partial(odes.slider_acceleration, "LSODA", charts.SCENE, LAW, *SPAN, 1e-7),
    "velocity Verlet, 1e-6 s": partial(
        explicit.integrate, charts.SCENE, LAW, *SPAN, 1e-6, "velocity Verlet", guarded=False
    ),
}


@pytest.mark.parametrize("name", RUNS)
def test_rigid_links_with_clearance(benchmark, name):
    benchmark.group = "0.3 s with clearance, rigid links"
    benchmark.name = name
    benchmark.pedantic(RUNS[name], rounds=7, warmup_rounds=1)


def test_time_over_that_of_compiled_cvode(capsys):
    """Prints ratios at equal error; all runs by turns in this process."""
    if cvode.version() is None:
        pytest.skip("gcc or SUNDIALS 6 (libsundials-dev) is not installed")
    names = timing.OURS, "CVODE in C"
    runs = [*charts.steppers(compile_times=False), *others.steppers()]
    chosen = [run for run in runs if run.method.startswith(names)]
    table = timing.at_equal_error(timing.chart("steppers", chosen, 5))
    table = table.pivot(index="method", columns="error", values=["time", "ratio"])
    with capsys.disabled():
        print("\n0.3 s with clearance, rigid links, compiled: time in s, ratio to this study")
        print(table.to_string(float_format="{:.3g}".format))


@pytest.mark.parametrize("model", ["particles", "beams"])
def test_flexible_links(benchmark, model):
    benchmark.group = "0.1 s with clearance, flexible links"
    benchmark.pedantic(simulate, kwargs={"model": model}, rounds=3, warmup_rounds=1)


@pytest.mark.parametrize("method", [*flexible.MODELS, "ANCF cables"])
def test_first_impact_of_flexible_links(benchmark, method):
    """Each with the mesh and step that are within 3 % in the least time."""
    if method == "ANCF cables":
        pytest.importorskip("exudyn", reason="Exudyn is not installed")
    n, step = {"particles": (4, 1e-6), "beams": (4, 4e-6), "ANCF cables": (2, 4e-6)}[method]
    arguments = "first impact", (n, 2 * n), step
    if method == "ANCF cables":
        run = others.cable(*arguments)
    else:
        run = partial(flexible.simulated, method, *arguments)
    benchmark.group, benchmark.name = "first impact within 3 %, flexible links", method
    benchmark.pedantic(run, rounds=7, warmup_rounds=1)


@pytest.mark.parametrize("name", ["forces", "Exudyn's user function"])
def test_joint_in_space(benchmark, name):
    joint = ClearanceJoint(DimensionalJoint(10e-3, 5e-5, 3e-3), restitution=0.5, friction=0.1)
    state = [[3.1e-5, 3e-5, 3e-5], [0.01, -0.02, 0.04], [1.0, 2.0, 3.0]]
    if name == "forces":
        call = partial(joint.forces, *map(np.array, state))
    else:
        place, velocity, spin = state
        call = partial(joint._resisted, None, 0.0, 0, place, [0.0] * 3, velocity, spin)
    benchmark.group, benchmark.name = "one call of the joint in space", name
    benchmark.pedantic(call, rounds=200, iterations=1000, warmup_rounds=5)


def test_start_of_stepping_in_a_new_process(benchmark):
    """Time from the loaded library to the first millisecond simulated, with a warm cache."""
    code = (
        "import time; from study.mechanism import simulate; start = time.perf_counter(); "
        "simulate(duration=1e-3); print(time.perf_counter() - start)"
    )

    def start():
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
        return float(done.stdout)

    start()
    benchmark.group = "start"
    benchmark.name = f"whole process; of it stepping starts after {min(start(), start()):.2f} s"
    benchmark.pedantic(start, rounds=3)
