"""Types of the library's public functions: all there, and no contradiction among them."""

import ast
import subprocess
import sys

import pytest

from study import paths

ROOMS = ("contact", "joint", "mechanism", "dataset", "choose", "sweep")
BOTH = ("shapes",)
"""Modules whose functions are compiled elsewhere, for scalars, and called with arrays too."""


def test_mypy(tmp_path):
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path)]
    done = subprocess.run(command, cwd=paths.ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def public_functions(tree):
    for node in tree.body:
        if getattr(node, "name", "_").startswith("_"):
            continue
        if isinstance(node, ast.ClassDef):
            yield from public_functions(node)
        elif isinstance(node, ast.FunctionDef) and not is_compiled(node):
            yield node


def is_compiled(function):
    return any(
        getattr(d, "id", None) in ("compiled", "inlined", "inner") for d in function.decorator_list
    )


def untyped(function):
    given = function.args
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return function.returns is None or any(
        one is not None and one.annotation is None and one.arg not in ("self", "cls")
        for one in every
    )


@pytest.mark.parametrize("room", ROOMS)
def test_public_functions_are_typed(room):
    found = []
    for source in sorted((paths.ROOT / "study" / room).glob("*.py")):
        if source.stem in BOTH:
            continue
        functions = public_functions(ast.parse(source.read_text()))
        found += [f"{source.stem}.{f.name}" for f in functions if untyped(f)]
    assert not found
