"""The recipe "add a law": one more law in a copy of the project changes no result but its own."""

import os
import subprocess
import sys

import pandas as pd
import pytest
from helpers.project import copy_project, environment, study

from study import paths

pytestmark = pytest.mark.slow
SHAPE = '''def stiffer(ds, constants):
    """ds^(3/2) (1 + b ds)."""
    s, b = np.sqrt(ds), constants[0]
    return ds * s * (1 + b * ds), s * (1.5 + 2.5 * b * ds)


SHAPES = '''
LAW = '''@dataclass(frozen=True, repr=False)
class Stiffer(Law):
    """Hertz's law times (1 + b ds)."""

    b: float = parameter(0.1, "Coefficient", above=0)

    name, evidence = "stiffer", "user's"

    def parts(self, r2_star: Any) -> Parts:
        return Parts(hertz_factor(r2_star), shapes.stiffer, (self.b,))


PAPER_LAWS = '''
LOOK = "law,stiffer,stiffer Hertz,#117733,>,-.\n"
RECIPE = {
    "study/contact/shapes.py": [
        ("SHAPES = ", SHAPE),
        ("stiffened, table)\n", "stiffened, table, stiffer)\n"),
    ],
    "study/contact/forces.py": [
        ("STIFFENED, TABLE = range", "STIFFENED, TABLE, STIFFER = range"),
        (
            "    else:\n        value, slope = shapes.table",
            "    elif shape == STIFFER:\n        value, slope = shapes.stiffer(ds, constants)\n"
            "    else:\n        value, slope = shapes.table",
        ),
    ],
    "study/contact/laws.py": [
        ("PAPER_LAWS = ", LAW),
        ("StiffenedHertz, Table)\n", "StiffenedHertz, Table, Stiffer)\n"),
    ],
    "study/pages/looks.csv": [("law,tabulated", f"{LOOK}law,tabulated")],
}
"""File -> texts there, and what is there with the law."""
LAW_PART = """
import json, sys
for cell in json.load(open(sys.argv[1]))["cells"]:
    if cell["cell_type"] == "code":
        exec(source := "".join(cell["source"]))
        if "speed_laws" in source:
            break
"""
"""What notebook 16 does up to the chart of the laws."""


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    root = copy_project(tmp_path_factory.mktemp("law") / "project")
    for name, changes in RECIPE.items():
        text = (root / name).read_text(encoding="utf-8")
        for old, new in changes:
            assert text.count(old) == 1
            text = text.replace(old, new)
        (root / name).write_text(text, encoding="utf-8")
    assert study(root, "data", "accept", "study/pages/looks.csv").returncode == 0
    return root


def test_results_of_all_laws_stay_as_they_are(project):
    done = study(project, "run", "trend", "reach")
    assert done.returncode == 0, done.stderr


def test_a_new_law_is_timed_and_drawn_by_its_cost(project, tmp_path):
    words = ("measure", "--chart", "laws", "--repeats", "1")
    done = study(project, *words)
    assert done.returncode == 0, done.stderr
    notebook = project / "notebooks/16-speed-against-accuracy.ipynb"
    results = environment(project) | {paths.WRITE_VARIABLE: str(tmp_path)}
    command = [sys.executable, "-c", LAW_PART, notebook]
    subprocess.run(command, cwd=project, env=results, check=True)
    assert "stiffer" in set(pd.read_csv(tmp_path / "speed_laws.csv").method)
    assert os.path.getsize(tmp_path / "speed_laws.png")


def test_a_new_law_is_in_every_command(project):
    joint = ("--r2-star", "200")
    for words in (
        ("law", "stiffer", *joint, "--depth-star", "0.1", "--b", "0.2", "--json"),
        ("simulate", "--law", "stiffer", "--option", "b=0.2", "--duration", "0.003", "--json"),
        ("export", "--law", "stiffer", "--option", "b=0.2", "--format", "c", *joint),
    ):
        done = study(project, *words)
        assert done.returncode == 0, done.stderr
