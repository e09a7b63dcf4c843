"""Speed of the steppers: run with ``make bench``. Nothing fails for being slow.

At equal accuracy, beside other programs: ``make speed``, drawn in notebook 16.
"""

import subprocess
import sys
from functools import partial

import numpy as np
import pytest

from study.joint import Joint
from study.measure import charts
from study.mechanism import simulate
from study.mechanism.spatial import ClearanceJoint


def test_rigid_links_with_clearance(benchmark):
    benchmark.group = "0.3 s with clearance, rigid links"
    span = {"duration": charts.DURATION, "outputs": charts.OUTPUTS}
    run = partial(simulate, charts.SCENE, law="hertz", **span)
    benchmark.pedantic(run, rounds=7, warmup_rounds=1)


@pytest.mark.parametrize("model", ["particles", "beams"])
def test_flexible_links(benchmark, model):
    benchmark.group = "0.1 s with clearance, flexible links"
    benchmark.pedantic(simulate, kwargs={"model": model}, rounds=3, warmup_rounds=1)


def test_joint_in_space(benchmark):
    joint = ClearanceJoint(Joint(10e-3, 5e-5, 3e-3), restitution=0.5, friction=0.1)
    state = np.array([[3.1e-5, 3e-5, 3e-5], [0.01, -0.02, 0.04], [1.0, 2.0, 3.0]])
    benchmark.pedantic(joint.forces, (*state,), rounds=200, iterations=1000, warmup_rounds=5)


def test_start_of_stepping_in_a_new_process(benchmark):
    """With a warm cache, to the first millisecond simulated."""
    code = "from study.mechanism import simulate; simulate(duration=1e-3)"
    command = [sys.executable, "-c", code]
    benchmark.group = "start"
    benchmark.pedantic(subprocess.run, (command,), {"check": True}, rounds=3, warmup_rounds=1)
