"""What an import or a quick command loads."""

import subprocess
import sys

import pytest

HEAVY = {"numba", "pandas", "skfem", "matplotlib"}


LIST = """
import contextlib, io
from study import cli
with contextlib.redirect_stdout(io.TextIOWrapper(io.BytesIO())):
    cli.main(["list"], standalone_mode=False)
"""


def loaded(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.mark.parametrize(
    ("code", "heavy"),
    [
        ("import study.contact", HEAVY),
        ("from study.mechanism import Scene, simulate", {"skfem", "matplotlib", "study.dataset"}),
        ("from study.joint import Joint, Material", HEAVY),
        (LIST, {*HEAVY, "snakemake", "sqlalchemy", "scipy", "papermill"}),
    ],
)
def test_an_import_loads_what_it_needs(code, heavy):
    assert not heavy & set(loaded(f"{code}\nimport sys\nprint(*sys.modules)"))
