"""The recipe "A law" of CONTRIBUTING, in a copy of the project: a new law and a new shape."""

import io
import subprocess
import sys

import numba
import numpy as np
import pandas as pd
import pytest
from helpers.project import copy_project, environment

from study import compiled, paths

LAWS, SHAPES = "study/contact/laws.py", "study/contact/shapes.py"
FORCES, LOOKS = "study/contact/forces.py", "study/pages/looks.csv"
TWO_TERMS = '''@dataclass(frozen=True, repr=False)
class TwoTerms(Law):
    """P* = R2* (a ds + b ds^2)."""

    a: float = parameter(0.1, "Factor of the depth", above=0)
    b: float = parameter(1.0, "Factor of its square", above=0)

    name, fitted_constants = "two_terms", ("a", "b")

    def parts(self, r2_star: Any) -> Parts:
        return Parts(r2_star, shapes.hyperbolic, (self.b, self.a))


'''
SHAPE = """def two_terms(ds, constants):
    a, b = constants[0], constants[1]
    return ds * (a + b * ds), a + 2 * b * ds


"""
BRANCH = """    elif shape == TWO_TERMS:
        value, slope = shapes.two_terms(ds, constants)
"""
CODE = """
from study.contact import DimensionalLaw, forces
law = DimensionalLaw("two_terms", ball_radius=0.995, socket_radius=1, composite_modulus=1)
print(law.force(2e-3), law.stiffness(2e-3), *forces.elastic_force(law.packed(), 2e-3))
"""


def insert(path, text, before, after=""):
    """Put lines above the first line that begins with one text, below one with another."""
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    start = next(k for k, line in enumerate(lines) if line.startswith(after))
    place = next(k for k in range(start, len(lines)) if lines[k].startswith(before))
    path.write_text("".join([*lines[:place], text, *lines[place:]]), encoding="utf-8")


def python(root, *words):
    """Run Python in a copy; what it prints."""
    command, of_copy = [sys.executable, *words], environment(root)
    done = subprocess.run(command, cwd=root, env=of_copy, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def table(root, *words):
    """Table that a command prints, with a row for each law."""
    return pd.read_csv(io.StringIO(python(root, "-m", "study.cli", *words)), index_col="law")


def add_law(root, code):
    """Add the class of a law above the list of the classes, and to its end; and its look."""
    insert(root / LAWS, code, "CLASSES")
    insert(root / LAWS, "    TwoTerms,\n", ")", "CLASSES")
    with (root / LOOKS).open("a", encoding="utf-8") as looks:
        looks.write("law,two_terms,two terms,#999999,*,-\n")
    python(root, "data/build.py", "hash", LOOKS)


def test_a_law_with_two_fitted_constants_is_in_every_command(tmp_path):
    root = copy_project(tmp_path / "project")
    loops = root / "build/compiled" / compiled.folder().name
    add_law(root, TWO_TERMS)
    folders = [root / "study" / name for name in ("contact", "mechanism")]
    sources = [path for of in folders for path in of.glob("*.*") if path.suffix in (".py", ".toml")]
    # a law of a known shape leaves the compiled loops as they are
    loops.rename(loops.with_name(paths.digest(sorted(sources), numba.__version__)))

    depth = np.linspace(0.02, 0.6, 30)
    force = 200 * (0.2 * depth + 1.5 * depth**2)
    curve = pd.DataFrame({"depth_star": depth, "force_star": force})
    curve.to_csv(root / "curve.csv", index=False)
    row = table(root, "fit", "curve.csv", "--r2-star", "200").loc["two_terms"]
    assert [row.a, row.b] == pytest.approx([0.2, 1.5], rel=1e-6)

    row = table(root, "laws", "--r2-star", "200").iloc[-1]
    assert (row.name, row.numbers) == ("two_terms", "a=0.1, b=1")
    assert np.isnan(row.relative_cost)  # it has not been timed

    run = python(root, "-m", "study.cli", "simulate", "--law", "two_terms", "--duration", "0.003")
    assert run.splitlines()[1].startswith("1,")  # one contact
    text = python(root, "-m", "study.cli", "export", "two_terms", "c", "--r2-star", "200")
    assert "int two_terms_law(double depth" in text


def test_a_law_of_a_new_shape_is_compiled(tmp_path):
    root = copy_project(tmp_path / "project")
    insert(root / SHAPES, SHAPE, "SHAPES")
    insert(root / SHAPES, "    two_terms,\n", ")", "SHAPES")
    insert(root / FORCES, "TWO_TERMS = 8\n", '"""Place of each shape')
    insert(root / FORCES, BRANCH, "    else:", "def elastic_force")
    add_law(root, TWO_TERMS.replace("hyperbolic, (self.b, self.a)", "two_terms, (self.a, self.b)"))
    found = np.array(python(root, "-c", CODE).split(), float)
    force, stiffness = 200 * (0.1 * 0.4 + 0.4**2), 200 * (0.1 + 2 * 0.4)
    assert found == pytest.approx(2 * [0.005**2 * force, 0.005 * stiffness])
