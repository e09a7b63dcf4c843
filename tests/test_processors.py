"""Other processors: their kernels change the last digits, and no result with them."""

import platform
import re

import numpy as np
import pytest
from copied import copy_project, study

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

pytestmark = pytest.mark.skipif(
    platform.machine() != "x86_64", reason="the processors simulated here are x86-64"
)


@pytest.mark.parametrize(
    ("processor", "names"),
    [
        pytest.param(OLD, ["table1", "table2", "fig12", "convergence"], id="old"),
        pytest.param(ANOTHER, ["fig08", "table2", "fig14"], id="another"),
    ],
)
def test_results_agree_and_the_kept_files_stay(tmp_path, processor, names):
    root = copy_project(tmp_path / "project")
    done = study(root, "run", *names, **processor)
    assert done.returncode == 0, done.stdout + done.stderr
    last = done.stdout.splitlines()[-1]
    assert re.fullmatch(r"\d+ results: \d+ identical, \d+ agree, 0 differ", last)
    for made in (root / "build/made").iterdir():
        name = made.name
        assert (root / "figures" / name).read_bytes() == (paths.FIGURES / name).read_bytes()
