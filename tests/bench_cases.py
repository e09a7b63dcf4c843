"""Throughput of many cases: run with ``make bench``. Nothing fails for being slow."""

import numpy as np
import pytest

from study.cases import run
from study.cases.joints import JOINTS
from study.cases.scenes import SCENES

RANDOM = np.random.default_rng(0)
JOINTS_AT_RANDOM = [
    {"r2_star": radius, "socket_ratio": ratio, "depth_star": "0.1;0.5"}
    for radius, ratio in zip(
        RANDOM.uniform(20, 2000, 300), RANDOM.uniform(1.1, 2, 300), strict=True
    )
]
SCENES_AT_RANDOM = [{"clearance": gap} for gap in RANDOM.uniform(2e-5, 2e-4, 300)]


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize(
    ("kind", "cases"), [(JOINTS, JOINTS_AT_RANDOM), (SCENES, SCENES_AT_RANDOM)]
)
def test_random_cases(benchmark, kind, cases, jobs):
    run.solve(kind, cases[:2], jobs=1)  # compiled from here on
    table = benchmark.pedantic(run.solve, (kind, cases, None, jobs), rounds=1)
    assert "error" not in table
    of = "joints" if kind is JOINTS else "scenes of 0.1 s"
    benchmark.stats.name = f"{len(cases)} {of}, {jobs} processes"
