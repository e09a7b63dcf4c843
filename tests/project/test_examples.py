"""Examples run: programs in another folder with the number that is expected, and docstrings."""

import doctest
import os
import pydoc
import re
import subprocess
import sys
from importlib import import_module

import pytest

from study import paths
from study.contact import Material
from study.joint import Joint
from study.mechanism import Scene
from study.parameters import described

EXAMPLES = paths.ROOT / "examples"
EXPECTED = {
    "curve_of_a_joint": (r"^ *3\.892 +(\S+)", 2608, 1),
    "bearing": (r"specific load (\S+) MPa", 86.2, 0.05),
    "fit_your_curve": (r"^clearance: (\S+) um", 43.88, 0.02),
    "liner": (r"has (\S+) of the stiffness", 0.351, 0.001),
    "pendulum": (r"largest force: (\S+) N", 301.6, 0.1),
    "tolerance_of_the_clearance": (r"standard deviation: (\S+) um", 0.246, 0.001),
    "two_numbers_for_adams": (r"^2 to 20 um: .* n = (\S+),", 1.6526, 1e-4),
}
"""Where the number is in the text, the number, and how far off it may be."""


PACKAGES = ("contact", "joint", "mechanism", "choose", "dataset", "export", "cases")
WITH_EXAMPLES = [
    ".".join(path.relative_to(paths.ROOT).with_suffix("").parts).removesuffix(".__init__")
    for package in PACKAGES
    for path in sorted((paths.ROOT / "study" / package).rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]
"""Modules of the library with examples in docstrings."""


@pytest.mark.slow
@pytest.mark.parametrize("module", WITH_EXAMPLES)
def test_examples_of_docstrings_print_what_they_show(module):
    flags = doctest.NORMALIZE_WHITESPACE
    failed, attempted = doctest.testmod(import_module(module), optionflags=flags)
    assert (failed, attempted > 0) == (0, True)


CALLED_FIRST = {
    "joint": ("Joint", "first_yield"),
    "contact": ("DimensionalLaw", "Material"),
    "mechanism": ("Scene", "simulate"),
    "choose": ("compare_laws", "compare_models", "fit_curve"),
    "export": ("export",),
    "cases.run": ("solve",),
}


@pytest.mark.parametrize("module", CALLED_FIRST)
def test_what_users_call_first_has_an_example_and_short_types(module):
    for name in CALLED_FIRST[module]:
        function = getattr(import_module(f"study.{module}"), name)
        assert ">>> " in function.__doc__
        assert "_SupportsArray" not in pydoc.render_doc(function, renderer=pydoc.plaintext)


def test_every_example_has_its_number():
    assert {path.stem for path in EXAMPLES.glob("*.py")} == EXPECTED.keys()


@pytest.mark.slow
@pytest.mark.parametrize("name", EXPECTED)
def test_an_example_prints_its_number(name, tmp_path):
    if name == "pendulum":
        pytest.importorskip("exudyn")
    plot = tmp_path / "plot.png"
    done = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py", plot],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(paths.ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    pattern, number, off = EXPECTED[name]
    (found,) = re.findall(pattern, done.stdout, re.MULTILINE)
    assert float(found) == pytest.approx(number, abs=off)
    assert plot.exists() == (name == "tolerance_of_the_clearance")


@pytest.mark.parametrize("owner", [Joint, Joint.from_ratios, Scene, Material])
def test_docstrings_have_every_parameter_with_its_type(owner):
    section = re.search(r"Parameters\n *-+\n(.*?)\n\n", owner.__doc__, re.DOTALL)[1]
    names = re.findall(r"^ *(\w+(?:, \w+)*) : [\w{]", section, re.MULTILINE)
    assert {name for line in names for name in line.split(", ")} >= described(owner).keys()
