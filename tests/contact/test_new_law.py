"""The recipe "add a law": one more law in a copy of the project, drawn where every law is."""

import os
import subprocess
import sys

import pandas as pd
import pytest
from helpers.copied import copy_project, environment, study

from study import paths

LAW = '''@_law
def seventh(r2_star: Floats) -> Parts:
    """A tenth more than Hertz."""
    return 1.1 * 4 / 3 * np.sqrt(r2_star * (r2_star - 1)), shapes.hertz, ()


LAWS: dict'''
RECIPE = [
    ("LAWS: dict", LAW),
    ('Literal[PaperLawName, "', 'Literal[PaperLawName, "seventh", "'),
    ("stiffened_hertz)\n}", "stiffened_hertz, seventh)\n}"),
]
"""Texts of study/contact/laws.py, and what stands there with the law."""
DESCRIBE = "from study.dataset import record; record.write_description()"
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
    path = root / "study/contact/laws.py"
    text = path.read_text()
    for old, new in RECIPE:
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text)
    python(root, "-c", DESCRIBE)
    return root


def python(root, *words, **more):
    done = subprocess.run(
        [sys.executable, *words],
        cwd=root,
        env=environment(root) | more,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_a_new_law_is_drawn_where_every_law_is(project):
    done = study(project, "run", "trend", "reach")
    assert done.returncode == 1  # the figures of every law differ from the kept ones
    assert "failed" not in done.stderr
    trend, radius, reach = (
        pd.read_csv(project / f"figures/{name}.csv") for name in ("trend", "reach_radius", "reach")
    )
    kept = pd.read_csv(paths.FIGURES / "trend.csv")
    assert trend.seventh.to_numpy() == pytest.approx(1.1 * trend.hertz, rel=1e-8)
    assert set(trend) - set(kept) == {"seventh", "slope_seventh", "exponent_seventh"}
    assert "seventh" in set(radius.law) & set(reach.law)
    compared = project / "figures/fig10.csv"  # the paper's comparison has the paper's laws
    assert compared.read_bytes() == (paths.FIGURES / compared.name).read_bytes()


def test_a_new_law_is_timed_and_drawn_by_its_cost(project, tmp_path):
    words = ("measure", "--chart", "laws", "--repeats", "1")
    done = study(project, *words)
    assert done.returncode == 0, done.stderr
    notebook = project / "notebooks/16-speed-against-accuracy.ipynb"
    python(project, "-c", LAW_PART, str(notebook), **{paths.RESULTS_VARIABLE: str(tmp_path)})
    assert "seventh" in set(pd.read_csv(tmp_path / "speed_laws.csv").method)
    assert os.path.getsize(tmp_path / "speed_laws.png")


def test_a_new_law_is_on_the_command_line(project):
    done = study(project, "law", "seventh", "--r2-star", "200", "--depth-star", "0.1", "--json")
    assert done.returncode == 0, done.stderr
    done = study(project, "simulate", "--law", "seventh", "--duration", "0.003", "--json")
    assert done.returncode == 0, done.stderr
