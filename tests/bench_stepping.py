"""Speed of the steppers: run with ``make bench``. Nothing fails for being slow.

At equal accuracy, beside other programs: ``make speed``, drawn in notebook 20.
"""

import subprocess
import sys
from functools import partial

import pytest

from study.measure import charts
from study.mechanism import simulate


def test_rigid_links_with_clearance(benchmark):
    benchmark.group = "0.3 s with clearance, rigid links"
    span = {"duration": charts.DURATION, "outputs": charts.OUTPUTS}
    run = partial(simulate, charts.SCENE, law="hertz", **span)
    benchmark.pedantic(run, rounds=7, warmup_rounds=1)


@pytest.mark.parametrize("model", ["particles", "beams"])
def test_flexible_links(benchmark, model):
    benchmark.group = "0.1 s with clearance, flexible links"
    benchmark.pedantic(simulate, kwargs={"model": model}, rounds=3, warmup_rounds=1)


def test_start_of_stepping_in_a_new_process(benchmark):
    """With a warm cache, to the first millisecond simulated."""
    code = "from study.mechanism import simulate; simulate(duration=1e-3)"
    command = [sys.executable, "-c", code]
    benchmark.group = "start"
    benchmark.pedantic(subprocess.run, (command,), {"check": True}, rounds=3, warmup_rounds=1)
