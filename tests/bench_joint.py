"""Speed of the solver: run with ``make bench``. Not a test; nothing fails for being slow."""

import numpy as np
import pytest

from study import contact
from study.elastic import fem
from study.joint import Joint, force_curve

DEPTHS = np.linspace(0.025, 0.5, 20)


def test_default_meshes_to_compliances(benchmark):
    def both():
        fem.ball_compliance.cache_clear()
        fem.socket_compliance.cache_clear()
        fem.ball_compliance()
        fem.socket_compliance(1.19)

    benchmark.pedantic(both, rounds=5, warmup_rounds=1)


@pytest.mark.parametrize("kinematics", ["small", "linear"])
def test_curve_of_20_depths_with_its_error_estimate(benchmark, kinematics):
    joint = Joint(200, kinematics=kinematics)
    force_curve(joint, DEPTHS)  # the compliances are cached from here on
    benchmark(force_curve, joint, DEPTHS)


@pytest.mark.parametrize("law", contact.LAWS)
def test_law_on_a_thousand_depths(benchmark, law):
    benchmark(contact.LAWS[law], np.linspace(0, 1, 1000), 200.0)
