"""Rows, states, impacts, forces and constants are read by the names of their fields."""

import ast

import pytest

from study import paths

PLAIN = {"a", "b", "shape", "times", "block", "masses", "rest", "roots", "table", "depth", "rows"}
PLAIN |= {"m1", "m2", "truth", "x", "places", "rates", "solution"}
"""Names of series of numbers, of which one may be read by its place, as the last."""
MODULES = sorted((paths.ROOT / "study/mechanism").glob("*.py"))


def is_whole(index):
    if isinstance(index, ast.UnaryOp):
        index = index.operand
    return isinstance(index, ast.Constant) and type(index.value) is int


def is_plain(node):
    """Whether it is a series of numbers, or a column of a table."""
    if isinstance(node, ast.Subscript):
        return isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, str)
    return bool(PLAIN.intersection(ast.unparse(node).split(".")))


def indexed_by_a_number(tree):
    """Subscripts with a whole number, but for those of plain series."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript):
            indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            if any(map(is_whole, indices)) and not is_plain(node.value):
                yield ast.unparse(node)


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.stem)
def test_no_number_is_an_index_into_a_record(module):
    assert list(indexed_by_a_number(ast.parse(module.read_text()))) == []


@pytest.mark.parametrize(
    "text", ["row[9]", "state[-1]", "forces(x)[5]", "p[2]", "impacts[i, 3]", "motion.coupler[0]"]
)
def test_such_an_index_is_found(text):
    assert list(indexed_by_a_number(ast.parse(f"y = {text}"))) == [text]
