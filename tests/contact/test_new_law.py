"""The recipe "A law" of CONTRIBUTING, in a copy of the project: two new laws and a new shape."""

import io
import subprocess
import sys

import numba
import numpy as np
import pandas as pd
import pytest
from helpers.project import copy_project, environment

from study import compiled, paths
from study.joint import Joint

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
STIFFER = '''@dataclass(frozen=True, repr=False)
class Stiffer(Law):
    """Hertz's law times (1 + b ds)."""

    b: float = parameter(0.1, "Coefficient", above=0)

    name = "stiffer"

    def parts(self, r2_star: Any) -> Parts:
        return Parts(hertz_factor(r2_star), shapes.stiffer, (self.b,))


'''
SHAPE = '''def stiffer(ds, constants):
    """ds^(3/2) (1 + b ds)."""
    s, b = np.sqrt(ds), constants[0]
    return ds * s * (1 + b * ds), s * (1.5 + 2.5 * b * ds)


'''
BRANCH = """    elif shape == STIFFER:
        value, slope = shapes.stiffer(ds, constants)
"""
CODE = """
from study.contact import forces
from study.joint import Joint
law = Joint(10e-3, 50e-6, 3e-3).law("stiffer")
print(law.force(5e-6), law.stiffness(5e-6), *forces.elastic_force(law.packed(), 5e-6))
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


def add_law(root, code, name, word):
    """Add the class of a law above the list of the classes, and to its end; and its look."""
    insert(root / LAWS, code, "CLASSES")
    insert(root / LAWS, f"    {name},\n", ")", "CLASSES")
    with (root / LOOKS).open("a", encoding="utf-8") as looks:
        looks.write(f"law,{word},{word},#999999,*,-\n")
    python(root, "data/build.py", "hash", LOOKS)


@pytest.fixture
def root(tmp_path):
    return copy_project(tmp_path / "project")


def test_a_law_with_two_fitted_constants_is_in_every_command(root):
    loops = root / "build/compiled" / compiled.folder().name
    add_law(root, TWO_TERMS, "TwoTerms", "two_terms")
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
    assert "void two_terms_law(double depth" in text


def test_a_law_of_a_new_shape_is_compiled(root):
    insert(root / SHAPES, SHAPE, "SHAPES")
    insert(root / SHAPES, "    stiffer,\n", ")", "SHAPES")
    insert(root / FORCES, "STIFFER = 8\n", '"""Place of each shape')
    insert(root / FORCES, BRANCH, "    else:", "def elastic_force")
    add_law(root, STIFFER, "Stiffer", "stiffer")
    force, stiffness, *of_loops = map(float, python(root, "-c", CODE).split())
    assert force == pytest.approx(1.01 * Joint(10e-3, 50e-6, 3e-3).law("hertz").force(5e-6))
    assert of_loops == pytest.approx([force, stiffness])
