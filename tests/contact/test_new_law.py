"""The recipe "add a law": one more law in a copy of the project is in every command."""

import subprocess
import sys

import pytest
from helpers.project import copy_project, study

from study.contact import Hertz

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
}
"""File -> texts there, and what is there with the law."""


def test_a_new_law_is_in_every_command(tmp_path):
    root = copy_project(tmp_path / "project")
    for name, changes in RECIPE.items():
        text = (root / name).read_text(encoding="utf-8")
        for old, new in changes:
            assert text.count(old) == 1
            text = text.replace(old, new)
        (root / name).write_text(text, encoding="utf-8")
    for words in (
        "simulate --law stiffer --duration 0.003",
        "export stiffer c --r2-star 200",
        "laws --r2-star 200",
    ):
        done = study(root, *words.split())
        assert done.returncode == 0, done.stderr
    code = "from study.contact import LAWS; print(LAWS['stiffer'](0.2)(0.1, 200))"
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True)
    assert float(done.stdout) == pytest.approx(Hertz()(0.1, 200) * 1.02)
