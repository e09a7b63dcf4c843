"""Rows, states, impacts, forces and constants are read by the names of their fields."""

import ast

from study import paths

RECORDS = {"row", "event", "impact", "impacts", "state", "forces", "motion"}
RECORDS |= {"p", "law", "parts", "joint", "contact", "load", "pose", "ball", "system", "section"}


def indexed_by_a_number(tree):
    """Subscripts of records, or of their fields, with a whole number."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript) and RECORDS & {*ast.unparse(node.value).split(".")}:
            last = node.slice.elts[-1] if isinstance(node.slice, ast.Tuple) else node.slice
            last = last.operand if isinstance(last, ast.UnaryOp) else last
            is_number = isinstance(last, ast.Constant) and isinstance(last.value, int)
            if is_number and not ast.unparse(node.value).endswith(".shape"):
                yield ast.unparse(node)


def test_no_number_is_an_index_into_a_record():
    texts = ["row[9]", "state[-1]", "p[2]", "impacts[i, 3]", "motion.coupler[0]", "z[1]"]
    found = list(indexed_by_a_number(ast.parse("; ".join(texts))))
    assert found == texts[:-1]
    for module in sorted((paths.ROOT / "study/mechanism").glob("*.py")):
        found = list(indexed_by_a_number(ast.parse(module.read_text())))
        assert not found, (module.name, found)
