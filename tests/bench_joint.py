"""Speed of the solver and the laws: run with ``make bench``. Nothing fails for being slow.

Compiled laws, as the steppers call them: ``make speed``.
"""

import numpy as np
import pytest

from study import contact
from study.joint import Joint, modes, series
from study.joint.compliance import Ball, Socket
from study.joint.joint import table_of

JOINT = Joint.from_ratios(200)
OFF_AXIS = Joint.from_ratios(200, ball_support="core:0.2")
DEPTHS = np.linspace(0.025, 0.5, 20)


@pytest.mark.parametrize("solver", [series, modes])
def test_bodies(benchmark, solver):
    def both():
        for cached in (series.compliance, series.hat_coefficients, modes.compliance, modes.meshed):
            cached.cache_clear()
        for body in (Ball(), Socket(1.19)):
            solver.compliance(body)

    benchmark.pedantic(both, rounds=5, warmup_rounds=1)


@pytest.mark.parametrize("depth", [0.1, 0.5, 1.0])
def test_a_depth_off_the_axis_with_its_error_estimate(benchmark, depth):
    OFF_AXIS.solve(depth_star=0.1, tilt=30)  # the bodies are cached from here on
    benchmark.pedantic(lambda: OFF_AXIS.solve(depth_star=depth, tilt=30), rounds=5)


@pytest.mark.parametrize("kinematics", ["small", "linear"])
def test_curve_of_20_depths_with_its_error_estimate(benchmark, kinematics):
    joint = Joint.from_ratios(200, kinematics=kinematics)
    joint.solve(depth_star=DEPTHS[-1:])  # the bodies are cached from here on
    benchmark.pedantic(lambda: joint.solve(depth_star=DEPTHS), rounds=20)


@pytest.mark.parametrize("bodies", ["known", "new"])
def test_table_of_a_joint(benchmark, bodies):
    def new():
        table_of.cache_clear()
        if bodies == "new":
            series.compliance.cache_clear()
        return JOINT.table()

    benchmark.pedantic(new, rounds=10, warmup_rounds=1)


@pytest.mark.parametrize("law", contact.LAWS)
def test_law_on_a_thousand_depths(benchmark, law):
    benchmark(JOINT.law(law).law, np.linspace(0, 1, 1000), 200.0)
