"""Other processors: their kernels change the last digits, and no result with them."""

import os
import platform
import re
import subprocess
import sys

import numpy as np
import pytest
from helpers.project import copy_project, study

from study import paths

FEATURES = np._core._multiarray_umath
DISPATCHED = [f for f in FEATURES.__cpu_dispatch__ if FEATURES.__cpu_features__.get(f)]
OLD = {
    "OPENBLAS_CORETYPE": "Prescott",
    "NPY_DISABLE_CPU_FEATURES": " ".join(DISPATCHED),
    "NUMBA_CPU_NAME": "nehalem",
    "NUMBA_CPU_FEATURES": "",
}
ANOTHER = {"OPENBLAS_CORETYPE": "Zen", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(platform.machine() != "x86_64", reason="x86-64 is simulated"),
]


@pytest.mark.parametrize(
    ("processor", "names"),
    [
        pytest.param(OLD, ["table2", "fig12"], id="old"),
        pytest.param(ANOTHER, ["fig08", "fig14"], id="another"),
    ],
)
def test_results_agree_and_the_kept_files_stay(tmp_path, processor, names):
    root = copy_project(tmp_path / "project")
    done = study(root, "run", *names, **processor)
    assert done.returncode == 0, done.stdout + done.stderr
    last = done.stdout.splitlines()[-1]
    assert re.fullmatch(r"\d+ results: \d+ identical, \d+ agree, 0 differ", last)
    for name in names:
        assert (root / f"build/results/{name}.csv").is_file()
    for kept in paths.FIGURES.iterdir():
        assert (root / "figures" / kept.name).read_bytes() == kept.read_bytes()


CONSTANTS = """
import numpy as np
from study.contact import StiffenedHertz
from study.joint import Joint
for seed in range(20):
    r2, q, e, nu = np.random.default_rng(seed).uniform((20, 1.1, 0.1, 0.2), (400, 3, 9, 0.46))
    bodies = {"socket_ratio": q, "modulus_ratio": e, "poisson": nu, "socket_poisson": 0.66 - nu}
    law = StiffenedHertz.of(Joint.from_ratios(r2, **bodies, ball_support="clamped", rim="free"))
    print([float(x).hex() for x in (law.parts(law.r2_star).scale, *law.constants)])
"""


@pytest.mark.parametrize("processor", [OLD, ANOTHER], ids=["old", "another"])
def test_stiffened_hertz_has_the_same_bits(processor):
    """So that impacts, which are chaotic, are the same ones."""
    told = {
        subprocess.run(
            [sys.executable, "-c", CONSTANTS],
            env=os.environ | {"PYTHONPATH": str(paths.ROOT)} | changed,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for changed in ({}, processor)
    }
    assert len(told) == 1
